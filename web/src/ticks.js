// Where the ticks of an axis are, and what stands at them.

// Whether numbers in this range are one but for rounding: ticks so close could not be told apart, nor be counted.
export const is_rounding = (low, high) => !(high - low > 1e-13 * Math.max(Math.abs(low), Math.abs(high)));

// The power of ten at or below a number, and the number m 10^k: Math.log10 and ** are off by rounding.
export const exponent_of = v => Number(v.toExponential().split('e')[1]);
export const in_decade = (m, k) => Number(`${m}e${k}`);
// As 0.002, 50, 2e-7.
export const name_in_decade = (m, k) => (k >= -3 && k <= 4 ? `${in_decade(m, k)}` : `${m}e${k}`);

// What stands at ticks: the digits that tell each from what it is not, and one power of ten for all, of thousands.
export function labels_of(values) {
  const most = Math.max(...values.map(Math.abs)), step = values.length > 1 ? Math.abs(values[1] - values[0]) : most;
  const digits = power => {
    const scale = in_decade(1, power);
    let n = 0;
    while (n < 16 && values.some(v => Math.abs(+(v / scale).toFixed(n) - v / scale) > 1e-3 * step / scale)) ++n;
    return n;
  };
  let power = most > 0 && (most >= 1e5 || most < 1e-3) ? 3 * Math.floor(exponent_of(most) / 3) : 0;
  // Many digits are read more easily without a power, as 7000000.25.
  if (power > 0 && power < 12 && digits(power) > 5) power = 0;
  const n = digits(power), scale = in_decade(1, power);
  return values.map(v => (v === 0 ? '0' : (v / scale).toFixed(n) + (power ? `e${power}` : '')));
}
const named = values => { const names = labels_of(values); return values.map((v, i) => [v, names[i]]); };

// Multiples of 1, 2 or 5 times a power of ten.
function round_numbers(low, high, most) {
  if (is_rounding(low, high)) return [];
  const least = (high - low) / Math.max(2, most), k = exponent_of(least);
  const [m, e] = [[1, k], [2, k], [5, k], [1, k + 1]].find(([m, e]) => in_decade(m, e) >= least * 0.999), step = in_decade(m, e), out = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) out.push(i === 0 ? 0 : in_decade(i * m, e));
  return named(out);
}

// Powers of ten, and where these are few twice and five times them; where even those are less than three, round numbers.
// fewer: than the axis has room for, by this factor.
const few_decades = 2.2;
function decades(low, high, most, fewer) {
  const span = Math.log10(high) - Math.log10(low), thin = Math.max(1, Math.round(span / 8 * fewer)), parts = span < few_decades && fewer === 1 ? [1, 2, 5] : [1], out = [];
  for (let k = exponent_of(low); k <= exponent_of(high); ++k)
    for (const m of parts) {
      const v = in_decade(m, k);
      if (k % thin === 0 && v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9)) out.push([v, name_in_decade(m, k)]);
    }
  return out.length < 3 && span < few_decades ? round_numbers(low, high, most) : out;
}

// The ticks of an axis from low to high, and what stands at each: [[value, label]].
// length: of the axis [px]; apart: how far ticks are apart at least [px]; across: labels stand side by side
const letter = 7.2, between = 10; // widths of a digit and of what parts two labels, at 12 px
export function axis_ticks(low, high, { length, apart, log = false, across = false }) {
  const tell = log ? Math.log10 : v => v, pixels = length / (tell(high) - tell(low));
  const room = (a, b) => (tell(b[0]) - tell(a[0])) * pixels >= letter * (a[1].length + b[1].length) / 2 + between;
  for (let fewer = 1; ; fewer *= 1.3) {
    const most = length / apart / fewer, ticks = log ? decades(low, high, most, fewer) : round_numbers(low, high, most);
    if (!across || most < 2 || ticks.every((t, i) => i === 0 || room(ticks[i - 1], t))) return ticks;
  }
}

// Ends of an axis about numbers, with room beside them as a part of their range. Numbers that differ by rounding alone
// stand in the middle, with `about` to both sides.
export function ends_of(low, high, room, about = low === 0 ? 1 : 0.1 * Math.abs(low)) {
  const beside = is_rounding(low, high) ? about : room * (high - low);
  return [low - beside, high + beside];
}
