// The glTF of a run, read by three.js' loader, against the numbers on the run's page.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { AnimationMixer, DoubleSide, Vector3 } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { unpack } from '../src/data.js';
import { Motion } from '../src/motion.js';

const sides = 8; // of tubes

async function loaded(file) {
  globalThis.self ??= globalThis; // the loader was made for browsers
  const bytes = readFileSync(file);
  return new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), '');
}

// Points of a body, body axes, as its surface has them: the middles of a tube's rings, corners of a sheet.
function middles(body, mesh) {
  const position = mesh.geometry.attributes.position, at = v => mesh.getVertexPosition(v, new Vector3());
  const mean = (first, count) => {
    const sum = new Vector3();
    for (let v = first; v < first + count; ++v) sum.add(at(v));
    return sum.divideScalar(count);
  };
  if (body.kind === 'mesh') return Array.from({ length: body.count }, (_, k) => at(k));
  // The two sides of a sheet.
  if (body.kind === 'strip') return Array.from({ length: body.count }, (_, k) => at(k).add(at(body.count + k)).multiplyScalar(0.5));
  if (position.count === body.count * sides + 2) return Array.from({ length: body.count }, (_, k) => mean(sides * k, sides));
  assert.equal(position.count, 6 * body.count, 'beads');
  return Array.from({ length: body.count }, (_, k) => mean(6 * k, 6));
}

// Rings have the widths of the page's sections, along the axes that these have when they are bent and twisted. What is
// thinner than a hundredth of the whole may be drawn thicker.
function check_sections(motion, body, mesh, scale, what) {
  const position = mesh.geometry.attributes.position, at = v => mesh.getVertexPosition(v, new Vector3());
  if (!body.sections || position.count !== body.count * sides + 2) return;
  const y = new Vector3();
  for (let k = 0; k < body.count; ++k) {
    const across = at(sides * k).sub(at(sides * k + sides / 2)).multiplyScalar(0.5), wide = body.sections.widths[2 * k];
    assert.ok(across.length() > 0.999 * wide, `width of section ${k} of ${what}`);
    if (wide > 0.01 * scale) assert.ok(across.length() < 1.001 * wide, `width of section ${k} of ${what}`);
    if (body.turns) assert.ok(motion.y_axis(body, k, 1, y).angleTo(across) < 0.03, `turn of section ${k} of ${what}`);
  }
}

// Every body is where the page has it, at moments and, of flexible ones, with every point that it draws.
export async function check_gltf(file, data) {
  const gltf = await loaded(file), run = unpack(data.runs[0]), motion = new Motion(run.animation);
  const root = gltf.scene.children[0], mixer = new AnimationMixer(gltf.scene);
  mixer.clipAction(gltf.animations[0]).play();
  // Far from the world's origin a node carries the bodies, from a place that the file tells.
  const carrier = motion.remainders ? root.children[0] : null, nodes = (carrier ?? root).children, origin = new Vector3().fromArray(root.userData.origin ?? [0, 0, 0]);
  assert.equal(Boolean(carrier), 'origin' in root.userData);
  assert.equal(nodes.length, motion.bodies.length);
  motion.go(motion.start, 1);
  const scale = Math.max(...motion.bodies.flatMap(b => (carrier ? b.pose.p.clone().sub(motion.bodies[0].pose.p) : b.pose.p).toArray().map(Math.abs)), 1);
  // What the file promises: a part of a body's greatest displacement of all moments.
  const promised = new Map(motion.bodies.map(body => [body, 0]));
  for (const t of motion.times) {
    motion.go(t, 1);
    for (const body of motion.bodies) promised.set(body, body.displacements.reduce((most, u) => Math.max(most, 1e-4 * Math.abs(u)), promised.get(body)));
  }
  // Before anything is played bodies are as at the first moment.
  for (const i of [undefined, 0, 1, motion.times.length >> 1, motion.times.length - 2]) {
    const t = motion.times[i ?? 0];
    if (i !== undefined) mixer.setTime(t);
    gltf.scene.updateMatrixWorld(true);
    motion.go(t, 1);
    motion.bodies.forEach((body, b) => {
      const node = nodes[b];
      const what = `${body.name} at ${i === undefined ? 'rest' : `${t} s`}`;
      const place = node.position.clone();
      if (carrier) {
        assert.ok(place.distanceTo(body.pose.p.clone().sub(motion.bodies[0].pose.p)) < 1e-5 * scale, `${what}, from the first body`);
        place.add(carrier.position).add(origin);
      }
      // How far the carrier has gone is told by 32 bits.
      assert.ok(place.distanceTo(body.pose.p) < 1e-4 * scale + (carrier ? 2 ** -22 * carrier.position.length() : 0), what);
      assert.ok(node.quaternion.angleTo(body.pose.q) < 1e-3, what);
      if (body.surface) {
        const { array } = node.geometry.attributes.position;
        assert.deepEqual([...array], [...body.surface.vertices], `the surface that ${body.name} is given`);
        assert.deepEqual([...node.geometry.index.array], [...body.surface.triangles]);
      }
      if (!body.flexible) return;
      assert.equal(node.material.side, DoubleSide, `${body.name} is seen from both sides`);
      check_sections(motion, body, node, scale, what);
      const greatest = Math.max(...body.displacements.map(Math.abs), 1e-9);
      const order = new Map(body.kind === 'points' ? chain(body).map((k, j) => [k, j]) : []);
      const points = middles(body, node), beads = node.geometry.attributes.position.count === 6 * body.count;
      for (let k = 0; k < body.count; ++k) {
        const given = points[order.size && !beads ? order.get(k) : k];
        for (let c = 0; c < 3; ++c)
          assert.ok(Math.abs(given.getComponent(c) - body.points[3 * k + c] - body.displacements[3 * k + c]) < Math.max(1e-3 * greatest, promised.get(body)) + 1e-6 * scale, `point ${k} of ${what}`);
      }
    });
  }
}

// Points of a body of data one behind the other, as a tube joins them.
function chain(body) {
  const away = k => body.points[3 * k] ** 2 + body.points[3 * k + 1] ** 2 + body.points[3 * k + 2] ** 2;
  return Array.from({ length: body.count }, (_, k) => k).sort((k, l) => away(k) - away(l));
}
