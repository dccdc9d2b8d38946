// What a page knows of the rows of runs: all of them, or of long runs some whole ones, and of every stretch the least
// and the greatest numbers, of which nobody knows the times.

// A quantity over time: {t, y} to be drawn; whether these are the two numbers of each stretch (`spans`); and of the rows
// that are known whole {t, y, every}, `every` where they are all there are. Arrays are made when they are asked for.
export function of_rows(run, column, change) {
  const spans = run.table.stride > 2, made = values => change ? values.map(change) : values;
  return {
    t: run.time,
    y: () => made(column.data),
    spans,
    whole: spans ? ('samples' in column ? { t: run.animation.times, y: () => made(column.samples), every: false } : none) : null,
  };
}
const none = { t: [], y: () => [], every: false };

// Times of rows are a start and a multiple of an interval, each right to a rounding, and so is what is made of them:
// two that stand for one time differ by four of the greatest at most.
const rounding_of = (...times) => 4 * Number.EPSILON * Math.max(...times.flatMap(t => [Math.abs(t[0]), Math.abs(t[t.length - 1])]));

// Places [i, k] in two lists of times that rise, of each time that is in both. An instant at which states jump has
// several rows: where it has as many in both these belong together, or else nobody knows which do.
export function common_times(t, u) {
  const pairs = [];
  if (!t.length || !u.length) return pairs;
  const off = rounding_of(t, u), rows_at = (v, i) => { let n = 1; while (i + n < v.length && v[i + n] - v[i] <= off) ++n; return n; };
  for (let i = 0, k = 0; i < t.length && k < u.length;) {
    if (t[i] - u[k] < -off) ++i;
    else if (t[i] - u[k] > off) ++k;
    else {
      const n = rows_at(t, i), m = rows_at(u, k);
      for (let r = 0; n === m && r < n; ++r) pairs.push([i + r, k + r]);
      i += n;
      k += m;
    }
  }
  return pairs;
}

// Differences of the rows that two runs have at one time, from whole rows alone: {t, y, times, gaps}. A line is drawn
// only between rows that follow each other in one of the runs; elsewhere a null parts them, for nobody knows what lies
// between.
export function difference(a, b) {
  const t = [], y = [], pairs = common_times(a.t, b.t);
  let gaps = false;
  pairs.forEach(([i, k], n) => {
    const [before_i, before_k] = pairs[n - 1] ?? [];
    if (n > 0 && !(a.every && i === before_i + 1) && !(b.every && k === before_k + 1)) {
      t.push((a.t[before_i] + a.t[i]) / 2);
      y.push(null);
      gaps = true;
    }
    t.push(a.t[i]);
    y.push(a.y[i] - b.y[k]);
  });
  return { t, y, times: pairs.length, gaps };
}

// The place of a time in what was drawn: the last that is not later.
export function place_of(t, time) {
  let low = 0, high = t.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (t[middle] <= time) low = middle; else high = middle - 1;
  }
  return low;
}

// Places at which a curve has a number of its own, in arrays that several curves share: others have undefined there, and
// `parted` curves null between their points. The nearest, and the last up to a place; null where there is none.
const is_own = (value, parted) => value !== undefined && !(parted && value === null);
export function nearest_own(values, place, parted) {
  for (let off = 0; off < values.length; ++off) {
    if (place - off >= 0 && is_own(values[place - off], parted)) return place - off;
    if (place + off < values.length && is_own(values[place + off], parted)) return place + off;
  }
  return null;
}
export function own_before(values, place, parted) {
  for (let i = place; i >= 0; --i) if (is_own(values[i], parted)) return i;
  return null;
}
