// A satellite 7000 km from the world's origin is drawn as at the origin.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Vector3 } from 'three';
import { unpack } from '../src/data.js';
import { Motion } from '../src/motion.js';
import { check_gltf } from './gltf.mjs';
import { opened, text } from './browser.mjs';

const at = (x, speed) => `format: withy/1
name: satellite
gravity: [0, 0, 0]
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-12}
time: {end: 12, output: 0.1}
bodies:
  bus: {type: rigid, mass: 120, inertia: [18, 20, 22, 0, 0, 0], frames: {side: {position: [0, 0.5, 0], orientation: {axis: [0, 0, 1], angle: 90 deg}}}}
  boom: {type: beam, length: 6, mass_per_length: 0.3, bending_y: {stiffness: 150, modes: 2, family: clamped-free}}
  ball: {type: rigid, mass: 1, inertia: [0.01, 0.01, 0.01, 0, 0, 0], frames: {grip: {position: [0, 0, -0.2]}}}
hinges:
  float: {type: free, parent: world, child: bus}
  side: {type: weld, parent: bus.side, child: boom}
  end: {type: revolute, axis: [0, 0, 1], parent: boom.tip, child: ball.grip}
initial: {hinges: {float: {position: [1, 0, 0, 0, ${x}, 0, 0], rate: [0, 0, 0.1, ${speed}, 0, 0]}, end: {rate: [0.3]}}, bodies: {boom: {modes: [0.3, 0]}}}
outputs: {tip: {type: frame, of: boom.tip, in: world}, load: {type: reaction, hinge: end}}
`;
const data_of = file => JSON.parse(/<script type="application\/json" id="withy-data">([^]*?)<\/script>/.exec(readFileSync(file, 'utf8'))[1]);

// Tips and arrows are where results.csv has the frame, to what 32 bits tell of lengths of the satellite.
function check_places(file) {
  const { animation, table } = unpack(data_of(file).runs[0]), motion = new Motion(animation), boom = motion.bodies[1], out = new Vector3();
  const tip = ['x', 'y', 'z'].map(c => table.columns.find(k => k.name === `tip.${c}`)), force = animation.arrows.find(a => a.name === 'load force');
  motion.times.forEach((t, i) => {
    const expected = new Vector3(...tip.map(c => (c.samples ?? c.data)[i]));
    assert.ok(motion.end_of(boom, i, out).distanceTo(expected) < 3e-6, `tip at ${t}: ${out.toArray()} for ${expected.toArray()}`);
    const place = new Vector3().fromArray(force.numbers, 6 * i);
    if (force.remainders) place.add(new Vector3().fromArray(force.remainders, 3 * i));
    assert.ok(place.distanceTo(expected) < 3e-6, `arrow at ${t}`);
  });
  return motion.remainders !== undefined;
}

const picture = page => page.evaluate(() => {
  const source = document.querySelector('#view canvas'), canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [source.width, source.height];
  const context = canvas.getContext('2d');
  context.drawImage(source, 0, 0);
  return [...context.getImageData(0, 0, canvas.width, canvas.height).data];
});

export async function check_far(browser, folder, run, troubles) {
  const simulate = (name, ...where) => {
    writeFileSync(join(folder, `${name}.yaml`), at(...where));
    run('run', join(folder, `${name}.yaml`), '--out', join(folder, name));
    return join(folder, name, 'report.html');
  };
  const files = { near: simulate('near', 0, 0), far: simulate('far', 7e6, 0), away: simulate('away', 7e6, 7600) };
  assert.deepEqual(Object.values(files).map(check_places), [false, true, true]);
  for (const name of ['far', 'away']) {
    run('report', join(folder, name), '--out', join(folder, `${name}.glb`));
    await check_gltf(join(folder, `${name}.glb`), data_of(files[name]));
  }
  const shown = [];
  for (const name of ['near', 'far', 'away']) {
    const page = await opened(browser, files[name], 't=8&theme=light', troubles);
    await page.check('#axes');
    assert.equal(await page.isVisible('#rule'), name === 'away', `a rule for the scale of '${name}'`);
    if (name === 'away') assert.match(await text(page, '#rule'), /^\d+ m$/);
    else {
      // Squares lie at whole numbers of the world's, and may lie otherwise by half of one.
      await page.evaluate(() => { const { view } = document.getElementById('view'); view.grid.visible = false; view.draw(); });
      shown.push(await picture(page));
    }
    await page.close();
  }
  const [near, far] = shown, other = near.filter((v, i) => Math.abs(v - far[i]) > 40).length / near.length;
  assert.equal(near.length, far.length);
  assert.ok(other < 2e-4, `${other} of the picture is another far from the origin`);
}
