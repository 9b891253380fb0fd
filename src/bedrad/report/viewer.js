/* A bed in three dimensions: each sphere is a square whose pixels meet the sphere exactly, with a wedge taken out.
   The same picture as `still` in pictures.py; its numbers come with the data. */
"use strict";
(() => {
  const figure = document.querySelector(".viewer");
  if (!figure) return;
  const data = JSON.parse(document.getElementById("bed-data").textContent);
  const canvas = figure.querySelector("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) {
    figure.querySelector(".failed").style.display = "block";
    return;
  }

  const common = `#version 300 es
  precision highp float;
  precision highp int;
  uniform mat3 axes;
  uniform vec2 shift, half_size;
  uniform float reach, ambient;
  uniform vec3 planes[2], light;
  const float FAR = 1e30;
  vec3 start_of(vec2 at) { return at.x * axes[0] + at.y * axes[1]; }
  void removed(vec3 start, out float near, out float far, out int last) {
    near = -FAR; far = FAR; last = 0;
    for (int k = 0; k < 2; k++) {
      float height = dot(start, planes[k]), slope = dot(axes[2], planes[k]);
      if (abs(slope) < 1e-7) {
        if (height <= 0.0) { near = FAR; far = -FAR; return; }
        continue;
      }
      float distance = -height / slope;
      if (slope > 0.0) near = max(near, distance);
      else if (distance < far) { far = distance; last = k; }
    }
  }
  vec4 lit(vec3 color, vec3 normal, bool cut) {
    float bright = ambient + (1.0 - ambient) * max(dot(normal, light), 0.0);
    return vec4(color * (cut ? 0.55 + 0.45 * bright : bright), 1.0);
  }
  float depth_of(float seen) { return 0.5 + 0.5 * seen / reach; }
  `;

  const sphereVertex = common + `
  layout(location = 0) in vec3 place;
  layout(location = 1) in float size;
  uniform vec3 low, extent;
  uniform float largest;
  flat out vec3 center;
  flat out float radius;
  out vec2 at;
  void main() {
    center = low + place * extent;
    radius = size * largest;
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    at = vec2(dot(center, axes[0]), dot(center, axes[1])) + radius * corner;
    gl_Position = vec4((at - shift) / half_size, 0.0, 1.0);
  }`;

  const layers = data.edges.length - 1;
  const sphereFragment = common + `
  flat in vec3 center;
  flat in float radius;
  in vec2 at;
  out vec4 color;
  uniform vec3 middle, palette[${layers + 1}];
  uniform float edges[${layers + 1}], wall_radius;
  uniform int kind;
  void main() {
    vec3 start = start_of(at), away = start - center;
    float along = dot(away, axes[2]), inside = along * along - dot(away, away) + radius * radius;
    if (inside <= 0.0) discard;
    float half_chord = sqrt(inside), seen = -along - half_chord, near, far;
    int last;
    removed(start, near, far, last);
    bool cut = near < far && near <= seen && seen < far;
    if (cut) {
      seen = far;
      if (seen >= half_chord - along) discard;
    }
    vec3 point = start + seen * axes[2], real = point + middle;
    float depth = kind == 2 ? real.z : (kind == 0 ? wall_radius - length(real.xy) : length(real.xy) - wall_radius);
    int layer = 0;
    for (int k = 1; k <= ${layers}; k++) if (depth >= edges[k]) layer = k;
    color = lit(palette[layer], cut ? planes[last] : (point - center) / radius, cut);
    gl_FragDepth = depth_of(seen);
  }`;

  const wallVertex = common + `
  out vec2 at;
  void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    at = shift + corner * half_size;
    gl_Position = vec4(corner, 0.0, 1.0);
  }`;

  const wallFragment = common + `
  in vec2 at;
  out vec4 color;
  uniform float outer, hole;
  uniform vec3 box_low, box_high, wall_color;
  void cylinder(vec3 start, float radius, out float near, out float far) {
    near = FAR; far = -FAR;
    float a = dot(axes[2].xy, axes[2].xy), c = dot(start.xy, start.xy) - radius * radius;
    if (a < 1e-9) {
      if (c < 0.0) { near = -FAR; far = FAR; }
      return;
    }
    float b = dot(start.xy, axes[2].xy) / a, square = b * b - c / a;
    if (square <= 0.0) return;
    near = -b - sqrt(square); far = -b + sqrt(square);
  }
  vec3 round_normal(vec3 start, float distance) { return vec3(normalize((start + distance * axes[2]).xy), 0.0); }
  void main() {
    vec3 start = start_of(at), normal = vec3(0.0);
    float begin = -FAR, end = FAR, near, far;
    for (int axis = outer > 0.0 ? 2 : 0; axis < 3; axis++) {
      float low = box_low[axis] - start[axis], high = box_high[axis] - start[axis], slope = axes[2][axis];
      if (abs(slope) < 1e-7) {
        if (low > 0.0 || high < 0.0) discard;
        continue;
      }
      near = min(low / slope, high / slope);
      if (near > begin) { begin = near; normal = vec3(0.0); normal[axis] = -sign(slope); }
      end = min(end, max(low / slope, high / slope));
    }
    if (outer > 0.0) {
      cylinder(start, outer, near, far);
      if (near > begin) { begin = near; normal = round_normal(start, begin); }
      end = min(end, far);
    }
    bool cut = false;
    if (hole > 0.0) {
      float hole_near, hole_far;
      int last;
      cylinder(start, hole, hole_near, hole_far);
      removed(start, near, far, last);
      for (int step = 0; step < 4; step++) {
        if (hole_near <= begin && begin < hole_far) {
          begin = hole_far; cut = false; normal = -round_normal(start, begin);
        } else if (near <= begin && begin < far) {
          begin = far; cut = true; normal = planes[last];
        } else break;
      }
    }
    if (begin >= end) discard;
    color = lit(wall_color, normal, cut);
    gl_FragDepth = depth_of(begin);
  }`;

  function program(vertex, fragment) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    return { made, at: (name) => gl.getUniformLocation(made, name) };
  }

  const spheres = program(sphereVertex, sphereFragment), wall = program(wallVertex, wallFragment);
  const bytes = Uint8Array.from(atob(data.spheres), (letter) => letter.charCodeAt(0));
  const full = gl.createVertexArray(), empty = gl.createVertexArray();
  gl.bindVertexArray(full);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, bytes, gl.STATIC_DRAW);
  for (const [place, count, offset] of [[0, 3, 0], [1, 1, 6]]) {
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, count, gl.UNSIGNED_SHORT, true, 8, offset);
    gl.vertexAttribDivisor(place, 1);
  }
  const number = bytes.length / 8;
  gl.enable(gl.DEPTH_TEST);
  gl.clearColor(0, 0, 0, 0);

  const rad = Math.PI / 180;
  const opening = figure.querySelector("[name=opening]"), shown = figure.querySelector("[name=wall]");
  const bar = figure.querySelector(".bar");
  let view, asked = false;
  const reset = () => { view = { azimuth: data.azimuth, elevation: data.elevation, zoom: 1, x: 0, y: 0 }; };
  const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

  function eyeAxes() {
    const a = view.azimuth * rad, e = view.elevation * rad;
    const [ca, sa, ce, se] = [Math.cos(a), Math.sin(a), Math.cos(e), Math.sin(e)];
    return [-sa, ca, 0, -se * ca, -se * sa, ce, -ce * ca, -ce * sa, -se];
  }

  /* Half of the width of the picture, in millimetres; at zoom 1 everything fits into the first view. */
  function halfWidth() {
    const e = data.elevation * rad;
    const tall = data.half_height * Math.abs(Math.cos(e)) + data.across * Math.abs(Math.sin(e));
    return 1.04 * Math.max(data.across, tall * canvas.width / canvas.height) / view.zoom;
  }

  function use({ made, at }, axes, width) {
    gl.useProgram(made);
    gl.uniformMatrix3fv(at("axes"), false, axes);
    gl.uniform2f(at("half_size"), width, width * canvas.height / canvas.width);
    gl.uniform2f(at("shift"), view.x, view.y);
    gl.uniform1f(at("reach"), data.reach);
    gl.uniform1f(at("ambient"), data.ambient);
    const middle = data.front * rad, open = opening.value / 2 * rad;
    const angles = [middle + open - Math.PI / 2, middle - open + Math.PI / 2];
    gl.uniform3fv(at("planes"), angles.flatMap((angle) => [Math.cos(angle), Math.sin(angle), 0]));
    const length = Math.hypot(...data.light);
    gl.uniform3fv(at("light"), [0, 1, 2].map((k) =>
      data.light.reduce((sum, part, row) => sum + part * axes[3 * row + k], 0) / length));
  }

  function draw() {
    asked = false;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const axes = eyeAxes(), half = halfWidth();
    use(spheres, axes, half);
    gl.uniform3fv(spheres.at("low"), data.low);
    gl.uniform3fv(spheres.at("extent"), data.extent);
    gl.uniform1f(spheres.at("largest"), data.largest);
    gl.uniform3fv(spheres.at("middle"), data.middle);
    gl.uniform3fv(spheres.at("palette"), data.palette.flat());
    gl.uniform1fv(spheres.at("edges"), data.edges);
    gl.uniform1f(spheres.at("wall_radius"), data.wall_radius);
    gl.uniform1i(spheres.at("kind"), data.kind);
    gl.bindVertexArray(full);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, number);
    if (shown.checked) {
      use(wall, axes, half);
      gl.uniform1f(wall.at("outer"), data.solid[0]);
      gl.uniform1f(wall.at("hole"), data.solid[1]);
      gl.uniform3fv(wall.at("box_low"), data.solid.slice(2, 5));
      gl.uniform3fv(wall.at("box_high"), data.solid.slice(5, 8));
      gl.uniform3fv(wall.at("wall_color"), data.wall_color);
      gl.bindVertexArray(empty);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
    scaleBar(half);
  }

  /* The longest of 1, 2, 5, 10, ... that takes at most a quarter of the width; the unit of the data is a millimetre. */
  function scaleBar(half) {
    const power = 10 ** Math.floor(Math.log10(half / 2));
    const length = power * [5, 2, 1].find((step) => step * power <= half / 2);
    bar.style.width = `${100 * length / (2 * half)}%`;
    bar.textContent = `${Number(length.toPrecision(3))} mm`;
  }

  function redraw() {
    if (!asked) { asked = true; requestAnimationFrame(draw); }
  }

  function turn(right, down) {
    view.azimuth -= right;
    view.elevation = clamp(view.elevation + down, -90, 90);
    redraw();
  }

  function zoom(factor) {
    view.zoom = clamp(view.zoom * factor, 0.5, 40);
    redraw();
  }

  function move(right, up) {
    const half = halfWidth();
    view.x -= right * 2 * half / canvas.clientWidth;
    view.y -= up * 2 * half / canvas.clientWidth;
    redraw();
  }

  const fingers = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const [right, down] = [event.clientX - before.clientX, event.clientY - before.clientY];
    if (fingers.size === 2) {
      const other = [...fingers.values()].find((finger) => finger.pointerId !== event.pointerId);
      const apart = (finger) => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY);
      zoom(Math.max(apart(event), 1) / Math.max(apart(before), 1));
    } else if (event.shiftKey || event.buttons === 2) move(right, -down);
    else turn(0.4 * right, 0.4 * down);
    fingers.set(event.pointerId, event);
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  /* the wheel scrolls the page until the picture has been chosen */
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    zoom(Math.exp(-0.0015 * event.deltaY));
  }, { passive: false });
  const keys = {
    ArrowLeft: () => turn(-5, 0), ArrowRight: () => turn(5, 0), ArrowUp: () => turn(0, -5), ArrowDown: () => turn(0, 5),
    "+": () => zoom(1.15), "=": () => zoom(1.15), "-": () => zoom(1 / 1.15), Home: () => { reset(); redraw(); },
  };
  const moves = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, 20], ArrowDown: [0, -20] };
  canvas.addEventListener("keydown", (event) => {
    const step = event.shiftKey && moves[event.key];
    const action = step ? () => move(...step) : keys[event.key];
    if (!action || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    action();
  });
  opening.addEventListener("input", redraw);
  shown.addEventListener("change", redraw);
  figure.querySelector("button").addEventListener("click", () => {
    reset();
    opening.value = data.opening;
    shown.checked = true;
    redraw();
  });
  canvas.addEventListener("webglcontextlost", () => figure.classList.remove("drawn"));
  reset();
  figure.classList.add("drawn");
  new ResizeObserver(redraw).observe(canvas);
  draw();
})();
