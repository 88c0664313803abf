// What is drawn over the picture: picked points, the lines between them, the clip box, what others point at.
import { pointers, state } from './app.mjs';

const sub = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => { const n = Math.hypot(...a) || 1; return a.map(x => x / n); };

// A world place in CSS pixels; null behind the camera.
function projector(camera, width, height) {
  const look = sub(camera.target, camera.position), forward = unit(look);
  const right = unit(cross(forward, camera.up)), above = cross(right, forward);
  const half = Math.tan(camera.fov_deg * Math.PI / 360), away = Math.hypot(...look);
  return world => {
    const v = sub(world, camera.position), depth = dot(v, forward);
    if (!camera.orthographic && depth <= 0) return null;
    const scale = height / 2 / (half * (camera.orthographic ? away : depth));
    return [width / 2 + dot(v, right) * scale, height / 2 - dot(v, above) * scale];
  };
}

function shape(name, attributes, text) {
  const node = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  return node;
}

export function drawMarks(camera, canvas) {
  const marks = document.getElementById('marks');
  marks.replaceChildren();
  if (!camera) return;
  const box = canvas.getBoundingClientRect(), to = projector(camera, box.width, box.height);
  const line = (a, b) => { if (a && b) marks.append(shape('line', { x1: a[0], y1: a[1], x2: b[0], y2: b[1] })); };
  if (state.clip) {
    const corner = i => to([state.clip[i & 1 ? 3 : 0], state.clip[i & 2 ? 4 : 1], state.clip[i & 4 ? 5 : 2]]);
    for (let i = 0; i < 8; ++i) for (const bit of [1, 2, 4]) if (!(i & bit)) line(corner(i), corner(i | bit));
  }
  const picked = state.picked ?? [];
  picked.forEach((each, i) => {
    if (i === 0) return;
    const a = to(picked[i - 1].world), b = to(each.world);
    line(a, b);
    if (a && b) marks.append(shape('text', { x: (a[0] + b[0]) / 2 + 6, y: (a[1] + b[1]) / 2 }, `${each.distance_text} ${state.scene?.unit ?? ''}`));
  });
  for (const each of picked) {
    const at = to(each.world);
    if (at) marks.append(shape('circle', { cx: at[0], cy: at[1], r: 5 }));
  }
  for (const [id, world] of pointers) {
    const at = to(world), color = `hsl(${id * 137 % 360} 90% 45%)`;
    if (!at) continue;
    const arrow = shape('path', { class: 'pointer', 'data-page': id, d: `M${at[0]},${at[1]}l4,15l3.5,-6l7,-1.5z` });
    arrow.style.fill = color;
    marks.append(arrow, shape('text', { x: at[0] + 14, y: at[1] + 20 }, id));
  }
}

export function showPicked() {
  const panel = document.getElementById('picked'), last = state.picked?.at(-1);
  panel.hidden = !last;
  if (!last) return;
  const long = text => `${text} ${state.scene?.unit ?? ''}`;
  const rows = [['x', last.text[0]], ['y', last.text[1]], ['z', last.text[2]], ['point', last.point], ...last.attributes];
  if (last.distance_text) rows.push(['distance', long(last.distance_text)], ['height', long(last.height.toPrecision(6))], ['horizontal', long(last.horizontal.toPrecision(6))]);
  const table = document.createElement('table');
  for (const [name, value] of rows) {
    const row = table.insertRow();
    row.insertCell().textContent = name;
    row.insertCell().textContent = value;
  }
  panel.replaceChildren(table);
}
