// What the tests of pages share: a browser, a folder for results, and the program.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

// A machine with other work to do is slow, not wrong: waits end with what they wait for, or here [ms].
const patience = 200000;

export const text = (page, selector) => page.textContent(selector);

// Waits until the text of an element is like a pattern.
export const says = (page, selector, pattern) =>
  page.waitForFunction(([at, source]) => new RegExp(source).test(document.querySelector(at)?.textContent ?? ''), [selector, pattern.source]);

// A page as it stands on disk; what it complains of or asks for goes to `troubles`.
export async function opened(browser, file, hash, troubles) {
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  page.setDefaultTimeout(patience);
  page.on('console', m => troubles.push(`console: ${m.text()}`));
  page.on('pageerror', e => troubles.push(`error: ${e.stack}`));
  page.on('request', r => { if (!/^(file|data):/.test(r.url())) troubles.push(`request: ${r.url()}`); });
  await page.goto(`file://${file}#${hash}`);
  await page.waitForSelector('body[data-ready]');
  return page;
}

// Calls check(browser, folder, run).
export async function in_browser(withy, executablePath, check) {
  const folder = mkdtempSync(join(tmpdir(), 'withy-page-'));
  const run = (...words) => execFileSync(withy, words, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
  let browser;
  try {
    browser = await chromium.launch({
      executablePath,
      timeout: patience,
      args: ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update',
        '--disable-sync', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
    });
    await check(browser, folder, run);
  } finally {
    await browser?.close();
    rmSync(folder, { recursive: true });
  }
}
