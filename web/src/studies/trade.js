// Error against cost: each model a mark, the Pareto front a line; the model that is clicked in full.
import { number } from '../numbers.js';
import { element } from '../words.js';
import { Figure, legend, room_in, table_of } from './figure.js';

const modes_of = p => p.modes === 0 ? "the scene's modes" : `${p.modes} ${p.modes === 1 ? 'mode' : 'modes'}${p.family ? ` (${p.family})` : ''}`;
const name_of = p => `${p.formulation}, ${modes_of(p)}, ${p.integrator} at ${power(p.tolerance)}`;
const power = v => v < 1e-2 ? v.toExponential() : `${v}`;
const milliseconds = p => 1e3 * p.cpu_seconds;
const percent = p => 100 * p.relative_error;
const done = p => p.status === 'completed';

export class Trade {
  constructor(holder, data) {
    Object.assign(this, { data, chosen: null });
    this.formulations = [...new Set(data.points.map(p => p.formulation))].map((name, i) => ({ name, index: i }));
    this.integrators = [...new Set(data.points.map(p => p.integrator))].map((name, i) => ({ name, index: i }));
    this.overs = [...new Set(data.points.map(p => p.over.join(' ')))];
    this.answer = element('div', null, { class: 'answer' });
    this.names = element('div');
    this.figures = element('div', null, { class: 'figures' });
    this.card = element('aside', null, { class: 'card', id: 'model', 'aria-live': 'polite' });
    const beside = element('div', null, { class: 'beside' }), left = element('div');
    left.append(this.names, this.figures);
    beside.append(left, this.card);
    holder.append(this.answer, beside, element('h2', 'Every model'), this.table(), this.reasons());
    this.write_answer();
    this.choose(data.points[data.cheapest.findLast(c => c.point != null)?.point] ?? data.points.find(p => p.pareto));
  }

  write_answer() {
    // What the command printed: errors of one's own, or the usual ones.
    const { cheapest, points } = this.data;
    for (const over of new Set(cheapest.map(c => c.over))) {
      const list = element('ul');
      for (const { within, point } of cheapest.filter(c => c.over === over)) {
        const best = points[point];
        list.append(element('li', `Within ${number(100 * within)} %: ${best ? `${name_of(best)} – ${number(milliseconds(best))} ms, error ${number(percent(best))} %` : 'none of these models'}`));
      }
      this.answer.append(element('p', over ? `The cheapest at ${over}` : 'The cheapest'), list);
    }
    const failed = this.data.points.filter(p => !done(p)).length;
    this.answer.append(element('p', `${this.data.points.length} models${failed ? `, ${failed} of which did not come to their end` : ''}. Errors are the greatest of all outputs, each in % of its own range.${Object.values(this.data.references).some(r => r.relative_error > 0) ? ' An error below that of the reference, the dotted line, tells no difference.' : ''}`, { class: 'soft' }));
  }

  table() {
    const over = this.overs.length > 1 ? [['over', p => p.over.join(' ')]] : [];
    const table = table_of([['front', p => p.pareto ? '*' : ''], ['formulation', p => p.formulation], ['modes', p => p.modes], ['family', p => p.family ?? "scene's"], ...over,
      ['integrator', p => p.integrator], ['tolerance', p => p.tolerance, p => power(p.tolerance)], ['outcome', p => p.status],
      ['error [%]', p => done(p) ? percent(p) : null, p => done(p) ? number(percent(p)) : '–'], ['CPU [ms]', p => done(p) ? milliseconds(p) : null, p => done(p) ? number(milliseconds(p)) : '–'],
      ['steps', p => done(p) ? p.steps : null, p => done(p) ? p.steps : '–']], this.data.points, p => this.choose(p));
    const frame = element('div', null, { class: 'scroll' });
    frame.append(table);
    return frame;
  }

  reasons() {
    const reasons = new Map();
    for (const p of this.data.points.filter(p => !done(p))) {
      const key = `${p.formulation}: ${p.message}`;
      reasons.set(key, (reasons.get(key) ?? 0) + 1);
    }
    if (!reasons.size) return element('p');
    const part = element('details'), list = element('ul');
    part.append(element('summary', 'Why models did not come to their end'));
    for (const [text, count] of reasons) list.append(element('li', count > 1 ? `${text} (${count} models)` : text));
    part.append(list);
    return part;
  }

  paint(colours) {
    this.colours = colours;
    this.formulations.forEach(f => { f.color = colours[f.index % colours.length]; });
    this.integrators.forEach(i => { i.color = 'currentColor'; i.shape = i.index; });
    const again = () => this.paint(colours);
    this.names.replaceChildren(legend(this.formulations, again), this.integrators.length > 1 ? legend(this.integrators, again) : '');
    this.figures.replaceChildren(...this.overs.map(over => this.figure(over)));
    this.mark_chosen();
  }

  figure(over) {
    const hidden = p => this.formulations.find(f => f.name === p.formulation).hidden || this.integrators.find(i => i.name === p.integrator).hidden;
    const all = this.data.points.filter(p => p.over.join(' ') === over && done(p)), shown = all.filter(p => !hidden(p));
    const reference = this.data.references[over], least = reference?.relative_error > 0 ? 100 * reference.relative_error : null;
    const figure = new Figure({ title: over || null, room: room_in(this.figures), height: this.overs.length > 1 ? 360 : 460, x: { label: 'CPU time [ms]', log: true, values: all.map(milliseconds) }, y: { label: 'error [% of range]', log: true, zeros: true, values: [...all.map(percent), ...(least ? [least] : [])] } });
    if (least) {
      const y = figure.y(least);
      figure.marks.append(Object.assign(figure.line([[10 ** figure.x.low, least], [10 ** figure.x.high, least]], { class: 'limit' })));
      figure.text(figure.width - figure.right - 6, y - 5, 'error of the reference', { 'text-anchor': 'end', class: 'soft' });
    }
    const front = all.filter(p => p.pareto).sort((a, b) => a.cpu_seconds - b.cpu_seconds);
    figure.line(front.map(p => [milliseconds(p), percent(p)]), { class: 'front' });
    for (const p of shown) {
      const f = this.formulations.find(o => o.name === p.formulation), i = this.integrators.find(o => o.name === p.integrator);
      p.mark = figure.mark(milliseconds(p), percent(p), i.index, { fill: p.pareto ? f.color : 'none', stroke: f.color, 'stroke-width': 1.6 }, () => [name_of(p), `error ${number(percent(p))} %, CPU time ${number(milliseconds(p))} ms`, p.pareto ? 'on the front: nothing is both cheaper and more exact' : 'click for all of it'], () => this.choose(p));
    }
    return figure.element;
  }

  choose(p) {
    if (!p) return;
    this.chosen = p;
    const rows = [['formulation', p.formulation], ['modes', p.modes === 0 ? "the scene's" : p.modes], ['mode family', p.family ?? "the scene's"], ['integrator', `${p.integrator}, rtol ${power(p.tolerance)}`]];
    if (p.over.length) rows.push(['at', p.over.join(' ')]);
    rows.push(['outcome', p.status]);
    if (done(p)) rows.push(['error', `${number(percent(p))} % of range`], ...(p.hinge_error === null ? [] : [['hinges', `${number(p.hinge_error)} rad or m`]]), ...(p.tip_error === null ? [] : [['tips', `${number(1e3 * p.tip_error)} mm`]]), ['CPU time', `${number(milliseconds(p))} ms`], ['steps', `${p.steps}, ${p.evaluations} evaluations`], ['front', p.pareto ? 'yes' : 'no']);
    const table = element('table');
    for (const [name, value] of rows) {
      const row = element('tr');
      row.append(element('th', name, { scope: 'row' }), element('td', `${value}`));
      table.append(row);
    }
    this.card.replaceChildren(element('h2', 'Model'), table);
    if (p.message) this.card.append(element('p', p.message, { class: 'message' }));
    if (p.command) this.card.append(element('p', 'To run it:', { class: 'soft' }), element('pre', p.command));
    this.mark_chosen();
  }
  mark_chosen() {
    for (const p of this.data.points) {
      p.mark?.classList.toggle('chosen', p === this.chosen);
      p.line?.classList.toggle('chosen', p === this.chosen);
    }
  }
}
