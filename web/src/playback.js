// How fast a run is played, and what its clock shows.
import { exponent_of, in_decade, name_in_decade } from './ticks.js';

const usual = [...[-2, -1, 0, 1].flatMap(k => [1, 2, 5].map(m => [m, k])), [1, 2], [1, 3]];
const value_of = ([m, k]) => in_decade(m, k);
const nearest_to = (choice, wanted) => choice.reduce((a, b) => (Math.abs(Math.log(value_of(b) / wanted)) < Math.abs(Math.log(value_of(a) / wanted)) ? b : a));

// The speeds to choose from, and the one at first: {all: [{value, name}], chosen: value}. A run of 3 s to a minute is
// played as fast as it is, others of 1 to 100 s in 6 or in 30 s; those that are shorter and longer by far in some 15 s,
// with powers of ten about that.
export function speeds_of(duration) {
  const far = duration > 0 && (duration < 1 || duration > 100);
  const aim = duration / (far ? 15 : duration < 3 ? 6 : duration > 60 ? 30 : duration || 1);
  let choice = usual, chosen = nearest_to(usual, aim || 1);
  if (far) {
    const k = exponent_of(aim);
    chosen = nearest_to([0, 1].flatMap(d => [1, 2, 5].map(m => [m, k + d])), aim);
    choice = [-2, -1, 0, 1, 2].flatMap(d => [1, 2, 5].map(m => [m, chosen[1] + d]));
    if (!choice.some(c => value_of(c) === 1)) choice = aim < 1 ? [...choice, [1, 0]] : [[1, 0], ...choice];
  }
  return { all: choice.map(c => ({ value: value_of(c), name: value_of(c) === 1 ? 'as it is' : `× ${name_in_decade(...c)}` })), chosen: value_of(chosen) };
}

// A time of a run as its clock shows it: a thousandth of the run is told, with a power of ten, of thousands, where times
// are as short.
export function clock_of(start, end) {
  const most = Math.max(Math.abs(start), Math.abs(end)), length = end - start || most || 1;
  const power = most > 0 && most < 1e-3 ? 3 * Math.floor(exponent_of(most) / 3) : 0;
  const digits = Math.max(0, Math.min(15, 3 + power - exponent_of(length)));
  return t => `${(t / in_decade(1, power)).toFixed(digits)}${power ? `e${power}` : ''} s`;
}
