// The line to the server, the picture and the hand that moves it.
import { build, update } from './panels.mjs';
import { drawMarks, showPicked } from './marks.mjs';
import { makeWarper, unpack } from './warp.mjs';

const $ = id => document.getElementById(id);
const canvas = $('picture'), paper = canvas.getContext('2d');
export const state = {}, pointers = new Map();  // of others: the place that each points at
let socket, retry = 500, shown = null, camera = null, newest = 0, said = 0;
let depth = null, wanted = null, background = '#ffffff';  // of the picture; the camera as it now is
const warp = makeWarper();

export function send(message) {
  if (socket?.readyState !== WebSocket.OPEN) return;
  socket.send(JSON.stringify(message));
  ++said;
  if (message.do !== 'got' && message.do !== 'pointer') canvas.dataset.said = said;  // what may change the picture
}

export function say(text, isError = false) {
  const line = document.createElement('p');
  line.textContent = text;
  line.classList.toggle('error', isError);
  $('says').append(line);
  while ($('says').children.length > 4) $('says').firstChild.remove();
  setTimeout(() => line.remove(), isError ? 9000 : 4500);
}

function connect() {
  const address = new URL('socket', location.href);
  address.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
  socket = new WebSocket(address);
  socket.binaryType = 'arraybuffer';
  socket.onopen = () => { retry = 500; newest = said = 0; sendSize(); };
  socket.onmessage = event => typeof event.data === 'string' ? hear(JSON.parse(event.data)) : take(event.data);
  socket.onclose = event => {
    wait(event.reason ? `closed: ${event.reason}` : 'the server does not answer; trying again');
    setTimeout(connect, retry);
    retry = Math.min(8000, 2 * retry);
  };
}

function hear(message) {
  if (message.say) say(message.say, message.error);
  if (message.command) copy(message.command);
  if (message.camera) { wanted = message.camera; paint(); }
  if (message.share) { state.share = message.share; pointers.clear(); }
  if (message.pointer) {
    if (message.pointer.at) pointers.set(message.pointer.id, message.pointer.at); else pointers.delete(message.pointer.id);
    drawMarks(camera, canvas);
  }
  if (!message.state) return;
  Object.assign(state, message.state);
  update(message.state);
  if (message.state.picked || message.state.clip !== undefined) { drawMarks(camera, canvas); showPicked(); }
  if (message.state.files) document.title = `${state.files[0] ?? ''}${state.files.length > 1 ? ` and ${state.files.length - 1} more` : ''} - sfumato`;
  if (message.state.history) { $('undo').disabled = !state.history.undo; $('redo').disabled = !state.history.redo; }
  if (message.state.activity) wait(state.activity.text, state.activity.fraction);
}

function wait(text, fraction) {
  if (!shown && !text) text = 'opening';
  $('wait').hidden = !text;
  $('wait').classList.toggle('quiet', !!shown);
  $('wait').firstChild.textContent = text;
  const bar = $('wait').querySelector('progress');
  if (fraction > 0) bar.value = fraction; else bar.removeAttribute('value');
}

async function take(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const packed = header.depth?.bytes ?? 0, blob = new Blob([new Uint8Array(buffer, 4 + length + packed)], { type: header.type });
  if (header.kind === 'shot') return save(blob, header.name);
  const [picture, depths] = await Promise.all([createImageBitmap(blob), unpack(header.depth, new Uint8Array(buffer, 4 + length, packed))].map(each => each.catch(() => null)));
  send({ do: 'got', id: header.id });
  if (!picture || header.id < newest) return picture?.close();
  newest = header.id;
  shown?.close();
  shown = picture;
  camera = header.camera;
  depth = depths;
  background = header.background;
  canvas.dataset.exact = header.exact;
  canvas.dataset.heard = header.heard;
  canvas.dataset.technique = header.technique;
  canvas.dataset.pictures = 1 + Number(canvas.dataset.pictures ?? 0);
  paint();
  wait(state.activity?.text ?? '', state.activity?.fraction);
}

function paint() {
  if (!shown) return;
  const isOld = wanted && depth && JSON.stringify(wanted) !== JSON.stringify(camera);
  const bent = isOld && warp?.(shown, depth, camera, wanted, background, canvas.width, canvas.height);
  if (bent) canvas.dataset.warped = 1 + Number(canvas.dataset.warped ?? 0);
  paper.imageSmoothingEnabled = !bent && shown.width !== canvas.width;
  paper.drawImage(bent || shown, 0, 0, canvas.width, canvas.height);
  drawMarks(bent ? wanted : camera, canvas);
}

function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  window.lastShot = blob;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  say(`saved ${name}`);
}

async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    say('the command is copied');
  } catch {
    const field = document.createElement('textarea');
    field.value = text;
    document.body.append(field);
    field.select();
    const done = document.execCommand('copy');
    field.remove();
    say(done ? 'the command is copied' : text);
  }
  canvas.dataset.command = text;
}

const density = () => Math.min(window.devicePixelRatio || 1, 2);
function sendSize() {
  const box = canvas.getBoundingClientRect();
  const width = Math.max(16, Math.min(4096, Math.round(box.width * density())));
  const height = Math.max(16, Math.min(4096, Math.round(box.height * density())));
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width; canvas.height = height;
    paint();
  }
  send({ do: 'size', width, height });
}
new ResizeObserver(sendSize).observe(canvas);

// Hands: what pointers do is gathered and sent once a frame, so that nothing queues.
const fingers = new Map();
let pending = null, grabbed = null, moved = 0, pinch = null;
const place = event => {
  const box = canvas.getBoundingClientRect();
  return { x: (event.clientX - box.left) * canvas.width / box.width, y: (event.clientY - box.top) * canvas.height / box.height };
};
function later(key, message, add) {
  pending ??= (requestAnimationFrame(flush), new Map());
  const before = pending.get(key);
  pending.set(key, before && add ? add(before, message) : message);
}
function flush() {
  for (const message of pending.values()) send(message);
  pending = null;
}
const addDrag = (a, b) => ({ do: 'drag', dx: a.dx + b.dx, dy: a.dy + b.dy });
const addSteps = (a, b) => ({ ...b, steps: a.steps + b.steps });
function grab(kind, at) {
  if (pending) flush();
  grabbed = kind;
  send({ do: 'grab', kind, ...at });
}

canvas.addEventListener('pointerdown', event => {
  canvas.setPointerCapture(event.pointerId);
  canvas.focus({ preventScroll: true, focusVisible: false });
  const at = place(event);
  fingers.set(event.pointerId, at);
  if (fingers.size === 1) {
    moved = 0;
    grab(event.ctrlKey && event.shiftKey ? 'light' : event.button === 0 && !event.shiftKey ? 'rotate' : 'pan', at);
  } else if (fingers.size === 2) {
    const [a, b] = fingers.values();
    pinch = { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
    moved = 100;
    grab('pan', { x: pinch.x, y: pinch.y });
  }
});
canvas.addEventListener('pointermove', event => {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  const at = place(event);
  fingers.set(event.pointerId, at);
  if (fingers.size === 1 && grabbed) {
    moved += Math.abs(at.x - before.x) + Math.abs(at.y - before.y);
    if (moved > 3 * density()) later('drag', { do: 'drag', dx: at.x - before.x, dy: at.y - before.y }, addDrag);
  } else if (fingers.size === 2 && pinch) {
    const [a, b] = fingers.values();
    const now = { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.max(1, Math.hypot(a.x - b.x, a.y - b.y)) };
    later('drag', { do: 'drag', dx: now.x - pinch.x, dy: now.y - pinch.y }, addDrag);
    later('zoom', { do: 'zoom', steps: 8 * Math.log(now.apart / Math.max(1, pinch.apart)), x: now.x, y: now.y }, addSteps);
    pinch = now;
  }
});
function release(event) {
  const at = fingers.get(event.pointerId);
  fingers.delete(event.pointerId);
  if (pending) flush();
  if (at && event.type === 'pointerup' && grabbed === 'rotate' && moved <= 3 * density() && event.button === 0)
    send({ do: 'pick', ...at, add: event.ctrlKey || event.metaKey });
  grabbed = null;
  if (fingers.size < 2) pinch = null;
}
let pointing = 0;
canvas.addEventListener('pointermove', event => {
  if (!state.share || pointing) return;
  pointing = setTimeout(() => { pointing = 0; send({ do: 'pointer', ...place(event) }); }, 60);
});
canvas.addEventListener('pointerleave', () => {
  if (!state.share) return;
  clearTimeout(pointing);
  pointing = 0;
  send({ do: 'pointer', away: true });
});
canvas.addEventListener('pointerup', release);
canvas.addEventListener('pointercancel', release);
canvas.addEventListener('contextmenu', event => event.preventDefault());
canvas.addEventListener('dblclick', event => send({ do: 'look_at', ...place(event) }));
canvas.addEventListener('wheel', event => {
  event.preventDefault();
  const unit = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1;
  const steps = Math.max(-5, Math.min(5, -event.deltaY * unit / 100));
  later('zoom', event.shiftKey ? { do: 'angle', steps } : { do: 'zoom', steps, ...place(event) }, addSteps);
}, { passive: false });

const techniqueOf = key => state.techniques?.[Number(key) - 1]?.name;
document.addEventListener('keydown', event => {
  const key = event.key, command = event.ctrlKey || event.metaKey;
  const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(document.activeElement?.tagName ?? '');
  if (key === 'F9') { togglePanels(); return event.preventDefault(); }
  if (typing) return;
  const middle = { x: canvas.width / 2, y: canvas.height / 2 };
  const step = canvas.height / 24;
  const arrows = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
  if (command) {
    const deed = { z: 'undo', y: 'redo' }[key.toLowerCase()];
    if (deed) send({ do: deed });
    else if (key === 's') shoot();
    else if (key === 'c' && !String(getSelection())) send({ do: 'command' });
    else return;
  } else if (arrows[key] && document.activeElement === canvas) {
    send({ do: 'grab', kind: event.shiftKey ? 'pan' : 'rotate', ...middle });
    send({ do: 'drag', dx: arrows[key][0], dy: arrows[key][1] });
  } else if (key === '+' || key === '=' || key === '-') {
    send({ do: 'zoom', steps: key === '-' ? -1 : 1, ...middle });
  } else if (techniqueOf(key)) send({ do: 'technique', name: techniqueOf(key) });
  else if (key === 'Home') send({ do: 'view', name: 'reset' });
  else if (key === 'f') send({ do: 'view', name: 'frame' });
  else if (key === 'p') send({ do: 'view', name: 'parallel' });
  else if (key === 'l') send({ do: 'legend', on: !state.color?.legend });
  else if (key === 'Escape') send({ do: 'clear' });
  else if (key === 'k') send({ do: 'path', what: 'add' });
  else if ('wasdqe'.includes(key.toLowerCase())) {
    const way = { w: [0, 0, 1], s: [0, 0, -1], a: [-1, 0, 0], d: [1, 0, 0], e: [0, 1, 0], q: [0, -1, 0] }[key.toLowerCase()];
    later('fly', { do: 'fly', way, seconds: 0.05, fast: event.shiftKey });
  } else return;
  event.preventDefault();
});

function shoot(width = canvas.width, height = canvas.height) { send({ do: 'shoot', width, height }); }
function togglePanels(on) {
  const bare = document.querySelector('main').classList.toggle('bare', on === undefined ? undefined : !on);
  $('toggle').setAttribute('aria-expanded', String(!bare));
}
$('toggle').onclick = () => togglePanels();
$('undo').onclick = () => send({ do: 'undo' });
$('redo').onclick = () => send({ do: 'redo' });
$('shoot').onclick = () => shoot();
$('copy').onclick = () => send({ do: 'command' });
$('side').onchange = event => { if (event.target.value) send({ do: 'view', name: event.target.value }); event.target.value = ''; };
for (const button of document.querySelectorAll('[data-view]')) button.onclick = () => send({ do: 'view', name: button.dataset.view });
if (matchMedia('(max-width: 760px)').matches || window !== window.parent) togglePanels(false);  // narrow, or in a notebook: the scan first

build($('panels'));
wait('opening');
connect();
