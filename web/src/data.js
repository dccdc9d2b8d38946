// What the program wrote into the page, as arrays, and what is computed of it.
import { of_rows } from './rows.js';

// What base64 stands for. The loop takes a tenth of the time of Uint8Array.from with a function.
function bytes(text) {
  const characters = atob(text), out = new Uint8Array(characters.length);
  for (let i = 0; i < out.length; ++i) out[i] = characters.charCodeAt(i);
  return out.buffer;
}

// A member that is made when it is asked for first: of a long run most plots are never scrolled to.
function lazy(object, name, make) {
  Object.defineProperty(object, name, {
    configurable: true,
    enumerable: true,
    get() {
      const value = make();
      Object.defineProperty(object, name, { value, enumerable: true });
      return value;
    },
  });
  return object;
}

// Puts arrays of numbers in the place of their indices.
export function unpack(run) {
  const { animation, arrays, table } = run;
  const doubles = index => new Float64Array(bytes(arrays[index]));
  // Of two rows a stretch has both, in their order; of one that is left over it has it twice.
  const of_table = index => table.stride > 2 ? doubles(index) : doubles(index).subarray(0, table.rows);
  // Pages of earlier versions have none that are derived.
  for (const column of [...table.columns, ...table.derived ??= []]) {
    const { data, samples } = column;
    lazy(column, 'data', () => of_table(data));
    if (samples != null) lazy(column, 'samples', () => doubles(samples));
  }
  animation.times = doubles(animation.times);
  const floats = index => new Float32Array(bytes(arrays[index]));
  animation.numbers = floats(animation.numbers);
  // What 32 bits leave of places: of motions far from the world's origin alone.
  if (animation.remainders != null) animation.remainders = floats(animation.remainders);
  for (const part of animation.parts) {
    if (part.surface) part.surface = { vertices: floats(part.surface[0]), triangles: new Uint32Array(bytes(arrays[part.surface[1]])) };
    if (part.shapes != null) part.shapes = floats(part.shapes);
    if (part.triangles != null) part.triangles = new Uint32Array(bytes(arrays[part.triangles]));
    if (part.sections) part.sections.widths = floats(part.sections.widths);
  }
  // Pages of earlier versions have none.
  for (const arrow of animation.arrows ??= []) {
    arrow.numbers = floats(arrow.numbers);
    if (arrow.remainders != null) arrow.remainders = floats(arrow.remainders);
  }
  for (const series of run.validity) {
    const { data } = series;
    lazy(series, 'data', () => series.of === 'rows' ? of_table(data) : doubles(data));
  }
  run.time = run.table.columns[0].data;
  delete run.arrays;
  return run;
}

export function prepared(data) {
  data.runs.forEach((run, index) => { unpack(run).index = index; });
  nameRuns(data.runs);
  return data;
}

// By what tells them apart: formulation, integrator, what was set, scene; or their number.
function nameRuns(runs) {
  const features = [
    run => run.run.formulation,
    run => run.run.integrator,
    run => (run.run.set ?? []).join(' '),
    run => run.title,
  ];
  const told = features.filter(f => new Set(runs.map(f)).size > 1);
  for (const run of runs) run.label = (told.length ? told : [features[0]]).map(f => f(run)).filter(Boolean).join(', ') || 'as the scene';
  const seen = new Map();
  for (const run of runs) {
    const n = (seen.get(run.label) ?? 0) + 1;
    seen.set(run.label, n);
    if (n > 1) run.label += ` (${n})`;
  }
}

const degrees = 180 / Math.PI;

// Of whole turns an angle may be off by between two moments, none is left; where there is no angle nothing is told.
function unwrapped(angles) {
  const out = angles.slice();
  let before = NaN;
  for (let i = 0; i < out.length; ++i) {
    if (Number.isFinite(before)) out[i] -= 360 * Math.round((out[i] - before) / 360);
    if (Number.isFinite(out[i])) before = out[i];
  }
  return out;
}

// Intrinsic rotations about x, y, z [deg]: R = Rx(a) Ry(b) Rz(c).
function attitude(w, x, y, z) {
  const a = new Float64Array(w.length), b = a.slice(), c = a.slice();
  for (let i = 0; i < w.length; ++i) {
    const n = Math.hypot(w[i], x[i], y[i], z[i]) || 1;
    const [W, X, Y, Z] = [w[i] / n, x[i] / n, y[i] / n, z[i] / n];
    a[i] = degrees * Math.atan2(2 * (W * X - Y * Z), 1 - 2 * (X * X + Y * Y));
    b[i] = degrees * Math.asin(Math.max(-1, Math.min(1, 2 * (X * Z + W * Y))));
    c[i] = degrees * Math.atan2(2 * (W * Z - X * Y), 1 - 2 * (Y * Y + Z * Z));
  }
  return [unwrapped(a), b, unwrapped(c)];
}

// What is computed of several columns: of all rows where the page has them, or else what the program has computed of
// all. Pages of earlier versions have neither of long runs: it is of the moments of the animation, as the page says then.
// null where a column is missing.
function computed(run, name, names, compute) {
  const columns = names.map(n => run.table.columns.find(c => c.name === n));
  if (columns.some(c => !c)) return null;
  const derived = run.table.derived?.find(c => c.name === name);
  if (derived) return of_rows(run, derived);
  if (!(run.table.stride > 2)) return { t: run.time, y: () => compute(columns.map(c => c.data)), spans: false, whole: null };
  return { ...of_moments(run, () => compute(columns.map(c => c.samples))), few: true };
}
const of_moments = (run, y) => {
  const { times } = run.animation;
  return { t: times, y, spans: false, whole: { t: times, y, every: false } };
};
const few_told = run => `, at ${run.animation.times.length} moments alone`;

// Angles that turn far in any of the runs: they are told in turns in all of them, else their curves could not be compared.
const far = 20 * Math.PI;
const turning = runs => new Set(runs.flatMap(run => run.table.columns.filter(c => c.unit === 'rad' && c.data.some(v => Math.abs(v) > far)).map(c => c.name)));

// The quantities of a run: {group, name, unit, t, y, spans, whole, limit?} as of_rows has them, groups in the order of
// the page.
export function quantities(run, turns = turning([run])) {
  const out = [];
  const add = (group, name, unit, { few, y, whole, ...from }, more = {}) => {
    const quantity = lazy({ group: group + (few ? few_told(run) : ''), name, unit, ...from, ...more }, 'y', y);
    out.push(lazy(quantity, 'whole', () => whole ? lazy({ ...whole }, 'y', whole.y) : { t: quantity.t, y: quantity.y, every: true }));
  };
  // Angles that say again what a quaternion beside them says.
  const told = new Set(run.table.columns.filter(c => c.name.endsWith('.qw')).flatMap(c => ['rx', 'ry', 'rz'].map(r => c.name.replace(/qw$/, r))));
  // Coordinates and rates of hinges and modes stand before the energies, outputs of the scene behind them.
  const states = run.table.columns.findIndex(c => c.name === 'kinetic_energy');
  for (const [place, column] of [...run.table.columns.entries()].slice(1)) {
    const { name, unit } = column, data = of_rows(run, column), state = states < 0 || place < states;
    const last = name.slice(name.lastIndexOf('.') + 1);
    const quaternion = /^(.*)\.q([wxyz])$/.exec(name);
    if (quaternion) {
      if (quaternion[2] !== 'w') continue;
      const base = quaternion[1], parts = ['qw', 'qx', 'qy', 'qz'].map(q => `${base}.${q}`);
      let angles = null;
      for (const [i, axis] of ['x', 'y', 'z'].entries()) {
        const angle = computed(run, `${base}.${axis}`, parts, columns => (angles ??= attitude(...columns))[i]);
        if (angle) add(`Attitude of ${base}: turns about x, y, z in this order`, `${base}.${axis}`, 'deg', angle);
      }
    } else if ((name.endsWith('_energy') || name === 'work') && unit === 'J') add('Energies', name, unit, data);
    else if (/^(linear|angular)_momentum\./.test(name)) add(name.startsWith('linear') ? 'Linear momentum' : 'Angular momentum', name, unit, data);
    else if (/\.tip\.deflection_[xyz]$/.test(name)) add('Deflection of tips', name, unit, data);
    else if (/\.tip\.[xyz]$/.test(name)) add('Position of tips', name, unit, data);
    else if (/\.motion_effort(\.\d+)?$/.test(name)) add(`Effort of motions, ${unit}`, name, unit, data);
    else if (state && /\.rate(\.\d+)?$/.test(name)) add(unit === 'rad/s' ? 'Rates of hinges' : unit === 'm/s' ? 'Speeds of hinges' : 'Rates of modal coordinates', name, unit && unit !== '1' ? unit : '1/s', data);
    else if (unit === 'rad' && told.has(name)) continue;
    else if (unit === 'rad' && turns.has(name)) add('Turns', name, 'turns', of_rows(run, column, v => v / 2 / Math.PI));
    else if (unit === 'rad') add('Angles', name, 'deg', of_rows(run, column, v => v * degrees));
    else if (state && unit === '') add('Modal coordinates', name, '1', data);
    // Of outputs: a strain, a formula.
    else if (unit === '1' || unit === '') add('Numbers without a unit', name, '1', data);
    else if (name.includes('.')) add(`${name.slice(0, -last.length - 1)}, ${unit}`, name, unit, data);
    else add(state && unit === 'm' ? 'Travel of hinges' : `${name}, ${unit}`, name, unit, data);
  }
  const drift = computed(run, 'drift', ['kinetic_energy', 'potential_energy', 'work'], ([T, V, W]) => T.map((v, i) => v + V[i] - W[i] - (T[0] + V[0] - W[0])));
  if (drift) add('Drift of energy: kinetic + potential − work, less its first value', 'drift', 'J', drift);
  for (const series of run.validity) {
    const over_limit = v => v / series.limit, few = series.of !== 'rows';
    const from = few ? of_moments(run, () => series.data.map(over_limit)) : of_rows(run, series, over_limit);
    add('Validity: rates and deflections, each over its limit, which is 1', series.name, '1', { ...from, few: few && run.table.rows > run.animation.times.length }, { limit: 1 });
  }
  return out;
}

// What of the certificate's limits a run passes that no curve shows, in words.
export function passed_unseen(run) {
  const seen = new Set(run.validity.map(series => series.name)), plain = v => `${+v.toPrecision(2)}`;
  return (run.run?.certificate?.indicators ?? []).filter(i => i.value > i.limit && !seen.has(i.what))
    .map(i => `${i.what}: ${plain(i.value)}, limit ${plain(i.limit)}`);
}

// Groups over all runs: [{title, unit, series: [{name, of: [{run, t, y, spans, whole}], flat, greatest}]}]. Where limits
// are passed, one of the limits, also where it has no series.
const first = ['Angles', 'Turns', 'Travel of hinges', 'Attitude', 'Deflection of tips', 'Validity', 'Energies', 'Drift'];
const last = ['Position of tips', 'Modal coordinates', 'Rates of modal', 'Rates of hinges', 'Speeds of hinges', 'Linear momentum', 'Angular momentum'];
const rank = title => {
  const a = first.findIndex(f => title.startsWith(f));
  if (a >= 0) return a;
  const b = last.findIndex(f => title.startsWith(f));
  return b >= 0 ? 100 + b : 50;
};
export function grouped(runs) {
  const groups = new Map(), turns = turning(runs);
  for (const run of runs) {
    for (const q of quantities(run, turns)) {
      const group = groups.get(q.group) ?? { title: q.group, unit: q.unit, limit: q.limit, series: new Map() };
      groups.set(q.group, group);
      const series = group.series.get(q.name) ?? { name: q.name, of: [] };
      group.series.set(q.name, series);
      series.of.push(lazy(lazy({ run, t: q.t, spans: q.spans }, 'y', () => q.y), 'whole', () => q.whole));
    }
  }
  const all = [...groups.values()];
  if (!all.some(group => group.limit) && runs.some(run => passed_unseen(run).length)) all.push({ title: 'Validity: passed limits without a curve', unit: '', limit: 1, series: new Map() });
  for (const group of all) {
    group.series = [...group.series.values()];
    for (const s of group.series) {
      // Runs that each have a number of their own differ.
      lazy(s, 'flat', () => s.of.every(({ y }) => y.every(v => v === s.of[0].y[0])));
      lazy(s, 'greatest', () => s.of.reduce((most, { y }) => y.reduce((m, v) => v > m ? v : m, most), -Infinity));
    }
  }
  return all.sort((a, b) => rank(a.title) - rank(b.title));
}

// Numbers as a plot takes them, or the logarithms' magnitudes: null where there is none, which leaves a gap.
export const drawn = (values, log) => Array.from(values, v => !Number.isFinite(v) || (log && v === 0) ? null : log ? Math.abs(v) : v);

// Okabe and Ito's colours, told apart by those who do not see colours too; by theme.
export const palette = dark => dark
  ? ['#56b4e9', '#e69f00', '#2fc79a', '#e58fc0', '#f0e442', '#ff7f3f', '#b8c4d6', '#7fa8ff']
  : ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#b8860b', '#56b4e9', '#444444', '#7f3c8d'];
export const dashes = [[], [8, 4], [2, 3], [10, 4, 2, 4], [4, 4], [14, 5]];
// A line of a pen, as the background of a flat element.
export function pen_sample(colour, dash) {
  let at = 0;
  const stops = dash.map((length, i) => `${i % 2 ? 'transparent' : colour} ${at}px ${at += length}px`);
  return stops.length ? `repeating-linear-gradient(90deg, ${stops.join(', ')})` : colour;
}
