// What stands at the ticks of an axis.

// Whether numbers in this range are one but for rounding: ticks so close could not be told apart, nor be counted.
export const is_rounding = (low, high) => !(high - low > 1e-13 * Math.max(Math.abs(low), Math.abs(high)));

// As many digits as tell each of the ticks from what it is not.
export function label_of(v, ticks, log) {
  if (v === 0) return '0';
  if (log) return Math.log10(Math.abs(v)) % 1 === 0 || ticks.length < 12 ? v.toExponential(0).replace('e+', 'e') : '';
  const step = ticks.length > 1 ? Math.abs(ticks[1] - ticks[0]) : Math.abs(v);
  const most = Math.max(...ticks.map(Math.abs));
  if (most >= 1e5 || most < 1e-3) {
    let places = 0;
    while (places < 16 && ticks.some(t => Math.abs(Number(t.toExponential(places)) - t) > 1e-3 * step)) ++places;
    // Many digits are read more easily without a power, as 7000000.25.
    if (places < 6 || most < 1e-3 || most >= 1e12) return v.toExponential(places);
  }
  let digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  while (digits < 9 && Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-6) ++digits;
  return v.toFixed(digits);
}
