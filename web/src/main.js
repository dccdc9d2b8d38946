// The page begins: it holds runs, or a study.
import { show_runs } from './runs.js';
import { show_study } from './studies/study.js';

const page = JSON.parse(document.getElementById('withy-data').textContent);
if (page.format === 'withy-study/1') show_study(page); else show_runs(page);
