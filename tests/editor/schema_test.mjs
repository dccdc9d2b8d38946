// The published schemas in an editor: a language server finds nothing wrong with the scenes that come along, marks what
// is wrong where it stands, and completes and explains what is being written.
//   node schema_test.mjs WITHY SCENES
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { LanguageServer } from './language_server.mjs';

const [withy, scenes] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'withy-editor-'));
const schema = (name, ...options) => writeFileSync(join(folder, name), execFileSync(withy, ['schema', ...options]));
// The line that docs/command-line.md gives for editors.
const headed = (text, name = 'withy.schema.json') => `# yaml-language-server: $schema=${name}\n${text}`;
const file = name => join(folder, name);
const begun = `format: withy/1
bodies:
  rod: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: rod}
`;

async function check_scenes(server) {
  const names = ['', 'gallery/'].flatMap(part => readdirSync(join(scenes, part)).filter(n => n.endsWith('.yaml')).map(n => part + n));
  assert.ok(names.length > 30);
  for (const name of names)
    assert.deepEqual(await server.problems(file(name.replace('/', '-')), headed(readFileSync(join(scenes, name), 'utf8'))), [], name);
  const plans = readdirSync(join(scenes, 'sweeps')).filter(n => n.endsWith('.yaml'));
  for (const name of plans)
    assert.deepEqual(await server.problems(file(`plan-${name}`), headed(readFileSync(join(scenes, 'sweeps', name), 'utf8'), 'sweep.schema.json')), [], name);
  return names.length + plans.length;
}

async function check_faults(server) {
  const faults = [
    [/mass: 1,/, 'mas: 1,', 4, /mas/],
    [/mass: 1,/, 'mass: [1],', 4, /type/i],
    [/revolute/, 'revolut', 6, /./],
    [/axis: \[0, 0, 1\]/, 'axis: [0, 0]', 6, /./],
    [/bodies:/, 'bodeis:', 3, /bodeis/],
  ];
  for (const [[from, to, line, message], k] of faults.map((f, i) => [f, i])) {
    const found = await server.problems(file(`fault-${k}.yaml`), headed(begun.replace(from, to)));
    assert.ok(found.some(p => p.line === line && message.test(p.message)), `${to}: ${JSON.stringify(found)}`);
  }
}

async function check_completion(server) {
  const offers = async (name, text, ...wanted) => {
    const labels = await server.completions(file(name), headed(text));
    for (const label of wanted) assert.ok(labels.includes(label), `${label} of ${text.split('\n').at(-1)}: ${labels.slice(0, 30)}`);
  };
  await offers('top.yaml', `${begun}lo`, 'loads');
  await offers('type.yaml', 'format: withy/1\nbodies:\n  link:\n    type: ', 'beam', 'rigid');
  await offers('beam.yaml', 'format: withy/1\nbodies:\n  link:\n    type: beam\n    ', 'length', 'mass_per_length', 'bending_y');
  await offers('hinge.yaml', `${begun}  elbow:\n    type: `, 'revolute', 'spherical');
  await offers('load.yaml', `${begun}loads:\n  push:\n    type: hinge-effort\n    `, 'hinge', 'law');
  await offers('integrator.yaml', `${begun}integrator:\n  name: `, 'dopri5', 'radau');
}

async function check_hover(server) {
  const text = headed(`${begun}gravity: [0, -9.81, 0]\n`);
  assert.match(await server.hover(file('hover.yaml'), text, 7, 3), /m\/s/);
}

schema('withy.schema.json');
schema('sweep.schema.json', '--sweep');
const server = await new LanguageServer().begin();
try {
  const count = await check_scenes(server);
  await check_faults(server);
  await check_completion(server);
  await check_hover(server);
  console.log(`the language server knows ${count} scenes and plans, and what is wrong with others`);
} finally {
  server.end();
  rmSync(folder, { recursive: true });
}
