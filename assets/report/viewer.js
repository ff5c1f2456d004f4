// A small viewer of one GLB (glTF 2.0): WebGL, turn by dragging, zoom by the wheel. Opaque surfaces with vertex colours first, then the
// see-through ones. Draws only when something changed.
function readGlb(base64) {
  const text = atob(base64), bytes = Uint8Array.from(text, c => c.charCodeAt(0)), view = new DataView(bytes.buffer);
  if (view.getUint32(0, true) !== 0x46546c67) throw new Error('no GLB');
  const length = view.getUint32(12, true), gltf = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length)));
  const start = 20 + length + 8, sizes = {SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4};
  const array = index => {
    const a = gltf.accessors[index], v = gltf.bufferViews[a.bufferView];
    return new (a.componentType === 5126 ? Float32Array : Uint32Array)(bytes.buffer.slice(start + v.byteOffset, start + v.byteOffset + 4 * a.count * sizes[a.type]));
  };
  const meshes = gltf.meshes.map(mesh => {
    const p = mesh.primitives[0], material = (gltf.materials || [])[p.material] || {};
    return {name: mesh.name, position: array(p.attributes.POSITION), color: p.attributes.COLOR_0 === undefined ? null : array(p.attributes.COLOR_0),
      value: p.attributes._VALUE === undefined ? null : array(p.attributes._VALUE), index: array(p.indices),
      base: (material.pbrMetallicRoughness || {}).baseColorFactor || [1, 1, 1, 1]};
  });
  return {scenes: gltf.scenes.map(s => ({name: s.name, meshes: s.nodes.map(n => gltf.nodes[n].mesh)})), meshes};
}
function normalsOf(mesh) {
  const n = new Float32Array(mesh.position.length), p = mesh.position, q = mesh.index;
  for (let i = 0; i < q.length; i += 3) {
    const [a, b, c] = [3 * q[i], 3 * q[i + 1], 3 * q[i + 2]];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2], vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const k of [a, b, c]) { n[k] += x; n[k + 1] += y; n[k + 2] += z; }
  }
  return n;
}
const VERTEX = `attribute vec3 position, normal, color; uniform mat3 turn; uniform vec3 center; uniform vec2 zoom; varying vec3 n, c;
void main() { vec3 p = turn * (position - center); n = turn * normal; c = color; gl_Position = vec4(p.xy * zoom, -p.z * 8.0, 1.0); }`;
const FRAGMENT = `precision mediump float; varying vec3 n, c; uniform vec4 base;
void main() { vec3 d = normalize(n); float light = 0.45 + 0.55 * abs(dot(d, normalize(vec3(0.3, 0.5, 0.8))));
  float edge = 1.0 - abs(d.z); gl_FragColor = vec4(pow(c * base.rgb, vec3(1.0 / 2.2)) * light, base.a < 1.0 ? base.a * (0.35 + 1.6 * edge * edge) : 1.0); }`;

function cross(a, b) { return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]; }
function unit(a) { const l = Math.hypot(...a) || 1; return a.map(v => v / l); }

class Viewer {
  constructor(canvas, model) {
    this.canvas = canvas;
    this.gl = canvas.getContext('webgl', {alpha: false, antialias: true, preserveDrawingBuffer: true});
    if (!this.gl) throw new Error('this browser draws no WebGL');
    const gl = this.gl;
    if (!gl.getExtension('OES_element_index_uint')) throw new Error('this browser draws no large models');
    this.file = readGlb(model.glb);
    this.center = (model.center || [0, 0, 0]).map((v, k) => v + (model.axis ? 0.6 * model.radius * model.axis[k] : 0));
    this.radius = model.radius || 0.02;
    // Start: a little from above the valve, the axis up on the screen.
    const axis = unit(model.axis || [0, 0, 1]), side = unit(cross(axis, Math.abs(axis[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0]));
    this.frame = [side, axis, cross(side, axis)];
    this.reset();
    this.program = this.link();
    this.buffers = this.file.meshes.map(m => this.upload(m));
    this.scene = 0;
    this.listen();
    this.draw();
  }
  reset() { this.yaw = 0.5; this.pitch = 0.95; this.size = 2.1 * this.radius; }
  link() {
    const gl = this.gl, program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text); gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    return program;
  }
  upload(mesh) {
    const gl = this.gl, put = (target, data) => { const b = gl.createBuffer(); gl.bindBuffer(target, b); gl.bufferData(target, data, gl.STATIC_DRAW); return b; };
    return {position: put(gl.ARRAY_BUFFER, mesh.position), normal: put(gl.ARRAY_BUFFER, normalsOf(mesh)), color: mesh.color && put(gl.ARRAY_BUFFER, mesh.color),
      index: put(gl.ELEMENT_ARRAY_BUFFER, mesh.index), count: mesh.index.length, base: mesh.base};
  }
  turn() {  // rows: screen right, up, towards the eye, in the model's coordinates
    const [s, a, f] = this.frame, cy = Math.cos(this.yaw), sy = Math.sin(this.yaw), cp = Math.cos(this.pitch), sp = Math.sin(this.pitch);
    const right = s.map((v, k) => cy * v + sy * f[k]), forward = s.map((v, k) => -sy * v + cy * f[k]);
    return [right, a.map((v, k) => cp * v - sp * forward[k]), a.map((v, k) => sp * v + cp * forward[k])];
  }
  draw() {
    const gl = this.gl, c = this.canvas, ratio = window.devicePixelRatio || 1, w = Math.round((c.clientWidth || 600) * ratio), h = Math.round((c.clientHeight || 430) * ratio);
    if (c.width !== w || c.height !== h) { c.width = w; c.height = h; }
    gl.viewport(0, 0, w, h); gl.clearColor(0.933, 0.941, 0.957, 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST); gl.useProgram(this.program);
    const at = n => gl.getUniformLocation(this.program, n), rows = this.turn(), m = [];
    for (let column = 0; column < 3; ++column) for (let row = 0; row < 3; ++row) m.push(rows[row][column]);
    gl.uniformMatrix3fv(at('turn'), false, m); gl.uniform3fv(at('center'), this.center);
    gl.uniform2f(at('zoom'), h / w / this.size, 1 / this.size);
    for (const clear of [false, true]) for (const k of this.file.scenes[this.scene].meshes) {
      const b = this.buffers[k];
      if (b.base[3] < 1 !== clear) continue;
      if (clear) { gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA); gl.depthMask(false); }
      ['position', 'normal', 'color'].forEach(name => {
        const where = gl.getAttribLocation(this.program, name);
        if (where < 0) return;
        if (!b[name]) { gl.disableVertexAttribArray(where); gl.vertexAttrib3f(where, 1, 1, 1); return; }
        gl.bindBuffer(gl.ARRAY_BUFFER, b[name]); gl.enableVertexAttribArray(where); gl.vertexAttribPointer(where, 3, gl.FLOAT, false, 0, 0);
      });
      gl.uniform4fv(at('base'), b.base); gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, b.index); gl.drawElements(gl.TRIANGLES, b.count, gl.UNSIGNED_INT, 0);
      gl.disable(gl.BLEND); gl.depthMask(true);
    }
  }
  listen() {
    let last = null;
    this.canvas.addEventListener('pointerdown', e => { last = [e.clientX, e.clientY]; this.canvas.setPointerCapture(e.pointerId); });
    this.canvas.addEventListener('pointerup', () => { last = null; });
    this.canvas.addEventListener('pointermove', e => {
      if (!last) return;
      this.yaw += 0.01 * (e.clientX - last[0]); this.pitch = Math.max(-1.57, Math.min(1.57, this.pitch + 0.01 * (e.clientY - last[1])));
      last = [e.clientX, e.clientY]; this.draw();
    });
    this.canvas.addEventListener('wheel', e => { e.preventDefault(); this.size *= Math.exp(0.001 * e.deltaY); this.draw(); }, {passive: false});
    window.addEventListener('resize', () => this.draw());
    window.addEventListener('beforeprint', () => this.draw());
  }
  // How many pixels differ from the background, and a sum over them: what a test sees.
  fingerprint() {
    const gl = this.gl, pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let drawn = 0, sum = 0;
    for (let i = 0; i < pixels.length; i += 4) if (Math.abs(pixels[i] - 238) + Math.abs(pixels[i + 1] - 240) + Math.abs(pixels[i + 2] - 244) > 12) { ++drawn; sum = (sum * 31 + pixels[i] + 7 * pixels[i + 1] + i) % 1000000007; }
    return {drawn, sum};
  }
}
