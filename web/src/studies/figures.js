// What a command says in words, and its curves: names switch them off, the pointer is told the nearest point.
import { dashes } from '../data.js';
import { number_among } from '../numbers.js';
import { element } from '../words.js';
import { Figure, draw, legend, room_in, shapes, tell } from './figure.js';

// What the command said: sentences are broken where the page ends, tables scroll.
function said(words) {
  const holder = element('pre', null, { class: 'said' });
  let last = null;
  for (const part of words.split(/(?<=\n\n)(?!\n)/)) {
    const table = /^ *-{3,} *$/m.test(part);
    for (const line of part.split(/(?<=\n)/)) {
      const kind = table || /\S {2,}\S|^ {5}/.test(line) ? 'columns' : 'sentences';
      if (line !== '\n' && last?.className !== kind) last = holder.appendChild(element('div', null, { class: kind }));
      last.append(line);
    }
  }
  return holder;
}

export class Figures {
  constructor(holder, data) {
    this.data = data;
    holder.append(said(data.words.replace(/^\n+|\s+$/g, '')));
    this.parts = data.pictures.map(picture => {
      const names = element('div'), figures = element('div', null, { class: 'figures' });
      if (picture.title) holder.append(element('h2', picture.title));
      holder.append(names, figures);
      const named = new Map(picture.panels.flatMap(p => p.curves.filter(c => c.name).map(c => [c.pen, c.name])));
      return { picture, names, figures, entries: [...named].map(([pen, name]) => ({ pen, name })) };
    });
  }

  paint(colours) {
    for (const part of this.parts) {
      const points = pen => part.picture.panels.every(p => p.curves.every(c => c.pen !== pen || c.points));
      for (const e of part.entries) {
        e.color = colours[e.pen % colours.length];
        if (points(e.pen)) e.shape = e.pen % shapes.length; else e.dash = dashes[e.pen % dashes.length].join(' ');
      }
      part.names.replaceChildren(part.entries.length > 1 ? legend(part.entries, () => this.paint(colours)) : '');
      const hidden = new Set(part.entries.filter(e => e.hidden).map(e => e.pen));
      part.figures.replaceChildren(...part.picture.panels.map(panel => this.figure(panel, hidden, colours, room_in(part.figures))));
    }
  }

  figure(panel, hidden, colours, room) {
    if (!panel.curves.some(c => c.y.some(v => v != null && (!panel.log_y || v > 0)))) return element('p', `${panel.y}: ${panel.log_y ? 'zero throughout, but for rounding' : 'no values'}.`, { class: 'soft' });
    const shown = panel.curves.filter(c => !hidden.has(c.pen)), [low, high] = panel.range;
    const within = v => v >= low && v <= high;
    const figure = new Figure({
      room, height: Math.max(240, 1.3 * panel.height),
      x: { label: panel.x, log: panel.log_x, values: panel.curves.flatMap(c => c.x), room: panel.log_x ? 0.05 : 0.01 },
      y: { label: panel.y, log: panel.log_y, values: [...panel.curves.flatMap(c => c.y).filter(within), ...(low < high && panel.log_y ? [low] : [])] },
    });
    const clip = `clip-${Figures.clips = (Figures.clips ?? 0) + 1}`, frame = draw('clipPath', { id: clip });
    frame.append(draw('rect', { x: figure.left, y: figure.top, width: figure.width - figure.left - figure.right, height: figure.height - figure.top - figure.bottom }));
    figure.svg.append(frame);
    figure.marks.setAttribute('clip-path', `url(#${clip})`);
    const known = [];
    for (const curve of shown) {
      const color = colours[curve.pen % colours.length];
      curve.x.forEach((x, i) => { if (curve.y[i] != null && (!panel.log_y || curve.y[i] > 0)) known.push([figure.x(x), figure.y(curve.y[i]), curve, i]); });
      if (curve.points) curve.x.forEach((x, i) => { if (curve.y[i] != null) figure.mark(x, curve.y[i], curve.name ? curve.pen : 0, { fill: curve.name ? 'none' : color, stroke: color, 'stroke-width': 1.6, small: !curve.name }); });
      else figure.line(curve.x.map((x, i) => [x, curve.y[i]]), { stroke: color, 'stroke-width': 1.8, 'stroke-dasharray': curve.name ? dashes[curve.pen % dashes.length].join(' ') : null });
    }
    this.ask(figure, panel, known);
    return figure.element;
  }

  // The point of a curve that is nearest to the pointer.
  ask(figure, panel, known) {
    const ring = figure.svg.appendChild(draw('circle', { r: 5, fill: 'none', stroke: 'currentColor', visibility: 'hidden' }));
    const { svg } = figure, told_x = number_among(panel.curves.flatMap(c => c.x)), told_y = new Map(panel.curves.map(c => [c, number_among(c.y)]));
    svg.addEventListener('pointermove', event => {
      const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      let best = null, least = 900;
      for (const k of known) {
        const d = (k[0] - p.x) ** 2 + (k[1] - p.y) ** 2;
        if (d < least) [best, least] = [k, d];
      }
      ring.setAttribute('visibility', best ? 'visible' : 'hidden');
      if (!best) return tell(null);
      const [x, y, curve, i] = best;
      ring.setAttribute('cx', x);
      ring.setAttribute('cy', y);
      tell([curve.notes?.[i] ?? curve.name ?? panel.y, `${panel.x}: ${told_x(curve.x[i])}`, `${panel.y}: ${told_y.get(curve)(curve.y[i])}`], event.clientX, event.clientY);
    });
    svg.addEventListener('pointerleave', () => { ring.setAttribute('visibility', 'hidden'); tell(null); });
  }
}
