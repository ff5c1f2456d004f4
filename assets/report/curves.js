'use strict';
// Plain SVG: line charts, corridor bars, the M-mode trace.
const NS = 'http://www.w3.org/2000/svg';
function svg(tag, attributes, parent, text) {
  const node = document.createElementNS(NS, tag);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  if (parent) parent.appendChild(node);
  return node;
}
function niceStep(span, count) {
  const raw = span / count, power = Math.pow(10, Math.floor(Math.log10(raw)));
  for (const f of [1, 2, 2.5, 5, 10]) if (f * power >= raw) return f * power;
  return 10 * power;
}
function label(v) { return String(+v.toPrecision(6)); }

// curves: [{name, color, time, value, dash}]; shade: [[from, to]] in s
function chart(title, unit, curves, shade) {
  const W = 540, H = 210, left = 48, right = 12, top = 26, bottom = 26;
  const all = curves.flatMap(c => c.value.filter(Number.isFinite)), times = curves.flatMap(c => c.time);
  const node = svg('svg', {viewBox: `0 0 ${W} ${H}`, role: 'img', 'aria-label': title});
  if (!all.length) return node;
  let low = Math.min(0, ...all), high = Math.max(...all);
  if (high - low < 1e-30) high = low + 1;
  const step = niceStep(high - low, 5);
  low = Math.floor(low / step + 1e-9) * step; high = Math.ceil(high / step - 1e-9) * step;
  const t0 = Math.min(...times), last = Math.max(...times), t1 = last > t0 ? last : t0 + 1;
  const x = t => left + (t - t0) / (t1 - t0) * (W - left - right), y = v => H - bottom - (v - low) / (high - low) * (H - top - bottom);
  for (const [a, b] of shade || []) svg('rect', {x: x(a), y: top, width: Math.max(0, x(b) - x(a)), height: H - top - bottom, fill: '#eef3fb'}, node);
  for (let v = low; v <= high + step / 2; v += step) {
    svg('line', {x1: left, x2: W - right, y1: y(v), y2: y(v), stroke: Math.abs(v) < step / 1e6 ? '#9aa3b2' : '#e6e9ef'}, node);
    svg('text', {x: left - 6, y: y(v) + 4, 'text-anchor': 'end'}, node, label(v));
  }
  const ts = niceStep(t1 - t0, 6);
  for (let t = Math.ceil(t0 / ts) * ts; t <= t1 + ts / 1e6; t += ts) svg('text', {x: x(t), y: H - bottom + 15, 'text-anchor': 'middle'}, node, label(t));
  svg('text', {x: W - right, y: H - 2, 'text-anchor': 'end'}, node, 's');
  svg('text', {x: 0, y: 14, class: 'name'}, node, `${title} [${unit}]`);
  let at = W - right;
  for (const c of curves.slice().reverse()) if (c.name) {
    at -= 7 * c.name.length + 6;
    svg('text', {x: at, y: 14, fill: c.color, style: `fill:${c.color};font-weight:600`}, node, c.name);
    at -= 8;
  }
  for (const c of curves) {
    let path = '', pen = 'M';
    c.time.forEach((t, i) => { if (Number.isFinite(c.value[i])) { path += `${pen}${x(t).toFixed(1)},${y(c.value[i]).toFixed(1)}`; pen = 'L'; } });
    svg('path', {d: path, fill: 'none', stroke: c.color, 'stroke-width': 1.6, 'stroke-dasharray': c.dash || ''}, node);
  }
  return node;
}

// M-mode as echocardiography draws it: light on dark, time to the right, depth downwards; the two cusps' tips against the aortic walls.
function mMode(time, first, second, wall) {
  const W = 540, H = 210, left = 48, right = 12, top = 26, bottom = 26;
  const node = svg('svg', {viewBox: `0 0 ${W} ${H}`, role: 'img', 'aria-label': 'M-mode'});
  svg('text', {x: 0, y: 14, class: 'name'}, node, 'M-mode: places of two cusps’ tips [mm]');
  const reach = 1.15 * Math.max(wall, ...first.map(Math.abs), ...second.map(Math.abs));
  const x = t => left + (t - time[0]) / (time[time.length - 1] - time[0]) * (W - left - right), y = v => top + (reach - v) / (2 * reach) * (H - top - bottom);
  svg('rect', {x: left, y: top, width: W - left - right, height: H - top - bottom, fill: '#0b0e14'}, node);
  for (const w of [wall, -wall]) svg('line', {x1: left, x2: W - right, y1: y(w), y2: y(w), stroke: '#8d95a3', 'stroke-width': 5, opacity: 0.55}, node);
  for (const trace of [first, second]) {
    const d = time.map((t, i) => `${i ? 'L' : 'M'}${x(t).toFixed(1)},${y(trace[i]).toFixed(1)}`).join('');
    for (const [width, opacity] of [[6, 0.18], [3.2, 0.4], [1.4, 0.95]]) svg('path', {d, fill: 'none', stroke: '#f2f4f7', 'stroke-width': width, opacity}, node);
  }
  for (const v of [-10, 0, 10]) svg('text', {x: left - 6, y: y(v) + 4, 'text-anchor': 'end'}, node, v);
  const ts = niceStep(time[time.length - 1] - time[0], 6);
  for (let t = time[0]; t <= time[time.length - 1] + 1e-9; t += ts) svg('text', {x: x(t), y: H - bottom + 15, 'text-anchor': 'middle'}, node, label(t));
  return node;
}

// Where a value lies against its corridor: green band, a mark with its uncertainty.
function bar(value, spread, low, high) {
  const node = svg('svg', {viewBox: '0 0 150 16', class: 'bar'});
  if (value === null || (low === null && high === null)) return node;
  const a = low === null ? 0 : low, b = high === null ? 2 * low : high, margin = Math.max(b - a, 1e-30);
  let from = Math.min(a - 0.6 * margin, value), to = Math.max(b + 0.6 * margin, value);
  if (a >= 0) from = Math.max(from, Math.min(0, value));
  const x = v => 4 + (v - from) / (to - from) * 142;
  svg('line', {x1: 4, x2: 146, y1: 8, y2: 8, stroke: '#d9dde5', 'stroke-width': 2}, node);
  svg('rect', {x: x(a), y: 3, width: x(b) - x(a), height: 10, fill: '#bfe5d6', rx: 2}, node);
  if (spread) svg('line', {x1: Math.max(2, x(value - spread)), x2: Math.min(148, x(value + spread)), y1: 8, y2: 8, stroke: '#1d2330', 'stroke-width': 1.5}, node);
  svg('circle', {cx: x(value), cy: 8, r: 4, fill: '#1d2330'}, node);
  return node;
}
