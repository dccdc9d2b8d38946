// How long the page of a long run takes to open: 1e5 rows of 124 columns, 40 MB as they are and drawn by extremes.
//   node load_bench.mjs WITHY SCENES CHROMIUM
import { statSync } from 'node:fs';
import { join } from 'node:path';
import { in_browser } from './browser.mjs';

const [withy, scenes, chromium] = process.argv.slice(2);
await in_browser(withy, chromium, async (browser, folder, run) => {
  run('run', join(scenes, 'loads-of-the-slew.yaml'), '--set', 'time.output=3.8e-5', '--no-hdf5', '--out', folder, '--force');
  const file = join(folder, 'report.html'), times = [];
  for (let i = 0; i < 7; ++i) {
    const page = await browser.newPage({ viewport: { width: 1200, height: 900 } }), begin = performance.now();
    await page.goto(`file://${file}#t=0`);
    await page.waitForSelector('body[data-ready]');
    // Two frames later what is in sight has been drawn.
    await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
    times.push((performance.now() - begin) / 1000);
    await page.close();
  }
  times.sort((a, b) => a - b);
  const megabytes = path => (statSync(path).size / 1e6).toFixed(1);
  console.log(`report.html of ${megabytes(file)} MB (results.csv ${megabytes(join(folder, 'results.csv'))} MB): open in ${times[0].toFixed(2)} s at least, ${times[3].toFixed(2)} s in the middle of ${times.length}`);
});
