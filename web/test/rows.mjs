// What pages say of rows: at which times differences can be told, what a legend may say, and that plots of long runs lose
// neither peaks nor turns. Expected numbers are closed forms, or those of results.csv.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { grouped, passed_unseen, prepared } from '../src/data.js';
import { common_times, difference, nearest_own, own_before, place_of } from '../src/rows.js';
import { opened, text } from './browser.mjs';

// Outputs every 0.02 s and every 0.03 s meet every 0.06 s, however their multiples are rounded.
function check_common_times() {
  const every = (step, n) => Array.from({ length: n }, (_, k) => k * step);
  const t = every(0.02, 51), u = every(0.03, 34), pairs = common_times(t, u);
  assert.deepEqual(pairs, Array.from({ length: 17 }, (_, k) => [3 * k, 2 * k]));
  assert.deepEqual(common_times([0, 1], [0.5, 1.5]), []);
  assert.deepEqual(common_times([], [1]), []);
  // A jump has two rows at one time; where the other has one, nobody knows which of them it is.
  assert.deepEqual(common_times([0, 1, 1, 2], [0, 1, 1, 2]), [[0, 0], [1, 1], [2, 2], [3, 3]]);
  assert.deepEqual(common_times([0, 1, 1, 2], [0, 1, 2]), [[0, 0], [3, 2]]);
}

// Of one motion at different times the difference is nought; lines join only rows between which none is left out.
function check_differences() {
  const rows = (step, n, every = true) => { const t = Array.from({ length: n }, (_, k) => k * step); return { t, y: t.map(x => Math.cos(60 * x)), every }; };
  const sparse = difference(rows(0.02, 251), rows(0.03, 167));
  assert.equal(sparse.times, 84);
  assert.ok(sparse.gaps && sparse.y.filter((_, i) => i % 2).every(v => v === null), 'dots');
  assert.ok(sparse.y.filter(v => v !== null).every(v => Math.abs(v) < 1e-12));
  const coarser = difference(rows(0.01, 101), rows(0.05, 21));
  assert.deepEqual([coarser.times, coarser.gaps, coarser.y.length], [21, false, 21], 'a line through all rows of one');
  assert.ok(difference(rows(0.16, 10, false), rows(0.16, 10, false)).gaps, 'between rows of long runs others are left out');
  assert.deepEqual(difference(rows(0.1, 3), { t: [0.05], y: [1], every: true }), { t: [], y: [], times: 0, gaps: false });
}

function check_places() {
  assert.deepEqual([-1, 0, 0.5, 1, 9].map(x => place_of([0, 1, 1, 2], x)), [0, 0, 0, 2, 3]);
  const values = [undefined, 1, null, undefined, 4];
  assert.deepEqual([nearest_own(values, 0, false), nearest_own(values, 3, false), nearest_own(values, 3, true), nearest_own([undefined], 0, false)], [1, 2, 4, null]);
  assert.deepEqual([own_before(values, 3, false), own_before(values, 3, true), own_before(values, 0, false)], [2, 1, null]);
}

// A constant of each run is no constant of all of them.
function check_flat() {
  const run = tilt => ({ table: { columns: [{ name: 't', unit: 's', data: [0, 1] }, { name: 'tilt', unit: 'm', data: [tilt, tilt] }] }, validity: [], time: [0, 1] });
  const flat = (...runs) => grouped(runs)[0].series[0].flat;
  assert.deepEqual([flat(run(10)), flat(run(10), run(10)), flat(run(10), run(40))], [true, true, false]);
}

// What passes its limit is told of, where no curve shows it.
function check_passed() {
  const limit = (what, value) => ({ what, value, limit: 0.1 });
  const indicators = [limit('energy of a mode', 0.67), limit('tip deflection', 0.2), limit('load', 0.05), limit('rate', null)];
  assert.deepEqual(passed_unseen({ validity: [{ name: 'tip deflection' }], run: { certificate: { indicators } } }), ['energy of a mode: 0.67, limit 0.1']);
  // Also where no limit has a curve.
  const run = (...list) => ({ table: { columns: [{ name: 't', unit: 's', data: [0, 1] }] }, validity: [], time: [0, 1], run: { certificate: { indicators: list } } });
  assert.deepEqual(grouped([run(indicators[2])]), []);
  assert.deepEqual(grouped([run(indicators[2]), run(indicators[0])]).map(g => [g.title, g.series.length]), [['Validity: passed limits without a curve', 0]]);
}

export function check_rows() {
  check_common_times();
  check_differences();
  check_places();
  check_flat();
  check_passed();
}

const scenes = {
  // A top that turns at 24 rad/s: 7.7 rad between two of the rows that a page has whole.
  spin: `format: withy/1
gravity: [0, 0, 0]
time: {end: 100, output: 0.01}
integrator: {name: dopri5, rtol: 1e-8, atol: 1e-10}
bodies: {top: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {b: {type: spherical, parent: world, child: top}}
initial: {hinges: {b: {rate: [0, 0, 24]}}}
`,
  // A blow of 0.04 s bends the beam beyond the limit, far from the moments of the animation.
  spike: `format: withy/1
time: {end: 100, output: 0.01}
bodies: {beam: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 500, modes: 1, family: clamped-free}, damping_ratio: 0.7}}
hinges: {w: {type: weld, parent: world, child: beam}}
loads: {f: {type: force, frame: beam.tip, law: steps, table: [[30.60, 0, 400, 0], [30.64, 0, 0, 0]]}}
`,
  osc: `format: withy/1
gravity: [0, 0, 0]
time: {end: 100, output: 0.01}
integrator: {name: dop853, rtol: 1e-10, atol: 1e-12}
bodies: {cart: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {s: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}}
loads: {k: {type: hinge-spring, hinge: s, stiffness: 3600}}
initial: {hinges: {s: {position: [1], rate: [0]}}}
`,
  // Nine beams of which the last, the softest, is bent most.
  nine: `format: withy/1
gravity: [0, 0, 0]
time: {end: 0.5, output: 0.01}
bodies:
${Array.from({ length: 9 }, (_, k) => `  b${k + 1}: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: ${k < 8 ? 1000 : 10}, modes: 1, family: clamped-free}, damping_ratio: 0.1}`).join('\n')}
hinges: {${Array.from({ length: 9 }, (_, k) => `w${k + 1}: {type: weld, parent: world, child: b${k + 1}}`).join(', ')}}
loads: {${Array.from({ length: 9 }, (_, k) => `f${k + 1}: {type: force, frame: b${k + 1}.tip, value: [0, 5, 0]}`).join(', ')}}
`,
};

const series = (files, title, name) => {
  const runs = files.flatMap(file => JSON.parse(/<script type="application\/json" id="withy-data">([^]*?)<\/script>/.exec(readFileSync(file, 'utf8'))[1]).runs);
  return grouped(prepared({ runs }).runs).find(g => g.title.startsWith(title)).series.find(s => s.name === name).of;
};
const table = folder => {
  const [head, ...rows] = readFileSync(join(folder, 'results.csv'), 'utf8').trim().split('\n').map(line => line.split(','));
  return name => { const i = head.findIndex(h => h.replace(/\[.*/, '') === name); assert.ok(i >= 0, name); return rows.map(r => +r[i]); };
};
const greatest = values => values.reduce((m, v) => Math.max(m, v), -Infinity);

export async function check_long_runs(browser, folder, run, troubles) {
  const at = name => join(folder, name), page_of = name => join(folder, name, 'report.html');
  const simulate = (scene, out, ...more) => {
    writeFileSync(at(`${scene}.yaml`), scenes[scene]);
    run('run', at(`${scene}.yaml`), '--out', at(out), ...more);
  };
  simulate('spin', 'spin');
  const [turned] = series([page_of('spin')], 'Attitude of b', 'b.z'), whole = 24 * 100 * 180 / Math.PI;
  assert.ok(turned.spans && Math.abs(turned.y[turned.y.length - 1] - whole) < 1e-6 * whole, `${turned.y[turned.y.length - 1]} deg for ${whole}`);

  simulate('spike', 'spike');
  const column = table(at('spike')), parts = ['x', 'y', 'z'].map(c => column(`beam.tip.deflection_${c}`));
  const peak = greatest(parts[0].map((_, i) => Math.hypot(...parts.map(p => p[i])))) / 0.1;
  const [bent] = series([page_of('spike')], 'Validity', "tip deflection of 'beam' over its length");
  assert.ok(peak > 1 && Math.abs(greatest(bent.y) - peak) < 1e-9 * peak, `${greatest(bent.y)} of the limit for ${peak}`);
  const [T, V, W] = ['kinetic_energy', 'potential_energy', 'work'].map(column), drift = T.map((v, i) => v + V[i] - W[i] - (T[0] + V[0] - W[0]));
  const [drifted] = series([page_of('spike')], 'Drift', 'drift');
  assert.ok(Math.abs(greatest(drifted.y.map(Math.abs)) - greatest(drift.map(Math.abs))) <= 1e-12 * greatest(T));
  await check_told(browser, folder, run, simulate, troubles);
  await check_first_seen(browser, page_of, simulate, troubles);
}

// Two oscillators of one frequency, 0.3 rad apart: their difference is another, of 2 sin(0.15) m.
async function check_told(browser, folder, run, simulate, troubles) {
  simulate('osc', 'osc-a');
  simulate('osc', 'osc-b', '--set', 'initial.hinges.s={position: [0.955336489], rate: [-17.7312124]}');
  const pages = ['osc-a', 'osc-b'].map(name => join(folder, name, 'report.html')), [a, b] = series(pages, 'Travel of hinges', 's');
  const { t, y, times } = difference(a.whole, b.whole), [s, s_b] = ['osc-a', 'osc-b'].map(name => table(join(folder, name))('s'));
  assert.ok(times > 200);
  t.forEach((time, i) => { if (y[i] != null) assert.ok(Math.abs(y[i] - (s[Math.round(100 * time)] - s_b[Math.round(100 * time)])) < 1e-12, `at ${time}`); });
  assert.ok(Math.abs(greatest(y.map(v => Math.abs(v ?? 0))) - 2 * Math.sin(0.15)) < 1e-3);
  const file = join(folder, 'osc.html');
  run('report', ...pages, '--out', file);
  const page = await opened(browser, file, 't=50.07&theme=light', troubles);
  // At 50.07 s row 5007 is in a stretch, of which the legend says when it is and what lies within it.
  const [, from, to, low, high] = /t \[s\]:?\s*([\d.]+) … ([\d.]+)[^]*?as the scene:?\s*(-?[\d.]+) … (-?[\d.]+)/.exec(await text(page, 'figure')).map(Number);
  assert.ok(from <= 50.07 && 50.07 <= to && to - from < 0.5, `${from} … ${to} s`);
  assert.ok(low <= s[5007] && s[5007] <= high && s[5007] > 0.66 && s[5007] < 0.67, `${low} … ${high} for ${s[5007]}`);
  await page.check('#differences');
  assert.match(await text(page, 'figure .untold'), new RegExp(`Differences at the ${times} times`));
  await page.close();
}

// Of more bodies than a plot shows at first, those nearest to their limit; the chips of the others say how near they come.
async function check_first_seen(browser, page_of, simulate, troubles) {
  simulate('nine', 'nine');
  const page = await opened(browser, page_of('nine'), 't=0.1&theme=light', troubles);
  const figure = page.locator('figure', { hasText: 'Validity' });
  await figure.scrollIntoViewIfNeeded();
  const names = await figure.locator('.u-legend .u-label').allTextContents(), chips = await figure.locator('.chip').allTextContents();
  assert.match(names[1], /'b9'/);
  assert.ok(chips.length === 1 && /^tip deflection of 'b\d' over its length ≤ 0\.\d+$/.test(chips[0]), chips.join());
  await page.close();
}
