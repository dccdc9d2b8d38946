// Frequencies and damping over what is swept (a Campbell diagram), or of one configuration; the shape of the mode that is
// clicked.
import { dashes } from '../data.js';
import { number, number_among } from '../numbers.js';
import { element } from '../words.js';
import { Figure, draw, legend, room_in, table_of } from './figure.js';

// Diagrams show Im λ, the damped frequency; tables, as modes.csv, the natural one, |λ|. Of equal blades only the first is known.
const hertz = m => m.hertz;
const radians = m => 2 * Math.PI * m.hertz;
const natural = m => m.natural ?? m.hertz;
// Equal blades have modes as what does not turn sees them, and those of the equations at one angle.
const standing = 'where the rotor does not turn', turning = 'the blades, at one angle';

// A line without what is below `floor`: where it passes that it has a point that is no mode.
function cut(points, floor) {
  const below = p => p && p[1] != null && p[1] < floor, out = [];
  points.forEach((p, i) => {
    const q = points[i - 1];
    if (q && q[1] != null && p[1] != null && below(q) !== below(p)) out.push([q[0] + (floor - q[1]) / (p[1] - q[1]) * (p[0] - q[0]), floor, null]);
    out.push(below(p) ? [p[0], null, null] : p);
  });
  return out;
}

export class Modes {
  constructor(holder, data) {
    const blades = Math.max(...data.runs.map(run => run.blades?.count ?? 0));
    Object.assign(this, { data, blades, seen_from: blades ? standing : turning, unit: 'Hz', chosen: null, harmonics: data.rate ? (blades ? 2 * blades : 4) : 0 });
    this.swept = data.points > 1;
    this.tools = element('div', null, { class: 'bar' });
    this.names = element('div');
    this.figures = element('div', null, { class: 'figures' });
    this.card = element('aside', null, { class: 'card', id: 'mode', 'aria-live': 'polite' });
    const beside = element('div', null, { class: 'beside' }), left = element('div');
    left.append(this.tools, this.names, this.figures);
    beside.append(left, this.card);
    const said = element('div', null, { class: 'answer' });
    for (const remark of data.remarks) said.append(element('p', remark));
    this.meaning = element('div');
    said.append(this.meaning);
    holder.append(said, beside);
    this.set_up();
    this.see();
  }

  // Takes the branches that are seen from where it is chosen.
  see() {
    const stands = this.seen_from === standing, of = run => (stands ? run.blades?.branches ?? [] : run.branches);
    this.branches = this.data.runs.flatMap((run, r) => of(run).map((branch, i) => ({ ...branch, run, r, index: i, name: this.name_of(branch, run) })));
    this.meaning.replaceChildren(...(stands ? [] : this.data.frozen).map(text => element('p', text)), element('p', this.words(stands), { class: 'soft' }));
    const first = this.branches[0];
    if (first) this.choose(first, first.at.find(Boolean));
  }

  words(stands) {
    if (stands) return 'Modes of equal blades by the multi-blade transform: frequencies that an instrument on what does not turn sees, named after the blades\' coordinate and the way its pattern runs round. Branches are followed by shape: a name is that at the beginning and, where it becomes another, at the end. What does not swing has the frequency 0. Triangles mark motions that grow.';
    const most = this.data.loops ? 'what takes part most, a coordinate or a state of a load' : 'the coordinate with most of the kinetic energy';
    return this.swept ? `Branches are followed by shape: a name is of ${most}, at the beginning and, where it becomes another, at the end. Triangles mark motions that grow. Click a mark for its shape.`
      : `A mode is named after ${most}. Click a row for its shape.${this.rigid()}`;
  }

  // Numbers are those of modes.csv, which has these too.
  rigid() {
    const most = Math.max(...this.data.runs.map(run => run.rigid));
    return most ? ` ${most === 1 ? 'One rigid motion is' : `${most} rigid motions are`} not listed; numbers count ${most === 1 ? 'it' : 'them'}.` : '';
  }

  name_of(branch, run) {
    const known = branch.at.filter(Boolean), from = known[0].dominated_by, to = known.at(-1).dominated_by;
    const name = from === to ? from : `${from} → ${to}`;
    return this.data.runs.length > 1 ? `${run.formulation}: ${name}` : name;
  }

  set_up() {
    const add = (label, options, value, act) => {
      const holder = element('label', `${label} `), select = element('select', null, { 'aria-label': label });
      for (const o of options) select.append(element('option', `${o}`, { value: o }));
      select.value = value;
      select.onchange = () => { act(select.value); this.paint(this.colours); };
      holder.append(select);
      this.tools.append(holder);
    };
    if (this.blades) add('Seen from', [standing, turning], standing, v => { this.seen_from = v; this.see(); });
    if (this.swept) add('Frequencies in', ['Hz', 'rad/s'], 'Hz', v => { this.unit = v; });
    const lines = [0, 1, 2, 3, 4, 6, 8, 12, ...[1, 2, 3, 4].map(k => k * this.blades)];
    if (this.swept && this.data.rate) add('Lines of the rate up to', [...new Set(lines)].sort((a, b) => a - b), this.harmonics, v => { this.harmonics = +v; });
  }

  paint(colours) {
    this.colours = colours;
    const several = this.data.runs.length > 1;
    for (const b of this.branches) {
      b.color = colours[(several ? b.r : b.index) % colours.length];
      b.dash = several ? dashes[b.index % dashes.length].join(' ') : '';
    }
    this.names.replaceChildren(this.swept ? legend(this.branches, () => this.paint(colours)) : '');
    this.figures.replaceChildren(...(this.swept ? [this.campbell(), this.data.loops && this.seen_from !== standing ? this.locus() : null, this.damping(), this.growth()].filter(Boolean) : [this.table()]));
    if (this.chosen) this.choose(...this.chosen);
  }

  values(of) {
    return this.branches.filter(b => !b.hidden).map(b => ({ b, points: b.at.map((m, i) => [this.data.values[i], m ? of(m) : null, m]) }));
  }

  // Curves below `floor` are cut off there.
  figure(label, of, { log = false, include, floor = null, height = 330, right = 16 } = {}) {
    const curves = this.values(of).map(({ b, points }) => ({ b, points: floor == null ? points : cut(points, floor) }));
    const all = curves.flatMap(c => c.points.map(p => p[1])).filter(v => v != null);
    const figure = new Figure({ height, right, room: room_in(this.figures), x: { label: this.data.label, values: this.data.values, room: 0 }, y: { label, values: all, log, include } });
    for (const { b, points } of curves) {
      figure.line(points.map(([x, y]) => [x, log && !(y > 0) ? null : y]), { stroke: b.color, 'stroke-width': 1.8, 'stroke-dasharray': b.dash });
      for (const [x, y, m] of points) {
        if (y == null || !m || (log && !(y > 0))) continue;
        figure.mark(x, y, m.unstable ? 2 : 0, { fill: m.unstable ? 'var(--bad)' : b.color, small: !m.unstable }, () => this.about(b, m), () => this.choose(b, m));
      }
    }
    return figure;
  }

  campbell() {
    const of = this.unit === 'Hz' ? hertz : radians, named = room_in(this.figures) > 560; // the legend names them too
    const figure = this.figure(this.seen_from === standing ? `frequency [${this.unit}]` : `damped frequency [${this.unit}]`, of, { include: [0], height: 520, ...(named ? { right: 210 } : {}) });
    this.per_rev(figure);
    if (named) this.label(figure, of);
    figure.element.id = 'campbell';
    return figure.element;
  }

  // Of loops the eigenvalues in their plane, upper half, along the sweep: what lies right of zero grows. A larger mark is where a branch begins.
  locus() {
    const of = this.unit === 'Hz' ? hertz : radians;
    const curves = this.branches.filter(b => !b.hidden).map(b => ({ b, points: b.at.map(m => (m ? [m.growth, of(m), m] : [null, null])) }));
    const all = k => curves.flatMap(c => c.points.map(p => p[k])).filter(v => v != null);
    const figure = new Figure({ height: 420, room: room_in(this.figures), x: { label: 'growth [1/s]', values: all(0), include: [0] }, y: { label: `damped frequency [${this.unit}]`, values: all(1), include: [0] } });
    for (const { b, points } of curves) {
      figure.line(points, { stroke: b.color, 'stroke-width': 1.2, 'stroke-dasharray': b.dash });
      const first = points.findIndex(p => p[2]);
      points.forEach(([x, y, m], i) => {
        if (m) figure.mark(x, y, m.unstable ? 2 : 0, { fill: m.unstable ? 'var(--bad)' : b.color, small: !m.unstable && i !== first }, () => this.about(b, m), () => this.choose(b, m));
      });
    }
    figure.element.id = 'locus';
    return figure.element;
  }

  // Multiples of the rate, the highest first: what does not turn meets those of the blades that pass.
  multiples() {
    const all = Array.from({ length: this.harmonics }, (_, k) => this.harmonics - k);
    return this.seen_from === standing ? all.filter(n => n === 1 || n % this.blades === 0) : all;
  }

  // n times the rate: where a branch crosses one, n impulses a turn meet it. From 0 they rise to both sides.
  per_rev(figure) {
    const { values, rate } = this.data, low = Math.min(...values), high = Math.max(...values);
    for (const n of this.multiples()) {
      const slope = n * rate / (this.unit === 'Hz' ? 2 * Math.PI : 1), reach = figure.y.high / slope;
      for (const side of [1, -1]) {
        const [near, far] = side > 0 ? [Math.max(low, 0), high] : [Math.min(high, 0), low];
        const end = side * Math.min(side * far, reach);
        if (!(side * near < side * end)) continue;
        const word = figure.text(figure.x(end) - 4 * side, figure.y(slope * Math.abs(end)) + (end === far ? -4 : 12), `${n} per turn`, { class: 'harmonic', 'text-anchor': side > 0 ? 'end' : 'start' });
        // Under the branches, which their words must not cut.
        figure.marks.prepend(figure.line([[near, slope * Math.abs(near)], [end, slope * Math.abs(end)]], { class: 'harmonic' }), word);
      }
    }
  }

  // Names at the right ends of branches, moved apart.
  label(figure, of) {
    const rightmost = points => points.filter(p => p[1] != null).reduce((a, p) => (a && a[0] > p[0] ? a : p), null);
    const ends = this.values(of).map(({ b, points }) => [b, rightmost(points)]).filter(([, p]) => p)
      .map(([b, p]) => ({ b, y: figure.y(p[1]), from: figure.y(p[1]), end: figure.x(p[0]) })).sort((p, q) => p.y - q.y);
    for (let i = 1; i < ends.length; ++i) ends[i].y = Math.max(ends[i].y, ends[i - 1].y + 15);
    const over = ends.length ? Math.max(0, ends.at(-1).y - (figure.height - figure.bottom)) : 0;
    for (let i = ends.length - 1, most = Infinity; over > 0 && i >= 0; --i) {
      ends[i].y = Math.min(ends[i].y, most, figure.height - figure.bottom);
      most = ends[i].y - 15;
    }
    const x = figure.width - figure.right;
    for (const { b, y, from, end } of ends) {
      if (end < x - 1) figure.svg.append(draw('path', { d: `M${end} ${from}H${x}`, stroke: b.color, 'stroke-width': 0.7, 'stroke-dasharray': '1 4' }));
      figure.svg.append(draw('path', { d: `M${x} ${from}L${x + 14} ${y}`, stroke: b.color, fill: 'none', 'stroke-width': 1 }));
      figure.text(x + 18, y + 4, b.name.length > 30 ? `${b.name.slice(0, 29)}…` : b.name, { style: `fill: ${b.color}` });
    }
  }

  damping() {
    const of = m => m.damping_ratio == null ? null : 100 * m.damping_ratio;
    if (!this.values(of).some(c => c.points.some(p => p[1] != null && Math.abs(p[1]) > 1e-7))) return null;
    return this.figure('damping ratio [%]', of).element;
  }
  growth() {
    if (!this.branches.some(b => b.at.some(m => m?.unstable))) return null;
    const growth = this.branches.filter(b => !b.hidden).flatMap(b => b.at).filter(Boolean).map(m => m.growth);
    // What decays by far faster than anything grows leaves the picture: the axis shows where growth begins.
    const far = 4, greatest = Math.max(...growth);
    return this.figure('growth [1/s]', m => m.growth, { floor: greatest > 0 ? Math.max(-far * greatest, Math.min(...growth)) : null, include: [0] }).element;
  }

  about(b, m) {
    const all = b.at.filter(Boolean).map(natural), in_hertz = number_among(all), in_radians = number_among(all.map(f => 2 * Math.PI * f));
    return [b.name, this.swept ? `${this.data.label} ${number_among(this.data.values)(m.value)}` : '', natural(m) || !m.growth ? `${in_hertz(natural(m))} Hz, ${in_radians(2 * Math.PI * natural(m))} rad/s` : '', m.hertz === 0 && m.growth ? `growth ${number(m.growth)}/s` : '', m.damping_ratio == null ? '' : `damping ratio ${number(100 * m.damping_ratio)} %`, m.state].filter(Boolean);
  }

  // What share of the kinetic energy each coordinate of the shape has, and how like the first shape of the branch it is.
  choose(b, m) {
    this.chosen = [b, m];
    this.card.replaceChildren(element('h2', 'Mode'));
    for (const text of this.about(b, m)) this.card.append(element('div', text));
    if (!m.shape) return;
    if (this.swept) this.card.append(element('div', `like the branch's first shape (MAC): ${m.mac.toFixed(3)}`, { class: 'soft' }));
    this.card.append(element('p', 'Shares of the kinetic energy, and phases; a share is negative where a coordinate moves against the momentum that the others give it', { class: 'soft' }));
    const bars = element('table', null, { class: 'bars' });
    for (const [name, share, phase] of m.shape) {
      const row = element('tr'), cell = element('td'), bar = element('div', null, { class: 'level' });
      bar.style.width = `${Math.min(100, Math.max(1, 100 * Math.abs(share)))}%`;
      bar.style.background = b.color ?? 'currentColor';
      cell.append(bar);
      row.append(element('th', name), cell, element('td', `${(100 * share).toFixed(Math.abs(share) < 0.1 ? 1 : 0)} %`, { class: 'number' }), element('td', `${Math.round(phase)}°`, { class: 'number' }));
      bars.append(row);
    }
    this.card.append(bars);
  }

  table() {
    const rows = this.branches.map(b => ({ b, m: b.at.find(Boolean) }));
    const several = this.data.runs.length > 1 ? [['formulation', r => r.b.run.formulation]] : [];
    const table = table_of([...several, ['mode', r => r.b.number ?? r.b.index + 1], ['frequency [Hz]', r => natural(r.m), r => number(natural(r.m))], ['[rad/s]', r => 2 * Math.PI * natural(r.m), r => number(2 * Math.PI * natural(r.m))],
      ['damping ratio [%]', r => r.m.damping_ratio == null ? null : 100 * r.m.damping_ratio, r => r.m.damping_ratio == null ? '–' : number(100 * r.m.damping_ratio)], ['growth [1/s]', r => r.m.growth, r => number(r.m.growth)], ['mostly', r => r.m.dominated_by], ['state', r => r.m.state ?? '–']], rows, r => this.choose(r.b, r.m));
    const frame = element('div', null, { class: 'scroll' });
    for (const run of this.data.runs) if (run.floquet) frame.append(...this.exponents(run));
    frame.append(table);
    return frame;
  }

  // The whole turn first: what the modes of one angle do not tell.
  exponents({ formulation, floquet }) {
    const of = this.data.runs.length > 1 ? `${formulation}: ` : '', known = (r, v) => (r.resolved ? number(v) : '–');
    const beside = r => r.lines.map(([f, share]) => `${number(f)} (${Math.round(100 * share)} %)`).join(', ');
    const table = table_of([['growth [1/s]', r => r.growth, r => (r.resolved ? number(r.growth) : `< ${number(r.growth)}`)], ['frequency [Hz]', r => r.hertz, r => known(r, r.hertz)], ['[rad/s]', r => radians(r), r => known(r, radians(r))], ['mostly', r => r.dominated_by], ['seen beside at [Hz]', beside]], floquet.modes);
    return [element('h2', `${of}The whole turn is ${floquet.stable ? 'stable' : 'unstable'} (Floquet; growth to ${number(floquet.resolution)}/s)`), table, element('h2', 'Modes')];
  }
}
