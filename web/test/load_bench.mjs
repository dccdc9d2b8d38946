// How long the page of a long run takes to open: 1e5 rows of 124 columns, drawn by extremes. Opening an
// empty page takes half a second of CPU time.
//   node load_bench.mjs WITHY SCENES CHROMIUM
import { statSync } from 'node:fs';
import { join } from 'node:path';
import { in_browser } from './browser.mjs';

const [withy, scenes, chromium] = process.argv.slice(2);
await in_browser(withy, chromium, async (browser, folder, run) => {
  run('run', join(scenes, 'loads-of-the-slew.yaml'), '--set', 'time.output=3.8e-5', '--no-hdf5', '--out', folder, '--force');
  const file = join(folder, 'report.html'), times = [], costs = [];
  const session = await browser.newBrowserCDPSession();
  const processes = async () => new Map((await session.send('SystemInfo.getProcessInfo')).processInfo.map(p => [p.id, p.cpuTime]));
  for (let i = 0; i < 7; ++i) {
    const before = await processes(), begin = performance.now();
    const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
    await page.goto(`file://${file}#t=0`);
    await page.waitForSelector('body[data-ready]');
    // Two frames later what is in sight has been drawn.
    await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
    times.push((performance.now() - begin) / 1000);
    costs.push([...await processes()].reduce((sum, [id, seconds]) => sum + seconds - (before.get(id) ?? 0), 0));
    await page.close();
  }
  const least = all => Math.min(...all).toFixed(2), megabytes = path => (statSync(path).size / 1e6).toFixed(1);
  console.log(`report.html of ${megabytes(file)} MB (results.csv ${megabytes(join(folder, 'results.csv'))} MB): open in ${least(times)} s, ${least(costs)} s of CPU time of all processes of the browser; the least of ${times.length}`);
});
