// What is said in words: the certificate, the numbers of each run, its scene, and what it was made with.

const element = (name, text, attributes = {}) => {
  const e = document.createElement(name);
  if (text != null) e.textContent = text;
  for (const [key, value] of Object.entries(attributes)) e.setAttribute(key, value);
  return e;
};
export { element };

// What stands between backticks is to be typed.
function with_code(holder, text) {
  `${text}`.split('`').forEach((part, i, all) => holder.append(i % 2 && i + 1 < all.length ? element('code', part) : part));
  return holder;
}

// "modelled    what it is": the program's two columns, where a line without the first belongs to the one before. A name
// of a body may be longer than its column, and has no blanks.
export function certificate_rows(text) {
  const rows = [];
  for (const line of text.split('\n')) {
    if (!line.trim() || line === 'certificate') continue;
    const end = line.indexOf(' ', 23), name = line.slice(0, end).trim(), rest = line.slice(end).trim();
    if (name) rows.push([name, [rest]]); else rows[rows.length - 1]?.[1].push(rest);
  }
  return rows;
}

function table_of(rows) {
  const table = element('table');
  for (const [name, values] of rows) {
    const row = element('tr'), cell = element('td');
    for (const value of [values].flat()) cell.append(with_code(element('div'), value));
    row.append(element('th', name, { scope: 'row' }), cell);
    table.append(row);
  }
  return table;
}

const plain = v => typeof v === 'number' ? (v !== 0 && (Math.abs(v) < 1e-3 || Math.abs(v) >= 1e6) ? v.toExponential(2) : `${+v.toPrecision(6)}`) : `${v}`;

export function write_words(holder, runs) {
  for (const run of runs) {
    const r = run.run, part = element('article');
    part.append(element('h2', runs.length > 1 ? run.label : 'Certificate'));
    if (runs.length > 1) part.append(element('p', run.outcome, { class: `state ${r.status}` }));
    if (r.message) part.append(element('p', r.message, { class: r.status === 'completed' ? 'told' : 'message' }));
    part.append(table_of(certificate_rows(run.certificate)));
    const rows = [['integrator', r.integrator], ['energy drift', plain(r.energy_drift)],
      ['steps', `${r.steps} (${r.rejected_steps} rejected), ${r.evaluations} evaluations`], ['CPU time', `${plain(r.cpu_seconds)} s`]];
    for (const [body, d] of Object.entries(r.peaks?.tip_deflection ?? {}))
      rows.push([`peak deflection ${body}`, `y ${plain(d.y)} m, z ${plain(d.z)} m`]);
    for (const [name, o] of Object.entries(r.outputs ?? {}))
      rows.push([`range of ${name}`, `${plain(o.min.value)} at ${plain(o.min.t)} s to ${plain(o.max.value)} at ${plain(o.max.t)} s ${o.unit === '1' ? '' : o.unit}`]);
    for (const e of r.events ?? []) rows.push([`event ${e.name}`, `${plain(e.time)} s${e.direction ? `, ${e.direction}wards` : ''}`]);
    for (const [name, e] of Object.entries(r.acted ?? {})) if (e.energy_lost) rows.push([`energy lost in ${name}`, `${plain(e.energy_lost)} J`]);
    const more = element('details');
    more.append(element('summary', 'Numbers of the run'), table_of(rows));
    part.append(more);
    holder.append(part);
  }
}

export function write_sources(holder, runs) {
  holder.append(element('h2', 'Scene and versions'));
  for (const run of runs) {
    const r = run.run, part = element('details');
    part.append(element('summary', `${runs.length > 1 ? `${run.label}: ` : ''}${r.scene}`));
    const program = r.program ?? {};
    const rows = [['formulation', r.formulation], ['integrator', r.integrator]];
    if (r.set?.length) rows.push(['set', r.set]);
    rows.push(['program', `withy ${program.version ?? ''} ${program.git ?? ''}`], ['scene, SHA-256', r.scene_sha256], ['fingerprint', r.fingerprint]);
    if (r.files?.length) rows.push(['files', r.files.map(f => `${f.path}  ${f.sha256}`)]);
    if (r.plugins?.length) rows.push(['plugins', r.plugins.map(p => `${p.id ?? ''}  ${p.version ?? ''}`)]);
    rows.push(['table', `${run.table.rows} rows, ${run.table.columns.length} columns` + (run.table.stride > 1 ? `; drawn here by the least and the greatest of each ${run.table.stride} rows` : '')]);
    part.append(table_of(rows.filter(([, v]) => v)), element('pre', run.scene, { class: 'scene' }));
    holder.append(part);
  }
}
