// Numbers in words and notes.
import { is_rounding } from './ticks.js';

// As many digits as are asked for, and a power of ten where the number is very large or small. `even`: with zeros at the
// end too, where numbers change under the eye of the reader.
export function number(v, digits = 4, even = false) {
  if (v == null || Number.isNaN(v)) return '–';
  if (v === 0) return '0';
  if (Math.abs(v) >= 1e5 || Math.abs(v) < 1e-3) return v.toExponential(digits - 2).replace('e+', 'e');
  return even ? v.toPrecision(digits) : `${+v.toPrecision(digits)}`;
}

// Numbers of one range, with the digits that tell a thousandth of it apart; with `least_digits` where the range is as
// large as they.
export function number_within(least, greatest, least_digits = 4, even = false) {
  const range = greatest - least, largest = Math.max(Math.abs(least), Math.abs(greatest));
  const digits = !is_rounding(least, greatest) ? Math.min(15, Math.ceil(Math.log10(largest / range)) + 3) : 0;
  if (digits <= least_digits) return v => number(v, least_digits, even);
  return v => (Number.isFinite(v) && v !== 0 ? (even ? v.toPrecision(digits) : `${+v.toPrecision(digits)}`).replace('e+', 'e') : number(v));
}

// The same for those of a list.
export function number_among(values, ...digits) {
  let least = Infinity, greatest = -Infinity;
  for (const v of values) {
    if (!Number.isFinite(v)) continue;
    least = Math.min(least, v);
    greatest = Math.max(greatest, v);
  }
  return number_within(least, greatest, ...digits);
}
