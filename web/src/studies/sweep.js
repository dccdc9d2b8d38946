// Many cases: how results are distributed, what they depend on, and which cases failed.
import { number, number_among, number_within } from '../numbers.js';
import { element } from '../words.js';
import { Figure, answers, draw, room_in, scale_of, table_of, tell } from './figure.js';

const most_told = 6;  // results, in words
const short = name => name.replace(/^peak\.|^final\./, '');
// Numbers of a column.
const told_of = column => number_within(column.least, column.greatest);

export class Sweep {
  constructor(holder, data) {
    Object.assign(this, { data, holder, parts: [] });
    this.varied = data.columns.filter(c => c.role !== 'result' && c.numeric);
    this.results = data.columns.filter(c => c.role === 'result' && c.numeric);
    this.write_answer();
    this.card = element('aside', null, { class: 'card', id: 'case', 'aria-live': 'polite' });
    if (data.indices) this.section('What it depends on', (colours, result, room) => this.indices(colours, result, room), true);
    if (data.histories?.length) this.over_time();
    this.section('Envelopes over what varies', (colours, result, room) => this.envelopes(colours, result, room), true);
    this.section('Distributions', (colours, _, room) => this.histograms(colours, room));
    this.section('Scatter', (colours, _, room) => [this.scatter(colours, room)]);
    if (data.statistics) this.section('Statistics', () => [this.rows(data.statistics)]);
    if (data.failures.length) this.section(`Cases that failed (${data.failed})`, () => [this.failures()]);
  }

  write_answer() {
    const { cases, done, failed, failed_share } = this.data, said = element('div', null, { class: 'answer' });
    said.append(element('p', `${cases} cases: ${done} done, ${failed} of them failed${cases > done ? `, ${cases - done} missing` : ''}.`));
    if (failed > 0) said.append(element('p', `${number(100 * failed_share.value)} % failed; with 95 % confidence ${number(100 * failed_share.low)} to ${number(100 * failed_share.high)} %, were they drawn at random.`, { class: 'message' }));
    if (this.data.counted < cases) said.append(element('p', `Distributions and envelopes are of ${this.data.counted} cases, taken at random; table.csv has all.`));
    for (const c of this.results.slice(0, most_told)) {
      const told = told_of(c);
      said.append(element('p', `${c.name}: half of the cases are below ${told(c.median)}, 5 % below ${told(c.p05)}, 5 % above ${told(c.p95)}; least ${told(c.least)}, greatest ${told(c.greatest)}.`, { class: 'soft' }));
    }
    const note = text => said.append(element('p', text, { class: 'soft' }));
    const more = this.results.length - most_told;
    if (more > 0) note(more > 1 ? `${more} more results are below.` : 'One more result is below.');
    const not_drawn = this.data.columns.filter(c => c.role !== 'result' && !c.numeric).map(c => c.name);
    if (not_drawn.length) note(`In no figure, for no numbers or one value in all cases: ${not_drawn.join(', ')}.`);
    this.holder.append(said);
  }

  // A part of the page; with a choice of the result where it shows one at a time.
  section(title, make, chooses = false, choice = this.results) {
    const part = element('section'), bar = element('div', null, { class: 'bar' }), figures = element('div', null, { class: 'figures small' });
    bar.append(element('h2', title));
    const entry = { make, figures, part, result: choice[0] };
    if (chooses && choice.length > 1) {
      const select = element('select', null, { 'aria-label': `Result, ${title}` });
      for (const c of choice) select.append(element('option', c.name, { value: c.name }));
      select.onchange = () => { entry.result = choice.find(c => c.name === select.value); this.fill(entry); };
      bar.append(select);
    }
    part.append(bar, figures);
    this.holder.append(part);
    this.parts.push(entry);
  }
  fill(entry) {
    entry.part.hidden = false;
    const made = entry.make(this.colours, entry.result ?? null, room_in(entry.figures));
    entry.figures.replaceChildren(...made);
    entry.part.hidden = made.length === 0;
  }
  paint(colours) {
    this.colours = colours;
    this.parts.forEach(entry => this.fill(entry));
  }

  histograms(colours, room) {
    return [...this.results, ...this.varied].map(c => {
      const { bins, least, greatest } = c, told = told_of(c), width = (greatest - least) / bins.length || 1;
      const figure = new Figure({ title: c.name, room, width: 420, height: 250, x: { label: c.name, values: [least, greatest], room: 0.02 }, y: { label: 'cases', values: bins, include: [0], room: c.role === 'result' ? room_of_names : 0.05 } });
      bins.forEach((count, i) => {
        if (!(count > 0)) return;
        // All cases may have one value: a bar about it.
        const one = !(greatest > least), x0 = one ? figure.x(least) - 10 : figure.x(least + i * width);
        const x1 = one ? x0 + 21 : figure.x(least + (i + 1) * width), y = figure.y(count);
        const bar = draw('rect', { x: x0, y, width: Math.max(1, x1 - x0 - 1), height: Math.max(0, figure.y(0) - y), fill: c.role === 'result' ? colours[0] : colours[6] });
        answers(bar, () => [`${count} cases`, one ? told(least) : `${told(least + i * width)} to ${told(least + (i + 1) * width)}`]);
        figure.marks.append(bar);
      });
      if (c.role === 'result') {
        const lines = [[c.p05, '5 %'], [c.median, 'median'], [c.p95, '95 %']].map(([v, name]) => ({ x: figure.x(v), name }));
        for (const { x } of lines) figure.marks.append(draw('line', { x1: x, x2: x, y1: figure.top, y2: figure.height - figure.bottom, class: 'limit' }));
        for (const { x, name, anchor } of names_beside(lines, figure.left, figure.width - figure.right)) figure.text(x, figure.top + 11, name, { class: 'soft', 'text-anchor': anchor });
      }
      return figure.element;
    });
  }

  // Bands over time that shares of the cases lie in, a figure a point of the grids; one result at a time.
  over_time() {
    const names = [...new Set(this.data.histories.map(h => h.name))];
    this.section('Over time', (colours, chosen, room) => [
      element('p', `Line: median; bands: from 25 to 75, from 5 to 95 % of the cases, and from the least to the greatest.${of_all(this.data.histories.length, this.data.histories_in_all, 'histories.csv has all')}`, { class: 'soft wide' }),
      ...this.data.histories.filter(h => h.name === chosen.name).flatMap(h => this.of_history(h, colours, room)),
    ], names.length > 1, names.map(name => ({ name })));
  }
  // Bands that are narrow beside the way of the median are shown about it too.
  of_history(h, colours, room) {
    const known = h.rows.filter(r => r[2] != null), medians = known.map(r => r[5]);
    const widest = Math.max(...known.map(r => r[8] - r[2])), way = Math.max(...medians) - Math.min(...medians);
    if (!(widest > 0 && widest < 0.1 * way)) return [this.history(h, colours, room)];
    const less = { ...h, name: `${h.name} − median`, rows: known.map(r => [r[0], r[1], ...r.slice(2).map(v => v - r[5])]) };
    return [this.history(h, colours, room), this.history(less, colours, room)];
  }
  history({ name, of, rows }, colours, room) {
    const shown = rows.filter(r => r[2] != null);
    const at = Object.entries(of).map(([path, value]) => `${path} = ${Number.isFinite(+value) ? number_among(this.data.histories.map(h => +h.of[path]))(+value) : value}`).join(', ');
    const told = number_among(shown.flatMap(r => [r[2], r[8]])), told_time = number_among(rows.map(r => r[0]));
    const figure = new Figure({ title: at || null, room, width: 420, height: 300, x: { label: 't [s]', values: rows.map(r => r[0]), room: 0.01 }, y: { label: name, values: shown.flatMap(r => [r[2], r[8]]) } });
    [[2, 8, 0.14], [3, 7, 0.2], [4, 6, 0.3]].forEach(([low, high, opacity]) => {
      const there = shown.map(r => `${figure.x(r[0])} ${figure.y(r[high])}`), back = [...shown].reverse().map(r => `${figure.x(r[0])} ${figure.y(r[low])}`);
      if (shown.length) figure.marks.append(draw('path', { d: `M${[...there, ...back].join('L')}Z`, fill: colours[0], opacity }));
    });
    figure.line(shown.map(r => [r[0], r[5]]), { stroke: colours[0], 'stroke-width': 2 });
    const { svg } = figure, line = svg.appendChild(draw('line', { y1: figure.top, y2: figure.height - figure.bottom, class: 'limit', visibility: 'hidden' }));
    svg.addEventListener('pointermove', event => {
      const x = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse()).x;
      const r = shown.reduce((a, b) => Math.abs(figure.x(b[0]) - x) < Math.abs(figure.x(a[0]) - x) ? b : a, shown[0]);
      if (!r) return;
      for (const end of ['x1', 'x2']) line.setAttribute(end, figure.x(r[0]));
      line.setAttribute('visibility', 'visible');
      tell([`t = ${told_time(r[0])} s, ${r[1]} cases`, `median ${told(r[5])}, 25 to 75 % ${told(r[4])} to ${told(r[6])}`, `5 to 95 % ${told(r[3])} to ${told(r[7])}`, `least ${told(r[2])}, greatest ${told(r[8])}`], event.clientX, event.clientY);
    });
    svg.addEventListener('pointerleave', () => { line.setAttribute('visibility', 'hidden'); tell(null); });
    return figure.element;
  }

  // Over each number that varies: least, 5 %, median, 95 % and greatest of the cases near each of its values.
  envelopes(colours, result, room) {
    if (!result) return [];
    const told = told_of(result);
    const made = this.varied.map(axis => {
      const levels = this.data.envelopes[axis.name]?.[result.name];
      if (!levels || levels.length < 2) return null;
      const figure = new Figure({ room, width: 420, height: 300, x: { label: axis.name, values: levels.map(l => l.at), room: 0.02 }, y: { label: result.name, values: levels.flatMap(l => [l.least, l.greatest]) } });
      const band = (low, high, opacity) => {
        const there = levels.map(l => `${figure.x(l.at)} ${figure.y(l[high])}`), back = [...levels].reverse().map(l => `${figure.x(l.at)} ${figure.y(l[low])}`);
        figure.marks.append(draw('path', { d: `M${[...there, ...back].join('L')}Z`, fill: colours[0], opacity }));
      };
      band('least', 'greatest', 0.16);
      band('p05', 'p95', 0.3);
      figure.line(levels.map(l => [l.at, l.median]), { stroke: colours[0], 'stroke-width': 2 });
      for (const l of levels) figure.mark(l.at, l.median, 0, { fill: colours[0], small: true }, () => [`${axis.name} about ${told_of(axis)(l.at)}`, `median ${told(l.median)}, 5 % ${told(l.p05)}, 95 % ${told(l.p95)}`, `least ${told(l.least)}, greatest ${told(l.greatest)}, ${l.count} cases`]);
      return figure.element;
    }).filter(Boolean);
    const drawn = Object.values(this.data.envelopes).reduce((n, of_axis) => n + Object.keys(of_axis).length, 0);
    const which = of_all(drawn, this.data.envelopes_in_all, 'the others are in table.csv');
    return made.length || which ? [element('p', `Line: median; dark: from 5 to 95 % of the cases; light: from the least to the greatest.${which}`, { class: 'soft wide' }), ...made] : [];
  }

  indices(colours, result, room) {
    const { head, rows } = this.data.indices, at = name => head.indexOf(name);
    const own = rows.filter(r => r[at('result')] === result?.name);
    if (!own.length) return [];
    const value = at('value') >= 0 ? told_values(own, at('parameter'), at('value')) : () => '';
    const bars = (title, of, color) => this.bars(title, own.map(r => ({ name: r[at('parameter')], value_told: value(r), ...of(r) })), color, room);
    const end = cell => cell === '' || cell == null ? undefined : +cell; // of one number there is no interval
    const estimate = name => r => ({ value: +r[at(name)], low: end(r[at(`${name}.low`)]), high: end(r[at(`${name}.high`)]) });
    if (at('total') >= 0) return [bars('Sobol index, alone: share of the variance', estimate('first'), colours[0]), bars('Sobol index, total: with all others', estimate('total'), colours[1])];
    if (at('mu_star') >= 0) return [bars('Morris: mean size of the elementary effects', estimate('mu_star'), colours[0]), bars('Morris: their deviation (interaction, curvature)', r => ({ value: +r[at('sigma')] }), colours[1])];
    return [bars(`Change of ${result.name}, one value at a time`, r => ({ value: +r[at('difference')] }), colours[0])];
  }

  // Horizontal bars with intervals, the greatest first.
  bars(title, entries, color, room) {
    const all = entries.filter(e => Number.isFinite(e.value)).sort((a, b) => Math.abs(b.value) - Math.abs(a.value));
    entries = all.slice(0, 30);
    if (all.length > entries.length) title += `: the first ${entries.length} of ${all.length}, indices.csv has all`;
    const figure = element('figure', null, { class: 'study-figure' }), width = Math.min(560, room), line = 26, height = entries.length * line + 30;
    const most = Math.min(310, 0.55 * width), names = entries.map(e => name_within(e.name, e.value_told ?? '', Math.floor((most - 16) / 7))), left = Math.min(most, Math.max(120, 20 + 7 * Math.max(0, ...names.map(n => n.length))));
    const beside = 60; // room of a number at the end of its bar
    const svg = draw('svg', { viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': title });
    const x = scale_of(entries.flatMap(e => [e.value, e.low ?? e.value, e.high ?? e.value]), { from: left + (entries.some(e => e.value < 0) ? beside : 0), to: width - beside, include: [0] });
    const axes = draw('g', { class: 'axes' });
    for (const [v, name] of x.ticks) axes.append(draw('line', { x1: x(v), x2: x(v), y1: 0, y2: height - 24 }), draw('text', { x: x(v), y: height - 8, 'text-anchor': 'middle' }, name));
    svg.append(axes);
    entries.forEach((e, i) => {
      const y = i * line + 5, from = Math.min(x(0), x(e.value));
      const bar = draw('rect', { x: from, y, width: Math.max(1, Math.abs(x(e.value) - x(0))), height: 16, fill: color });
      answers(bar, () => [e.name + (e.value_told ?? ''), `${number(e.value)}${e.low != null ? `, with 95 % confidence ${number(e.low)} to ${number(e.high)}` : ''}`]);
      svg.append(bar);
      if (e.low != null) svg.append(draw('path', { d: `M${x(e.low)} ${y + 8}H${x(e.high)}M${x(e.low)} ${y + 4}v8M${x(e.high)} ${y + 4}v8`, stroke: 'currentColor', 'stroke-width': 1.4 }));
      svg.append(draw('text', { x: left - 8, y: y + 12, 'text-anchor': 'end', class: 'name' }, names[i]));
      const end = e.value < 0 ? { x: Math.min(x(e.value), x(e.low ?? e.value)) - 6, 'text-anchor': 'end' } : { x: Math.max(x(e.value), x(e.high ?? e.value)) + 6 };
      svg.append(draw('text', { ...end, y: y + 12, class: 'soft' }, number(e.value)));
    });
    figure.append(element('figcaption', title), svg);
    return figure;
  }

  // Every pair of some columns; a case is found by the pointer and shown whole by a click.
  scatter(colours, room) {
    const all = [...this.varied, ...this.results];
    this.pairs ??= new Set([...this.varied.slice(0, 3), ...this.results.slice(0, 3)]);
    const holder = element('div', null, { class: 'pairs' }), bar = element('div', null, { class: 'legend' });
    for (const c of all) {
      const chip = element('button', c.name, { class: 'chip', 'aria-pressed': this.pairs.has(c) });
      chip.onclick = () => {
        if (!this.pairs.delete(c) && this.pairs.size < 8) this.pairs.add(c);
        this.fill(this.parts.find(p => p.figures.contains(holder)));
      };
      bar.append(chip);
    }
    const beside = element('div', null, { class: 'beside' });
    const frame = element('div', null, { class: 'sideways' });
    frame.append(this.matrix(all.filter(c => this.pairs.has(c)), colours, room));
    beside.append(frame, this.card);
    if (!this.card.childElementCount) this.card.append(element('h2', 'Case'), element('p', 'Click a point.', { class: 'soft' }));
    const { most, of } = this.data.sample;
    holder.append(bar, element('p', `Completed cases as points, failed ones as crosses where both values are known${most < of ? `; ${most} of the ${of} cases, taken at random` : ''}.`, { class: 'soft' }), beside);
    return holder;
  }

  matrix(columns, colours, room) {
    const n = columns.length;
    // Ends of axes stand beside each other below a cell where there is room, else below each other.
    const ends = new Map(columns.map(c => [c, [c.least, c.greatest].map(told_of(c))])), longest = Math.max(1, ...[...ends.values()].flat().map(e => e.length));
    const left = 22 + Math.max(42, 7 * longest), least = 110, cell = Math.max(least, Math.min(250, 840 / Math.max(1, n), (room - left) / Math.max(1, n))), size = n * cell, lines = 14 * longest > cell - 16 ? 2 : 1, bottom = 34 + 12 * lines;
    const svg = draw('svg', { viewBox: `0 0 ${left + size + 6} ${size + bottom + 6}`, role: 'img', 'aria-label': 'Scatter of every pair', style: `max-width: ${left + size + 6}px; min-width: ${left + n * least + 6}px` });
    const place = name => this.data.columns.findIndex(c => c.name === name);
    const scales = columns.map(c => scale_of([c.least, c.greatest], { from: 6, to: cell - 6, room: 0 }));
    columns.forEach((y, i) => columns.forEach((x, j) => {
      const g = draw('g', { transform: `translate(${left + j * cell} ${4 + i * cell})`, class: 'axes' });
      g.append(draw('rect', { x: 0, y: 0, width: cell - 4, height: cell - 4, class: 'frame hit' }));
      if (i === j) this.own(g, x, cell, colours);
      else this.points(g, [place(x.name), scales[j]], [place(y.name), scales[i]], cell, colours, [x, y]);
      if (i === n - 1) {
        ends.get(x).forEach((name, k) => g.append(draw('text', { x: k ? cell - 6 : 0, y: cell + 10 + (k ? 12 * (lines - 1) : 0), 'text-anchor': k ? 'end' : 'start' }, name)));
        g.append(draw('text', { x: cell / 2, y: cell + 14 + 12 * lines, 'text-anchor': 'middle', class: 'name' }, fitted(short(x.name), cell)));
      }
      if (j === 0) {
        ends.get(y).forEach((name, k) => g.append(draw('text', { x: -6, y: k ? 11 : cell - 6, 'text-anchor': 'end' }, name)));
        g.append(draw('text', { x: 14 - left, y: cell / 2, 'text-anchor': 'middle', class: 'name', transform: `rotate(-90 ${14 - left} ${cell / 2})` }, fitted(short(y.name), cell)));
      }
      svg.append(g);
    }));
    return svg;
  }
  own(g, c, cell, colours) {
    const most = Math.max(1, ...c.bins), width = (cell - 12) / c.bins.length;
    c.bins.forEach((count, k) => g.append(draw('rect', { x: 6 + k * width, y: cell - 4 - count / most * (cell - 16), width: Math.max(1, width - 0.6), height: count / most * (cell - 16), fill: c.role === 'result' ? colours[0] : colours[6], opacity: 0.75 })));
  }
  points(g, [ix, sx], [iy, sy], cell, colours, [x, y]) {
    let path = '', crosses = '';
    const known = [];
    for (const row of this.data.sample.rows) {
      const [a, b] = [row.values[ix], row.values[iy]];
      if (a == null || b == null) continue;
      const px = sx(a), py = cell - sy(b);
      known.push([px, py, row]);
      if (row.status === 'completed') path += `M${px.toFixed(1)} ${py.toFixed(1)}h0`;
      else crosses += `M${(px - 3).toFixed(1)} ${(py - 3).toFixed(1)}l6 6m-6 0l6 -6`;
    }
    g.append(draw('path', { d: path, stroke: colours[0], 'stroke-width': known.length > 400 ? 2.4 : 3.6, 'stroke-linecap': 'round', opacity: 0.65 }), draw('path', { d: crosses, stroke: 'var(--bad)', 'stroke-width': 1.5 }));
    const ring = g.appendChild(draw('circle', { r: 5.5, fill: 'none', stroke: 'currentColor', visibility: 'hidden' }));
    const nearest = event => {
      const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(g.getScreenCTM().inverse());
      let best = null, least = 144;
      for (const k of known) {
        const d = (k[0] - p.x) ** 2 + (k[1] - p.y) ** 2;
        if (d < least) [best, least] = [k, d];
      }
      return best;
    };
    g.addEventListener('pointermove', event => {
      const found = nearest(event);
      ring.setAttribute('visibility', found ? 'visible' : 'hidden');
      if (!found) return tell(null);
      ring.setAttribute('cx', found[0]);
      ring.setAttribute('cy', found[1]);
      tell([`case ${found[2].case}`, `${x.name} ${told_of(x)(found[2].values[ix])}`, `${y.name} ${told_of(y)(found[2].values[iy])}`], event.clientX, event.clientY);
    });
    g.addEventListener('pointerleave', () => { ring.setAttribute('visibility', 'hidden'); tell(null); });
    g.addEventListener('click', event => { const found = nearest(event); if (found) this.choose(found[2]); });
  }

  choose(row) {
    const table = element('table');
    this.data.columns.forEach((c, i) => {
      const line = element('tr');
      line.append(element('th', c.name, { scope: 'row' }), element('td', row.values[i] == null ? '–' : typeof row.values[i] === 'number' ? told_of(c)(row.values[i]) : `${row.values[i]}`));
      table.append(line);
    });
    this.card.replaceChildren(element('h2', `Case ${row.case}`), element('div', row.status, { class: `state ${row.status}` }), table, element('p', 'To run it alone:', { class: 'soft' }), element('pre', `${this.data.command} ${row.case}`));
  }

  rows({ head, rows }) {
    // Of a result a row tells where it lies, and how far it scatters.
    const [first, least, greatest] = ['mean', 'least', 'greatest'].map(name => head.indexOf(name)), numeric = v => v !== '' && Number.isFinite(+v);
    const told = (row, i) => (i < first ? number_among(rows.map(cells => +cells[i])) : head[i] === 'deviation' ? number : number_within(+row.cells[least], +row.cells[greatest]));
    const columns = head.map((name, i) => [name, row => (numeric(row.cells[i]) ? +row.cells[i] : row.cells[i]), row => (numeric(row.cells[i]) ? told(row, i)(+row.cells[i]) : row.cells[i])]);
    const frame = element('div', null, { class: 'scroll' });
    frame.append(table_of(columns, rows.map(cells => ({ cells }))));
    return frame;
  }
  failures() {
    const frame = element('div', null, { class: 'scroll' });
    frame.append(table_of([['case', r => r.case], ['status', r => r.status], ['why', r => r.message], ['to run it alone', r => r.command]], this.data.failures));
    return frame;
  }
}

// Of a histogram's height, for the names of its lines above the bars.
const room_of_names = 0.12;

// Names of vertical lines, from left to right, each beside its line and within the frame; lines whose names would run into
// each other have one name together. A letter is some 6.5 wide.
export function names_beside(lines, left, right) {
  const placed = ({ x, name }) => {
    const width = 6.5 * name.length + 6;
    if (x + width <= right) return { x: x + 3, name, anchor: 'start', from: x, to: x + width };
    const end = x - width >= left ? x : right;
    return { x: end - 3, name, anchor: 'end', from: end - width, to: end };
  };
  let groups = lines, all = groups.map(placed);
  for (let k; (k = all.findIndex((g, i) => i > 0 && g.from < all[i - 1].to)) > 0; all = groups.map(placed)) {
    const [a, b] = [groups[k - 1], groups[k]];
    groups = [...groups.slice(0, k - 1), { x: a.x, name: `${a.name}, ${b.name}` }, ...groups.slice(k + 1)];
  }
  return all;
}

// What stands behind figures of which some only are on the page.
const of_all = (shown, all, where) => all > shown ? ` The first ${shown} of ${all}; ${where}.` : '';

// " = 0.8966" behind the name of a parameter, with the digits that tell its values apart; what is no number as it is.
function told_values(rows, parameter, value) {
  const of = new Map();
  for (const r of rows) if (r[value] !== '' && Number.isFinite(+r[value])) of.set(r[parameter], [...of.get(r[parameter]) ?? [], +r[value]]);
  const told = new Map([...of].map(([name, values]) => [name, number_among(values)]));
  return r => ` = ${r[value] !== '' && Number.isFinite(+r[value]) ? told.get(r[parameter])(+r[value]) : r[value]}`;
}

// Of a name that is too long the end, and what stands behind it whole.
export function name_within(name, behind, most) {
  const room = Math.max(8, most - behind.length);
  return (name.length > room ? `…${name.slice(1 - room)}` : name) + behind;
}

function fitted(name, width) {
  const most = Math.floor(width / 6.6);
  return name.length > most ? `…${name.slice(-most + 1)}` : name;
}
