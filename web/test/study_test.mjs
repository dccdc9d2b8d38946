// The pages of studies in a browser: what they show is what the program's files say; hover, click and sorting work.
//   node study_test.mjs WITHY SCENES CHROMIUM [PICTURES]
import assert from 'node:assert/strict';
import { execSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { number, number_among, number_within } from '../src/numbers.js';
import { scale_of } from '../src/studies/figure.js';
import { name_within, names_beside } from '../src/studies/sweep.js';
import { in_browser, opened, says, text } from './browser.mjs';
import { check_words } from './landmarks.mjs';

const [withy, scenes, chromium, pictures] = process.argv.slice(2).map(path => resolve(path));
const page_data = file => JSON.parse(/<script type="application\/json" id="withy-data">([^]*?)<\/script>/.exec(readFileSync(file, 'utf8'))[1]).data;
// Words of a page stand apart; of a test with a folder for pictures the page is left there.
const shot = async (page, name) => { await check_words(page); if (pictures) await page.screenshot({ path: join(pictures, `${name}.png`), fullPage: true }); };
const close = (a, b) => assert.ok(Math.abs(a - b) <= 1e-9 * Math.max(Math.abs(a), Math.abs(b)), `${a} and ${b}`);

// An axis in decades has numbers wherever its values lie.
function check_log_ticks() {
  const told = (...values) => scale_of(values, { log: true, from: 0, to: 600 }).ticks.map(([, name]) => name);
  assert.deepEqual(told(3.34, 3.75), ['3.4', '3.5', '3.6', '3.7']);
  assert.deepEqual(told(2.1, 4.8), ['2.5', '3.0', '3.5', '4.0', '4.5', '5.0']);
  assert.deepEqual(told(1, 50), ['1', '2', '5', '10', '20', '50']);
  assert.deepEqual(told(1, 1e4), ['1', '10', '100', '1000', '10000']);
}

// Numbers of a narrow range are told apart, others have four digits.
function check_numbers() {
  assert.deepEqual([0.8113306, 0.8113613].map(number_within(0.8113306, 0.8113613)), ['0.8113306', '0.8113613']);
  assert.deepEqual([2.41e-18, 2.4100123e-18, 0, null].map(number_within(2.41e-18, 2.4100123e-18)), ['2.41e-18', '2.4100123e-18', '0', '–']);
  assert.deepEqual([1, 12345].map(number_within(1, 12345)), ['1', '12350']);
  assert.deepEqual([1.9999, 2].map(number_among([1.9999, NaN, 2], 5, true)), ['1.9999000', '2.0000000']);
  assert.equal(number_within(7e32, 7e32 * (1 + 1e-15))(7e32), '7.00e32', 'rounding tells nothing apart');
  assert.deepEqual([number(1e-4), number(123456), number(0.5, 5, true), number(0), number(NaN)], ['1.00e-4', '1.23e5', '0.50000', '0', '–']);
}

// What is zero stands below all decades, where anything is.
function check_zeros() {
  const scale = values => scale_of(values, { log: true, from: 400, to: 0, zeros: true }), told = at => at.ticks.map(([, name]) => name);
  const some = scale([0, 0.05, 3]);
  assert.deepEqual(told(some), ['0', '0.05', '0.1', '0.2', '0.5', '1', '2']);
  assert.ok(some(0) < 400 && some(0.05) < some(0) - 20 && some(3) > 0);
  assert.ok(!told(scale([0.05, 3])).includes('0'));
  assert.deepEqual(told(scale([0, 0])), ['0']);
}

// Of a name that is too long the end stands, and its value whole.
function check_names() {
  assert.equal(name_within('bodies.cart.mass', ' = 0.8966', 42), 'bodies.cart.mass = 0.8966');
  const cut = name_within('initial.hinges.the_slider_of_the_arm.position.0', ' = -0.3654', 42);
  assert.equal(cut, '…he_slider_of_the_arm.position.0 = -0.3654');
  assert.equal(cut.length, 42);
}

// Wherever three lines stand, their names are all there in their order, in the frame, and none runs into another.
function check_names_of_lines() {
  const names = ['5 %', 'median', '95 %'], at = [80, 81, 100, 130, 200, 300, 380, 399, 400];
  for (const a of at) for (const b of at.filter(x => x >= a)) for (const c of at.filter(x => x >= b)) {
    const placed = names_beside([a, b, c].map((x, i) => ({ x, name: names[i] })), 80, 400);
    assert.equal(placed.map(p => p.name).join(', '), '5 %, median, 95 %');
    placed.forEach((p, i) => {
      assert.ok(p.from >= 80 && p.to <= 400, `${[a, b, c]}: ${p.name} leaves the frame`);
      assert.ok(i === 0 || p.from >= placed[i - 1].to, `${[a, b, c]}: ${p.name} runs into the one before`);
    });
  }
  assert.equal(names_beside([100, 200, 300].map((x, i) => ({ x, name: names[i] })), 80, 400).length, 3);
}

// Each model is a mark where its numbers say; a click tells all of it, with the command that runs it.
async function check_trade(browser, folder, run, troubles) {
  const out = join(folder, 'trade');
  run('trade', join(scenes, 'driven-arm.yaml'), '--set', 'time.end=1', '--formulations', 'ruthless,consistent,quadratic,linear', '--modes', '1,2', '--tolerances', '1e-4,1e-6', '--out', out);
  const { points } = JSON.parse(readFileSync(join(out, 'trade.json'))), done = points.filter(p => p.status === 'completed');
  const page = await opened(browser, join(out, 'report.html'), 'theme=light', troubles);
  const marks = page.locator('.figures .mark');
  assert.equal(await marks.count(), done.length);
  assert.deepEqual(await page.$$eval('.answer li', all => all.map(e => /^Within ([\d.]+ %):/.exec(e.textContent)[1])), ['10 %', '1 %', '0.1 %']);
  const at = await marks.evaluateAll(all => all.map(m => /translate\(([-\d.]+) ([-\d.]+)\)/.exec(m.getAttribute('transform')).slice(1).map(Number)));
  done.forEach((p, i) => done.forEach((q, j) => {
    if (q.cpu_seconds > 1.05 * p.cpu_seconds) assert.ok(at[j][0] > at[i][0], 'dearer is further to the right');
    if (q.relative_error > 1.05 * p.relative_error && p.relative_error > 1e-13) assert.ok(at[j][1] < at[i][1], 'worse is higher');
  }));
  for (const which of [p => p.pareto, p => !p.pareto]) {  // full and hollow marks
    await page.mouse.move(0, 0);
    await marks.nth(done.findIndex(which)).hover({ force: true });
    await says(page, '#note:not([hidden])', /error .* %, CPU time .* ms/);
  }
  await page.click('table.rows tbody tr:nth-child(2)');
  assert.match(await text(page, '#model'), new RegExp(`${points[1].formulation}[^]*withy run .*driven-arm.yaml`));
  await page.click('table.rows th:nth-child(2) button');
  const sorted = await page.$$eval('table.rows tbody tr', rows => rows.map(r => r.children[1].textContent));
  assert.deepEqual(sorted, [...sorted].sort());
  await shot(page, 'trade-light');
  await page.click('.legend .chip');
  assert.ok(await marks.count() < done.length, 'a formulation is taken away');
  await page.click('.legend .chip');
  await page.keyboard.press('d');
  assert.equal(await page.getAttribute('html', 'data-theme'), 'dark');
  await shot(page, 'trade-dark');
  assert.ok((await page.pdf()).length > 20000, 'it prints');
  await page.close();
  await check_asked(browser, folder, run, troubles);
  // The command of the page is the model's run.
  const { command, steps } = page_data(join(out, 'report.html')).points.at(-1);
  execSync(`${command.replace('withy', withy)} --out ${join(folder, 'point')}`, { stdio: 'ignore' });
  assert.equal(JSON.parse(readFileSync(join(folder, 'point/run.json'))).steps, steps);
}

// The errors that are asked for are those of the command and of the page.
async function check_asked(browser, folder, run, troubles) {
  const out = join(folder, 'asked');
  const said = run('trade', join(scenes, 'driven-arm.yaml'), '--set', 'time.end=0.3', '--modes', '1,2', '--tolerances', '1e-4', '--accuracy', '5%,0.000001%', '--out', out);
  assert.match(said, /within 5 % /);
  const { points, cheapest } = page_data(join(out, 'report.html'));
  const page = await opened(browser, join(out, 'report.html'), 'theme=light', troubles), lines = await page.$$eval('.answer li', all => all.map(e => e.textContent));
  assert.equal(lines.length, 2);
  assert.ok(lines[0].startsWith(`Within 5 %: ${points[cheapest[0].point].formulation}, `), lines[0]);
  assert.match(lines[1], /^Within 1\.00e-6 %: none of these models$/);
  await page.close();
}

// Branches are the columns of modes.csv; lines of the rate rise by one rate a rate.
async function check_modes(browser, folder, run, troubles) {
  const out = join(folder, 'modes');
  run('modes', join(scenes, 'rotating-blade.yaml'), '--sweep', 'spin.axle=0 rpm:60 rpm:9', '--out', out);
  const { runs, values, rate } = page_data(join(out, 'report.html'));
  close(rate, 2 * Math.PI / 60);
  const exact = JSON.parse(readFileSync(join(out, 'modes.json'))).runs[0].points;
  runs[0].branches.forEach((b, i) => b.at.forEach((m, k) => {
    close(m.hertz, exact[k].modes[i].eigenvalue[1] / 2 / Math.PI);
    assert.equal(m.value, values[k]);
    const all = m.shape.reduce((sum, [, share]) => sum + share, 0);
    assert.ok(all > 0.95 && all < 1 + 1e-12, `shares of ${all}`);
    assert.ok(m.mac >= 0 && m.mac <= 1 + 1e-12);
    if (k === 0) close(m.mac, 1);
  }));
  const page = await opened(browser, join(out, 'report.html'), 'theme=light', troubles);
  assert.match(await text(page, '#campbell'), /1 per turn[^]*2 per turn/);
  assert.match(await text(page, '#campbell'), /spin.axle \[rpm\]/);
  await page.locator('#campbell .mark').nth(12).click({ force: true });
  await says(page, '#mode', /kinetic energy[^]*blade\./);
  await page.selectOption('select[aria-label="Frequencies in"]', 'rad/s');
  assert.match(await text(page, '#campbell'), /frequency \[rad\/s\]/);
  await page.selectOption('select[aria-label="Lines of the rate up to"]', '0');
  assert.doesNotMatch(await text(page, '#campbell'), /per turn/);
  await page.selectOption('select[aria-label="Lines of the rate up to"]', '4');
  await page.selectOption('select[aria-label="Frequencies in"]', 'Hz');
  await shot(page, 'modes-light');
  await page.click('#theme');
  await shot(page, 'modes-dark');
  await page.close();
  await check_lines_of_the_rate(browser, folder, run, troubles);
  run('modes', join(scenes, 'two-link-slew.yaml'), '--lock', 'shoulder,elbow', '--out', join(folder, 'locked'));
  const single = await opened(browser, join(folder, 'locked/report.html'), 'theme=light', troubles);
  assert.ok(await single.locator('table.rows tbody tr').count() >= 2);
  assert.doesNotMatch(await text(single, '.answer'), /rigid/);
  await shot(single, 'modes-single');
  await single.close();
  // Rows have the numbers of modes.csv, where rigid motions come first.
  const free = join(folder, 'free');
  run('modes', join(scenes, 'two-link-slew.yaml'), '--out', free);
  const listed = readFileSync(join(free, 'modes.csv'), 'utf8').trim().split('\n').slice(1).map(line => line.split(',')), rigid = listed.filter(row => row[7] === '');
  assert.equal(rigid.length, 2);
  const rows = await opened(browser, join(free, 'report.html'), 'theme=light', troubles);
  assert.deepEqual(await rows.$$eval('table.rows tbody tr', all => all.map(r => r.children[0].textContent)), listed.slice(rigid.length, rigid.length + 10).map(row => row[2]));
  assert.match(await text(rows, '.answer'), /2 rigid motions are not listed/);
  await rows.close();
}

// Lines of the rate are inside the frame for rates of either sign, whichever way they are swept: from zero to both sides.
async function check_lines_of_the_rate(browser, folder, run, troubles) {
  for (const [rates, sides] of [['-60 rpm:60 rpm:5', 2], ['60 rpm:0 rpm:5', 1], ['-60 rpm:0 rpm:5', 1], ['30 rpm:60 rpm:5', 1]]) {
    const out = join(folder, `rates${rates.replaceAll(/[ :]/g, '_')}`);
    run('modes', join(scenes, 'rotating-blade.yaml'), '--sweep', `spin.axle=${rates}`, '--out', out);
    const page = await opened(browser, join(out, 'report.html'), 'theme=light', troubles);
    const frame = await page.locator('#campbell rect.frame').evaluate(e => { const { x, y, width, height } = e.getBBox(); return { x, y, width, height }; });
    const lines = await page.locator('#campbell path.harmonic').evaluateAll(all => all.map(e => { const b = e.getBBox(); return [b.x, b.y, b.x + b.width, b.y + b.height]; }));
    assert.equal(lines.length, 4 * sides, rates);
    for (const [left, top, right, foot] of lines)
      assert.ok(left > frame.x - 0.1 && right < frame.x + frame.width + 0.1 && top > frame.y - 0.1 && foot < frame.y + frame.height + 0.1, rates);
    await page.close();
  }
}

// The locus of a loop has a mark for each eigenvalue of its branches, and branches that end leave gaps.
async function check_loops(browser, folder, run, troubles) {
  const out = join(folder, 'loops');
  run('modes', join(scenes, 'manipulator-pid.yaml'), '--sweep', 'loads.hold_elbow.derivative=1:30:8', '--count', '12', '--out', out);
  const { runs, loops } = page_data(join(out, 'report.html')), points = JSON.parse(readFileSync(join(out, 'modes.json'))).runs[0].points;
  assert.equal(loops, true);
  let shown = 0;
  runs[0].branches.forEach((b, i) => b.at.forEach((m, k) => {
    const exact = points[k].modes.find(mode => mode.branch === i + 1);
    assert.equal(m === null, exact === undefined);
    if (!m) return;
    close(m.growth, exact.eigenvalue[0]);
    close(m.hertz, exact.eigenvalue[1] / 2 / Math.PI);
    close(m.natural, exact.hertz);
    close(m.damping_ratio, exact.damping_ratio);
    ++shown;
  }));
  assert.ok(runs[0].branches.some(b => b.at.includes(null)), 'a pair parts');
  const page = await opened(browser, join(out, 'report.html'), 'theme=light', troubles);
  assert.equal(await page.locator('#locus .mark').count(), shown);
  await page.locator('#locus .mark').first().dispatchEvent('click');  // others lie on top of it
  await says(page, '#mode', /hold_elbow\.integral[^]*growth -1\./);
  await shot(page, 'modes-loops');
  await page.close();
  // Of sampled loops too, with what is sampled said.
  const sampled = join(folder, 'sampled');
  run('modes', join(scenes, 'manipulator-pid.yaml'), '--sweep', 'loads.hold_wrist.sample=0.005:0.02:4', '--count', '14', '--out', sampled);
  const there = await opened(browser, join(sampled, 'report.html'), 'theme=light', troubles);
  assert.match(await text(there, '.answer'), /sampled every 0\.005 to 0\.02 s/);
  assert.ok(await there.locator('#locus .mark').count() >= 4 * 12);
  await shot(there, 'modes-sampled');
  await there.close();
}

// What stands beside a rotor sees the frequencies of blades.csv and the passing of blades; the other view is of one angle.
async function check_blades(browser, folder, run, troubles) {
  const scene = join(folder, 'turbine.yaml'), out = join(folder, 'blades');
  run('new', 'turbine', scene);
  run('modes', scene, '--blades', 'auto', '--sweep', 'spin.shaft=0:12 rpm:4', '--set', 'motions={}', '--set', 'loads={}', '--count', '8', '--out', out);
  const [{ blades, branches }] = page_data(join(out, 'report.html')).runs;
  assert.equal(blades.count, 3);
  const told = readFileSync(join(out, 'blades.csv'), 'utf8').trim().split('\n').slice(1).map(line => line.split(','));
  for (const m of blades.branches.flatMap(b => b.at).filter(Boolean)) {
    assert.ok(told.some(row => +row[1] === m.value && m.dominated_by.startsWith(row[3]) && Math.abs(row[5] - m.hertz) <= 1e-9 * m.hertz), `${m.dominated_by} at ${m.value}`);
  }
  assert.ok(blades.branches.every(b => b.at[0] === null), 'at rest nothing turns');
  const page = await opened(browser, join(out, 'report.html'), 'theme=light', troubles);
  const marks = () => page.locator('#campbell .mark').count();
  assert.equal(await marks(), blades.branches.flatMap(b => b.at).filter(Boolean).length);
  assert.match(await text(page, '#campbell'), /1 per turn[^]*3 per turn[^]*6 per turn/);
  for (const [most, lines] of [['4', ['1', '3']], ['12', ['1', '3', '6', '9', '12']], ['1', ['1']], ['0', []], ['6', ['1', '3', '6']]]) {
    await page.selectOption('select[aria-label="Lines of the rate up to"]', most);
    const drawn = await page.locator('#campbell text.harmonic').evaluateAll(all => all.map(e => e.textContent.split(' ')[0]));
    assert.deepEqual(drawn.sort((a, b) => a - b), lines, `up to ${most}`);
  }
  assert.match(await text(page, '#campbell'), /forward|backward|collective/);
  assert.doesNotMatch(await text(page, '.answer'), /one frozen angle/);
  await shot(page, 'blades-light');
  await page.selectOption('select[aria-label="Seen from"]', 'the blades, at one angle');
  assert.equal(await marks(), branches.flatMap(b => b.at).filter(Boolean).length);
  assert.match(await text(page, '#mode'), /kinetic energy/);
  assert.match(await text(page, '.answer'), /one frozen angle/);
  await page.close();
  run('modes', scene, '--floquet', '--spin', 'shaft=12 rpm', '--set', 'motions={}', '--set', 'loads={}', '--out', join(folder, 'turn'));
  const whole = await opened(browser, join(folder, 'turn/report.html'), 'theme=light', troubles);
  assert.match(await text(whole, '.scroll'), /The whole turn is (un)?stable \(Floquet/);
  await whole.close();
}

function write_plan(folder, name, text) {
  const file = join(folder, name);
  writeFileSync(file, `format: withy-sweep/1\nscene: ${join(scenes, 'two-link-slew.yaml')}\nset: {time.end: 1, integrator.rtol: 1e-5}\nseed: 7\nkeep: {final: [shoulder, elbow], peak: [link1.tip.deflection_y], history: {of: [elbow, link1.tip.deflection_y], every: 0.05 s}}\n${text}`);
  return file;
}

// Quantiles, histograms and cases are those of table.csv; failures are named.
async function check_sweep(browser, folder, run, troubles) {
  const out = join(folder, 'sweep');
  const plan = write_plan(folder, 'the plan.yaml', 'vary:\n  loads.slew.time_scale: {grid: [0.5, 0.8, 1.0]}\n  bodies.link1.mass_per_length: {normal: {mean: 1.33937, deviation: 0.05}}\n  bodies.link2.bending_y.stiffness: {uniform: {from: 8, to: 20}}\ncases: 60\n');
  run('sweep', 'run', plan, '--out', out);
  const data = page_data(join(out, 'report.html'));
  const [head, ...rows] = readFileSync(join(out, 'table.csv'), 'utf8').trim().split('\n').map(l => l.split(','));
  for (const column of data.columns) {
    const own = rows.map(r => +r[head.indexOf(column.name)]).sort((a, b) => a - b);
    assert.equal(own.length, 180);
    close(column.least, own[0]);
    close(column.greatest, own[179]);
    close(column.median, (own[89] + own[90]) / 2);
    assert.equal(column.bins.reduce((a, b) => a + b), 180);
    const width = (own[179] - own[0]) / 24;
    close(column.bins[0], own.filter(x => x < own[0] + width).length);
  }
  const peak = 'peak.link1.tip.deflection_y[m]', slow = data.envelopes['loads.slew.time_scale'][peak].find(l => l.at === 0.5);
  assert.equal(slow.count, 60);
  close(slow.greatest, Math.max(...rows.filter(r => +r[head.indexOf('loads.slew.time_scale')] === 0.5).map(r => +r[head.indexOf(peak)])));
  // The end of each history is the final value of the same cases.
  const last = data.histories.find(h => h.name === 'elbow[rad]' && h.of['loads.slew.time_scale'] === '0.8').rows;
  assert.deepEqual(last.map(r => r[0]).slice(0, 3), [0, 0.05, 0.1]);
  const ends = rows.filter(r => +r[head.indexOf('loads.slew.time_scale')] === 0.8).map(r => +r[head.indexOf('final.elbow[rad]')]).sort((a, b) => a - b);
  assert.equal(last.at(-1)[1], 60);
  [[2, ends[0]], [5, (ends[29] + ends[30]) / 2], [8, ends[59]]].forEach(([k, expected]) => close(last.at(-1)[k], expected));
  const narrow = Math.max(...last.map(r => r[8] - r[2])) < 0.1 * (Math.max(...last.map(r => r[5])) - Math.min(...last.map(r => r[5])));
  const page = await opened(browser, join(out, 'report.html'), 'theme=light', troubles);
  const over_time = page.locator('section', { hasText: 'Over time' });
  assert.equal(await over_time.locator('figcaption', { hasText: 'time_scale = 0.8' }).count(), narrow ? 2 : 1, 'a figure a point of the grid, and one about the median where bands are narrow');
  await over_time.locator('select').selectOption('link1.tip.deflection_y[m]');
  await over_time.locator('svg').first().hover();
  await says(page, '#note', /t = [\d.]+ s, 60 cases[^]*median/);
  assert.match(await text(page, '.answer'), /180 cases: 180 done, 0 of them failed/);
  // The first point of the first pair, brought to where the pointer can reach it.
  const place = await page.locator('.pairs svg g:has(circle)').first().evaluate(g => {
    const d = /^M([\d.]+) ([\d.]+)/.exec(g.querySelector('path').getAttribute('d'));
    const here = () => new DOMPoint(+d[1], +d[2]).matrixTransform(g.getScreenCTM());
    scrollBy(0, here().y - 300);
    const { x, y } = here();
    return { x, y };
  });
  await page.mouse.move(place.x, place.y);
  await says(page, '#note', /case \d+/);
  await page.mouse.click(place.x, place.y);
  await says(page, '#case', /withy sweep case '.*the plan.yaml' \d+/);
  await shot(page, 'sweep-light');
  await page.click('#theme');
  await shot(page, 'sweep-dark');
  await page.close();
}

// Where all cases lie close together both ends of an axis are told apart, and so are the numbers of notes and tables.
async function check_narrow(browser, folder, run, troubles) {
  const out = join(folder, 'narrow');
  run('sweep', 'run', write_plan(folder, 'narrow.yaml', 'vary:\n  bodies.link1.mass_per_length: {uniform: {from: 1.33997, to: 1.34003}}\ncases: 6\n'), '--out', out);
  const page = await opened(browser, join(out, 'report.html'), 'theme=light', troubles), { columns } = page_data(join(out, 'report.html'));
  const ends = await page.$$eval('.pairs text:not(.name)', all => all.map(e => e.textContent));
  for (const c of columns) for (const v of [c.least, c.greatest]) assert.equal(ends.filter(e => Math.abs(e - v) < 2e-3 * (c.greatest - c.least)).length, 2, `${c.name}: ${v} of ${ends}`);
  const tables = await page.$$eval('table.rows tr', rows => rows.map(r => [...r.children].map(e => e.textContent))), [head] = tables;
  for (const row of tables.slice(1)) assert.notEqual(row[head.indexOf('least')], row[head.indexOf('greatest')], row.join());
  await shot(page, 'narrow-light');
  await page.close();
}

// Bars are the rows of indices.csv.
async function check_indices(browser, folder, run, troubles) {
  const out = join(folder, 'sobol');
  const plan = write_plan(folder, 'sobol.yaml', 'design: saltelli\nvary:\n  bodies.link1.mass_per_length: {uniform: {from: 1.2, to: 1.5}}\n  bodies.link1.bending_y.stiffness: {uniform: {from: 60, to: 120}}\n  loads.slew.time_scale: {uniform: {from: 0.4, to: 1.3}}\ncases: 16\n');
  run('sweep', 'run', plan, '--out', out);
  const page = await opened(browser, join(out, 'report.html'), 'theme=light', troubles);
  const names = await page.$$eval('section:first-of-type figcaption', all => all.map(f => f.textContent));
  assert.ok(names.some(n => /Sobol index, alone/.test(n)) && names.some(n => /total/.test(n)), names.join());
  assert.equal(await page.locator('section:first-of-type figure').first().locator('rect').count(), 3);
  await shot(page, 'sobol-light');
  await page.close();
}

// Bars of one value at a time: values in a few digits, and what is negative is told beside its bar, with its sign.
async function check_one_at_a_time(browser, folder, run, troubles) {
  const out = join(folder, 'oat');
  const plan = write_plan(folder, 'oat.yaml', 'design: one-at-a-time\nvary:\n  bodies.link1.mass_per_length: {normal: {mean: 1.33937, deviation: 0.05}}\n  loads.slew.time_scale: {uniform: {from: 0.4, to: 1.3}}\n');
  run('sweep', 'run', plan, '--out', out);
  const [head, ...rows] = readFileSync(join(out, 'indices.csv'), 'utf8').trim().split('\n').map(l => l.split(','));
  const of = name => head.indexOf(name), own = rows.filter(r => r[of('result')] === 'final.shoulder[rad]');
  const page = await opened(browser, join(out, 'report.html'), 'theme=light', troubles);
  const bars = await page.locator('section:first-of-type figure').first().evaluate(figure => {
    const all = [...figure.querySelectorAll('svg > text')], rects = [...figure.querySelectorAll('svg > rect')].map(r => r.getBBox());
    const names = all.filter(t => t.classList.contains('name')).map(t => t.textContent);
    return all.filter(t => t.classList.contains('soft')).map((t, i) => ({ name: names[i], value: t.textContent, left: t.getBBox().x, right: t.getBBox().x + t.getBBox().width, bar: [rects[i].x, rects[i].x + rects[i].width] }));
  });
  assert.equal(bars.length, own.length);
  assert.ok(bars.some(b => b.value.startsWith('-')) && bars.some(b => !b.value.startsWith('-')), 'some fall and some rise');
  for (const b of bars) {
    assert.match(b.name, /^[\w.]+ = -?\d*\.?\d{1,5}$/);
    const told = own.find(r => b.name.startsWith(`${r[of('parameter')]} = `) && Math.abs(b.name.split(' = ')[1] / r[of('value')] - 1) < 1e-3);
    assert.ok(Math.abs(b.value / told[of('difference')] - 1) < 5e-3, `${b.name}: ${b.value}`);
    assert.ok(b.value.startsWith('-') ? b.right <= b.bar[0] : b.left >= b.bar[1], `${b.name}: ${b.value} lies on its bar`);
  }
  await shot(page, 'oat-light');
  await page.close();
}

// Nobody scrolls on paper.
async function check_printed_whole(page) {
  const heights = () => page.$eval('.said', e => [e.scrollHeight, e.clientHeight]);
  await page.$eval('.said', e => { e.textContent = 'a line\n'.repeat(400); });
  const [lines, shown] = await heights();
  assert.ok(lines > 2 * shown, 'on the screen it scrolls');
  await page.emulateMedia({ media: 'print' });
  const [printed, seen] = await heights();
  assert.equal(printed, seen, 'all lines are printed');
}

// On the page of a phone figures have letters that can be read, tables keep their lines, and nothing is wider than it.
async function check_narrow_page(page, name) {
  const before = page.viewportSize();
  await page.setViewportSize({ width: 420, height: 900 });
  await page.waitForFunction(() => [...document.querySelectorAll('.study-figure svg')].every(svg => svg.getScreenCTM().a > 0.99));
  const sizes = await page.$$eval('.study-figure text', all => all.map(e => parseFloat(getComputedStyle(e).fontSize) * e.ownerSVGElement.getScreenCTM().a));
  assert.ok(Math.min(...sizes) > 10.5, `letters of ${Math.min(...sizes)} px on the page of ${name}`);
  const lines = await page.$$eval('.said .columns', all => all.map(e => [e.textContent.replace(/\n$/, '').split('\n').length, Math.round(e.getBoundingClientRect().height / parseFloat(getComputedStyle(e).lineHeight))]));
  if (name === 'response') assert.ok(lines.length > 0);
  for (const [written, seen] of lines) assert.ok(seen <= written + 1, `${written} lines of a table take ${seen}`); // and a bar to scroll with
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `the page of ${name} is too wide`);
  await page.setViewportSize(before);
}

// Words and curves of the files: each point told by the pointer, curves taken away by their names.
async function check_figures(browser, folder, run, troubles) {
  const measured = join(scenes, 'measured/pendulum.csv');
  run('terms', join(scenes, 'two-link-slew.yaml'), '--set', 'time.end=1', '--out', join(folder, 'terms'));
  run('tune', join(scenes, 'pendulum.yaml'), '--match', measured, '--parameters', 'bodies.rod.center_of_mass.1', '--out', join(folder, 'tune'));
  run('response', join(scenes, 'pd-arm.yaml'), '--input', 'control.elbow', '--out', join(folder, 'response'));
  run('advise', join(scenes, 'pendulum.yaml'), '--accuracy', '1%', '--out', join(folder, 'advise'));
  const expected = {
    terms: [/rms %/, 2], tune: [/center_of_mass/, 1], response: [/phase may lag by/, 3], advise: [/advice/, 1],
  };
  for (const [name, [words, figures]] of Object.entries(expected)) {
    const page = await opened(browser, join(folder, name, 'report.html'), 'theme=light', troubles);
    assert.match(await text(page, '.said'), words, name);
    const panels = page_data(join(folder, name, 'report.html')).pictures.flatMap(p => p.panels);
    assert.ok(panels.length >= figures, `${panels.length} figures of ${name}`);
    assert.equal(await page.locator('.study-figure').count(), panels.length);
    const drawn = await page.$$eval('.study-figure path', all => all.filter(p => p.getAttribute('d').length > 3).length);
    assert.ok(drawn >= panels.reduce((sum, p) => sum + p.curves.length, 0), `${drawn} curves of ${name}`);
    // Names are told apart by dashes: a sample of a line shows all of them.
    const samples = await page.$$eval('.legend path[stroke-dasharray]', all => all.map(p => [p.getTotalLength() * p.ownerSVGElement.getScreenCTM().a, p.getAttribute('stroke-dasharray')]));
    if (name === 'terms') assert.ok(samples.length > 2, 'a line for each term');
    for (const [length, dashes] of samples) assert.ok(length >= dashes.split(' ').reduce((sum, d) => sum + +d, 0), `${length} px of ${dashes} on the page of ${name}`);
    await shot(page, `${name}-light`);
    await check_narrow_page(page, name);
    await check_printed_whole(page);
    await page.close();
  }
  // The dots of a fit are the measurement, in degrees where it is in radians.
  const rows = readFileSync(join(folder, 'tune/fit.csv'), 'utf8').trim().split('\n').map(l => l.split(','));
  const [panel] = page_data(join(folder, 'tune/report.html')).pictures[0].panels, dots = panel.curves.find(c => c.points);
  assert.equal(dots.name, 'measured');
  const factor = panel.y.endsWith('[deg]') ? 180 / Math.PI : 1;
  dots.x.forEach((t, i) => { close(t, +rows[i + 1][0]); assert.ok(Math.abs(dots.y[i] - factor * rows[i + 1][1]) < 1e-9 * (1 + Math.abs(dots.y[i]))); });
  const page = await opened(browser, join(folder, 'tune/report.html'), 'theme=dark', troubles);
  const frame = await page.locator('.study-figure svg').first().boundingBox();
  await page.mouse.move(frame.x + frame.width / 2, frame.y + frame.height / 2);
  for (let k = 0; k < 40; ++k) await page.mouse.move(frame.x + frame.width / 2, frame.y + frame.height * (0.1 + 0.02 * k));
  await says(page, '#note', /t \[s\]: /);
  const paths = await page.locator('.study-figure path').count();
  await page.locator('.legend .chip', { hasText: 'measured' }).click();
  await page.waitForFunction(before => document.querySelectorAll('.study-figure path').length < before, paths);
  await page.close();
}

// Where nothing acts there is a sentence, and no axis of numbers that are none.
async function check_nothing(browser, folder, run, troubles) {
  const file = join(folder, 'still.yaml');
  writeFileSync(file, `format: withy/1
time: {end: 1, output: 0.1}
bodies: {b: {type: beam, length: 1, mass_per_length: 1, bending_z: {stiffness: 0.5, modes: 2, family: clamped-free}}}
hinges: {j: {type: revolute, axis: [0, 1, 0], parent: world, child: b}}
`);
  run('terms', file, '--out', join(folder, 'still-terms'));
  const page = await opened(browser, join(folder, 'still-terms/report.html'), 'theme=light', troubles);
  assert.equal(await page.locator('.study-figure').count(), 0);
  assert.deepEqual(await page.$$eval('.figures p', all => all.map(e => e.textContent)), ['hinges', 'bending'].map(name => `${name} [N/sqrt(kg)]: zero throughout, but for rounding.`));
  await page.close();
  // Errors of zero stand at 0, and there is no line of a reference that is off by nothing.
  run('trade', file, '--modes', '1,2', '--tolerances', '1e-4', '--integrators', 'dopri5', '--out', join(folder, 'still-trade'));
  const trade = await opened(browser, join(folder, 'still-trade/report.html'), 'theme=light', troubles);
  const names = await trade.$$eval('.figures .axes text', all => all.map(e => e.textContent));
  assert.ok(names.includes('0') && !names.some(name => /^\d+e/.test(name)), names.join());
  assert.doesNotMatch(await text(trade, '#study'), /error of the reference|dotted line/);
  await trade.close();
}

// What motors have to give is on the page of the run that tells it.
async function check_inverse(browser, folder, run, troubles) {
  const out = join(folder, 'inverse');
  run('inverse', join(scenes, 'spin-up.yaml'), '--set', 'time.end=2', '--out', out);
  const page = await opened(browser, join(out, 'report.html'), 't=1&theme=light', troubles);
  assert.match(await text(page, '#charts'), /Effort of motions, N m/);
  await shot(page, 'inverse-light');
  await page.close();
}

check_log_ticks();
check_zeros();
check_numbers();
check_names();
check_names_of_lines();
await in_browser(withy, chromium, async (browser, folder, run) => {
  const troubles = [];
  for (const check of [check_inverse, check_trade, check_modes, check_loops, check_blades, check_sweep, check_narrow, check_indices, check_one_at_a_time, check_figures, check_nothing]) await check(browser, folder, run, troubles);
  assert.deepEqual(troubles, []);
  console.log('the pages of studies show what their files say');
});
