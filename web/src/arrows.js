// What sensors measure, as arrows where they are: forces, moments, accelerations. Those of one unit have one scale.
import { ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Vector3 } from 'three';

const up = new Vector3(0, 1, 0), from = new Vector3(), along = new Vector3(), one = new Vector3(), other = new Vector3();
const colours = dark => ({ force: dark ? '#e69f00' : '#b84a00', moment: dark ? '#e58fc0' : '#a5447c', acceleration: dark ? '#2fc79a' : '#00704f' });

// With the prefix of its unit, as 60.5 MN m, 0.5 m and 5 µm: lengths of a tenth are told without the next prefix.
const small = [[1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n'], [1e-12, 'p']], large = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k']];
export function measured(value, unit) {
  const prefixes = unit === 'm' ? [[1e3, 'k'], ...small] : /^N\b/.test(unit) ? [...large, ...small] : [[1, '']], least = s => (unit === 'm' && s <= 1 ? 0.1 * s : s);
  const [scale, prefix] = prefixes.find(([s]) => value >= 0.9999 * least(s)) ?? prefixes.at(-1);
  return `${+(value / scale).toPrecision(3)} ${prefix}${unit.replace('^2', '²')}`.replace('e+', 'e');
}

// Of the arrows of all runs, by unit: runs that are drawn over each other are compared. size: of the whole system [m]
export function greatest_of(arrows, size) {
  const greatest = new Map();
  for (const a of arrows) greatest.set(a.unit, Math.max(greatest.get(a.unit) ?? 0, a.greatest));
  // Moments that are what rounding leaves of forces are none.
  if (greatest.get('N m') < 1e-9 * size * greatest.get('N')) greatest.delete('N m');
  return greatest;
}

// How much the longest arrow of each unit stands for.
export const longest_in_words = greatest => [...greatest].filter(([, v]) => v > 0).map(([unit, v]) => measured(v, unit)).join(', ');

export class Arrows {
  // size: of the whole system [m]; greatest: see greatest_of
  constructor(motion, arrows, greatest, size, dark) {
    Object.assign(this, { motion, size, group: new Group() });
    this.items = arrows.filter(a => a.greatest > 0 && greatest.has(a.unit)).map(a => {
      const kind = a.name.slice(a.name.lastIndexOf(' ') + 1), material = new MeshBasicMaterial({ color: colours(dark)[kind] });
      const shaft = new Mesh(new CylinderGeometry(size * 0.0045, size * 0.0045, 1, 8), material), head = new Mesh(new ConeGeometry(size * 0.014, size * 0.04, 12), material);
      for (const part of [shaft, head]) { part.frustumCulled = false; this.group.add(part); }
      return { arrow: a, shaft, head, scale: 0.22 * size / greatest.get(a.unit) };
    });
  }

  // Where an arrow is at a recorded moment.
  place({ numbers, remainders }, i, out) {
    out.fromArray(numbers, 6 * i);
    if (remainders) for (let c = 0; c < 3; ++c) out.setComponent(c, out.getComponent(c) + remainders[3 * i + c]);
    return out;
  }

  // Between two moments in proportion.
  go(time) {
    const { times } = this.motion, i = this.motion.index(time), j = Math.min(i + 1, times.length - 1);
    const w = j > i ? Math.min(1, Math.max(0, (time - times[i]) / (times[j] - times[i]))) : 0;
    for (const { arrow, shaft, head, scale } of this.items) {
      from.copy(this.place(arrow, i, one)).lerp(this.place(arrow, j, other), w);
      along.fromArray(arrow.numbers, 6 * i + 3).lerp(other.fromArray(arrow.numbers, 6 * j + 3), w).multiplyScalar(scale);
      const length = along.length();
      shaft.visible = head.visible = length > 0.004 * this.size;
      if (!shaft.visible) continue;
      along.divideScalar(length);
      shaft.scale.y = length;
      shaft.position.copy(from).addScaledVector(along, length / 2);
      head.position.copy(from).addScaledVector(along, length);
      for (const part of [shaft, head]) part.quaternion.setFromUnitVectors(up, along);
    }
  }
}
