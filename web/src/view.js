// The three-dimensional view: camera, light, ground, trails, and the bodies of every run.
import {
  AmbientLight, Box3, BufferGeometry, Color, DirectionalLight, GridHelper, Group, Line, LineBasicMaterial, PerspectiveCamera, Scene, Vector3, WebGLRenderer,
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

export class View {
  constructor(element, runs) {
    this.element = element;
    this.runs = runs;
    this.motions = runs.map(run => new Motion(run.animation));
    this.show = { trails: true, ghosts: true, axes: false, follow: false, sensors: true };
    this.scale = 1;
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
    const box = new Box3(), point = new Vector3(), first = new Box3(), way = new Box3();
    let travel = 0;
    for (const motion of this.motions) {
      const steps = Math.min(motion.times.length, 60);
      for (let s = 0; s < steps; ++s) {
        const i = Math.round(s * (motion.times.length - 1) / Math.max(1, steps - 1));
        motion.go(motion.times[i], 1);
        for (const body of motion.bodies) {
          const ends = [body.pose.p.clone(), motion.end_of(body, i, point).clone()];
          for (const hung of body.hung) ends.push(hung.now.p.clone().copy(body.flexible ? hung.now.p : hung.rest.p).applyQuaternion(body.pose.q).add(body.pose.p));
          if (body.kind === 'strip' || body.kind === 'mesh') for (let k = 0; k < body.count; ++k) ends.push(motion.point(body, k, 1, new Vector3()));
          for (const end of ends) way.expandByPoint(end);
          if (body.surface) for (const corner of body.corners) ends.push(corner.clone().applyQuaternion(body.pose.q).add(body.pose.p));
          else if (body.box) {
            const half = Math.max(...body.box.edges) / 2, p = new Vector3().fromArray(body.box.pose).applyQuaternion(body.pose.q).add(body.pose.p);
            ends.push(p.clone().addScalar(half), p.clone().addScalar(-half));
          }
          for (const end of ends) {
            box.expandByPoint(end);
            if (s === 0) first.expandByPoint(end);
          }
        }
      }
      if (motion.bodies.length) {
        const at = i => motion.bodies[0] && new Vector3().fromArray(motion.numbers, i * motion.size);
        travel = Math.max(travel, at(0).distanceTo(at(motion.times.length - 1)));
      }
    }
    if (box.isEmpty()) box.expandByPoint(new Vector3());
    this.size = first.getSize(point).length() || box.getSize(point).length() || 1e-3; // a point has none
    // A system that goes far away is followed, and what it takes up at the beginning is looked at.
    this.show.follow = travel > 2 * this.size;
    this.box = this.show.follow ? first : box;
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

  // The ways of the outermost points of bodies that carry nothing.
  add_trails(colours) {
    this.trails = new Group();
    this.motions.forEach((motion, i) => {
      for (const body of motion.bodies) {
        if (body.children.length > 0) continue;
        const points = Array.from(motion.times, (_, k) => motion.end_of(body, k, new Vector3()));
        const line = new Line(new BufferGeometry().setFromPoints(points), new LineBasicMaterial({ color: colours[i % colours.length], transparent: true, opacity: 0.75 }));
        line.frustumCulled = false;
        line.userData.motion = motion;
        this.trails.add(line);
      }
    });
    this.scene.add(this.trails);
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
    this.draw();
  }

  // Looks from a direction at all of the motion.
  look(from) {
    const center = this.box.getCenter(new Vector3()), half = this.box.getSize(new Vector3()).multiplyScalar(0.5);
    if (this.show.follow) {
      this.motions[0].go(this.time ?? 0, this.scale);
      const corners = new Box3();
      for (const body of this.motions[0].bodies) corners.expandByPoint(body.pose.p);
      corners.getCenter(center);
    }
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
    this.key.position.copy(this.camera.position).addScaledVector(this.up, this.size);
    this.renderer.render(this.scene, this.camera);
    this.seen_from.copy(this.camera.position);
  }
}
