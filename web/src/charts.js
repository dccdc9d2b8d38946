// Plots over time: a panel for each group of columns, made when it comes into sight.
import uPlot from 'uplot';
import { dashes, drawn, palette, passed_unseen, pen_sample } from './data.js';
import { number, number_among } from './numbers.js';
import { difference, nearest_own, own_before, place_of } from './rows.js';
import { axis_ticks, ends_of } from './ticks.js';

const most_shown = 8; // curves of a panel at first

const digits = 5; // of numbers beside a plot, and more where these would not tell them apart

class Panel {
  constructor(owner, group) {
    this.owner = owner;
    this.group = group;
    this.log = false;
    this.element = document.createElement('figure');
    this.element.innerHTML = `<figcaption><span class="name"></span><button class="log" aria-pressed="false" title="Logarithms of magnitudes (L)">log</button></figcaption><div class="chart"></div><p class="untold soft" hidden></p><p class="passed soft" hidden></p><div class="more"></div>`;
    this.element.querySelector('.name').textContent = `${group.title}${!group.unit || group.title.endsWith(group.unit) ? '' : `  [${group.unit}]`}`;
    if (group.limit) this.say_passed();
    this.button = this.element.querySelector('.log');
    this.button.onclick = () => this.toggle_log();
    // Limits without curves are told in words alone.
    this.wordy = !group.series.length;
    for (const part of [this.button, this.element.querySelector('.chart')]) part.hidden = this.wordy;
    this.element.addEventListener('pointerenter', () => { owner.under = this; });
  }

  // Numbers are read when the panel comes into sight.
  make() {
    if (this.wordy) return;
    const { series, limit } = this.group;
    // What is nearest to its limit, or farthest beyond, is seen first.
    if (limit) series.sort((a, b) => b.greatest - a.greatest || 0);
    const lively = series.filter(s => !s.flat);
    // What never changes is there to be switched on.
    for (const s of series) s.on = (lively.length ? lively : series).slice(0, most_shown).includes(s);
    this.chips();
    this.draw();
  }

  // A button for each column that is not shown at first; the legend takes away the others.
  chips() {
    const more = this.element.querySelector('.more');
    more.replaceChildren();
    for (const series of this.group.series.filter(s => !s.on)) {
      const chip = document.createElement('button');
      chip.textContent = series.name + (series.flat ? ` = ${number(series.of[0].y[0], digits)}` : this.group.limit && series.greatest > -Infinity ? ` ≤ ${number(series.greatest, digits)}` : '');
      chip.className = 'chip';
      chip.setAttribute('aria-pressed', series.on);
      chip.onclick = () => { series.on = !series.on; chip.setAttribute('aria-pressed', series.on); this.draw(); };
      more.append(chip);
    }
  }

  toggle_log() {
    if (this.wordy) return;
    this.log = !this.log;
    this.button.setAttribute('aria-pressed', this.log);
    this.draw();
  }

  curves() {
    const { differences, reference, runs } = this.owner;
    const shown = this.group.series.filter(s => s.on), out = [], said = [];
    shown.forEach((series, k) => {
      const of = series.of.find(o => o.run === runs[reference]);
      for (const own of series.of) {
        const { run, t, spans } = own;
        if (run.hidden) continue;
        const lean = shown.length === 1 && runs.length > 1;
        const pen = { color: lean ? run.index : k, dash: runs.length > 1 ? run.index : 0 };
        const label = runs.length > 1 ? (shown.length === 1 ? run.label : `${series.name} (${run.label})`) : series.name;
        if (!differences || this.group.limit) {
          out.push({ pen, label, t, values: own.y, y: drawn(own.y, this.log), spans, parted: false });
        } else if (of && of.run !== run) {
          const less = difference(own.whole, of.whole);
          said.push({ label, ...less });
          out.push({ pen, label: `${label} − reference`, t: less.t, values: less.y, y: drawn(less.y, this.log), spans: false, parted: less.gaps });
        }
      }
    });
    this.say(said);
    for (const curve of out) curve.told = number_among(curve.values, digits, true);
    this.time_told = number_among(out.flatMap(c => [c.t[0], c.t[c.t.length - 1]]), digits, true);
    return out;
  }

  // Curves below their limits would seem to say that all are kept.
  say_passed() {
    const { runs } = this.owner, passed = this.element.querySelector('.passed');
    const all = runs.flatMap(run => passed_unseen(run).map(what => (runs.length > 1 ? `${run.label}: ` : '') + what));
    passed.hidden = !all.length;
    passed.textContent = `Passed, and not drawn here: ${all.join('; ')}.`;
  }

  // What of differences nobody can tell.
  say(differences) {
    const parted = differences.filter(d => d.gaps && d.times), lines = differences.filter(d => !d.times)
      .map(d => `${d.label}: no difference can be told, as this page has no row of the run and the reference at one time.`);
    const counts = [...new Set(parted.map(d => d.times))].join(', ');
    if (parted.length) lines.push(`Differences at the ${counts} times at which this page has rows of both runs; what lies between dots is not told.`);
    const said = this.element.querySelector('.untold');
    said.hidden = !lines.length;
    said.textContent = lines.join(' ');
  }

  // What the legend says of a curve. Where its rows were drawn by stretches, which of a stretch's times a number is of
  // is not known: it says the least and the greatest; and of rows at another time than the one that it shows, when.
  told_at(u, curve, value, place) {
    if (place == null) return '–';
    const time = u.data[0][place], of_time = this.time_told;
    if (!curve.spans) return time === u.data[0][u.legend.idxs[0]] ? curve.told(value) : `${curve.told(value)} (at ${of_time(time)} s)`;
    const { t, values } = curve, first = this.stretch_of(curve, place, time), ends = [values[first], values[first + 1]];
    const told = ends[0] === ends[1] ? curve.told(ends[0]) : `${curve.told(Math.min(...ends))} … ${curve.told(Math.max(...ends))}`;
    return this.shared ? told : `${told} (${of_time(t[first])} … ${of_time(t[first + 1])} s)`;
  }
  stretch_of(curve, place, time) {
    const i = this.shared ? place : place_of(curve.t, time);
    return i - i % 2;
  }
  time_at(curves, value, place) {
    if (place == null || !this.shared || !curves[0]?.spans) return this.time_told(value);
    const { t } = curves[0], first = place - place % 2;
    return t[first] === t[first + 1] ? this.time_told(value) : `${this.time_told(t[first])} … ${this.time_told(t[first + 1])}`;
  }

  aligned(curves) {
    this.shared = true;
    if (curves.length === 0) return [[0, 1], [null, null]];
    this.shared = curves.every(c => c.t === curves[0].t || (c.t.length === curves[0].t.length && c.t.every((v, i) => v === curves[0].t[i])));
    if (this.shared) return [curves[0].t, ...curves.map(c => c.y)];
    return uPlot.join(curves.map(c => [Array.from(c.t), Array.from(c.y)]));
  }

  draw() {
    const holder = this.element.querySelector('.chart'), curves = this.drawn = this.curves(), dark = this.owner.dark;
    const colours = palette(dark), ink = dark ? '#c9d1d9' : '#24292f', faint = dark ? '#2d333b' : '#e3e7eb';
    const [least, most] = this.chart ? [this.chart.scales.x.min, this.chart.scales.x.max] : [];
    this.chart?.destroy();
    this.chart = null;
    const axis = { stroke: ink, grid: { stroke: faint, width: 1 }, ticks: { stroke: faint }, font: '12px system-ui, sans-serif' };
    const upright = { apart: 28, log: this.log }, across = { apart: 40, across: true };
    const limit = this.group.limit && !this.log ? this.group.limit : null;
    this.chart = new uPlot({
      width: Math.max(260, holder.clientWidth),
      height: 230,
      cursor: {
        sync: { key: 'withy' },
        drag: { x: true, y: false },
        dataIdx: (u, k, place) => k > 0 && curves[k - 1] ? nearest_own(u.data[k], place, curves[k - 1].parted) : place,
      },
      scales: { x: { time: false }, y: { distr: this.log ? 3 : 1, range: (_, low, high) => (this.log ? range_in_decades(low, high) : range(low, high, limit)) } },
      legend: {
        live: true,
        markers: { width: 0, fill: (_, k) => k > 0 ? pen_sample(colours[curves[k - 1].pen.color % colours.length], dashes[curves[k - 1].pen.dash % dashes.length]) : 'none' },
      },
      axes: [
        { ...axis, ...own_ticks(across), label: 't [s]', labelSize: 18, labelFont: '12px system-ui, sans-serif', size: 32 },
        { ...axis, ...own_ticks(upright), size: (_, labels) => Math.max(66, 18 + 7.7 * Math.max(0, ...(labels ?? []).map(l => l.length))) },
      ],
      series: [
        { label: 't [s]', value: (_, v, __, place) => this.time_at(curves, v, place) },
        ...curves.map(c => ({
          label: c.label,
          stroke: colours[c.pen.color % colours.length],
          dash: dashes[c.pen.dash % dashes.length],
          width: 1.75,
          points: { show: false, filter: (u, k) => lone(u.data[k]) }, // runs of other times leave no gaps
          value: (u, v, _, place) => this.told_at(u, c, v, place),
        })),
      ],
      hooks: {
        // uPlot empties its legend once it has drawn.
        draw: [u => { this.mark(u, limit); queueMicrotask(() => { this.told = -1; this.at(); }); }],
        // It empties it too where the pointer leaves any of the plots.
        setCursor: [u => { if (u.cursor.idx == null) queueMicrotask(() => { this.told = -1; this.at(); }); }],
        ready: [u => u.over.addEventListener('click', () => { if (!this.dragged(u)) this.owner.seek(u.posToVal(u.cursor.left, 'x')); })],
      },
    }, this.aligned(curves), holder);
    this.hand = this.chart.over.appendChild(Object.assign(document.createElement('div'), { className: 'hand' }));
    this.told = -1;
    this.at();
    if (least != null && this.zoomed(least, most)) this.chart.setScale('x', { min: least, max: most });
  }

  zoomed(least, most) {
    const t = this.chart.data[0];
    return least > t[0] || most < t[t.length - 1];
  }
  dragged(u) { return u.select.width > 3; }

  mark(u, limit) {
    if (!limit) return;
    const { ctx, bbox } = u, ratio = uPlot.pxRatio, y = u.valToPos(limit, 'y', true);
    if (y < bbox.top || y > bbox.top + bbox.height) return;
    ctx.save();
    ctx.strokeStyle = '#d55e00';
    ctx.setLineDash([6 * ratio, 4 * ratio]);
    ctx.lineWidth = ratio;
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.restore();
  }

  // The time of the animation: a line that moves over the plot, which is not drawn again.
  at() {
    const { chart, hand, owner } = this;
    if (!chart) return;
    const x = chart.valToPos(owner.time, 'x');
    hand.hidden = !(x >= 0 && x <= chart.bbox.width / uPlot.pxRatio);
    hand.style.transform = `translateX(${x}px)`;
    this.tell();
  }

  // The numbers at the time of the animation, where the pointer asks for no others.
  tell() {
    const t = this.chart.data[0];
    if (this.chart.cursor.idx != null) this.told = -1;
    if (this.chart.cursor.idx != null || t.length === 0) return;
    const low = place_of(t, this.owner.time + 1e-9 * (t[t.length - 1] - t[0])); // times have been rounded
    if (low === this.told) return;
    this.told = low;
    this.chart.setLegend({ idxs: this.chart.data.map((values, k) => k > 0 && this.drawn[k - 1] ? own_before(values, low, this.drawn[k - 1].parted) : low) }, false);
  }

  resize() {
    const width = this.element.querySelector('.chart').clientWidth;
    if (this.chart && width > 0 && width !== this.chart.width) this.chart.setSize({ width, height: this.chart.height });
  }
}

// Places of numbers between gaps, which make no line and are drawn as dots; null where there is none.
function lone(values) {
  const known = [];
  for (let i = 0; i < values.length; ++i) if (values[i] !== undefined) known.push(i);
  const at = known.filter((i, k) => values[i] !== null && values[known[k - 1]] == null && values[known[k + 1]] == null);
  return at.length ? at : null;
}

// Ticks for an axis of uPlot, whose own end at 1e-16 and at 1e33: those that it looks for are not asked for.
function own_ticks(how) {
  // What it calls space are the pixels of an increment, which is 1 here.
  const of = (low, high, space) => axis_ticks(low, high, { ...how, length: space * (high - low) });
  return {
    space: 0, incrs: [1], filter: (_, splits) => splits,
    splits: (u, axis, low, high, _, space) => of(low, high, space).map(([v]) => v),
    values: (u, splits, axis, space) => { const { min, max } = u.scales[u.axes[axis].scale]; return of(min, max, space).map(([, name]) => name); },
  };
}

// Ends of an axis: a limit is in sight where values come near it.
const room = 0.06;
function range(low, high, limit) {
  if (low == null) return [0, 1];
  if (limit && high > 0.05 * limit) high = Math.max(high, limit);
  return ends_of(limit ? Math.min(low, 0) : low, high, room);
}
// Of numbers above zero.
const range_in_decades = (low, high) => (low == null ? [null, null] : ends_of(Math.log10(low), Math.log10(high), room, 1).map(v => 10 ** v));

export class Charts {
  constructor(element, runs, groups, seek) {
    Object.assign(this, { element, runs, seek, time: 0, dark: false, differences: false, reference: 0, under: null });
    this.panels = groups.map(group => new Panel(this, group));
    element.append(...this.panels.map(p => p.element));
    this.watch = new IntersectionObserver(entries => {
      for (const entry of entries) {
        const panel = this.panels.find(p => p.element === entry.target);
        panel.seen = entry.isIntersecting;
        if (entry.isIntersecting && !panel.chart) panel.make();
        else if (entry.isIntersecting) panel.at();
      }
    }, { rootMargin: '400px' });
    for (const panel of this.panels) this.watch.observe(panel.element);
    new ResizeObserver(() => this.panels.forEach(p => p.resize())).observe(element);
  }
  redraw() { for (const panel of this.panels) if (panel.chart) panel.draw(); }
  all() { for (const panel of this.panels) if (!panel.chart) panel.make(); }
  at(time) {
    this.time = time;
    for (const panel of this.panels) if (panel.chart && panel.seen) panel.at();
  }
  filter(text) {
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    for (const panel of this.panels) {
      const { group } = panel;
      const all = [group.title, group.unit, ...group.series.map(s => s.name)].join(' ').toLowerCase();
      panel.element.hidden = !words.every(w => all.includes(w));
    }
  }
}
