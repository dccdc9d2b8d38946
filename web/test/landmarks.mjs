// A page as it is seen: what the program computed is where it must be on the screen, by its colour, and words that are
// read do not lie on each other. Pixels of a screenshot are looked at where numbers of results.csv say, not compared with
// an older picture.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { opened } from './browser.mjs';

const near = 3; // pixels

// Columns of results.csv by their names without units.
function table(file) {
  const [head, ...rows] = readFileSync(file, 'utf8').trim().split('\n').map(line => line.split(','));
  return name => { const i = head.findIndex(h => h.replace(/\[.*/, '') === name); assert.ok(i >= 0, name); return rows.map(r => +r[i]); };
}

// What was drawn, as pixels in the page: how near to a place one of a colour is; Infinity where there is none.
const distance_of = (page, places, colour, selector) => page.evaluate(async ([places, colour, selector, far]) => {
  const source = document.querySelector(selector), canvas = document.createElement('canvas');
  const box = source.getBoundingClientRect(), [w, h] = [Math.round(box.width), Math.round(box.height)];
  [canvas.width, canvas.height] = [w, h];
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.drawImage(source, 0, 0, w, h);
  const { data } = context.getImageData(0, 0, w, h);
  const wanted = [1, 3, 5].map(i => parseInt(colour.slice(i, i + 2), 16)), size = Math.hypot(...wanted);
  // Light and shade change how bright a colour is, not which.
  const alike = i => {
    const c = [data[i], data[i + 1], data[i + 2]], bright = Math.hypot(...c);
    return bright > 0.35 * size && c.reduce((s, v, k) => s + v * wanted[k], 0) / bright / size > 0.985;
  };
  return places.map(([x, y]) => {
    let least = Infinity;
    for (let j = Math.max(0, Math.round(y) - far); j <= Math.min(h - 1, Math.round(y) + far); ++j)
      for (let i = Math.max(0, Math.round(x) - far); i <= Math.min(w - 1, Math.round(x) + far); ++i)
        if (alike(4 * (j * w + i))) least = Math.min(least, Math.hypot(i + 0.5 - x, j + 0.5 - y));
    return least;
  });
}, [places, colour, selector, 24]);

// Points of the world [m] on the canvas [px].
const projected = (page, points) => page.evaluate(points => {
  const { camera, width, height } = document.querySelector('#view').view;
  camera.updateMatrixWorld();
  return points.map(p => {
    const v = camera.position.clone().fromArray(p).project(camera);
    return [(v.x + 1) / 2 * width, (1 - v.y) / 2 * height];
  });
}, points);

// The strip is where its frames are, and not in the middle of the straight line from its root to its tip.
async function check_bent(page, points, colour) {
  const at = await projected(page, points), straight = await projected(page, [points.at(-1).map(c => c / 2)]);
  const found = await distance_of(page, at, colour, '#view canvas');
  found.forEach((d, k) => assert.ok(d <= near, `point ${k} of the strip is drawn ${d} px from (${at[k].map(Math.round)})`));
  const stray = await distance_of(page, straight, colour, '#view canvas');
  assert.ok(stray[0] > 2 * near, `the strip is drawn ${stray[0]} px from the middle of its chord: straight`);
}

async function check_strip(browser, folder, run, scenes, troubles) {
  const out = join(folder, 'strip'), places = [0.3, 0.6, 0.9];
  run('run', join(scenes, 'gallery/flexible-pendulum.yaml'), '--out', out,
    '--set', `bodies.strip.frames={${places.map((x, k) => `p${k}: {at: ${x}}`)}}`,
    '--set', `outputs={${places.map((_, k) => `p${k}: {type: frame, of: strip.p${k}, in: world}`)}}`);
  const column = table(join(out, 'results.csv')), times = column('t');
  const at = row => name => ['x', 'y', 'z'].map(c => column(`${name}.${c}`)[row]);
  // When it is bent most in the first and in the second half of the run.
  const bent = times.map((_, row) => Math.hypot(...at(row)('p1').map((c, k) => c - at(row)('strip.tip')[k] / 2))), half = bent.length >> 1;
  const most = rows => rows.reduce((a, b) => bent[b] > bent[a] ? b : a), rows = [...times.keys()];
  for (const [theme, colour, row] of [['light', '#0072b2', most(rows.slice(0, half))], ['dark', '#56b4e9', most(rows.slice(half))]]) {
    const of = at(row);
    const points = [[0, 0, 0], of('p0'), of('p1'), of('p2'), of('strip.tip')];
    const page = await opened(browser, join(out, 'report.html'), `t=${times[row]}&theme=${theme}`, troubles);
    for (const name of ['trails', 'ghosts']) await page.uncheck(`#${name}`);
    for (const look of ['z', 'home']) {
      await page.click(`[data-view=${look}]`);
      await check_bent(page, points, colour);
    }
    // A page that draws no deformation fails.
    await page.evaluate(() => {
      const { view } = document.querySelector('#view'), [motion] = view.motions, [body] = motion.bodies;
      for (let i = 0; i < motion.times.length; ++i) motion.numbers.fill(0, i * motion.size + body.pointsAt, i * motion.size + body.pointsAt + body.points.length);
      view.go(view.time);
    });
    await assert.rejects(check_bent(page, points, colour), /strip/);
    await page.close();
  }
}

// Curves go through the numbers of results.csv, each with its colour; both axes have numbers that stand apart; the legend
// names every curve.
async function check_plots(browser, folder, troubles) {
  const column = table(join(folder, 'strip/results.csv')), times = column('t'), degrees = 180 / Math.PI;
  const page = await opened(browser, join(folder, 'strip/report.html'), 't=0&theme=light', troubles);
  await page.evaluate(() => window.dispatchEvent(new Event('beforeprint')));
  const titles = await page.$$eval('#charts figure .name', all => all.map(e => e.textContent));
  for (const title of titles) assert.match(title, /\[[^\]]+\]|, [^ ]+$|^Validity: rates and deflections, each over its limit/, 'a plot has a unit');
  const index = titles.findIndex(t => t.startsWith('Angles'));
  const rows = [10, 60, 110, 140], pin = column('pin');
  const places = await page.evaluate(([index, values]) => {
    const { chart } = document.querySelector('#charts').charts.panels[index], { over } = chart;
    return values.map(([t, y]) => [chart.valToPos(t, 'x') + over.offsetLeft, chart.valToPos(y, 'y') + over.offsetTop]);
  }, [index, rows.map(r => [times[r], pin[r] * degrees])]);
  const selector = `#charts figure:nth-of-type(${index + 1}) canvas`;
  (await distance_of(page, places, '#0072b2', selector)).forEach((d, k) => assert.ok(d <= near, `the curve is ${d} px from row ${rows[k]}`));
  // The legend tells the numbers of the animation's time, once the page is open.
  assert.match(await page.textContent(`#charts figure:nth-of-type(${index + 1}) .u-legend`), /pin\D*[\d.]+/);
  const labels = await page.evaluate(() => document.querySelector('#charts').charts.panels.map(panel => {
    const { chart } = panel, context = document.createElement('canvas').getContext('2d');
    context.font = '12px system-ui, sans-serif';
    const [x, y] = chart.axes.map((axis, k) => axis._splits.map((v, i) => ({ text: `${axis._values[i] ?? ''}`, at: chart.valToPos(v, k ? 'y' : 'x'), width: context.measureText(axis._values[i] ?? '').width })).filter(l => l.text));
    return { title: panel.group.title, x, y, room: chart.axes[1].size(chart, null, 1, 1), legend: panel.element.querySelectorAll('.u-legend .u-series').length - 1, curves: chart.series.length - 1 };
  }));
  for (const { title, x, y, room, legend, curves } of labels) {
    assert.ok(x.length >= 3 && y.length >= 3, `${title}: ${x.length} and ${y.length} numbers on the axes`);
    for (const l of y) assert.ok(l.width <= room - 14, `${title}: '${l.text}' is cut off`);
    x.slice(1).forEach((l, i) => assert.ok(l.at - x[i].at >= (l.width + x[i].width) / 2 + 4, `${title}: ${x[i].text} touches ${l.text}`));
    y.slice(1).forEach((l, i) => assert.ok(Math.abs(l.at - y[i].at) >= 12, `${title}: ${y[i].text} touches ${l.text}`));
    assert.equal(legend, curves);
  }
  await check_words(page);
  // Words that are pushed onto others are found.
  await page.$eval('#charts figure:nth-of-type(3) figcaption', e => { e.style.transform = 'translateY(-20px)'; });
  await page.$eval('#runs', e => { e.style.transform = 'translateY(-25px)'; });
  await assert.rejects(check_words(page), /lies on/);
  await page.close();
}

// Words that are shown lie neither on each other nor outside the page. For pages of 1200 px, of runs and of studies.
export async function check_words(page) {
  const faults = await page.evaluate(() => {
    const words = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), range = document.createRange();
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
      const parent = node.parentElement;
      if (!node.textContent.trim() || parent.closest('script, style, pre, .scroll, details:not([open]), select, dialog, #note, noscript')) continue;
      if (!parent.checkVisibility({ visibilityProperty: true })) continue;
      range.selectNodeContents(node);
      for (const r of range.getClientRects()) if (r.width > 1 && r.height > 1) words.push({ text: node.textContent.trim().slice(0, 30), parent, l: r.left + scrollX, r: r.right + scrollX, t: r.top + scrollY + 0.2 * r.height, b: r.bottom + scrollY - 0.2 * r.height });
    }
    // What a box scrolls out of sight is not seen.
    const seen = words.filter(w => { const box = w.parent.closest('#words, .more'); if (!box) return true; const c = box.getBoundingClientRect(); return w.b < c.bottom + scrollY && w.t > c.top + scrollY; });
    const out = seen.filter(w => w.r > innerWidth + 1 || w.l < -1).map(w => `'${w.text}' leaves the page`);
    seen.sort((a, b) => a.t - b.t);
    seen.forEach((a, i) => {
      for (let k = i + 1; k < seen.length && seen[k].t < a.b; ++k) {
        const b = seen[k];
        if (Math.min(a.r, b.r) - Math.max(a.l, b.l) > 1.5 && Math.min(a.b, b.b) - b.t > 1.5) out.push(`'${a.text}' lies on '${b.text}'`);
      }
    });
    return out;
  });
  assert.deepEqual(faults, []);
}

export async function check_landmarks(browser, folder, run, scenes, troubles) {
  await check_strip(browser, folder, run, scenes, troubles);
  await check_plots(browser, folder, troubles);
}
