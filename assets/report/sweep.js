// The summary page of a sweep: one table, and plots of a figure over a key, a curve for each combination of the other keys.
const TABLE = JSON.parse(document.getElementById('data').textContent), PAGE = document.getElementById('page');
const COLORS = ['#1a52a8', '#c96a08', '#1a8066', '#8c338c', '#bf2929', '#5b6475', '#0f8aa0', '#7a6a00'];
function el(tag, text, parent, cls) { const n = document.createElement(tag); if (text !== undefined) n.textContent = text; if (cls) n.className = cls; if (parent) parent.append(n); return n; }
const short = v => typeof v === 'number' ? String(+v.toPrecision(4)) : v === undefined || v === null ? '–' : String(v);
document.getElementById('notice').textContent = TABLE.notice;
document.title = `Sweep of ${TABLE.title}`;
el('h1', `Sweep of ${TABLE.title}`, PAGE);
el('p', `${TABLE.cases.length} cases over ${TABLE.keys.join(', ')}; ${TABLE.cases.filter(c => c.status === 'finished').length} finished`, PAGE, 'sub');

// What can be plotted: the clinical figures, else last and largest values of the columns that differ between cases.
const quantities = TABLE.figures.map(f => ({name: f.label, unit: f.unit, of: c => (c.figures || {})[f.key] === undefined ? undefined : c.figures[f.key] * f.factor}));
if (!quantities.length) for (const group of ['last', 'largest']) {
  const names = new Set(TABLE.cases.flatMap(c => Object.keys(c[group] || {})));
  for (const name of names) if (new Set(TABLE.cases.map(c => (c[group] || {})[name])).size > 1) quantities.push({name: `${name}, ${group}`, unit: 'SI', of: c => (c[group] || {})[name]});
}
const plots = el('section', undefined, PAGE);
el('h2', 'Plots', plots);
const buttons = el('div', undefined, plots, 'buttons'), choose = el('select', undefined, buttons), against = el('select', undefined, buttons), area = el('div', undefined, plots, 'charts');
quantities.forEach((q, i) => { el('option', q.name, choose).value = i; });
TABLE.keys.forEach(k => { el('option', k, against).value = k; });
function plotOf(quantity, key) {
  const groups = new Map();
  for (const c of TABLE.cases) {
    const x = c.settings[key], y = quantity.of(c);
    if (typeof x !== 'number' || typeof y !== 'number') continue;
    const group = TABLE.keys.filter(k => k !== key).map(k => `${k.split('.').pop()}=${short(c.settings[k])}`).join(' ');
    groups.set(group, (groups.get(group) || []).concat([[x, y]]));
  }
  const curves = [...groups].map(([name, points], i) => { points.sort((a, b) => a[0] - b[0]); return {name, color: COLORS[i % COLORS.length], time: points.map(p => p[0]), value: points.map(p => p[1])}; });
  const figure = document.createElement('figure'), node = chart(quantity.name, quantity.unit, curves.map(c => ({...c, name: ''})));
  [...node.querySelectorAll('text')].filter(t => t.textContent === 's').forEach(t => { t.textContent = key; });
  figure.append(node);
  const legend = el('figcaption', undefined, figure);
  curves.forEach(c => { const s = el('span', `● ${c.name || key}  `, legend); s.style.color = c.color; });
  return figure;
}
function draw() {
  area.replaceChildren();
  if (!quantities.length) { el('p', 'nothing to plot yet', area); return; }
  area.append(plotOf(quantities[choose.value || 0], against.value));
  quantities.slice(0, 4).forEach((q, i) => { if (i !== +choose.value) area.append(plotOf(q, against.value)); });
}
choose.addEventListener('change', draw); against.addEventListener('change', draw);
draw();
const section = el('section', undefined, PAGE, 'long');
el('h2', 'Cases', section);
const table = el('table', undefined, section), head = el('tr', undefined, el('thead', undefined, table)), body = el('tbody', undefined, table);
const shown = quantities.slice(0, 12);
for (const name of [...TABLE.keys, 'status', 'minutes', ...shown.map(q => `${q.name} [${q.unit}]`)]) el('th', name, head);
for (const c of TABLE.cases) {
  const row = el('tr', undefined, body);
  for (const k of TABLE.keys) el('td', short(c.settings[k]), row, 'n');
  el('td', c.status, row); el('td', short((c.wall_seconds || 0) / 60), row, 'n');
  for (const q of shown) el('td', short(q.of(c)), row, 'n');
}
el('footer', TABLE.notice, PAGE);
