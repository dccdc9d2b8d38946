// The page: time, view, plots and words of the runs that it holds.
import { Charts } from './charts.js';
import { dashes, grouped, palette, pen_sample, prepared } from './data.js';
import { clock_of, speeds_of } from './playback.js';
import { View } from './view.js';
import { element, write_sources, write_words } from './words.js';

export function show_runs(page) {
  const $ = id => document.getElementById(id);
  const data = prepared(page), runs = data.runs;
  const wish = new URLSearchParams(location.hash.slice(1)); // #t=1.9&theme=dark&play=0
  const start = Math.min(...runs.map(r => r.animation.times[0] ?? 0)), end = Math.max(...runs.map(r => r.animation.times.at(-1) ?? 0));

  document.title = `${data.title} – withy`;
  $('title').textContent = data.title;

  let dark = wish.get('theme') ? wish.get('theme') === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  let time = start, playing = false, before = 0, view = null;

  // What is drawn hangs on its elements, for tests and for those who look into a page with a browser's tools.
  const charts = $('charts').charts = new Charts($('charts'), runs, grouped(runs), t => { pause(); seek(t); });
  try {
    view = $('view').view = new View($('view'), runs);
  } catch (e) {
    $('view').append(element('p', `No picture: this browser has no WebGL (${e.message}). The plots need none.`, { class: 'message' }));
  }

  function paint() {
    document.documentElement.dataset.theme = dark ? 'dark' : 'light';
    $('theme').textContent = dark ? 'Light' : 'Dark';
    charts.dark = dark;
    charts.redraw();
    view?.build(dark);
    const colours = palette(dark);
    document.querySelectorAll('#runs .swatch').forEach((s, i) => { s.style.background = pen_sample(colours[i % colours.length], dashes[i % dashes.length]); });
  }

  const told = clock_of(start, end);
  function seek(t) {
    time = Math.min(end, Math.max(start, t));
    $('time').value = time;
    $('clock').textContent = told(time);
    view?.go(time);
    charts.at(time);
  }

  function pause() {
    if (playing) view?.rest();
    playing = false;
    $('play').textContent = '▶';
    $('play').setAttribute('aria-label', 'Play');
  }
  function play() {
    if (time >= end) seek(start);
    playing = true;
    before = performance.now();
    $('play').textContent = '❚❚';
    $('play').setAttribute('aria-label', 'Pause');
    requestAnimationFrame(advance);
  }
  function advance(now) {
    if (!playing) return;
    const next = time + (now - before) / 1000 * Number($('speed').value);
    view?.frame(now - before);
    before = now;
    if (next >= end) { seek(end); pause(); return; }
    seek(next);
    requestAnimationFrame(advance);
  }

  function set_scale(exponent) {
    const s = Math.min(2, Math.max(0, exponent));
    $('scale').value = s;
    if (view) view.scale = s === 0 ? 1 : 10 ** s;
    $('scale-value').textContent = `${+(10 ** s).toPrecision(2)}`;
    seek(time);
  }

  function set_up_time() {
    $('time').min = start;
    $('time').max = end;
    $('time').oninput = () => { pause(); seek(Number($('time').value)); };
    const { all, chosen } = speeds_of(end - start);
    for (const { value, name } of all) {
      const option = element('option', name, { value });
      option.selected = value === chosen;
      $('speed').append(option);
    }
    $('play').onclick = () => playing ? pause() : play();
  }

  function set_up_view() {
    $('sensors-label').hidden = !runs.some(run => run.animation.arrows.length);
    $('scale').oninput = () => set_scale(Number($('scale').value));
    for (const name of ['trails', 'ghosts', 'axes', 'sensors', 'follow']) {
      if (view) $(name).checked = view.show[name];
      $(name).onchange = () => { if (view) view.show[name] = $(name).checked; seek(time); };
    }
    document.querySelectorAll('[data-view]').forEach(b => { b.onclick = () => view?.look(b.dataset.view); });
  }

  function set_up_runs() {
    if (runs.length === 1) {
      $('runs').append(element('span', `${runs[0].run.formulation}, ${runs[0].run.integrator}`), element('span', runs[0].outcome, { class: `state ${runs[0].run.status}` }));
      return;
    }
    for (const run of runs) {
      const label = element('label'), box = element('input', null, { type: 'checkbox', checked: '' });
      box.onchange = () => { run.hidden = !box.checked; charts.redraw(); seek(time); };
      label.append(box, element('span', '', { class: 'swatch' }), ` ${run.label} `, element('span', run.outcome, { class: `state ${run.run.status}` }));
      $('runs').append(label);
      $('reference').append(element('option', run.label, { value: run.index }));
    }
    $('differences-label').hidden = false;
    charts.reference = data.reference >= 0 ? data.reference : runs.length - 1;
    $('reference').value = charts.reference;
    $('differences').onchange = () => { charts.differences = $('differences').checked; charts.redraw(); };
    $('reference').onchange = () => { charts.reference = Number($('reference').value); charts.redraw(); };
  }

  function set_up_page() {
    $('theme').onclick = () => { dark = !dark; paint(); };
    $('print').onclick = () => print();
    $('help').onclick = () => $('keys').showModal();
    $('filter').oninput = () => charts.filter($('filter').value);
    addEventListener('beforeprint', () => {
      pause();
      charts.all();
      charts.dark = false;
      charts.redraw();
      document.documentElement.dataset.theme = 'light';
      document.querySelectorAll('#sources details, #words details').forEach(d => { d.open = true; });
    });
    addEventListener('afterprint', paint);
    addEventListener('keydown', e => {
      if (e.target.matches('input[type=search], select') || e.ctrlKey || e.metaKey || e.altKey || $('keys').open) return;
      // A control that was reached by the keyboard keeps the keys that work it.
      if (e.target.matches('input:focus-visible, button:focus-visible, summary:focus-visible, a:focus-visible') &&
        (e.key === ' ' || (e.target.type === 'range' && /^(Arrow|Home|End)/.test(e.key)))) return;
      const step = (end - start) / Math.max(1, runs[0].animation.times.length - 1) * (e.shiftKey ? 10 : 1);
      const keys = {
        ' ': () => playing ? pause() : play(),
        ArrowLeft: () => { pause(); seek(time - step); },
        ArrowRight: () => { pause(); seek(time + step); },
        Home: () => seek(start),
        End: () => { pause(); seek(end); },
        '+': () => set_scale(Number($('scale').value) + 0.1),
        '-': () => set_scale(Number($('scale').value) - 0.1),
        '0': () => view?.look('home'),
        x: () => view?.look('x'), y: () => view?.look('y'), z: () => view?.look('z'),
        f: () => $('follow').click(),
        l: () => charts.under?.toggle_log(),
        d: () => $('theme').click(),
        '?': () => $('help').click(),
      };
      const act = keys[e.key] ?? keys[e.key.toLowerCase()];
      if (!act) return;
      e.preventDefault();
      if (document.activeElement instanceof HTMLButtonElement && e.key === ' ') document.activeElement.blur();
      act();
    });
  }

  set_up_runs();
  set_up_time();
  set_up_view();
  set_up_page();
  write_words($('words'), runs);
  write_sources($('sources'), runs);
  paint();
  seek(wish.has('t') && Number.isFinite(Number(wish.get('t'))) ? Number(wish.get('t')) : start);
  view?.resize();
  if (wish.get('play') !== '0' && !wish.has('t') && !matchMedia('(prefers-reduced-motion: reduce)').matches) play();
  document.body.dataset.ready = 'true';
}
