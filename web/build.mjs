// Makes the page: all scripts and styles in one HTML file, the scripts compressed.
//   node build.mjs OUT.html
import { gzipSync } from 'node:zlib';
import { readFileSync, mkdirSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, 'report.html');
const read = (...path) => readFileSync(join(here, ...path), 'utf8');

const bundle = await build({
  entryPoints: [join(here, 'src/main.js')],
  bundle: true,
  minify: true,
  format: 'iife',
  target: ['chrome100', 'firefox113', 'safari16.4'],
  legalComments: 'none', // the licences stand in the page whole
  write: false,
});
const script = gzipSync(bundle.outputFiles[0].contents, { level: 9 }).toString('base64');
const style = (await build({
  stdin: { contents: read('node_modules/uplot/dist/uPlot.min.css') + read('src/page.css'), loader: 'css' },
  minify: true,
  write: false,
})).outputFiles[0].text;
const licences = [['three.js', 'three'], ['uPlot', 'uplot']]
  .map(([name, folder]) => `${name}\n\n${read('node_modules', folder, 'LICENSE').trim()}`)
  .join('\n\n\n')
  .replaceAll('&', '&amp;')
  .replaceAll('<', '&lt;');

const page = read('src/page.html')
  .replace('/* style */', () => style)
  .replace('<!-- licences -->', () => licences)
  .replace('/* script */', () => script);
mkdirSync(dirname(out), { recursive: true });
writeFileSync(out, page);
