// The last picture as another camera would see it, by its depth, until that camera's own picture is here: a sheet of
// triangles over the picture, bent by depth. What the picture did not show is stretched, not invented.
const sub = (a, b) => a.map((x, i) => x - b[i]), dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => { const n = Math.hypot(...a) || 1; return a.map(x => x / n); };

const axes = camera => {
  const look = sub(camera.target, camera.position), forward = unit(look), right = unit(cross(forward, camera.up));
  return { forward, right, above: cross(right, forward), half: Math.tan(camera.fov_deg * Math.PI / 360), away: Math.hypot(...look) };
};

// Corners of the sheet in clip space of `to`: x, y, z, w each.
export function bend(depth, from, to, aspect) {
  const a = axes(from), b = axes(to), { width, height, values } = depth, out = new Float32Array(4 * width * height);
  const far = values.reduce((most, z) => Math.max(most, z), 0) || a.away, reach = 4 * (far + b.away);
  for (let j = 0, at = 0; j < height; ++j)
    for (let i = 0; i < width; ++i, at += 4) {
      const z = values[j * width + i] || far, scale = a.half * (from.orthographic ? a.away : z);
      const x = (2 * i / (width - 1) - 1) * scale * aspect, y = (1 - 2 * j / (height - 1)) * scale;
      const seen = from.position.map((p, k) => p + x * a.right[k] + y * a.above[k] + z * a.forward[k] - to.position[k]);
      const ahead = dot(seen, b.forward), w = to.orthographic ? 1 : Math.max(1e-3 * b.away, ahead), size = b.half * (to.orthographic ? b.away : 1);
      out[at] = dot(seen, b.right) / (size * aspect);
      out[at + 1] = dot(seen, b.above) / size;
      out[at + 2] = w * Math.min(1, Math.max(-1, 2 * ahead / reach - 1));
      out[at + 3] = w;
    }
  return out;
}

// What depth arrives as: 16 bits, 0 for nothing, each less than the one before, low bytes before high ones, deflated.
export async function unpack(packed, bytes) {
  if (!packed || !window.DecompressionStream) return null;
  const planes = new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer());
  const count = packed.width * packed.height, values = new Float32Array(count), step = (packed.far - packed.near) / 65534;
  for (let i = 0, before = 0; i < count; ++i) {
    before = before + planes[i] + 256 * planes[count + i] & 65535;
    values[i] = before ? packed.near + (before - 1) * step : 0;
  }
  return { ...packed, values };
}

// Null where the browser has no WebGL 2: the picture then stays where it was.
export function makeWarper() {
  const canvas = document.createElement('canvas');
  const gl = canvas.getContext('webgl2', { antialias: false, alpha: false, preserveDrawingBuffer: true });
  if (!gl) return null;
  const shader = (kind, text) => { const one = gl.createShader(kind); gl.shaderSource(one, `#version 300 es\n${text}`); gl.compileShader(one); return one; };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, 'in vec4 place; in vec2 spot; out vec2 uv; void main() { gl_Position = place; uv = spot; }'));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, 'precision mediump float; uniform sampler2D picture; in vec2 uv; out vec4 color; void main() { color = texture(picture, uv); }'));
  gl.bindAttribLocation(program, 0, 'place');
  gl.bindAttribLocation(program, 1, 'spot');
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return null;
  gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST);
  const places = gl.createBuffer(), spots = gl.createBuffer(), corners = gl.createBuffer();
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  for (const way of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, way, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  let width = 0, height = 0, held = null;

  function sheet(depth) {
    [width, height] = [depth.width, depth.height];
    const uv = new Float32Array(2 * width * height), index = new Uint32Array(6 * (width - 1) * (height - 1));
    for (let j = 0, n = 0; j < height; ++j)
      for (let i = 0; i < width; ++i) {
        const k = j * width + i;
        uv[2 * k] = i / (width - 1);
        uv[2 * k + 1] = j / (height - 1);
        if (i + 1 < width && j + 1 < height) for (const each of [k, k + 1, k + width, k + 1, k + width + 1, k + width]) index[n++] = each;
      }
    gl.bindBuffer(gl.ARRAY_BUFFER, spots);
    gl.bufferData(gl.ARRAY_BUFFER, uv, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 2, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, corners);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
  }

  return (picture, depth, from, to, background, wide, high) => {
    if (gl.isContextLost()) return null;
    if (canvas.width !== wide || canvas.height !== high) [canvas.width, canvas.height] = [wide, high];
    if (depth.width !== width || depth.height !== height) sheet(depth);
    if (held !== picture) gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, held = picture);
    gl.viewport(0, 0, wide, high);
    gl.clearColor(...[1, 3, 5].map(i => parseInt(background.slice(i, i + 2), 16) / 255), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.bindBuffer(gl.ARRAY_BUFFER, places);
    gl.bufferData(gl.ARRAY_BUFFER, bend(depth, from, to, picture.width / picture.height), gl.STREAM_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 4, gl.FLOAT, false, 0, 0);
    gl.drawElements(gl.TRIANGLES, 6 * (width - 1) * (height - 1), gl.UNSIGNED_INT, 0);
    return canvas;
  };
}
