// Where bodies are at a time: the recorded moments, in between, and with deformation drawn larger than it is.
import { Quaternion, Vector3 } from 'three';

class Pose {
  p = new Vector3();
  q = new Quaternion();
  read(a, at) {
    this.p.set(a[at], a[at + 1], a[at + 2]);
    this.q.set(a[at + 4], a[at + 5], a[at + 6], a[at + 3]);
    return this;
  }
  copy(o) {
    this.p.copy(o.p);
    this.q.copy(o.q);
    return this;
  }
  // this = this · o
  times(o) {
    this.p.add(scratch.copy(o.p).applyQuaternion(this.q));
    this.q.multiply(o.q);
    return this;
  }
  invert() {
    this.q.invert();
    this.p.applyQuaternion(this.q).negate();
    return this;
  }
}
const scratch = new Vector3();
const identity = new Quaternion();

function mixed(pose, other, w) {
  if (w === 0) return;
  pose.p.lerp(other.p, w);
  pose.q.slerp(other.q, w);
}

// A rotation by `s` times the angle of q.
function scaled(q, s) {
  if (q.w < 0) q.set(-q.x, -q.y, -q.z, -q.w);
  const sin = Math.hypot(q.x, q.y, q.z);
  if (sin < 1e-12) return q.copy(identity);
  const half = Math.min(Math.PI, Math.atan2(sin, q.w) * s), f = Math.sin(half) / sin;
  return q.set(q.x * f, q.y * f, q.z * f, Math.cos(half));
}

// Which point of a body is its end: of a line the last, of a sheet the middle of the last row, of a mesh the farthest from
// the root; -1 where points are none of its own.
function outermost(body) {
  const last = body.count - 1;
  if (body.kind === 'strip') return last - (body.columns - 1) / 2;
  if (body.kind === 'line' || body.kind === 'points') return last;
  if (body.kind !== 'mesh') return -1;
  const away = k => Math.hypot(...body.points.slice(3 * k, 3 * k + 3));
  let farthest = 0;
  for (let k = 1; k <= last; ++k) if (away(k) > away(farthest)) farthest = k;
  return farthest;
}

// Of the box around a surface.
function corners_of(vertices) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < vertices.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], vertices[i]);
    high[i % 3] = Math.max(high[i % 3], vertices[i]);
  }
  return Array.from({ length: 8 }, (_, k) => new Vector3(...[0, 1, 2].map(c => (k >> c & 1 ? high : low)[c])));
}

export class Motion {
  constructor(animation) {
    this.times = animation.times;
    this.numbers = animation.numbers;
    this.remainders = animation.remainders;
    this.size = animation.size;
    let at = 0;
    this.bodies = animation.parts.map((part, index) => {
      const body = { ...part, index, at, pose: new Pose(), recorded: new Pose(), count: part.points.length / 3 };
      at += 7;
      if (part.surface) body.corners = corners_of(part.surface.vertices);
      body.displacements = new Float32Array(part.points.length);
      body.pointsAt = at;
      // Weights of shapes, where displacements are sums of these; else displacements.
      body.weights = part.shapes ? part.shapes.length / part.points.length : 0;
      if (part.flexible) at += part.shapes ? body.weights : part.points.length;
      body.end = outermost(body);
      // The y axis of each section, where sections are not round and turn.
      body.turns = part.sections?.turns ?? false;
      body.yAxesAt = at;
      if (body.turns) {
        body.y_axes = new Float32Array(part.points.length);
        at += part.points.length;
      }
      body.hung = part.hung.map((numbers, i) => {
        const hung = { child: part.children[i], rest: new Pose().read(numbers, 0), now: new Pose(), drawn: new Pose(), at };
        if (part.flexible) at += 7;
        return hung;
      });
      return body;
    });
    if (at !== this.size) throw new Error('the animation does not have the numbers that it says');
  }
  get start() { return this.times[0] ?? 0; }
  get end() { return this.times[this.times.length - 1] ?? 0; }

  // The moment at or before t.
  index(t) {
    let low = 0, high = this.times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= t) low = middle; else high = middle - 1;
    }
    return low;
  }

  // Where a body was at a recorded moment.
  recorded_at(body, i, pose) {
    pose.read(this.numbers, i * this.size + body.at);
    const left = this.remainders, k = 3 * (i * this.bodies.length + body.index);
    if (left) for (let c = 0; c < 3; ++c) pose.p.setComponent(c, pose.p.getComponent(c) + left[k + c]);
    return pose;
  }

  // Brings every body's pose and displacements to time t. At scale 1 they are those computed; at others what hangs on a
  // flexible body goes along with what it hangs on.
  go(t, scale) {
    const i = this.index(t), j = Math.min(i + 1, this.times.length - 1);
    const span = this.times[j] - this.times[i];
    const w = span > 0 ? Math.min(1, Math.max(0, (t - this.times[i]) / span)) : 0;
    const a = this.numbers, I = i * this.size, J = j * this.size;
    const other = new Pose(), relative = new Pose();
    for (const body of this.bodies) {
      mixed(this.recorded_at(body, i, body.recorded), this.recorded_at(body, j, other), w);
      if (body.flexible) {
        if (body.shapes) this.deform(body, I, J, w);
        else for (let k = 0; k < body.displacements.length; ++k)
          body.displacements[k] = a[I + body.pointsAt + k] * (1 - w) + a[J + body.pointsAt + k] * w;
        for (let k = 0; body.turns && k < body.y_axes.length; ++k)
          body.y_axes[k] = a[I + body.yAxesAt + k] * (1 - w) + a[J + body.yAxesAt + k] * w;
        for (const hung of body.hung) {
          mixed(hung.now.read(a, I + hung.at), other.read(a, J + hung.at), w);
          hung.drawn.p.copy(hung.now.p).sub(hung.rest.p).multiplyScalar(scale).add(hung.rest.p);
          hung.drawn.q.copy(hung.rest.q).invert().multiply(hung.now.q);
          scaled(hung.drawn.q, scale);
          hung.drawn.q.premultiply(hung.rest.q);
        }
      }
    }
    this.bodies.forEach((body, index) => {
      body.pose.copy(body.recorded);
      const parent = this.bodies[body.parent];
      if (scale === 1 || !parent) return;
      // X_WC = X_WP · X_PC, with the deformed section's pose A in X_PC replaced by the one drawn: D · A⁻¹ · X_PC.
      relative.copy(parent.recorded).invert().times(body.recorded);
      const hung = parent.flexible ? parent.hung.find(h => h.child === index) : null;
      if (hung) {
        const inverse = new Pose().copy(hung.now).invert();
        relative.copy(new Pose().copy(hung.drawn).times(inverse).times(new Pose().copy(relative)));
      }
      body.pose.copy(parent.pose).times(relative);
    });
  }

  // The displacements of a body that are sums of shapes.
  deform({ shapes, displacements: u, weights, pointsAt }, I, J, w) {
    const a = this.numbers, n = u.length;
    u.fill(0);
    for (let s = 0; s < weights; ++s) {
      const much = a[I + pointsAt + s] * (1 - w) + a[J + pointsAt + s] * w;
      for (let k = 0, i = s * n; much !== 0 && k < n; ++k, ++i) u[k] += much * shapes[i];
    }
  }

  // A point k of a body, drawn at `scale`: in the body's axes, and in the world.
  own_point(body, k, scale, out) {
    const X = body.points, u = body.displacements;
    return out.set(X[3 * k] + scale * u[3 * k], X[3 * k + 1] + scale * u[3 * k + 1], X[3 * k + 2] + scale * u[3 * k + 2]);
  }
  point(body, k, scale, out) {
    return this.own_point(body, k, scale, out).applyQuaternion(body.pose.q).add(body.pose.p);
  }

  // The y axis of section k in the body's axes, drawn at `scale`; of one that does not turn, the body's own.
  y_axis(body, k, scale, out) {
    const y = body.y_axes;
    if (y) return out.set(scale * y[3 * k], 1 + scale * (y[3 * k + 1] - 1), scale * y[3 * k + 2]).normalize();
    return out.set(0, 1, 0);
  }

  // The outermost point of a body at a recorded moment, as computed: for trails and the room the motion takes.
  end_of(body, i, out) {
    const a = this.numbers, I = i * this.size;
    const pose = this.recorded_at(body, i, new Pose());
    if (body.end >= 0) {
      for (let c = 0; c < 3; ++c) {
        const k = 3 * body.end + c;
        let u = body.flexible && !body.shapes ? a[I + body.pointsAt + k] : 0;
        for (let s = 0; s < body.weights; ++s) u += a[I + body.pointsAt + s] * body.shapes[s * body.points.length + k];
        out.setComponent(c, body.points[k] + u);
      }
    } else if (body.tip) out.fromArray(body.tip);
    else if (body.box && !body.surface) out.fromArray(body.box.pose);
    else out.set(0, 0, 0);
    return out.applyQuaternion(pose.q).add(pose.p);
  }
}
