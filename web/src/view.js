// The three-dimensional view: camera, light, ground, trails, and the bodies of every run.
import {
  AmbientLight, Box3, BufferAttribute, BufferGeometry, Color, DirectionalLight, GridHelper, Group, Line, LineBasicMaterial, PerspectiveCamera, Scene, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Arrows, greatest_of, longest_in_words, measured } from './arrows.js';
import { palette } from './data.js';
import { Motion } from './motion.js';
import { Pace } from './pace.js';
import { Shapes } from './shapes.js';
import { exponent_of, in_decade } from './ticks.js';

// 1, 2 or 5 times a power of ten, at most x.
function round_down(x) {
  const k = exponent_of(x);
  return in_decade([5, 2, 1].find(m => in_decade(m, k) <= x * 1.0001), k);
}

// Where a body and what it carries are drawn now, deformed as computed: {ends, solid}, `solid` corners of its surface or box.
function places_of(motion, body) {
  const { p, q } = body.pose, in_world = v => v.applyQuaternion(q).add(p), at = numbers => in_world(new Vector3().fromArray(numbers));
  const ends = [p.clone()], solid = [];
  if (body.end >= 0) ends.push(motion.point(body, body.end, 1, new Vector3()));
  else if (body.tip) ends.push(at(body.tip));
  else if (body.box && !body.surface) ends.push(at(body.box.pose));
  for (const hung of body.hung) ends.push(in_world((body.flexible ? hung.now : hung.rest).p.clone()));
  if (body.kind === 'strip' || body.kind === 'mesh') for (let k = 0; k < body.count; ++k) ends.push(motion.point(body, k, 1, new Vector3()));
  if (body.surface) for (const corner of body.corners) solid.push(in_world(corner.clone()));
  else if (body.box) {
    const half = Math.max(...body.box.edges) / 2, middle = at(body.box.pose);
    solid.push(middle.clone().addScalar(half), middle.addScalar(-half));
  }
  return { ends, solid };
}

export class View {
  constructor(element, runs) {
    this.element = element;
    this.runs = runs;
    this.motions = runs.map(run => new Motion(run.animation));
    this.show = { trails: true, ghosts: true, axes: false, follow: false, sensors: true };
    this.scale = 1;
    this.origin = new Vector3();
    // Without alpha, which three.js would ask for, the browser need not mix the picture with the page behind it.
    const canvas = document.createElement('canvas'), wanted = { alpha: false, antialias: true, preserveDrawingBuffer: true };
    const context = canvas.getContext('webgl2', wanted);
    if (!context) throw new Error('no WebGL 2');
    this.renderer = new WebGLRenderer({ canvas, context, ...wanted });
    // To ask for the errors of shaders is to wait for them; they are three.js's own, tested where this page is.
    this.renderer.debug.checkShaderErrors = false;
    this.pace = new Pace(Math.min(2, window.devicePixelRatio));
    this.renderer.setPixelRatio(this.pace.finest);
    element.append(this.renderer.domElement);
    this.camera = new PerspectiveCamera(35, 1, 0.01, 1000);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.draw());
    this.controls.addEventListener('start', () => { this.turned = true; });
    // The controls tell of no change below a millimetre, which may be all of a system.
    this.seen_from = new Vector3();
    for (const moved of ['wheel', 'pointermove']) this.renderer.domElement.addEventListener(moved, () => requestAnimationFrame(() => { if (!this.seen_from.equals(this.camera.position)) this.draw(); }));
    this.measure();
    this.follow_from = this.root(new Vector3());
    new ResizeObserver(() => this.resize()).observe(element);
  }

  // The room that the motion takes, the size of the system, and which way is up.
  measure() {
    const box = new Box3(), point = new Vector3(), first = new Box3(), way = new Box3(), near = new Box3(), near_first = new Box3(), root = new Vector3(), begin = new Vector3();
    let travel = 0;
    for (const motion of this.motions) {
      const steps = Math.min(motion.times.length, 60);
      for (let s = 0; s < steps; ++s) {
        const i = Math.round(s * (motion.times.length - 1) / Math.max(1, steps - 1));
        motion.go(motion.times[i], 1);
        if (motion.bodies.length) root.copy(motion.bodies[0].pose.p);
        if (s === 0) begin.copy(root);
        for (const body of motion.bodies) {
          const { ends, solid } = places_of(motion, body);
          for (const end of ends) way.expandByPoint(end);
          for (const end of [...ends, ...solid]) {
            box.expandByPoint(end);
            if (s === 0) first.expandByPoint(end);
            near.expandByPoint(end.sub(root));
            if (s === 0) near_first.expandByPoint(end);
          }
        }
      }
      travel = Math.max(travel, begin.distanceTo(root)); // from the first to the last moment
    }
    for (const room of [box, near, near_first]) if (room.isEmpty()) room.expandByPoint(new Vector3());
    this.size = first.getSize(point).length() || box.getSize(point).length() || 1e-3; // a point has none
    // A system that goes far away is followed.
    this.show.follow = travel > 2 * this.size;
    this.box = this.show.follow ? first : box;
    // What it takes up about its root then, however it turns; where its parts go far from each other, at the beginning.
    this.near = near.getSize(point).length() > 4 * this.size ? near_first : near;
    const extent = (way.isEmpty() ? box : way).getSize(new Vector3()).toArray();
    const g = new Vector3().fromArray(this.runs[0].animation.gravity);
    const thin = extent.indexOf(Math.min(...extent));
    this.flat = extent[thin] < 0.05 * Math.max(...extent) && !this.show.follow ? thin : -1;
    if (g.length() > 0) this.up = g.clone().negate().normalize();
    else this.up = this.flat === 2 ? new Vector3(0, 1, 0) : new Vector3(0, 0, 1);
    this.camera.up.copy(this.up);
    this.low = Math.min(...[0, 1, 2, 3, 4, 5, 6, 7].map(k => new Vector3(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y, k & 4 ? box.max.z : box.min.z).dot(this.up)));
  }

  build(dark) {
    this.scene = new Scene();
    this.scene.background = new Color(dark ? '#12161c' : '#f6f8fa');
    const key = new DirectionalLight('#ffffff', 2.2);
    this.key = key;
    this.scene.add(new AmbientLight('#ffffff', dark ? 0.9 : 1.3), key);
    const colours = palette(dark), several = this.runs.length > 1;
    this.shapes = this.motions.map((motion, i) => {
      const own = colours[i % colours.length], grey = dark ? '#aab4c0' : '#6b7683';
      const mixed = new Color(own).lerp(new Color(grey), 0.55);
      const shapes = new Shapes(motion, this.size, { flexible: own, rigid: several ? mixed : grey, joint: dark ? '#f2f2f2' : '#22272e', ghost: dark ? '#8b949e' : '#8c959f' }, several);
      this.scene.add(shapes.group);
      return shapes;
    });
    this.greatest = greatest_of(this.runs.flatMap(run => run.animation.arrows), this.size);
    this.arrows = this.motions.map((motion, i) => new Arrows(motion, this.runs[i].animation.arrows, this.greatest, this.size, dark));
    for (const arrows of this.arrows) this.scene.add(arrows.group);
    this.add_ground(dark);
    this.add_trails(colours);
    this.go(this.time ?? 0);
  }

  add_ground(dark) {
    const extent = this.box.getSize(new Vector3()).length();
    this.cell = round_down((extent || this.size) / 8);
    const cells = 2 * Math.ceil(0.9 * extent / this.cell);
    const grid = new GridHelper(cells * this.cell, cells, dark ? '#3d4650' : '#b6bec8', dark ? '#262d36' : '#dde3e9');
    const flat = this.flat >= 0 && Math.abs(this.up.getComponent(this.flat)) < 0.5;
    // What moves in an upright plane has its squares behind it.
    const across = flat ? new Vector3().setComponent(this.flat, 1) : this.up;
    grid.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), across);
    const center = this.box.getCenter(new Vector3());
    const depth = flat ? this.box.min.getComponent(this.flat) - 0.03 * this.size : this.low - 0.02 * this.size;
    center.addScaledVector(across, depth - center.dot(across));
    for (let k = 0; k < 3; ++k) if (across.getComponent(k) === 0) center.setComponent(k, Math.round(center.getComponent(k) / this.cell) * this.cell);
    grid.position.copy(center);
    grid.visible = !this.show.follow;
    this.grid = grid;
    this.scene.add(grid);
  }

  // To which scale things are drawn, and what is not drawn where deformation is larger than it is.
  write_caption() {
    const arrows = this.show.sensors ? longest_in_words(this.greatest) : '', hidden = [arrows && 'arrows', this.show.trails && 'trails'].filter(Boolean);
    const words = this.scale === 1 ? arrows && `longest arrows: ${arrows}` : hidden.length && `${hidden.join(' and ')} at Deformation × 1 only`;
    const caption = [this.grid.visible && `squares of ${measured(this.cell, 'm')}`, words].filter(Boolean).join('; '), place = document.getElementById('cell');
    if (place.textContent !== caption) place.textContent = caption;
  }

  // How long a metre is in the middle of the picture, where no squares say so.
  write_rule() {
    const rule = document.getElementById('rule'), [line, words] = rule.children;
    rule.hidden = this.grid.visible && !this.show.follow;
    if (rule.hidden) return;
    const pixel = 2 * this.camera.position.distanceTo(this.controls.target) * Math.tan(this.camera.fov * Math.PI / 360) / this.height;
    const length = round_down(150 * pixel), told = measured(length, 'm'), width = `${(length / pixel).toFixed(1)}px`;
    if (line.style.width !== width) line.style.width = width;
    if (words.textContent !== told) words.textContent = told;
  }

  // The ways of the outermost points of bodies that carry nothing.
  add_trails(colours) {
    this.trails = new Group();
    this.motions.forEach((motion, i) => {
      for (const body of motion.bodies) {
        if (body.children.length > 0) continue;
        const points = new Float64Array(3 * motion.times.length), geometry = new BufferGeometry(), end = new Vector3();
        motion.times.forEach((_, k) => motion.end_of(body, k, end).toArray(points, 3 * k));
        geometry.setAttribute('position', new BufferAttribute(new Float32Array(points.length), 3));
        const line = new Line(geometry, new LineBasicMaterial({ color: colours[i % colours.length], transparent: true, opacity: 0.75 }));
        line.frustumCulled = false;
        Object.assign(line.userData, { motion, points });
        this.trails.add(line);
      }
    });
    this.scene.add(this.trails);
    this.lay_trails();
  }
  lay_trails() {
    const { x, y, z } = this.origin;
    for (const line of this.trails.children) {
      const { position } = line.geometry.attributes, { points } = line.userData;
      for (let k = 0, i = 0; k < position.count; ++k, i += 3) position.setXYZ(k, points[i] - x, points[i + 1] - y, points[i + 2] - z);
      position.needsUpdate = true;
      line.position.copy(this.origin);
    }
  }

  // What is not drawn in axes of a body stands about a place near what is looked at, as no more than a thousand times as
  // far away as the camera its numbers of 32 bits are less than a tenth of a pixel off.
  place_near() {
    const { target } = this.controls, far = this.origin.distanceTo(target) > 1000 * this.camera.position.distanceTo(target);
    if (far) {
      this.origin.copy(target);
      this.lay_trails();
    }
    if (far || this.moved) for (const shapes of this.shapes) shapes.place(this.origin);
    this.moved = false;
  }

  root(out) {
    const body = this.motions[0]?.bodies[0];
    return body ? out.copy(body.pose.p) : out.set(0, 0, 0);
  }

  // Brings everything to a time.
  go(time) {
    this.time = time;
    this.motions.forEach((motion, i) => {
      const own = Math.min(time, motion.end);
      motion.go(own, this.scale);
      this.shapes?.[i].update(this.scale, this.show);
      this.shapes[i].group.visible = !this.runs[i].hidden;
      // Where deformation is drawn larger than it is, they would stand beside the bodies.
      this.arrows[i].group.visible = this.show.sensors && this.scale === 1 && !this.runs[i].hidden;
      if (this.arrows[i].group.visible) this.arrows[i].go(own);
    });
    this.trails.visible = this.show.trails && this.scale === 1;
    this.write_caption();
    for (const line of this.trails.children) {
      const motion = line.userData.motion;
      line.visible = !this.runs[this.motions.indexOf(motion)].hidden;
      line.geometry.setDrawRange(0, motion.index(time) + 1);
    }
    const now = this.root(new Vector3());
    if (this.show.follow) {
      const step = now.clone().sub(this.follow_from);
      this.camera.position.add(step);
      this.controls.target.add(step);
    }
    this.follow_from = now;
    this.moved = true;
    this.draw();
  }

  // Looks from a direction at all of the motion.
  look(from) {
    const box = this.show.follow ? this.near : this.box;
    const center = box.getCenter(new Vector3()), half = box.getSize(new Vector3()).multiplyScalar(0.5);
    if (this.show.follow) center.add(this.root(new Vector3()));
    const direction = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] }[from];
    const d = direction ? new Vector3().fromArray(direction) : this.home();
    this.camera.up.copy(Math.abs(d.dot(this.up)) > 0.99 ? (from === 'z' ? new Vector3(0, 1, 0) : new Vector3(0, 0, 1)) : this.up);
    const distance = this.distance_of(half, d.normalize()) || 3 * this.size;
    this.camera.near = distance / 200;
    this.camera.far = distance * 50;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(d, distance);
    this.turned = false;
    this.controls.update();
    this.draw();
  }

  // How far away a box is seen whole with a margin, in a direction. \param half of the box's edges
  distance_of(half, direction) {
    const right = new Vector3().crossVectors(this.camera.up, direction).normalize();
    const up = new Vector3().crossVectors(direction, right);
    const high = 0.92 * Math.tan(this.camera.fov * Math.PI / 360), wide = high * this.camera.aspect;
    let distance = 0;
    for (let k = 0; k < 8; ++k) {
      const corner = new Vector3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1).multiply(half);
      const across = Math.max(Math.abs(corner.dot(up)) / high, Math.abs(corner.dot(right)) / wide);
      distance = Math.max(distance, corner.dot(direction) + across);
    }
    return distance;
  }

  // Across the plane of a motion that has one, else from above at a corner.
  home() {
    if (this.flat >= 0) {
      const across = new Vector3().setComponent(this.flat, this.flat === 1 ? -1 : 1);
      if (Math.abs(across.dot(this.up)) < 0.5) return across.addScaledVector(this.up, 0.12).addScaledVector(new Vector3().crossVectors(this.up, across), 0.18);
    }
    const sideways = new Vector3(1, 0, 0);
    if (Math.abs(this.up.x) > 0.9) sideways.set(0, 1, 0);
    sideways.addScaledVector(this.up, -sideways.dot(this.up)).normalize();
    const other = new Vector3().crossVectors(this.up, sideways);
    return sideways.multiplyScalar(0.75).addScaledVector(other, -1).addScaledVector(this.up, 0.55);
  }

  resize() {
    const { clientWidth: w, clientHeight: h } = this.element;
    if (!w || !h || (w === this.width && h === this.height)) return;
    [this.width, this.height] = [w, h];
    this.renderer.setSize(w, h);
    this.camera.aspect = w / h;
    this.camera.updateProjectionMatrix();
    if (!this.turned) this.look('home'); else this.draw();
  }

  // While the motion plays, pixels are as fine as the machine draws them in time; a picture that stands has all of them.
  frame(milliseconds) {
    if (this.pace.frame(milliseconds)) this.refine();
  }
  rest() {
    this.pace.rest();
    this.refine();
    if (this.width) this.draw();
  }
  refine() {
    this.renderer.setPixelRatio(this.pace.ratio); // the size that it is shown at stays
    this.element.dataset.pixels = this.pace.ratio;
  }

  draw() {
    if (!this.scene || !this.width) return; // a frame of the wrong size would be drawn twice
    this.place_near();
    this.write_rule();
    // From where one looks to what is looked at, wherever in the world that is.
    this.key.position.copy(this.camera.position).addScaledVector(this.up, this.size);
    this.key.target.position.copy(this.controls.target);
    this.key.target.updateMatrixWorld();
    this.renderer.render(this.scene, this.camera);
    this.seen_from.copy(this.camera.position);
  }
}
