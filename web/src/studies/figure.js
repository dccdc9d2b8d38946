// Figures of studies: SVG with axes, marks that answer the pointer, and a note beside it.
import { axis_ticks, ends_of } from '../ticks.js';

const svg_names = 'http://www.w3.org/2000/svg';
export function draw(name, attributes = {}, text) {
  const e = document.createElementNS(svg_names, name);
  for (const [key, value] of Object.entries(attributes)) if (value != null) e.setAttribute(key, value);
  if (text != null) e.textContent = text;
  return e;
}

// A scale from data to pixels with its ticks.
// zeros: of decades, what is zero has a place of its own at the beginning, where anything is
const place_of_zero = 0.05, beyond_zero = 0.13; // parts of the axis
export function scale_of(values, { log = false, from, to, include = [], room = 0.05, across = to > from, zeros = false }) {
  const begin = from, none = zeros && values.includes(0);
  if (none) from += beyond_zero * (to - from);
  const shown = values.filter(v => Number.isFinite(v) && (!log || v > 0));
  const tell = v => log ? Math.log10(v) : v;
  let low = Infinity, high = -Infinity;
  for (const v of [...shown, ...include]) {
    low = Math.min(low, tell(v));
    high = Math.max(high, tell(v));
  }
  if (low > high) [low, high] = log ? [-1, 1] : [0, 1];
  const [least, most] = ends_of(low, high, room, log ? 1 : undefined), from_include = include.length && low < high && Math.min(...include.map(tell)) <= low;
  if (!from_include) low = least;
  high = most;
  const at = v => (none && v === 0 ? begin + place_of_zero * (to - begin) : from + (tell(v) - low) / (high - low) * (to - from)), value = v => (log ? 10 ** v : v);
  const length = Math.abs(to - from);
  at.ticks = none && !shown.length ? [] : axis_ticks(value(low), value(high), { length, apart: length > 300 ? 80 : 50, log, across });
  if (none) at.ticks.unshift([0, '0']);
  at.low = low;
  at.high = high;
  return at;
}

// How wide a figure can be drawn in an element without becoming smaller, which its letters would too.
const beside_figure = 28, least_width = 260;
export const room_in = holder => Math.max(least_width, (holder.clientWidth || Infinity) - beside_figure);

// Axes with their labels; what is drawn goes to `marks`, cut off at the frame. room: see room_in
export class Figure {
  constructor({ title, width = 760, height = 440, right = 16, room = Infinity, x, y }) {
    const top = 14, bottom = 50;
    width = Math.min(width, room);
    height = Math.min(height, Math.max(240, width));
    this.y = scale_of(y.values, { ...y, from: height - bottom, to: top });
    const left = Math.max(74, 30 + 7.7 * Math.max(0, ...this.y.ticks.map(([, name]) => name.length)));
    Object.assign(this, { width, height, left, top, bottom, right });
    this.element = document.createElement('figure');
    this.element.className = 'study-figure';
    if (title) {
      const caption = document.createElement('figcaption');
      caption.textContent = title;
      this.element.append(caption);
    }
    this.svg = draw('svg', { viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': title ?? y.label });
    this.element.append(this.svg);
    this.x = scale_of(x.values, { ...x, from: left, to: width - right });
    this.grid(x.label, y.label);
    this.marks = draw('g');
    this.svg.append(this.marks);
  }
  grid(x_label, y_label) {
    const { width, height, left, top, bottom, right } = this, g = draw('g', { class: 'axes' });
    for (const [v, name] of this.x.ticks) {
      const p = this.x(v);
      if (p < left - 0.5 || p > width - right + 0.5) continue;
      g.append(draw('line', { x1: p, x2: p, y1: top, y2: height - bottom }), draw('text', { x: p, y: height - bottom + 17, 'text-anchor': 'middle' }, name));
    }
    for (const [v, name] of this.y.ticks) {
      const p = this.y(v);
      if (p < top - 0.5 || p > height - bottom + 0.5) continue;
      g.append(draw('line', { x1: left, x2: width - right, y1: p, y2: p }), draw('text', { x: left - 7, y: p + 4, 'text-anchor': 'end' }, name));
    }
    g.append(draw('rect', { x: left, y: top, width: width - right - left, height: height - bottom - top, class: 'frame' }));
    g.append(draw('text', { x: (left + width - right) / 2, y: height - 10, 'text-anchor': 'middle', class: 'label' }, x_label));
    g.append(draw('text', { x: 16, y: (top + height - bottom) / 2, 'text-anchor': 'middle', class: 'label', transform: `rotate(-90 16 ${(top + height - bottom) / 2})` }, y_label));
    this.svg.append(g);
  }
  line(points, attributes) {
    let path = '', pen = 'M';
    for (const [x, y] of points) {
      if (x == null || y == null || !Number.isFinite(y)) { pen = 'M'; continue; }
      path += `${pen}${this.x(x).toFixed(1)} ${this.y(y).toFixed(1)}`;
      pen = 'L';
    }
    const e = draw('path', { d: path, fill: 'none', ...attributes });
    this.marks.append(e);
    return e;
  }
  // A mark of a shape around a place; `about` is what the pointer is told, `chosen` what a click does.
  mark(x, y, shape, { small = false, ...attributes }, about, chosen) {
    const e = draw('path', { d: shapes[shape % shapes.length], transform: `translate(${this.x(x).toFixed(1)} ${this.y(y).toFixed(1)})${small ? ' scale(0.62)' : ''}`, class: 'mark', tabindex: chosen ? 0 : null, role: chosen ? 'button' : null, 'aria-label': chosen ? about().join(', ') : null, 'pointer-events': about ? 'all' : null, ...attributes });  // hollow ones too
    this.marks.append(e);
    answers(e, about, chosen);
    return e;
  }
  text(x, y, text, attributes) { return this.svg.appendChild(draw('text', { x, y, class: 'name', ...attributes }, text)); }
}

// Circle, square, triangle, diamond, downward triangle, cross: told apart without colour.
export const shapes = ['M-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0Z', 'M-4 -4H4V4H-4Z', 'M0 -5.4L4.9 3.6H-4.9Z', 'M0 -5.6L5.6 0L0 5.6L-5.6 0Z', 'M0 5.4L4.9 -3.6H-4.9Z', 'M-4.5 -1.5H-1.5V-4.5H1.5V-1.5H4.5V1.5H1.5V4.5H-1.5V1.5H-4.5Z'];

// A note beside the pointer, or beside what has the focus.
let note = null;
export function tell(lines, x, y) {
  note ??= document.body.appendChild(Object.assign(document.createElement('div'), { id: 'note' }));
  note.hidden = !lines;
  if (!lines) return;
  note.replaceChildren(...lines.map((text, i) => Object.assign(document.createElement(i ? 'div' : 'b'), { textContent: text })));
  const { offsetWidth: w, offsetHeight: h } = note;
  note.style.left = `${Math.max(4, Math.min(x + 14, innerWidth - w - 8))}px`;
  note.style.top = `${y + 18 + h > innerHeight ? y - h - 12 : y + 18}px`;
}
export function answers(e, about, chosen) {
  if (about) {
    e.addEventListener('pointermove', event => tell(about(), event.clientX, event.clientY));
    e.addEventListener('pointerleave', () => tell(null));
    e.addEventListener('focus', () => { const r = e.getBoundingClientRect(); tell(about(), r.right, r.bottom); });
    e.addEventListener('blur', () => tell(null));
  }
  if (chosen) {
    e.addEventListener('click', chosen);
    e.addEventListener('keydown', event => { if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); event.stopPropagation(); chosen(); } });
  }
}

// A table whose heads sort: columns are [head, of row, text of row].
export function table_of(columns, rows, chosen) {
  const table = document.createElement('table'), body = document.createElement('tbody'), head = document.createElement('tr');
  table.className = 'rows';
  let sorted = -1, sign = 1;
  const fill = () => body.replaceChildren(...rows.map(row => {
    const line = document.createElement('tr');
    for (const [, of, text] of columns) {
      const textContent = `${(text ?? of)(row) ?? ''}`;
      line.append(Object.assign(document.createElement('td'), { textContent, className: typeof of(row) === 'number' ? 'number' : textContent.length > 50 ? 'long' : '' }));
    }
    if (chosen) { line.tabIndex = 0; answers(line, null, () => chosen(row)); }
    row.line = line;
    return line;
  }));
  columns.forEach(([name, of], i) => {
    const cell = document.createElement('th'), button = Object.assign(document.createElement('button'), { textContent: name });
    button.onclick = () => {
      sign = sorted === i ? -sign : 1;
      sorted = i;
      rows = rows.map((row, k) => [row, k]).sort(([a, k], [b, l]) => {
        const [p, q] = [of(a), of(b)];
        return (p == null) - (q == null) || sign * (typeof p === 'number' ? p - q : `${p}`.localeCompare(`${q}`)) || k - l;
      }).map(([row]) => row);
      fill();
    };
    cell.append(button);
    head.append(cell);
  });
  const top = document.createElement('thead');
  top.append(head);
  table.append(top, body);
  fill();
  return table;
}

// Half a sample of a line: any of the dashes begins again within the whole.
const reach = 22;

// Names with their colours and shapes; a click hides what they stand for.
export function legend(entries, changed) {
  const holder = document.createElement('div');
  holder.className = 'legend';
  for (const entry of entries) {
    const line = entry.dash != null, half = line ? reach : 7;
    const button = document.createElement('button'), icon = draw('svg', { viewBox: `${-half} -7 ${2 * half} 14`, width: 2 * half, height: 14 });
    icon.append(line ? draw('path', { d: `M${-half} 0H${half}`, stroke: entry.color, 'stroke-width': 2.5, 'stroke-dasharray': entry.dash }) : draw('path', { d: shapes[entry.shape ?? 0], fill: entry.hollow ? 'none' : entry.color, stroke: entry.color, 'stroke-width': 1.5 }));
    button.append(icon, ` ${entry.name}`);
    button.className = 'chip';
    button.setAttribute('aria-pressed', !entry.hidden);
    if (changed) button.onclick = () => { entry.hidden = !entry.hidden; changed(); };
    else button.disabled = true;
    holder.append(button);
  }
  return holder;
}
