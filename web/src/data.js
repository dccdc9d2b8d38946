// What the program wrote into the page, as arrays, and what is computed of it.

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
  const { animation, arrays } = run;
  const doubles = index => new Float64Array(bytes(arrays[index]));
  for (const column of run.table.columns) {
    const { data, samples } = column;
    lazy(column, 'data', () => doubles(data));
    if (samples != null) lazy(column, 'samples', () => doubles(samples));
  }
  animation.times = doubles(animation.times);
  animation.numbers = new Float32Array(bytes(arrays[animation.numbers]));
  for (const part of animation.parts) {
    if (part.surface) part.surface = { vertices: new Float32Array(bytes(arrays[part.surface[0]])), triangles: new Uint32Array(bytes(arrays[part.surface[1]])) };
    if (part.shapes != null) part.shapes = new Float32Array(bytes(arrays[part.shapes]));
    if (part.triangles != null) part.triangles = new Uint32Array(bytes(arrays[part.triangles]));
    if (part.sections) part.sections.widths = new Float32Array(bytes(arrays[part.sections.widths]));
  }
  // Pages of earlier versions have none.
  for (const arrow of animation.arrows ??= []) arrow.numbers = new Float32Array(bytes(arrays[arrow.numbers]));
  for (const series of run.validity) {
    const { data } = series;
    lazy(series, 'data', () => doubles(data));
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

// Several columns by name, and whether each has numbers at the moments of the animation; null where one is missing.
function together(run, names) {
  const columns = names.map(name => run.table.columns.find(c => c.name === name));
  if (columns.some(c => !c)) return null;
  const sampled = 'samples' in columns[0];
  return { t: sampled ? run.animation.times : run.time, values: () => columns.map(c => sampled ? c.samples : c.data) };
}

// Angles that turn far in any of the runs: they are told in turns in all of them, else their curves could not be compared.
const far = 20 * Math.PI;
const turning = runs => new Set(runs.flatMap(run => run.table.columns.filter(c => c.unit === 'rad' && c.data.some(v => Math.abs(v) > far)).map(c => c.name)));

// The quantities of a run: {group, name, unit, t, y, limit?}, groups in the order of the page; y is made when asked for.
export function quantities(run, turns = turning([run])) {
  const out = [];
  const add = (group, name, unit, t, y, more = {}) => out.push(lazy({ group, name, unit, t, ...more }, 'y', y));
  // Angles that say again what a quaternion beside them says.
  const told = new Set(run.table.columns.filter(c => c.name.endsWith('.qw')).flatMap(c => ['rx', 'ry', 'rz'].map(r => c.name.replace(/qw$/, r))));
  // Coordinates and rates of hinges and modes stand before the energies, outputs of the scene behind them.
  const states = run.table.columns.findIndex(c => c.name === 'kinetic_energy');
  for (const [place, column] of [...run.table.columns.entries()].slice(1)) {
    const { name, unit } = column, data = () => column.data, state = states < 0 || place < states;
    const last = name.slice(name.lastIndexOf('.') + 1);
    const quaternion = /^(.*)\.q([wxyz])$/.exec(name);
    if (quaternion) {
      if (quaternion[2] !== 'w') continue;
      const base = quaternion[1];
      const parts = together(run, ['qw', 'qx', 'qy', 'qz'].map(q => `${base}.${q}`));
      if (!parts) continue;
      const angles = lazy({}, 'all', () => attitude(...parts.values()));
      for (const i of [0, 1, 2]) add(`Attitude of ${base}: turns about x, y, z in this order`, `${base}.${'xyz'[i]}`, 'deg', parts.t, () => angles.all[i]);
    } else if ((name.endsWith('_energy') || name === 'work') && unit === 'J') add('Energies', name, unit, run.time, data);
    else if (/^(linear|angular)_momentum\./.test(name)) add(name.startsWith('linear') ? 'Linear momentum' : 'Angular momentum', name, unit, run.time, data);
    else if (/\.tip\.deflection_[xyz]$/.test(name)) add('Deflection of tips', name, unit, run.time, data);
    else if (/\.tip\.[xyz]$/.test(name)) add('Position of tips', name, unit, run.time, data);
    else if (/\.motion_effort(\.\d+)?$/.test(name)) add(`Effort of motions, ${unit}`, name, unit, run.time, data);
    else if (state && /\.rate(\.\d+)?$/.test(name)) add(unit === 'rad/s' ? 'Rates of hinges' : unit === 'm/s' ? 'Speeds of hinges' : 'Rates of modal coordinates', name, unit && unit !== '1' ? unit : '1/s', run.time, data);
    else if (unit === 'rad' && told.has(name)) continue;
    else if (unit === 'rad' && turns.has(name)) add('Turns', name, 'turns', run.time, () => column.data.map(v => v / 2 / Math.PI));
    else if (unit === 'rad') add('Angles', name, 'deg', run.time, () => column.data.map(v => v * degrees));
    else if (state && unit === '') add('Modal coordinates', name, '1', run.time, data);
    // Of outputs: a strain, a formula.
    else if (unit === '1' || unit === '') add('Numbers without a unit', name, '1', run.time, data);
    else if (name.includes('.')) add(`${name.slice(0, -last.length - 1)}, ${unit}`, name, unit, run.time, data);
    else add(state && unit === 'm' ? 'Travel of hinges' : `${name}, ${unit}`, name, unit, run.time, data);
  }
  const energy = together(run, ['kinetic_energy', 'potential_energy', 'work']);
  if (energy) {
    add('Drift of energy: kinetic + potential − work, less its first value', 'drift', 'J', energy.t, () => {
      const [T, V, W] = energy.values();
      return T.map((v, i) => v + V[i] - W[i] - (T[0] + V[0] - W[0]));
    });
  }
  for (const series of run.validity)
    add('Validity: each over its limit, which is 1', series.name, '1', run.animation.times, () => series.data.map(v => v / series.limit), { limit: 1 });
  return out;
}

// Groups over all runs: [{title, unit, series: [{name, of: [{run, t, y}]}]}].
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
      series.of.push(lazy({ run, t: q.t }, 'y', () => q.y));
    }
  }
  const all = [...groups.values()];
  for (const group of all) {
    group.series = [...group.series.values()];
    for (const s of group.series) lazy(s, 'flat', () => s.of.every(({ y }) => y.every(v => v === y[0])));
  }
  return all.sort((a, b) => rank(a.title) - rank(b.title));
}

// y of a run at the times of another, between its own linearly; nothing outside.
export function resampled(t, y, at) {
  const out = new Array(at.length);
  let i = 0;
  for (let k = 0; k < at.length; ++k) {
    while (i + 1 < t.length && t[i + 1] < at[k]) ++i;
    if (t.length === 0 || at[k] < t[0] || at[k] > t[t.length - 1]) out[k] = null;
    else if (t[i] === at[k] || i + 1 >= t.length) out[k] = y[i];
    else if (t[i + 1] === at[k]) out[k] = y[i + 1];
    else out[k] = y[i] + (y[i + 1] - y[i]) * (at[k] - t[i]) / (t[i + 1] - t[i]);
  }
  return out;
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
