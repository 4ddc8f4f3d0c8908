// The robot in motion: triangles placed by recorded poses, in WebGL.
const SHADERS = {
  vertex: `
attribute vec3 position; attribute vec3 normal;
uniform mat4 camera, model; varying vec3 n; varying vec3 p;
void main() { vec4 w = model * vec4(position, 1.0); p = w.xyz; n = mat3(model) * normal; gl_Position = camera * w; }`,
  fragment: `
precision mediump float;
uniform vec4 colour; uniform vec3 eye; uniform float lit; varying vec3 n; varying vec3 p;
void main() {
  if (lit < 0.5) { gl_FragColor = colour; return; }
  vec3 m = normalize(n); vec3 v = normalize(eye - p);
  if (dot(m, v) < 0.0) m = -m;
  vec3 key = normalize(vec3(0.5, -0.6, 0.9));
  float light = 0.42 + 0.18 * m.z + 0.42 * max(dot(m, key), 0.0) + 0.12 * max(dot(m, v), 0.0);
  float shine = 0.16 * pow(max(dot(m, normalize(key + v)), 0.0), 32.0);
  gl_FragColor = vec4(colour.rgb * light + shine, colour.a);
}`,
};
const FIELD = Math.PI / 5;

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const unit = (a) => { const l = Math.hypot(...a) || 1; return [a[0] / l, a[1] / l, a[2] / l]; };
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

function product(a, b) {  // column-major 4 x 4
  const c = new Float32Array(16);
  for (let i = 0; i < 4; i++) {
    for (let j = 0; j < 4; j++) {
      for (let k = 0; k < 4; k++) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
    }
  }
  return c;
}

// Column-major matrix of a pose x y z, qx qy qz qw.
function matrix(p) {
  const [x, y, z, a, b, c, w] = p;
  return new Float32Array([
    1 - 2 * (b * b + c * c), 2 * (a * b + c * w), 2 * (a * c - b * w), 0,
    2 * (a * b - c * w), 1 - 2 * (a * a + c * c), 2 * (b * c + a * w), 0,
    2 * (a * c + b * w), 2 * (b * c - a * w), 1 - 2 * (a * a + b * b), 0,
    x, y, z, 1,
  ]);
}

class View3d {
  constructor(world, timeline) {
    this.world = world;
    this.timeline = timeline;
    this.canvas = element('canvas');
    this.canvas.setAttribute('aria-label', 'robot');
    this.azimuth = -0.86;
    this.height = 0.32;
    this.distance = 2.6 * world.reach;
    this.target = [0.12 * world.reach, 0, 0.3 * world.reach];
    this.gl = this.canvas.getContext('webgl', { antialias: true, preserveDrawingBuffer: true });
    if (!this.gl) return;
    this.program = this.compile();
    this.meshes = world.meshes.map((mesh) => this.upload(mesh));
    this.grid = this.lines(this.gridLines());
    this.paths = world.robots.map((robot) => this.lines(ARRAYS[robot.path]));
    this.listen();
    timeline.watch(() => this.draw());
  }

  compile() {
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, SHADERS.vertex], [gl.FRAGMENT_SHADER, SHADERS.fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    this.at = {};
    for (const name of ['camera', 'model', 'colour', 'eye', 'lit']) this.at[name] = gl.getUniformLocation(program, name);
    this.position = gl.getAttribLocation(program, 'position');
    this.normal = gl.getAttribLocation(program, 'normal');
    return program;
  }

  buffer(target, data) {
    const made = this.gl.createBuffer();
    this.gl.bindBuffer(target, made);
    this.gl.bufferData(target, data, this.gl.STATIC_DRAW);
    return made;
  }

  upload(mesh) {
    const gl = this.gl;
    return {
      vertices: this.buffer(gl.ARRAY_BUFFER, ARRAYS[mesh.vertices]),
      normals: this.buffer(gl.ARRAY_BUFFER, ARRAYS[mesh.normals]),
      faces: this.buffer(gl.ELEMENT_ARRAY_BUFFER, ARRAYS[mesh.faces]),
      count: ARRAYS[mesh.faces].length,
    };
  }

  lines(points) { return { vertices: this.buffer(this.gl.ARRAY_BUFFER, points), count: points.length / 3 }; }

  gridLines() {
    const cell = this.world.reach < 2 ? 0.25 : 0.5;
    const count = Math.ceil(1.3 * this.world.reach / cell);
    const points = [];
    for (let i = -count; i <= count; i++) {
      points.push(i * cell, -count * cell, 0, i * cell, count * cell, 0);
      points.push(-count * cell, i * cell, 0, count * cell, i * cell, 0);
    }
    return new Float32Array(points);
  }

  listen() {
    const canvas = this.canvas;
    let last = null;
    canvas.addEventListener('pointerdown', (event) => { last = event; canvas.setPointerCapture(event.pointerId); });
    canvas.addEventListener('pointerup', () => { last = null; });
    canvas.addEventListener('pointermove', (event) => {
      if (!last) return;
      const dx = event.clientX - last.clientX;
      const dy = event.clientY - last.clientY;
      last = event;
      if (event.shiftKey || event.buttons === 4) this.pan(dx, dy);
      else {
        this.azimuth -= 0.008 * dx;
        this.height = Math.min(Math.max(this.height + 0.008 * dy, -1.5), 1.5);
      }
      this.draw();
    });
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.distance *= Math.exp(0.001 * event.deltaY);
      this.draw();
    }, { passive: false });
  }

  pan(dx, dy) {
    const scale = this.distance * FIELD / Math.max(this.canvas.clientHeight, 1);
    const ahead = unit(minus(this.target, this.eye()));
    const right = unit(cross(ahead, [0, 0, 1]));
    const up = cross(right, ahead);
    this.target = this.target.map((value, i) => value - scale * (dx * right[i] - dy * up[i]));
  }

  eye() {
    const flat = Math.cos(this.height) * this.distance;
    return [
      this.target[0] + flat * Math.cos(this.azimuth),
      this.target[1] + flat * Math.sin(this.azimuth),
      this.target[2] + Math.sin(this.height) * this.distance,
    ];
  }

  camera(eye, aspect) {
    const back = unit(minus(eye, this.target));
    const right = unit(cross([0, 0, 1], back));
    const up = cross(back, right);
    const look = new Float32Array([
      right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
      -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
    ]);
    const f = 1 / Math.tan(FIELD / 2);
    const near = 0.02 * this.distance;
    const far = this.distance + 20 * this.world.reach;
    const lens = new Float32Array([
      f / Math.max(aspect, 1e-3), 0, 0, 0, 0, f, 0, 0,
      0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0,
    ]);
    return product(lens, look);
  }

  // Pose of a frame at the cursor, between the two recorded ones.
  pose(robot, frame) {
    if (frame === 0) return matrix([0, 0, 0, 0, 0, 0, 1]);
    const times = ARRAYS[robot.times];
    const poses = ARRAYS[robot.poses];
    const i = Math.min(Math.max(indexAt(times, this.timeline.cursor), 0), times.length - 1);
    const j = Math.min(i + 1, times.length - 1);
    const span = times[j] - times[i];
    const part = span > 0 ? Math.min((this.timeline.cursor - times[i]) / span, 1) : 0;
    const at = (k) => poses.subarray(7 * (k * robot.frames + frame - 1), 7 * (k * robot.frames + frame));
    const a = at(i);
    const b = at(j);
    const sign = a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6] < 0 ? -1 : 1;
    const mixed = Array.from(a, (value, k) => value + part * ((k > 2 ? sign : 1) * b[k] - value));
    const length = Math.hypot(mixed[3], mixed[4], mixed[5], mixed[6]);
    for (let k = 3; k < 7; k++) mixed[k] /= length;
    return matrix(mixed);
  }

  draw() {
    const gl = this.gl;
    const ratio = window.devicePixelRatio || 1;
    const width = Math.round(this.canvas.clientWidth * ratio);
    const height = Math.round(this.canvas.clientHeight * ratio);
    if (!gl || !width || !height) return;
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0.955, 0.963, 0.971, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    const eye = this.eye();
    gl.uniformMatrix4fv(this.at.camera, false, this.camera(eye, width / height));
    gl.uniform3fv(this.at.eye, eye);
    const still = matrix([0, 0, 0, 0, 0, 0, 1]);
    this.drawLines(this.grid, gl.LINES, still, [0.8, 0.82, 0.85, 1]);
    this.world.robots.forEach((robot, k) => this.drawLines(this.paths[k], gl.LINE_STRIP, still, robot.pathColour));
    for (const robot of this.world.robots) this.drawRobot(robot);
  }

  drawRobot(robot) {
    const frames = new Map();
    for (const part of robot.parts) {
      if (!frames.has(part.frame)) frames.set(part.frame, this.pose(robot, part.frame));
      this.drawMesh(this.meshes[part.mesh], frames.get(part.frame), part.colour);
    }
  }

  place(item, model, colour, lit) {
    const gl = this.gl;
    gl.uniformMatrix4fv(this.at.model, false, model);
    gl.uniform4fv(this.at.colour, colour);
    gl.uniform1f(this.at.lit, lit);
    gl.bindBuffer(gl.ARRAY_BUFFER, item.vertices);
    gl.enableVertexAttribArray(this.position);
    gl.vertexAttribPointer(this.position, 3, gl.FLOAT, false, 0, 0);
  }

  drawMesh(mesh, model, colour) {
    const gl = this.gl;
    this.place(mesh, model, colour, 1);
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.normals);
    gl.enableVertexAttribArray(this.normal);
    gl.vertexAttribPointer(this.normal, 3, gl.BYTE, true, 4, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.faces);
    gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_SHORT, 0);
  }

  drawLines(lines, kind, model, colour) {
    const gl = this.gl;
    this.place(lines, model, colour, 0);
    gl.disableVertexAttribArray(this.normal);
    gl.drawArrays(kind, 0, lines.count);
  }
}
