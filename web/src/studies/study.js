// The page of a study: its title, light or dark, print; what it shows is in the file of its kind.
import { palette } from '../data.js';
import { Figures } from './figures.js';
import { Modes } from './modes.js';
import { Sweep } from './sweep.js';
import { Trade } from './trade.js';

const kinds = { figures: Figures, trade: Trade, modes: Modes, sweep: Sweep };

export function show_study(page) {
  const $ = id => document.getElementById(id), wish = new URLSearchParams(location.hash.slice(1));
  document.title = `${page.title} – withy`;
  $('title').textContent = page.title;
  for (const id of ['stage', 'words', 'plots', 'sources', 'help']) $(id).remove();
  const holder = $('study');
  holder.hidden = false;
  const study = new kinds[page.kind](holder, page.data);
  let dark = wish.get('theme') ? wish.get('theme') === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  const paint = bright => {
    document.documentElement.dataset.theme = dark && !bright ? 'dark' : 'light';
    $('theme').textContent = dark ? 'Light' : 'Dark';
    study.paint(palette(dark && !bright));
  };
  $('theme').onclick = () => { dark = !dark; paint(); };
  $('print').onclick = () => print();
  addEventListener('beforeprint', () => paint(true));
  addEventListener('afterprint', () => paint());
  addEventListener('keydown', e => {
    if (e.target.matches('input, select') || e.ctrlKey || e.metaKey || e.altKey || e.key.toLowerCase() !== 'd') return;
    e.preventDefault();
    $('theme').click();
  });
  // Letters stay as large as they are on a narrow page, so that figures are drawn anew.
  const wide_enough = 1200;
  let width = holder.clientWidth;
  new ResizeObserver(() => {
    if (Math.min(holder.clientWidth, wide_enough) !== Math.min(width, wide_enough)) requestAnimationFrame(() => paint());
    width = holder.clientWidth;
  }).observe(holder);
  paint();
  document.body.dataset.ready = 'true';
}
