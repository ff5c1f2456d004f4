// Lays out the page from the data.
const DATA = JSON.parse(document.getElementById('data').textContent), RUNS = DATA.runs, MANY = RUNS.length > 1;
const VIEWERS = [], COLORS = ['#1a52a8', '#c96a08', '#1a8066', '#8c338c'], DASH = ['', '6 3', '2 3', '8 3 2 3'];
function el(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const key in attributes || {}) key === 'text' ? node.textContent = attributes[key] : node.setAttribute(key, attributes[key]);
  for (const child of children) if (child !== null && child !== undefined) node.append(child);
  return node;
}
function section(title, cls) { const s = el('section', {class: cls || ''}, el('h2', {text: title})); document.getElementById('page').append(s); return s; }
function num(v, digits) { return v === null || v === undefined || !Number.isFinite(v) ? '–' : String(+v.toPrecision(digits || 4)); }
function series(run, name, factor) {
  const s = run.series || {};
  return s[name] ? {time: s.time, value: s[name].map(v => v === null ? NaN : v * (factor || 1))} : null;
}
function minutes(m) { return m < 1 ? `${num(60 * m, 2)} s` : m < 90 ? `${num(m, 2)} min` : m < 2880 ? `${num(m / 60, 2)} h` : `${num(m / 1440, 2)} days`; }
const has = key => RUNS.some(r => r[key] && (!Array.isArray(r[key]) || r[key].length));

function heading() {
  document.getElementById('notice').textContent = DATA.notice;
  const title = MANY ? RUNS.map(r => r.title).join('  |  ') : RUNS[0].title;
  document.title = title;
  document.getElementById('page').append(el('h1', {text: title}), el('p', {class: 'sub', text: RUNS.map(r =>
    `${r.status} at ${num(r.end)} ${r.status === 'finished' ? 's' : 's planned'} · ${r.frames} frames · spacing ${num(1000 * r.spacing)} mm · ${r.scheme} scheme · cusp ${r.version}`).join('  |  ')}));
}
function pictures() {
  if (!has('movie') && !has('pictures')) return;
  const s = section(has('movie') ? 'Movie and stills' : 'Stills'), grid = el('div', {class: 'two'});
  RUNS.forEach((r, k) => { if (r.movie) s.append(el('figure', {}, el('video', {controls: '', muted: '', loop: '', playsinline: '', src: r.movie}), el('figcaption', {text: MANY ? r.title : 'Blood pressure and leaflet stress over the run'}))); });
  for (const r of RUNS) for (const p of r.pictures || []) grid.append(el('figure', {class: 'still'}, el('img', {src: p.data, alt: p.name}), el('figcaption', {text: `${MANY ? r.title + ', ' : ''}${p.name}, ${num(p.time, 3)} s`})));
  s.append(el('p'), grid);
}
function models() {
  if (!has('model')) return;
  const s = section('The stressed valve: turn it with the mouse'), grid = el('div', {class: MANY ? 'two' : ''});
  s.append(grid);
  for (const r of RUNS) {
    if (!r.model) continue;
    const canvas = el('canvas', {'aria-label': 'model of the valve'}), box = el('div', {class: 'viewer'}, canvas), buttons = el('div', {class: 'buttons'});
    box.append(buttons); grid.append(MANY ? el('div', {}, el('h3', {text: r.title}), box) : box);
    let viewer;
    try { viewer = new Viewer(canvas, r.model); } catch (error) { box.prepend(el('p', {class: 'warn', text: `The model can’t be drawn here: ${error.message}.`})); continue; }
    VIEWERS.push(viewer);
    viewer.file.scenes.forEach((scene, k) => {
      const b = el('button', {class: k ? '' : 'on', text: `${scene.name} (${num(r.model.times[k], 3)} s)`});
      b.addEventListener('click', () => { viewer.scene = k; buttons.querySelectorAll('.on').forEach(o => o.classList.remove('on')); b.classList.add('on'); viewer.draw(); });
      buttons.append(b);
    });
    const reset = el('button', {text: 'reset view'});
    reset.addEventListener('click', () => { viewer.reset(); viewer.draw(); });
    buttons.append(reset, el('a', {class: 'button', download: 'valve.glb', href: 'data:model/gltf-binary;base64,' + r.model.glb, text: 'save as GLB'}),
      el('span', {class: 'scale'}, '0', el('i'), `${num(r.model.top / 1000, 3)} kPa von Mises`));
  }
}
function corridor(f) {
  if (f.low === null && f.high === null) return '';
  return f.low === null ? `< ${f.high}` : f.high === null ? `> ${f.low}` : `${f.low} – ${f.high}`;
}
function figures() {
  if (!has('clinical')) return;
  const s = section('Clinical figures beside normal corridors', 'long'), head = el('tr', {}, el('th', {text: 'figure'}));
  for (const r of RUNS) head.append(el('th', {class: 'n', text: MANY ? r.title : 'value'}));
  if (MANY) head.append(el('th', {class: 'n', text: 'change'}));
  head.append(el('th', {text: 'unit'}), el('th', {text: 'corridor'}), el('th', {}), el('th', {text: 'verdict'}));
  const body = el('tbody'), first = RUNS.find(r => r.clinical);
  for (const f of first.clinical.figures) {
    const row = el('tr'), name = el('td', {}, f.label);
    if (f.note || f.time !== null) name.append(el('div', {class: 'source', text: [f.note, f.time !== null ? `at ${num(f.time, 3)} s` : ''].filter(Boolean).join(', ')}));
    for (const w of f.warnings) name.append(el('div', {class: 'warn', text: '⚠ ' + w}));
    if (f.source) name.append(el('div', {class: 'source', text: `corridor: ${f.source}`}));
    row.append(name);
    const found = RUNS.map(r => r.clinical && r.clinical.figures.find(o => o.key === f.key));
    for (const o of found) {
      const cell = el('td', {class: 'n'}, o ? num(o.value === null ? null : o.value * o.factor) : '–');
      if (o && o.uncertainty !== null && o.value !== null) cell.append(el('span', {class: 'pm', text: ` ± ${num(o.uncertainty * o.factor, 2)}`}));
      row.append(cell);
    }
    const last = found[found.length - 1];
    if (MANY) row.append(el('td', {class: 'n', text: last && f.value !== null && last.value !== null && f.value !== 0 ? `${num(100 * (last.value - f.value) / Math.abs(f.value), 3)} %` : '–'}));
    const drawn = el('td');
    drawn.append(bar(last && last.value !== null ? last.value * f.factor : null, last && last.uncertainty ? last.uncertainty * f.factor : 0, f.low, f.high));
    const words = found.map(o => o ? (o.kind === 'orientation' && corridor(o) ? 'orientation only' : o.verdict) : '').filter(Boolean), verdict = el('td');
    for (const w of new Set(words)) verdict.append(el('span', {class: `tag ${w}`, text: w}), ' ');
    row.append(el('td', {}, el('span', {class: 'unit', text: f.display_unit})), el('td', {text: corridor(f)}), drawn, verdict);
    body.append(row);
  }
  s.append(el('table', {}, el('thead', {}, head), body));
  for (const r of RUNS) for (const w of (r.clinical || {}).warnings || []) s.append(el('p', {class: 'warn', text: `⚠ ${MANY ? r.title + ': ' : ''}${w}`}));
  s.append(el('p', {class: 'source', text: '± is what the run itself tells: resolution, noise from output to output, or spread from beat to beat. Corridors marked “orientation only” were quoted from memory of the literature and give no verdict.'}));
}
function curves() {
  const s = section('Curves'), grid = el('div', {class: 'charts'});
  s.append(grid);
  const over = (title, unit, wanted) => {
    const list = [];
    RUNS.forEach((r, k) => wanted.forEach(([name, word, color, factor]) => {
      const c = series(r, name, factor);
      if (c) list.push({...c, name: MANY ? (wanted.length > 1 ? `${word} ${k + 1}` : `run ${k + 1}`) : word, color: wanted.length > 1 ? color : COLORS[k], dash: wanted.length > 1 ? DASH[k] : ''});
    }));
    if (list.length) grid.append(chart(title, unit, list, MANY || !RUNS[0].clinical ? [] : []));
  };
  const mm = 1 / 133.322;
  if (has('clinical')) {
    over('Pressure', 'mmHg', [['port.ventricle.pressure', 'ventricle', '#bf2929', mm], ['port.aorta.pressure', 'aorta', '#1a52a8', mm]]);
    over('Flow through the valve', 'mL/s', [['valve_flow', '', COLORS[0], 1e6]]);
    over('Orifice area', 'cm²', [['orifice_area', 'geometric', '#1a8066', 1e4], ['effective_orifice_area', 'effective', '#c96a08', 1e4]]);
    over('Jet speed', 'm/s', [['jet_speed', '', COLORS[0], 1]]);
    over('Leaflet stress, 99th percentile', 'kPa', [['leaflet_stress_p99', 'von Mises', '#8c338c', 1e-3], ['leaflet_principal_p99', 'principal', '#c96a08', 1e-3]]);
    over('Coaptation height', 'mm', [['coaptation_height', 'mean', '#1a52a8', 1e3], ['central_coaptation', 'central', '#1a8066', 1e3]]);
    over('Wall shear stress on leaflets', 'Pa', [['leaflet_wall_shear_p99', '99th percentile', '#c96a08', 1], ['leaflet_wall_shear_mean', 'mean', '#1a52a8', 1]]);
    for (const r of RUNS) {
      const a = series(r, 'm_mode.first', 1e3), b = series(r, 'm_mode.second', 1e3);
      if (a && b) grid.append(mMode(a.time, a.value, b.value, 1000 * ((r.model || {}).radius || 0.012)));
    }
  } else {
    for (const name of Object.keys(RUNS[0].series || {})) if (name !== 'time') over(name, (RUNS[0].units || {})[name] || '', [[name, '', COLORS[0], 1]]);
  }
}
function leaflets() {
  for (const r of RUNS) {
    if (!r.clinical || !r.clinical.leaflets) continue;
    const s = section(`Stress on each leaflet${MANY ? ': ' + r.title : ''}`), body = el('tbody');
    for (const l of r.clinical.leaflets) body.append(el('tr', {}, el('td', {text: `leaflet ${l.leaflet}`}), el('td', {text: l.region.replace('_', ' ')}), el('td', {class: 'n', text: num(l.von_mises / 1000, 3)}),
      el('td', {class: 'n', text: num(l.von_mises_time, 3)}), el('td', {class: 'n', text: num(l.principal / 1000, 3)}), el('td', {class: 'n', text: num(l.principal_time, 3)})));
    s.append(el('table', {}, el('thead', {}, el('tr', {}, el('th', {text: 'leaflet'}), el('th', {text: 'region'}), el('th', {class: 'n', text: 'von Mises [kPa]'}), el('th', {class: 'n', text: 'at [s]'}), el('th', {class: 'n', text: 'largest principal [kPa]'}), el('th', {class: 'n', text: 'at [s]'}))), body),
      el('p', {class: 'source', text: 'Largest over the beat of the 99th percentile over the region. What lies nearer to the attachment than the thickness or two spacings is left out: a clamped edge is a singularity.'}));
  }
}
function findings() {
  for (const r of RUNS) {
    const s = section(`What was simulated${MANY ? ': ' + r.title : ''}`, 'long'), body = el('tbody');
    for (const b of r.bodies || []) body.append(el('tr', {}, el('td', {text: b.name}), el('td', {text: b.kind}), el('td', {class: 'n', text: b.particles}), el('td', {text: b.material}),
      el('td', {class: 'n', text: b.youngs_modulus ? `${num(b.youngs_modulus / 1e6, 3)} MPa` : ''}), el('td', {class: 'n', text: b.thickness ? `${num(1000 * b.thickness, 3)} mm` : ''})));
    s.append(el('table', {}, el('thead', {}, el('tr', {}, el('th', {text: 'body'}), el('th', {text: 'kind'}), el('th', {class: 'n', text: 'particles'}), el('th', {text: 'material'}), el('th', {class: 'n', text: 'Young’s modulus'}), el('th', {class: 'n', text: 'thickness'}))), body));
    if (r.import) {
      const i = r.import, list = el('ul');
      list.append(el('li', {text: `${i.triangles_in} triangles read (${i.units}), ${i.triangles_out} after repair`}));
      for (const d of i.defects || []) list.append(el('li', {text: `${d.count} × ${d.kind}: ${d.repaired ? 'repaired' : 'not repaired'}`}));
      for (const o of i.open_ends || []) list.append(el('li', {text: `open end ${o.name || ''} (${o.role || 'unnamed'}), ${num(o.area_mm2, 3)} mm²`}));
      for (const w of i.warnings || []) list.append(el('li', {class: 'warn', text: w}));
      s.append(el('h3', {text: 'Import'}), list);
    }
    const a = r.accuracy || {}, list = el('ul');
    list.append(el('li', {text: `Spacing ${num(1000 * a.spacing)} mm; this run took ${minutes(a.minutes)}.`}));
    if (a.orifice_across) list.append(el('li', {text: `The open orifice is ${num(a.orifice_across, 2)} particles across; its area is resolved to about ± ${num(100 * a.orifice_error, 2)} %.`}));
    list.append(el('li', {text: `Better costs, on the same machine: about ${minutes(a.minutes_at_three_quarters)} at three quarters of the spacing, ${minutes(a.minutes_at_half)} at half of it.`}));
    s.append(el('h3', {text: 'How accurate this run is likely to be, and what better would cost'}), list);
    s.append(el('h3', {text: 'Warnings of the run'}));
    s.append((r.warnings || []).length ? el('ul', {}, ...r.warnings.map(w => el('li', {class: 'warn', text: w}))) : el('p', {text: 'none'}));
    const ledger = el('tbody');
    for (const [name, value, unit] of r.ledger || []) ledger.append(el('tr', {}, el('td', {text: name.replaceAll('_', ' ')}), el('td', {class: 'n', text: num(value, 5)}), el('td', {text: unit === '1' ? '' : unit})));
    s.append(el('h3', {text: 'Ledger at the end'}), el('details', {}, el('summary', {text: 'particles, corrections, energies'}), el('table', {}, ledger)));
    s.append(el('h3', {text: 'Settings'}), el('details', {}, el('summary', {text: `scene${r.settings.length ? ` and ${r.settings.length} settings on top` : ''}`}), el('pre', {text: (r.settings.length ? r.settings.map(t => `--set ${t}`).join('\n') + '\n\n' : '') + r.scene_text})));
  }
}
// With #check in the address the page tests itself and writes what it found into the document: for a headless browser.
async function check() {
  const found = {viewers: VIEWERS.length, tables: document.querySelectorAll('table').length, charts: document.querySelectorAll('.charts svg').length, turned: true, drawn: [], videos: []};
  for (const v of VIEWERS) {
    const before = v.fingerprint();
    v.yaw += 0.6; v.draw();
    const after = v.fingerprint();
    v.yaw -= 0.6; v.draw();
    found.drawn.push(before.drawn); found.turned = found.turned && before.sum !== after.sum && before.drawn > 1000;
  }
  for (const video of document.querySelectorAll('video')) {
    video.muted = true;
    try { await video.play(); await new Promise(r => setTimeout(r, 700)); found.videos.push(video.currentTime > 0 && video.videoWidth > 0); } catch (e) { found.videos.push(String(e)); }
  }
  document.body.append(el('pre', {id: 'check', text: JSON.stringify(found)}));
}
heading(); pictures(); models(); figures(); curves(); leaflets(); findings();
document.getElementById('page').append(el('footer', {text: `Cusp ${RUNS[0].version} · ${DATA.notice}`}));
if (location.hash === '#check') check();
