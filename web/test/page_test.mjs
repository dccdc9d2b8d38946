// The page in a browser: it shows what the program computed, asks for nothing, and its controls work.
//   node page_test.mjs WITHY SCENES CHROMIUM
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { Vector3 } from 'three';
import { thickness_of } from '../src/shapes.js';
import { drawn, grouped, quantities, unpack } from '../src/data.js';
import { Motion } from '../src/motion.js';
import { greatest_of, longest_in_words, measured } from '../src/arrows.js';
import { Pace } from '../src/pace.js';
import { clock_of, speeds_of } from '../src/playback.js';
import { axis_ticks, ends_of, labels_of } from '../src/ticks.js';
import { certificate_rows } from '../src/words.js';
import { in_browser, opened, text } from './browser.mjs';
import { check_far } from './far.mjs';
import { check_gltf } from './gltf.mjs';
import { check_landmarks } from './landmarks.mjs';
import { check_long_runs, check_rows } from './rows.mjs';

const [withy, scenes, chromium] = process.argv.slice(2);
let folder, run;
const simulate = (scene, out, ...more) => run('run', join(scenes, scene), '--out', join(folder, out), ...more);
const data_of = file => JSON.parse(/<script type="application\/json" id="withy-data">([^]*?)<\/script>/.exec(readFileSync(file, 'utf8'))[1]);

// Where deformation is drawn otherwise than it is, bodies hang on each other by the poses of hinges and deformed
// sections; as near to 1 as can be, that must give what was computed.
function check_motion(file) {
  for (const run of data_of(file).runs) {
    const motion = new Motion(unpack(run).animation);
    assert.ok(motion.end > motion.start);
    for (const i of [1, motion.times.length >> 1, motion.times.length - 1]) {
      motion.go(motion.times[i], 1);
      const computed = motion.bodies.map(b => b.pose.p.clone());
      motion.go(motion.times[i], 1 + 1e-9);
      motion.bodies.forEach((b, k) => assert.ok(b.pose.p.distanceTo(computed[k]) < 1e-4 * (1 + computed[k].length()), `${b.name} at ${motion.times[i]}`));
      motion.go(motion.times[i], 30);
    }
  }
}

// Every tick says its own value, and those of one axis have as many digits.
function check_ticks() {
  const labels = (...ticks) => labels_of(ticks).join(' ');
  assert.equal(labels(-1e-7, -7.5e-8, -5e-8, -2.5e-8, 0), '-100e-9 -75e-9 -50e-9 -25e-9 0');
  assert.equal(labels(0, 2e-5, 4e-5), '0 20e-6 40e-6');
  assert.equal(labels(1e6, 1.25e6, 1.5e6), '1.00e6 1.25e6 1.50e6');
  assert.equal(labels(0, 0.25, 0.5), '0 0.25 0.50');
  assert.equal(labels(6000, 6020), '6000 6020');
  assert.equal(labels(7000000, 7000000.25, 7000000.5), '7000000.00 7000000.25 7000000.50');
  assert.equal(labels(1e-4, 1e-4 + 2e-12), '100.000000e-6 100.000002e-6');
  assert.equal(labels(0, 5e-4, 1e-3), '0 0.0005 0.0010');
}

// Axes of every size have ticks, in steps of 1, 2 or 5, and those that stand side by side have room.
function check_axes() {
  const how = { length: 400, apart: 40, across: true };
  for (let k = -300; k <= 300; k += 3) {
    for (const m of [1, 1.7, 4, 9.9]) {
      const high = Number(`${m}e${k}`), ticks = axis_ticks(-0.3 * high, high, how), names = ticks.map(([, name]) => name);
      assert.ok(ticks.length >= 3 && ticks.length <= 12 && new Set(names).size === ticks.length, `to ${high}: ${names}`);
      ticks.forEach(([v, name]) => assert.ok(v >= -0.3 * high && v <= high && Math.abs(+name - v) <= 1e-9 * high, `${name} at ${v}`));
      assert.ok(names.every(name => (name.split('e')[1] ?? 0) % 3 === 0), names.join());
      assert.ok(axis_ticks(high, 50 * high, { ...how, log: true }).length >= 3);
    }
  }
  assert.deepEqual(axis_ticks(1.9999, 2, how).map(([, name]) => name), ['1.99990', '1.99992', '1.99994', '1.99996', '1.99998', '2.00000']);
  assert.deepEqual(axis_ticks(0, 1e-5, how).map(([, name]) => name), ['0', '2e-6', '4e-6', '6e-6', '8e-6', '10e-6']);
  assert.ok(axis_ticks(1e-300, 1e300, { ...how, log: true }).length >= 5);
  assert.deepEqual(axis_ticks(2, 2 + 1e-15, how), [], 'what rounding parts has no ticks between');
  assert.deepEqual(ends_of(0, 0, 0.06), [-1, 1]);
}

// Runs of every length can be watched, and the clock tells a thousandth of each.
function check_playback() {
  for (const [run, speed] of [[3.8, 1], [60, 1], [1, 0.2], [80, 2], [100, 5]]) assert.equal(speeds_of(run).chosen, speed, `${run} s`);
  for (let k = -12; k <= 12; ++k) {
    for (const m of [1, 1.7, 4, 9.9]) {
      const length = Number(`${m}e${k}`), { all, chosen } = speeds_of(length), seconds = length / chosen;
      assert.ok(all.some(s => s.value === chosen) && all.some(s => s.value === 1));
      if (length < 1 || length > 100) assert.ok(seconds > 9 && seconds < 24, `${length} s in ${seconds} s`);
      const told = clock_of(0, length);
      assert.ok(told(0.501 * length) !== told(0.5 * length) && Math.abs(parseFloat(told(length)) - length) < 1e-3 * length, `${told(length)} for ${length}`);
    }
  }
  assert.deepEqual([clock_of(0, 3.8)(1), clock_of(0, 1e-5)(3.7e-6), clock_of(0, 1e7)(2e6), clock_of(1.9999, 2)(1.99995)], ['1.000 s', '3.70e-6 s', '2000000 s', '1.99995000 s']);
}

// A hinge is no larger than a part of the way to the next one, however long the whole is, and can be seen.
function check_thickness() {
  const link = (...ways) => ({ end: -1, hung: ways.map(way => ({ rest: { p: new Vector3(way, 0, 0) } })), box: { pose: [0.05, 0, 0, 1, 0, 0, 0], edges: [0.1, 0.1, 0.1] } });
  const of = (body, size) => +thickness_of(body, size).toPrecision(3);
  assert.deepEqual([of(link(1), 2), of(link(0.1), 20), of(link(1, 1.1), 20), of(link(), 20), of(link(1e-6), 1)], [0.022, 0.018, 0.018, 0.018, 0.0008]);
  assert.ok(thickness_of({ end: -1, hung: [] }, 1) > 0);
}

// Runs lie over each other in the same unit, also where an angle turns far in one of them alone.
function check_turns() {
  const run = end => ({ table: { columns: [{ name: 't', unit: 's', data: [0, 1] }, { name: 'axle', unit: 'rad', data: [0, end] }] }, validity: [], time: [0, 1] });
  const groups = grouped([run(Math.PI), run(100 * Math.PI)]);
  assert.deepEqual(groups.map(g => [g.title, g.series[0].of.map(({ y }) => y[1])]), [['Turns', [0.5, 50]]]);
}

// An output without a unit is no modal coordinate.
function check_groups() {
  const columns = [['t', 's'], ['boom.bending_y.1', ''], ['root.strain_y', '1'], ['boom.bending_y.1.rate', '']].map(([name, unit]) => ({ name, unit, data: [0, 1] }));
  const groups = grouped([{ table: { columns }, validity: [], time: [0, 1], animation: { times: [0, 1] } }]);
  assert.deepEqual(groups.map(g => [g.title, ...g.series.map(s => s.name)]), [
    ['Numbers without a unit', 'root.strain_y'],
    ['Modal coordinates', 'boom.bending_y.1'],
    ['Rates of modal coordinates', 'boom.bending_y.1.rate'],
  ]);
}

// An output is no coordinate of a hinge, whatever its unit, and no energy in another unit.
function check_outputs() {
  const columns = [['t', 's'], ['slide', 'm'], ['slide.rate', 'm/s'], ['kinetic_energy', 'J'], ['gap', 'm'], ['gap.rate', 'm/s'], ['lost_energy', 'W']].map(([name, unit]) => ({ name, unit, data: [0, 1] }));
  const groups = grouped([{ table: { columns }, validity: [], time: [0, 1], animation: { times: [0, 1] } }]);
  assert.deepEqual(groups.map(g => [g.title, ...g.series.map(s => s.name)]), [
    ['Travel of hinges', 'slide'],
    ['Energies', 'kinetic_energy'],
    ['gap, m', 'gap'],
    ['gap, m/s', 'gap.rate'],
    ['lost_energy, W', 'lost_energy'],
    ['Speeds of hinges', 'slide.rate'],
  ]);
}

// A moment without a number leaves a gap, and the rest as it is.
function check_gaps() {
  assert.deepEqual(drawn(Float64Array.of(1, NaN, Infinity, 0, -2), false), [1, null, null, 0, -2]);
  assert.deepEqual(drawn([1, NaN, null, 0, -2], true), [1, null, null, null, 2]);
  const half = Math.SQRT1_2, columns = [['t', 's', [0, 1, 2]], ['eye.qw', '1', [1, NaN, half]], ['eye.qx', '1', [0, NaN, half]], ['eye.qy', '1', [0, NaN, 0]], ['eye.qz', '1', [0, NaN, 0]]];
  const [about_x] = quantities({ table: { columns: columns.map(([name, unit, data]) => ({ name, unit, data })) }, validity: [], time: [0, 1, 2] });
  assert.deepEqual(drawn(about_x.y, false).map(v => v == null ? v : Math.round(v)), [0, null, 90]);
}

// Names of bodies stand whole, however long.
function check_certificate() {
  const name = 'the_left_outer_solar_panel_of_the_satellite';
  assert.deepEqual(certificate_rows(`\ncertificate\n${'left out'.padEnd(23)} 42 % of it\n${''.padEnd(23)} and more\n${name} turns at 2\n`), [['left out', ['42 % of it', 'and more']], [name, ['turns at 2']]]);
}

// Runs on one page are compared: their arrows have one scale, which the page says.
function check_common_scale() {
  const arrow = (unit, greatest) => ({ unit, greatest });
  const greatest = greatest_of([arrow('N', 0.05), arrow('N m', 0.3), arrow('N', 2860), arrow('m/s^2', 0)], 10);
  assert.equal(greatest.get('N'), 2860);
  assert.equal(longest_in_words(greatest), '2.86 kN, 300 mN m');
  assert.deepEqual([5e-6, 2e-4, 1e-3, 0.05, 0.1, 0.5, 200, 1000, 1e8].map(v => measured(v, 'm')), ['5 µm', '0.2 mm', '1 mm', '50 mm', '0.1 m', '0.5 m', '200 m', '1 km', '100000 km']);
  assert.deepEqual([measured(3.2e-7, 'N'), measured(9.81, 'm/s^2')], ['320 nN', '9.81 m/s²']);
}

const picture = page => page.evaluate(() => document.querySelector('#view canvas').toDataURL());

// Arrows have the size of what was measured and, in world axes, its direction: what an accelerometer feels where nothing
// has weight is the change of the velocity in the world.
function check_arrows(file) {
  const run = unpack(data_of(file).runs[0]), { times, arrows } = run.animation;
  const column = name => { const c = run.table.columns.find(c => c.name === name); return c.samples ?? c.data; };
  const arrow = name => arrows.find(a => a.name === name);
  for (const [name, first] of [['elbow_load force', 'elbow_load.f'], ['middle moment', 'middle.m'], ['box acceleration', 'box.']]) {
    const parts = ['x', 'y', 'z'].map(c => column(first + c)), { numbers, greatest } = arrow(name);
    for (let i = 0; i < times.length; ++i)
      assert.ok(Math.abs(Math.hypot(...numbers.slice(6 * i + 3, 6 * i + 6)) - Math.hypot(...parts.map(p => p[i]))) <= 1e-6 * greatest, `${name} at ${times[i]}`);
  }
  const { numbers, greatest } = arrow('box acceleration');
  ['tip.vx', 'tip.vy'].forEach((name, k) => {
    const v = column(name);
    for (let i = 1; i + 1 < times.length; ++i)
      assert.ok(Math.abs(numbers[6 * i + 3 + k] - (v[i + 1] - v[i - 1]) / (times[i + 1] - times[i - 1])) < 0.03 * greatest, `${name} at ${times[i]}`);
  });
  ['x', 'y'].forEach((c, k) => column(`payload.tip.${c}`).forEach((x, i) => assert.ok(Math.abs(numbers[6 * i + k] - x) < 1e-6)));
}

async function check_sensors(browser, troubles) {
  const page = await opened(browser, join(folder, 'loads/report.html'), 't=1.2&theme=light', troubles);
  assert.match(await text(page, '#cell'), /longest arrows: [\d.]+ k?N, [\d.]+ k?N m, [\d.]+ m\/s²/);
  const with_arrows = await picture(page);
  await page.focus('#view');
  await page.keyboard.press('+');
  assert.match(await text(page, '#cell'), /; arrows and trails at Deformation × 1 only$/);
  await page.keyboard.press('-');
  assert.match(await text(page, '#cell'), /longest arrows/);
  await page.uncheck('#sensors');
  assert.notEqual(await picture(page), with_arrows);
  assert.doesNotMatch(await text(page, '#cell'), /arrows/);
  await page.close();
}

// A body of data that has few points is seen: rods of its colour reach from its root to its tip.
async function check_points(browser, troubles) {
  const page = await opened(browser, join(folder, 'boom/report.html'), 't=0.3&theme=light', troubles);
  const across = await page.evaluate(async () => {
    const source = document.querySelector('#view canvas'), canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [source.width, source.height];
    const context = canvas.getContext('2d');
    context.drawImage(source, 0, 0);
    const { data, width, height } = context.getImageData(0, 0, canvas.width, canvas.height);
    let least = width, most = 0;
    for (let y = 0; y < height; ++y) for (let x = 0; x < width; ++x) {
      const [r, g, b] = data.subarray(4 * (y * width + x));
      if (b - r > 90 && b > 110 && g > 60) [least, most] = [Math.min(least, x), Math.max(most, x)];
    }
    return (most - least) / width;
  });
  assert.ok(across > 0.35, `the boom takes ${across} of the picture`);
  await page.close();
}

// Points of plates and of meshes are where the program's own frames are, which results.csv has: to rounding of what the
// page holds, and drawn between moments along their chords.
const surfaces = [
  ['solar-panel.yaml', 'panel', { 'bodies.panel.frames': '{middle: {at: "(1.2, -0.275)"}, edge: {at: "(0.6, 0.55)"}, corner: {at: left}}', outputs: '{middle: {type: frame, of: panel.middle, in: world}, edge: {type: frame, of: panel.edge, in: world}, corner: {type: frame, of: panel.corner, in: world}}' },
    { middle: [[1.2, -0.275, 0]], edge: [[0.6, 0.55, 0]], corner: [[2.4, 0.55, 0]] }],
  ['spinning-boom.yaml', 'mesh', { 'bodies.boom.frames': '{end: {at: TIP}}', outputs: '{tip: {type: frame, of: boom.end, in: world}}' }, { tip: [[1, 0, 0.005], [1, 0, -0.005]] }],
];
function check_surface(out, places) {
  const run = unpack(data_of(join(folder, out, 'report.html')).runs[0]), motion = new Motion(run.animation);
  const body = motion.bodies.find(b => b.shapes), at = X => Array.from({ length: body.count }, (_, k) => k).filter(k => Math.hypot(...X.map((x, c) => x - body.points[3 * k + c])) < 1e-6);
  const column = name => { const c = run.table.columns.find(c => c.name === name); return c.samples ?? c.data; };
  let bent = 0;
  for (const [name, points] of Object.entries(places)) {
    const own = points.flatMap(at);
    assert.equal(own.length, points.length, `vertices at ${name}`);
    motion.times.forEach((t, i) => {
      motion.go(t, 1);
      ['x', 'y', 'z'].forEach((c, axis) => {
        const mean = own.reduce((sum, k) => sum + motion.point(body, k, 1, new Vector3()).getComponent(axis), 0) / own.length;
        assert.ok(Math.abs(mean - column(`${name}.${c}`)[i]) < 3e-6, `${name}.${c} at ${t}: ${mean} for ${column(`${name}.${c}`)[i]}`);
      });
      bent = Math.max(bent, ...body.displacements);
    });
  }
  assert.ok(bent > 1e-3, `${out} bends by ${bent} m`);
}

async function check_controls(browser, troubles) {
  const page = await opened(browser, join(folder, 'arm/report.html'), 't=1&theme=light', troubles);
  const begin = await picture(page);
  assert.match(await text(page, '#words'), /Second-order kinematics/);
  assert.match(await text(page, '#sources'), /Padilla and von Flotow/, 'the scene stands on the page, comments and all');
  assert.equal(await text(page, '#clock'), '1.000 s');
  await page.focus('#view');
  await page.keyboard.press('End');
  assert.equal(await text(page, '#clock'), '3.800 s');
  const end = await picture(page);
  assert.notEqual(end, begin, 'the arm is elsewhere');
  await page.keyboard.press('+');
  assert.equal(await text(page, '#scale-value'), '1.3');
  await page.keyboard.press('-');
  await page.keyboard.press('Home');
  await page.keyboard.press('Space');
  await page.waitForFunction(() => parseFloat(document.getElementById('clock').textContent) > 0.05);
  await page.keyboard.press('Space');
  const stopped = await text(page, '#clock');
  await page.waitForTimeout(200);
  assert.equal(await text(page, '#clock'), stopped, 'it pauses');
  // A control that the keyboard has reached keeps its keys.
  await page.focus('#trails');
  const trails = await page.isChecked('#trails');
  await page.keyboard.press('Space');
  assert.equal(await page.isChecked('#trails'), !trails);
  await page.focus('#scale');
  await page.keyboard.press('End');
  assert.equal(await page.inputValue('#scale'), '2');
  await page.keyboard.press('Home');
  await page.waitForTimeout(200);
  assert.equal(await text(page, '#clock'), stopped, 'the time stays');
  // Legends have the numbers at the time of the view where no pointer asks for others.
  const legend = () => page.$$eval('figure:not([hidden]) .u-value', all => all.map(v => v.textContent));
  const told = await legend();
  assert.ok(told.length > 2 && !told.includes('–'), told.join());
  // The view stands at any time, at which the first number may be that of one end of the plot, but not of all others too.
  const { width } = await (await page.$('figure:not([hidden]) .u-over')).boundingBox();
  const changed = async x => {
    await page.hover('figure:not([hidden]) .u-over', { position: { x, y: 40 } });
    return page.waitForFunction(was => document.querySelector('figure:not([hidden]) .u-value').textContent !== was, told[0], { timeout: 20000 }).then(() => true, () => false);
  };
  assert.ok(await changed(40) || await changed(width / 2) || await changed(width - 40), told[0]);
  await page.mouse.move(2, 2);
  await page.waitForFunction(was => document.querySelector('figure:not([hidden]) .u-value').textContent === was, told[0]);
  assert.deepEqual(await legend(), told);
  await page.click('[data-view=z]');
  await page.fill('#filter', 'energy');
  const shown = await page.$$eval('figure', all => all.filter(f => !f.hidden).map(f => f.querySelector('.name').textContent));
  assert.ok(shown.length >= 2 && shown.every(name => /energ/i.test(name)), shown.join());
  await page.fill('#filter', '');
  await page.click('figure .log');
  assert.equal(await page.getAttribute('figure .log', 'aria-pressed'), 'true');
  await page.click('#theme');
  assert.equal(await page.getAttribute('html', 'data-theme'), 'dark');
  await page.keyboard.press('?');
  assert.ok(await page.isVisible('#keys'));
  await page.keyboard.press('Escape');
  const sheet = await page.pdf({ printBackground: true });
  assert.ok(sheet.length > 50000, 'it prints');
  await page.close();
  const astray = await opened(browser, join(folder, 'arm/report.html'), 't=soon&play=0', troubles);
  assert.equal(await text(astray, '#clock'), '0.000 s', 'a time that is no number is the start');
  await astray.close();
}

// Where frames come late a moving picture has fewer pixels as far as fewer help; one that stands has all of them.
function check_pace() {
  const settled = (time_of, pace = new Pace(2)) => {
    for (let i = 0; i < 400; ++i) pace.frame(time_of(pace.ratio));
    return pace;
  };
  const pixels = settled(ratio => 5 + 8 * ratio ** 2);
  assert.ok(pixels.ratio < 2 && 5 + 8 * pixels.ratio ** 2 < 1000 / 45, `${pixels.ratio}`);
  assert.equal(settled(() => 16, settled(() => 16, pixels)).ratio, 2, 'all of them again when the machine is free');
  assert.equal(settled(() => 16.7).ratio, 2);
  const elsewhere = new Pace(2), ratios = [];
  for (let i = 0; i < 400; ++i) { elsewhere.frame(40); ratios.push(elsewhere.ratio); }
  assert.ok(ratios.filter(r => r === 2).length > 300 && Math.min(...ratios) === 1.5, 'fewer that do not help are given up');
  pixels.frame(60);
  pixels.rest();
  assert.equal(pixels.ratio, 2);
}

// The same of the page, with a clock on which a frame takes as long as its pixels do: no time of this machine counts.
async function check_adapts(browser, troubles) {
  const page = await browser.newPage({ viewport: { width: 640, height: 480 } });
  page.on('pageerror', e => troubles.push(`error: ${e.stack}`));
  await page.addInitScript(() => {
    let clock = 0;
    performance.now = () => clock;
    window.requestAnimationFrame = act => setTimeout(() => {
      const canvas = document.querySelector('#view canvas');
      clock += canvas ? 40 * (canvas.width / canvas.clientWidth) ** 2 : 16;
      act(clock);
    });
  });
  await page.goto(`file://${join(folder, 'craft/report.html')}#t=0`);
  await page.waitForSelector('body[data-ready]');
  const fineness = () => page.$eval('#view canvas', c => c.width / c.clientWidth);
  assert.ok(Math.abs(await fineness() - 1) < 0.01);
  await page.focus('#view');
  await page.selectOption('#speed', '0.01');
  await page.keyboard.press('Space');
  await page.waitForFunction(() => document.querySelector('#view').dataset.pixels === '0.55');
  assert.ok(Math.abs(await fineness() - 0.55) < 0.01, `${await fineness()}`);
  await page.keyboard.press('Space');
  assert.ok(Math.abs(await fineness() - 1) < 0.01, 'the picture that stands is sharp');
  await page.close();
}

// A run of some microseconds, of sizes and energies that are as small: axes, clock, speed and squares are of its scale.
async function check_small(browser, troubles) {
  writeFileSync(join(folder, 'mirror.yaml'), mirror);
  run('run', join(folder, 'mirror.yaml'), '--out', join(folder, 'mirror'));
  const page = await opened(browser, join(folder, 'mirror/report.html'), 't=0&theme=light', troubles);
  const axes = await page.evaluate(async () => {
    const { charts } = document.getElementById('charts');
    charts.all();
    await new Promise(done => setTimeout(done)); // they are drawn behind this
    return charts.panels.map(({ group, chart }) => ({ title: group.title, labels: chart.axes.map(a => a._values) }));
  });
  for (const { title, labels: [times, values] } of axes) {
    assert.deepEqual(times, ['0', '5e-6', '10e-6', '15e-6', '20e-6'], title);
    assert.ok(values.length >= 3 && new Set(values).size === values.length, `${title}: ${values}`);
  }
  assert.match(await text(page, '#cell'), /^squares of \d+ µm/);
  const [size, nearest] = await page.evaluate(() => { const { view } = document.getElementById('view'); return [view.size, Math.min(...view.shapes[0].items.map(i => i.radius))]; });
  assert.ok(size > 5e-5 && size < 2e-4 && nearest < 0.012 * size, `${nearest} of ${size}`);
  const far = await picture(page);
  await page.hover('#view canvas');
  await page.mouse.wheel(0, -400);
  await page.waitForFunction(before => document.querySelector('#view canvas').toDataURL() !== before, far); // it is drawn nearer
  assert.equal(await text(page, '#clock'), '0.00e-6 s');
  assert.equal(await page.inputValue('#speed'), '0.000001');
  await page.focus('#view');
  await page.keyboard.press('End');
  assert.equal(await text(page, '#clock'), '20.00e-6 s');
  await page.close();
}
const mirror = `format: withy/1
time: {end: 20e-6, output: 0.1e-6}
bodies: {b: {type: rigid, mass: 1e-9, center_of_mass: [50e-6, 0, 0], inertia: [1e-19, 1e-19, 1e-19, 0, 0, 0]}}
hinges: {j: {type: revolute, axis: [0, 1, 0], parent: world, child: b}}
loads: {m: {type: hinge-spring, hinge: j, stiffness: 1e-6}}
initial: {hinges: {j: {position: [1e-6]}}}
`;

// Every column is on the page: attitudes as angles.
async function check_columns(browser, troubles) {
  const page = await opened(browser, join(folder, 'craft/report.html'), 't=2', troubles);
  const names = data_of(join(folder, 'craft/report.html')).runs[0].table.columns.map(c => c.name).slice(1);
  await page.evaluate(() => window.dispatchEvent(new Event('beforeprint')));
  const all = await page.$$eval('figure', f => f.map(e => e.textContent).join(' '));
  for (const name of names) {
    if (/\.q[wxyz]$/.test(name)) assert.ok(!all.includes(name));
    else assert.ok(all.includes(name), name);
  }
  assert.match(all, /Attitude of float/);
  await page.close();
}

async function check_several(browser, troubles) {
  const file = join(folder, 'both.html');
  run('report', join(folder, 'arm'), join(folder, 'arm-ruthless'), '--reference', '1', '--out', file);
  const page = await opened(browser, file, 't=1.9&theme=light', troubles);
  const both = await picture(page);
  assert.deepEqual(await page.$$eval('#reference option', o => o.map(e => e.textContent)), ['quadratic', 'ruthless']);
  assert.equal(await page.inputValue('#reference'), '0');
  await page.check('#differences');
  assert.match(await text(page, 'figure'), /ruthless\) − reference/);
  assert.doesNotMatch(await text(page, 'figure'), /quadratic\) − reference/);
  const pens = await page.$$eval('#runs .swatch, figure:first-of-type .u-series:last-child .u-marker', all => all.map(e => /gradient/.test(e.style.background)));
  assert.deepEqual(pens, [false, true, true], 'the dashes of a run are told beside its name and in legends');
  await page.uncheck('#runs label:nth-child(2) input');
  assert.notEqual(await picture(page), both, 'a run that is taken away is not drawn');
  await page.close();
}

// A bus from a mesh, a dish, a ball, and a flat boom that tapers and twists.
const looks = `format: withy/1
name: craft with looks
bodies:
  bus: {type: rigid, mass: 120, inertia: [18, 20, 22, 0, 0, 0], visual: {mesh: bus.obj, scale: 1 mm},
        frames: {left: {position: [0, 0.5, 0], orientation: {axis: [0, 0, 1], angle: 90 deg}}, top: {position: [0, 0, 0.7]}}}
  boom: {type: beam, length: 3, mass_per_length: 0.6, bending_y: {stiffness: 10, modes: 2}, bending_z: {stiffness: 1.5, modes: 1},
         torsion: {stiffness: 0.3, inertia: 0.0002, modes: 2}, visual: {width: [[0, 0.3], [3, 0.1]], height: 0.02}}
  dish: {type: rigid, mass: 5, inertia: [0.1, 0.1, 0.1, 0, 0, 0], visual: {cylinder: {radius: 0.5, length: 0.1}, position: [0, 0, 0.05]}}
  ball: {type: rigid, mass: 0.2, center_of_mass: [0, 0, 0.3], inertia: [0.01, 0.01, 0.01, 0, 0, 0], visual: {sphere: 0.1}}
hinges:
  float: {type: free, parent: world, child: bus}
  root: {type: weld, parent: bus.left, child: boom}
  axle: {type: revolute, axis: [0, 0, 1], parent: bus.top, child: dish}
  end: {type: weld, parent: boom.tip, child: ball}
initial: {hinges: {float: {rate: [0.2, 0.1, 0.3, 0, 0, 0]}, axle: {rate: [2]}}, bodies: {boom: {modes: [0.2, 0, 0.1, 0.5, 0]}}}
time: {end: 4, output: 0.05}
`;
const bus = `v -400 -500 -700\nv 400 -500 -700\nv 400 500 -700\nv -400 500 -700\nv 0 0 700
f 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n`;

// What the scene says of them is on the page, in metres.
function check_looks(file) {
  const bodies = new Map(unpack(data_of(file).runs[0]).animation.parts.map(p => [p.name, p]));
  const { vertices, triangles } = bodies.get('bus').surface;
  assert.deepEqual([vertices.length, triangles.length], [15, 18]);
  assert.ok(Math.abs(Math.max(...vertices) - 0.7) < 1e-6);
  const { sections } = bodies.get('boom');
  assert.ok(sections.turns && sections.rectangle);
  [[0, 0.15], [1, 0.01], [sections.widths.length - 2, 0.05]].forEach(([i, half]) => assert.ok(Math.abs(sections.widths[i] - half) < 1e-6));
}

check_ticks();
check_axes();
check_playback();
check_thickness();
check_groups();
check_outputs();
check_gaps();
check_certificate();
check_turns();
check_common_scale();
check_rows();
await in_browser(withy, chromium, async (browser, own_folder, own_run) => {
  [folder, run] = [own_folder, own_run];
  simulate('two-link-slew.yaml', 'arm');
  simulate('two-link-slew.yaml', 'arm-ruthless', '--formulation', 'ruthless');
  simulate('spacecraft.yaml', 'craft', '--set', 'time.end=4');
  for (const [scene, out, set, places] of surfaces) {
    simulate(scene, out, ...Object.entries(set).flatMap(([path, value]) => ['--set', `${path}=${value}`]));
    check_surface(out, places);
  }
  simulate('loads-of-the-slew.yaml', 'loads');
  check_arrows(join(folder, 'loads/report.html'));
  simulate('imported-boom.yaml', 'boom');
  writeFileSync(join(folder, 'looks.yaml'), looks);
  writeFileSync(join(folder, 'bus.obj'), bus);
  run('run', join(folder, 'looks.yaml'), '--out', join(folder, 'looks'));
  check_looks(join(folder, 'looks/report.html'));
  for (const name of ['arm', 'craft', 'panel', 'mesh', 'boom', 'looks']) {
    const page = join(folder, name, 'report.html'), motion = join(folder, `${name}.glb`);
    check_motion(page);
    run('report', join(folder, name), '--out', motion);
    await check_gltf(motion, data_of(page));
  }
  check_pace();
  const troubles = [];
  await check_adapts(browser, troubles);
  await check_landmarks(browser, folder, run, scenes, troubles);
  await check_controls(browser, troubles);
  await check_small(browser, troubles);
  await check_columns(browser, troubles);
  await check_several(browser, troubles);
  await check_long_runs(browser, folder, run, troubles);
  await check_far(browser, folder, run, troubles);
  await check_sensors(browser, troubles);
  await check_points(browser, troubles);
  for (const name of ['panel', 'mesh', 'looks']) await (await opened(browser, join(folder, name, 'report.html'), 'theme=dark', troubles)).close();
  assert.deepEqual(troubles, []);
  console.log('the page shows, moves, compares and asks for nothing');
});
