// The site of the documentation, opened from disk: search finds, nothing is asked of the network.
//   node site_test.mjs SITE CHROMIUM [PICTURES]
import assert from 'node:assert/strict';
import { join, resolve } from 'node:path';
import { chromium } from 'playwright-core';

const [site, browser_path, pictures] = process.argv.slice(2).map(path => resolve(path));
const browser = await chromium.launch({ executablePath: browser_path, args: ['--no-sandbox', '--disable-background-networking', '--disable-component-update'] });
try {
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 } }), asked = [];
  page.on('request', r => { if (!/^(file|data):/.test(r.url())) asked.push(r.url()); });
  await page.goto(`file://${site}/index.html`);
  assert.match(await page.textContent('body'), /Tutorial: from a pendulum/);
  if (pictures) await page.screenshot({ path: join(pictures, 'site.png') });
  await page.goto(`file://${site}/search.html?q=foreshortening`);
  await page.waitForSelector('#search-results li a', { timeout: 20000 });
  const found = await page.$$eval('#search-results li a', all => all.map(a => a.getAttribute('href').split(/[?#]/)[0]));
  assert.ok(found.includes('theory.html') && found.includes('glossary.html'), found.join());
  await page.goto(`file://${site}/tutorial.html`);
  if (pictures) await page.screenshot({ path: join(pictures, 'site-tutorial.png') });
  assert.deepEqual(asked, []);
  console.log('the site opens from disk and is searched');
} finally {
  await browser.close();
}
