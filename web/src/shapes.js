// The bodies of a run as meshes, brought to where they are at a time. Graphics hardware has numbers of 32 bits, which far
// from the world's origin would not tell a body's points apart: vertices are in axes of their body, or about a place that
// is near what is looked at; three.js has places of objects in 64 bits, and tells the hardware where the camera sees them.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DoubleSide, Group, InstancedMesh, Line, LineBasicMaterial,
  LineDashedMaterial, LineSegments, Matrix4, Mesh, MeshLambertMaterial, SphereGeometry, Vector3,
} from 'three';
import { ConvexHull } from 'three/examples/jsm/math/ConvexHull.js';

// Points around a section of half widths 1, and which way its surface looks there: an ellipse, a rectangle.
const ellipse = Array.from({ length: 16 }, (_, j) => { const angle = Math.PI * j / 8, y = Math.cos(angle), z = Math.sin(angle); return [y, z, y, z]; });
const rectangle = [[1, -1, 1, 0], [1, 1, 1, 0], [1, 1, 0, 1], [-1, 1, 0, 1], [-1, 1, -1, 0], [-1, -1, -1, 0], [-1, -1, 0, -1], [1, -1, 0, -1]];
const a = new Vector3(), b = new Vector3(), c = new Vector3(), normal = new Vector3(), side = new Vector3(), matrix = new Matrix4();

function geometry_of(count, index) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(3 * count), 3));
  if (index) geometry.setIndex(index);
  return geometry;
}

// Quadrilaterals between rows of points; `closed` where a row is a ring.
function grid(rows, columns, closed) {
  const index = [];
  for (let r = 0; r + 1 < rows; ++r) {
    for (let k = 0; k < (closed ? columns : columns - 1); ++k) {
      const n = (k + 1) % columns, p = r * columns, q = p + columns;
      index.push(p + k, q + k, p + n, p + n, q + k, q + n);
    }
  }
  return index;
}

// Triangles that look the other way.
const turned = index => index.map((_, i) => index[i - i % 3 + [0, 2, 1][i % 3]]);

// A closed sheet about rows of points: all points above, all below, and the rim twice again, whose edges are sharp. Of the
// rim, seen from above, the points counter-clockwise.
function sheet(rows, columns) {
  const above = turned(grid(rows, columns, false)), n = rows * columns, rim = [];
  for (let k = 0; k + 1 < columns; ++k) rim.push(k);
  for (let r = 0; r + 1 < rows; ++r) rim.push(r * columns + columns - 1);
  for (let k = columns - 1; k > 0; --k) rim.push((rows - 1) * columns + k);
  for (let r = rows - 1; r > 0; --r) rim.push(r * columns);
  const below = turned(above).map(k => n + k);
  const around = rim.flatMap((_, i) => {
    const a = 2 * n + i, b = 2 * n + (i + 1) % rim.length, m = rim.length;
    return [a, a + m, b + m, a, b + m, b];
  });
  return { rim, count: 2 * n + 2 * rim.length, index: [...above, ...below, ...around] };
}

// Triangles around the points of a body at rest, which has no surface of its own in its data; none where the points lie
// in a plane or are too few.
function hull_of(body) {
  const points = Array.from({ length: body.count }, (_, k) => new Vector3().fromArray(body.points, 3 * k));
  if (points.length < 4) return null;
  const at = new Map(points.map((p, k) => [p, k])), index = [];
  for (const face of new ConvexHull().setFromPoints(points).faces) {
    const corners = [];
    let edge = face.edge;
    do { corners.push(at.get(edge.head().point)); edge = edge.next; } while (edge !== face.edge);
    for (let k = 1; k + 1 < corners.length; ++k) index.push(corners[0], corners[k], corners[k + 1]);
  }
  return index.length > 0 ? index : null;
}

// How thick what stands for hinges, rods and dots of a body is, half of it: a part of the whole system, but no more than
// of the shortest way from one hinge of the body to another, and what can be seen at least.
const of_system = 0.011, of_way = 0.18, least_seen = 0.0008;
export function thickness_of(body, size) {
  const ends = [new Vector3(), ...body.hung.map(h => h.rest.p)], extent = [];
  if (body.tip) ends.push(new Vector3().fromArray(body.tip));
  if (body.end >= 0) ends.push(new Vector3().fromArray(body.points, 3 * body.end));
  const ways = ends.flatMap((p, i) => ends.slice(0, i).map(q => p.distanceTo(q))).filter(d => d > 1e-9 * size);
  // What carries nothing is as long as it is.
  if (body.box) extent.push(Math.max(Math.hypot(...body.box.pose.slice(0, 3)), ...body.box.edges));
  const way = ways.length ? Math.min(...ways) : Math.min(...extent.filter(d => d > 0));
  return Math.max(least_seen * size, Math.min(of_system * size, of_way * way));
}

export class Shapes {
  // size: of the whole system [m]; colours: of flexible and rigid bodies
  constructor(motion, size, colours, faint) {
    this.motion = motion;
    this.size = size;
    this.group = new Group();
    // Lambert's law is half the work of a physical material where no graphics hardware does it.
    const solid = (color, more = {}) => new MeshLambertMaterial({ color, transparent: faint, opacity: faint ? 0.55 : 1, ...more });
    this.flexible = solid(colours.flexible, { side: DoubleSide });
    this.rigid = solid(colours.rigid, { transparent: true, opacity: faint ? 0.45 : 0.8 });
    this.joint = solid(colours.joint);
    this.skin = solid(colours.flexible, { side: DoubleSide, transparent: true, opacity: faint ? 0.25 : 0.45, flatShading: true });
    this.ghost = new LineDashedMaterial({ color: colours.ghost, dashSize: size * 0.02, gapSize: size * 0.015 });
    this.faceted = solid(colours.flexible, { side: DoubleSide, flatShading: true });
    this.given = solid(colours.rigid, { side: DoubleSide, flatShading: true });
    this.items = motion.bodies.map(body => this.make(body, thickness_of(body, size)));
    const joints = motion.bodies.filter(body => body.moves && body.parent >= 0), radius_of = body => this.items[motion.bodies.indexOf(body)].radius;
    this.balls = joints.map(body => 1.35 * Math.min(radius_of(body), radius_of(motion.bodies[body.parent])));
    this.joints = new InstancedMesh(new SphereGeometry(1, 16, 12), this.joint, joints.length);
    this.joints.frustumCulled = false;
    this.jointed = joints;
    this.group.add(this.joints);
    // From where a hinge is on the parent to the child: what a sliding hinge has drawn out.
    this.links = new LineSegments(geometry_of(2 * joints.length), new LineBasicMaterial({ color: colours.joint }));
    this.links.frustumCulled = false;
    this.group.add(this.links);
    this.axes = this.frames(motion.bodies.length);
    this.group.add(this.axes);
  }

  make(body, radius) {
    // Half of what is thinner would not be seen.
    const item = { body, radius, thinnest: 0.27 * radius, group: new Group() };
    if (body.kind === 'line') {
      item.ring = body.sections?.rectangle ? rectangle : ellipse;
      const around = item.ring.length, count = (body.count + 2) * around; // two rings more close the ends
      const caps = [body.count, body.count + 1].flatMap(row => Array.from({ length: around - 2 }, (_, j) => row === body.count ? [0, j + 1, j + 2] : [0, j + 2, j + 1]).flat().map(k => row * around + k));
      item.tube = new Mesh(geometry_of(count, [...grid(body.count, around, true), ...caps]), this.flexible);
      item.tube.geometry.setAttribute('normal', new BufferAttribute(new Float32Array(3 * count), 3));
      item.tube.frustumCulled = false;
      item.group.add(item.tube);
    } else if (body.kind === 'strip') {
      item.sheet = sheet(body.count / body.columns, body.columns);
      item.surface = new Mesh(geometry_of(item.sheet.count, item.sheet.index), this.flexible);
      item.surface.frustumCulled = false;
      item.group.add(item.surface);
    } else if (body.kind === 'mesh') {
      item.faces = new Mesh(geometry_of(body.count), this.faceted);
      item.faces.geometry.setIndex(new BufferAttribute(body.triangles, 1));
      item.faces.frustumCulled = false;
      item.group.add(item.faces);
    } else if (body.kind === 'points') {
      item.dots = new InstancedMesh(new SphereGeometry(radius * 0.8, 10, 8), this.flexible, body.count);
      item.dots.frustumCulled = false;
      item.group.add(item.dots);
      const index = hull_of(body);
      if (index) {
        item.hull = new Mesh(geometry_of(body.count, index), this.skin);
        item.hull.frustumCulled = false;
        item.group.add(item.hull);
      } else {
        // Too few for a surface: rods from each point to the next, as they lie behind each other from the root.
        const away = k => a.fromArray(body.points, 3 * k).lengthSq();
        item.chain = Array.from({ length: body.count }, (_, k) => k).sort((k, l) => away(k) - away(l));
        item.rods = item.chain.slice(1).map(() => {
          const rod = new Mesh(new CylinderGeometry(radius * 0.6, radius * 0.6, 1, 10), this.flexible);
          rod.frustumCulled = false;
          item.group.add(rod);
          return rod;
        });
      }
    } else this.make_box(body, item);
    if (body.flexible && (body.kind === 'line' || body.kind === 'strip')) {
      item.ghost = new Line(new BufferGeometry().setFromPoints(this.middle(body)), this.ghost);
      item.ghost.computeLineDistances();
      item.group.add(item.ghost);
    }
    this.group.add(item.group);
    return item;
  }

  // The line in the middle of a body at rest.
  middle(body) {
    const columns = body.columns ?? 1, out = [];
    for (let k = (columns - 1) / 2; k < body.count; k += columns) out.push(new Vector3().fromArray(body.points, 3 * k));
    return out;
  }

  // The surface that a rigid body is given; else the box of its mass and inertia, and rods to where its children hang.
  make_box(body, item) {
    if (body.surface) {
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(body.surface.vertices, 3));
      geometry.setIndex(new BufferAttribute(body.surface.triangles, 1));
      item.group.add(new Mesh(geometry, this.given));
      return;
    }
    const { radius } = item, least = radius * 1.6;
    if (body.box) {
      const [x, y, z] = body.box.edges.map(e => Math.max(e, least));
      const box = new Mesh(new BoxGeometry(x, y, z), this.rigid);
      const p = body.box.pose;
      box.position.set(p[0], p[1], p[2]);
      box.quaternion.set(p[4], p[5], p[6], p[3]);
      item.group.add(box);
    }
    const from = body.box ? new Vector3().fromArray(body.box.pose) : new Vector3();
    const ends = [new Vector3(), ...body.hung.map(h => h.rest.p)];
    if (body.tip) ends.push(new Vector3().fromArray(body.tip));
    for (const end of ends) {
      const length = end.distanceTo(from);
      if (length < radius) continue;
      const rod = new Mesh(new CylinderGeometry(radius * 0.5, radius * 0.5, length, 10), this.rigid);
      rod.position.copy(from).add(end).multiplyScalar(0.5);
      rod.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), a.copy(end).sub(from).normalize());
      item.group.add(rod);
    }
  }

  // Three short lines for each body: x red, y green, z blue.
  frames(count) {
    const geometry = geometry_of(6 * count);
    const colors = new Float32Array(18 * count);
    const axis = [new Color('#d55e00'), new Color('#009e73'), new Color('#0072b2')];
    for (let i = 0; i < 6 * count; ++i) axis[(i >> 1) % 3].toArray(colors, 3 * i);
    geometry.setAttribute('color', new BufferAttribute(colors, 3));
    const lines = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true, depthTest: false }));
    lines.frustumCulled = false;
    return lines;
  }

  update(scale, show) {
    for (const item of this.items) {
      const { body } = item;
      item.group.position.copy(body.pose.p);
      item.group.quaternion.copy(body.pose.q);
      if (item.ghost) item.ghost.visible = show.ghosts;
      if (item.tube) this.bend(item, scale);
      if (item.sheet) this.bend_sheet(item, scale);
      if (item.faces) this.warp(item.faces, body, scale);
      if (item.hull) this.warp(item.hull, body, scale);
      if (item.dots) this.scatter(item, scale);
      if (item.rods) this.join(item, scale);
    }
    this.axes.visible = show.axes;
  }

  // What stands between bodies, from a place that is near what is looked at.
  place(origin) {
    for (const part of [this.joints, this.links, this.axes]) part.position.copy(origin);
    const { position } = this.links.geometry.attributes;
    this.jointed.forEach((body, i) => {
      const parent = this.motion.bodies[body.parent], hung = parent.hung.find(h => h.child === body.index);
      a.copy(parent.flexible ? hung.drawn.p : hung.rest.p).applyQuaternion(parent.pose.q).add(parent.pose.p).sub(origin);
      b.copy(body.pose.p).sub(origin);
      this.joints.setMatrixAt(i, matrix.makeScale(this.balls[i], this.balls[i], this.balls[i]).setPosition(a));
      position.setXYZ(2 * i, a.x, a.y, a.z).setXYZ(2 * i + 1, b.x, b.y, b.z);
    });
    position.needsUpdate = this.joints.instanceMatrix.needsUpdate = true;
    if (this.axes.visible) this.turn_axes(origin);
  }

  // A tube around the deformed middle line, with the sections that the body has.
  bend({ body, tube, ring, radius, thinnest }, scale) {
    const { position, normal: outward } = tube.geometry.attributes, n = body.count, around = ring.length;
    const widths = body.sections?.widths;
    for (let k = 0; k < n; ++k) {
      this.motion.own_point(body, Math.max(0, k - 1), scale, a);
      this.motion.own_point(body, Math.min(n - 1, k + 1), scale, b);
      this.motion.own_point(body, k, scale, c);
      b.sub(a).normalize();
      if (k === 0 || body.turns) this.motion.y_axis(body, k, scale, side);
      side.addScaledVector(b, -side.dot(b)).normalize();
      normal.crossVectors(side, b);
      const y = widths ? widths[2 * k] : radius, z = widths ? widths[2 * k + 1] : radius;
      const u = Math.max(y, thinnest), v = Math.max(z, thinnest);
      const ends = k === 0 ? n : k === n - 1 ? n + 1 : -1;
      for (let j = 0; j < around; ++j) {
        const [fy, fz, ny, nz] = ring[j], length = Math.hypot(ny / u, nz / v), p = ny / u / length, q = nz / v / length;
        const x = fy * u, w = fz * v;
        position.setXYZ(k * around + j, c.x + x * side.x + w * normal.x, c.y + x * side.y + w * normal.y, c.z + x * side.z + w * normal.z);
        outward.setXYZ(k * around + j, p * side.x + q * normal.x, p * side.y + q * normal.y, p * side.z + q * normal.z);
        if (ends < 0) continue;
        const sign = k === 0 ? -1 : 1, i = ends * around + j, at = k * around + j;
        position.setXYZ(i, position.getX(at), position.getY(at), position.getZ(at));
        outward.setXYZ(i, sign * b.x, sign * b.y, sign * b.z);
      }
    }
    position.needsUpdate = outward.needsUpdate = true;
  }

  // The two sides of a plate, half its thickness from its middle surface, and its rim.
  bend_sheet({ body, surface, sheet: { rim }, thinnest }, scale) {
    const { position } = surface.geometry.attributes, n = body.count, columns = body.columns, rows = n / columns;
    const half = Math.max(body.thickness ?? 0, 0.7 * thinnest) / 2;
    for (let k = 0; k < n; ++k) {
      const r = Math.floor(k / columns), j = k % columns;
      this.motion.own_point(body, j > 0 ? k - 1 : k, scale, a);
      this.motion.own_point(body, j + 1 < columns ? k + 1 : k, scale, side).sub(a);
      this.motion.own_point(body, r > 0 ? k - columns : k, scale, a);
      this.motion.own_point(body, r + 1 < rows ? k + columns : k, scale, b).sub(a);
      normal.crossVectors(side, b).normalize();
      this.motion.own_point(body, k, scale, c);
      position.setXYZ(k, c.x + half * normal.x, c.y + half * normal.y, c.z + half * normal.z);
      position.setXYZ(n + k, c.x - half * normal.x, c.y - half * normal.y, c.z - half * normal.z);
    }
    rim.forEach((k, i) => {
      position.setXYZ(2 * n + i, position.getX(k), position.getY(k), position.getZ(k));
      position.setXYZ(2 * n + rim.length + i, position.getX(n + k), position.getY(n + k), position.getZ(n + k));
    });
    position.needsUpdate = true;
    surface.geometry.computeVertexNormals();
  }

  warp(surface, body, scale) {
    const position = surface.geometry.attributes.position;
    for (let k = 0; k < body.count; ++k) {
      this.motion.own_point(body, k, scale, a);
      position.setXYZ(k, a.x, a.y, a.z);
    }
    position.needsUpdate = true;
    surface.geometry.computeVertexNormals();
  }

  scatter({ body, dots }, scale) {
    for (let k = 0; k < body.count; ++k) dots.setMatrixAt(k, matrix.makeTranslation(this.motion.own_point(body, k, scale, a)));
    dots.instanceMatrix.needsUpdate = true;
  }

  join({ body, chain, rods }, scale) {
    rods.forEach((rod, i) => {
      this.motion.own_point(body, chain[i], scale, a);
      this.motion.own_point(body, chain[i + 1], scale, b);
      rod.position.copy(a).add(b).multiplyScalar(0.5);
      b.sub(a);
      rod.scale.y = Math.max(b.length(), 1e-9);
      rod.quaternion.setFromUnitVectors(c.set(0, 1, 0), b.normalize());
    });
  }

  turn_axes(origin) {
    const position = this.axes.geometry.attributes.position, length = this.size * 0.07;
    this.motion.bodies.forEach((body, i) => {
      b.copy(body.pose.p).sub(origin);
      for (let k = 0; k < 3; ++k) {
        a.set(0, 0, 0).setComponent(k, length).applyQuaternion(body.pose.q).add(b);
        position.setXYZ(6 * i + 2 * k, b.x, b.y, b.z);
        position.setXYZ(6 * i + 2 * k + 1, a.x, a.y, a.z);
      }
    });
    position.needsUpdate = true;
  }
}
