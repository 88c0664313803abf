// Turns pictures that were taken before, and measures by their depth. A plain script, as a page from a disk may load
// no modules and read no pictures.
'use strict';
(() => {
  const $ = id => document.getElementById(id);
  const canvas = $('picture'), paper = canvas.getContext('2d'), views = published.views;
  const rings = [...new Set(views.map(v => v.elevation))].sort((a, b) => a - b)
    .map(e => views.filter(v => v.elevation === e).sort((a, b) => a.turn - b.turn));
  const first = { ring: rings.findIndex(r => r.includes(views[0])), turn: views[0].turn, zoom: 1, x: 0.5, y: 0.5 };
  // Where one looks from; `zoom` times as large as fits, with the place x, y of the picture (0 to 1) in the middle.
  const now = { ...first };
  let points = [], aims = false, shown = null;

  // Pictures: the wanted one first, then its neighbours, then all.
  function load(view) {
    if (view.image) return;
    view.image = new Image();
    view.image.onload = () => { view.ready = true; if (view === wanted()) paint(); more(); };
    view.image.onerror = () => { view.failed = true; more(); };
    view.image.src = view.picture;
  }
  function more() {
    const ring = rings[now.ring], at = ring.indexOf(wanted());
    if (views.filter(v => v.image && !v.ready && !v.failed).length > 3) return;
    for (let i = 1; i <= ring.length / 2; ++i)
      for (const side of [i, -i]) {
        const next = ring[(at + side + ring.length) % ring.length];
        if (!next.image) return load(next);
      }
    const other = views.find(v => !v.image);
    if (other) load(other);
  }
  const apart = (a, b) => { const d = Math.abs(a - b) % 360; return Math.min(d, 360 - d); };
  const nearest = (all, turn) => all.reduce((a, b) => apart(b.turn, turn) < apart(a.turn, turn) ? b : a);
  const wanted = () => nearest(rings[now.ring], now.turn);

  const fits = () => Math.min(canvas.width / (published.width * published.reach[0]), canvas.height / (published.height * published.reach[1]));
  // The picture lies at left, top of the canvas in pixels of the screen, `scale` of them for one of its own.
  function frame() {
    const scale = fits() * now.zoom;
    return { scale, left: canvas.width / 2 - now.x * published.width * scale, top: canvas.height / 2 - now.y * published.height * scale };
  }
  const density = () => Math.min(window.devicePixelRatio || 1, 3);
  // A pixel of the pictures comes to be two of the page's a side, no more.
  const mostZoom = () => Math.max(1, 2 * density() / fits());

  function paint() {
    const view = wanted();
    load(view);
    const best = view.ready ? view : shown ?? views.find(v => v.ready);
    $('wait').hidden = !!view.ready;
    $('wait').textContent = view.failed ? `${view.picture} is missing` : 'loading';
    const { scale, left, top } = frame();
    paper.fillStyle = published.background;
    paper.fillRect(0, 0, canvas.width, canvas.height);
    if (best) {
      shown = best;
      paper.imageSmoothingQuality = 'high';
      paper.drawImage(best.image, left, top, published.width * scale, published.height * scale);
    }
    canvas.dataset.view = `${view.turn},${view.elevation}`;
    canvas.dataset.shown = best ? `${best.turn},${best.elevation}` : '';
    drawMarks(best ?? view);
    writeAddress();
  }

  // Cameras: eye space looks along `forward`; pixel centres are at halves, rows go down.
  const sub = (a, b) => a.map((v, i) => v - b[i]), dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = a => { const n = Math.hypot(...a) || 1; return a.map(v => v / n); };
  function axes(view) {
    const forward = unit(sub(view.target, view.position)), right = unit(cross(forward, view.up));
    return { forward, right, above: cross(right, forward) };
  }
  function place(view, x, y, depth) {
    const { forward, right, above } = axes(view), [fx, fy, cx, cy] = view.lens, far = view.orthographic ? 1 : depth;
    const u = (x - cx) / fx * far, v = -(y - cy) / fy * far;
    return view.position.map((p, i) => p + u * right[i] + v * above[i] + depth * forward[i]);
  }
  function project(view, world) {
    const { forward, right, above } = axes(view), [fx, fy, cx, cy] = view.lens, v = sub(world, view.position);
    const depth = dot(v, forward), far = view.orthographic ? 1 : depth;
    return far > 0 ? [cx + fx * dot(v, right) / far, cy - fy * dot(v, above) / far, depth] : null;
  }
  // Drawn heights may be exaggerated; those of the scan are not.
  function trueOf(world) {
    const height = dot(world, published.up) * (1 / published.exaggeration - 1);
    return world.map((v, i) => v + height * published.up[i]);
  }

  // Depth comes as a script of its own when somebody measures.
  window.takeDepth = (i, packed) => { views[i].packed = packed; };
  async function depthOf(view) {
    if (view.depths) return view.depths;
    if (!view.packed) await new Promise((done, fail) => {
      const script = document.createElement('script');
      script.src = view.depth;
      script.onload = done;
      script.onerror = () => fail(new Error(`${view.depth} is missing`));
      document.head.append(script);
    });
    if (!window.DecompressionStream) throw new Error('this browser is too old to measure');
    const { width, height, near, far, data } = view.packed;
    const bytes = Uint8Array.from(atob(data), c => c.charCodeAt(0));
    const planes = new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer());
    const count = width * height, values = new Uint16Array(count);
    for (let i = 0, before = 0; i < count; ++i) values[i] = before = before + planes[i] + 256 * planes[count + i] & 65535;
    view.packed = null;
    const step = (far - near) / 65534;
    return view.depths = { width, height, step, at: (x, y) => values[y * width + x] ? near + (values[y * width + x] - 1) * step : 0 };
  }

  // The drawn place nearest to a pixel of the picture, within `reach` of its pixels.
  function nearestDrawn(depths, x, y, reach) {
    let best = null;
    const r = Math.ceil(reach);
    for (let j = Math.max(0, Math.floor(y) - r); j <= Math.min(depths.height - 1, Math.floor(y) + r); ++j)
      for (let i = Math.max(0, Math.floor(x) - r); i <= Math.min(depths.width - 1, Math.floor(x) + r); ++i) {
        const away = Math.hypot(i + 0.5 - x, j + 0.5 - y);
        if (depths.at(i, j) && away <= reach + 1 && (!best || away < best.away)) best = { x: i + 0.5, y: j + 0.5, depth: depths.at(i, j), away };
      }
    return best;
  }

  async function measure(canvasX, canvasY) {
    const view = shown ?? wanted(), { scale, left, top } = frame();
    let depths;
    try { depths = await depthOf(view); } catch (error) { return tell(error.message); }
    const found = nearestDrawn(depths, (canvasX - left) / scale, (canvasY - top) / scale, Math.max(1.5, 8 * density() / scale));
    if (!found) return tell('nothing is drawn there');
    if (points.length === 2) points = [];
    const drawn = place(view, found.x, found.y, found.depth);
    const pixel = (view.orthographic ? 1 : found.depth) / view.lens[0];
    points.push({ drawn, world: trueOf(drawn), error: Math.hypot(pixel, depths.step) });
    report();
    paint();
  }
  function tell(text) { $('measured').textContent = text; $('measured').hidden = !text; }
  const digits = error => Math.max(0, Math.min(6, -Math.floor(Math.log10(error))));
  function measured() {
    const [a, b] = points, { symbol, metres } = published.unit, factor = metres || 1, name = metres ? 'm' : symbol;
    const way = sub(b.world, a.world), rise = dot(way, published.up), error = factor * Math.hypot(a.error, b.error);
    const text = value => `${(factor * value).toFixed(digits(error))} ${name}`;
    return { distance: factor * Math.hypot(...way), error, distanceText: text(Math.hypot(...way)), errorText: `${error.toFixed(digits(error))} ${name}`,
      heightText: text(rise), levelText: text(Math.sqrt(Math.max(0, dot(way, way) - rise * rise))) };
  }
  function report() {
    $('clear').disabled = !points.length;
    if (!points.length) return tell('');
    const last = points[points.length - 1], where = last.world.map(v => v.toFixed(digits(last.error))).join(', ');
    if (points.length === 1) return tell(`${where}\nanother click measures the distance`);
    if (published.unit.symbol === '°') return tell(`${where}\ndegrees have no length`);
    const m = measured();
    tell(`distance ${m.distanceText} (± ${m.errorText})\nheight ${m.heightText}, level ${m.levelText}\n${where}`);
  }
  window.publishedState = () => ({ ...now, points: points.map(p => p.world), measured: points.length === 2 ? measured() : null });
  window.publishedPlace = world => { const { scale, left, top } = frame(), p = project(shown ?? wanted(), world), d = canvas.width / canvas.clientWidth; return p && [(left + p[0] * scale) / d, (top + p[1] * scale) / d, p[2]]; };

  function shape(name, attributes, text) {
    const node = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    if (text) node.textContent = text;
    $('marks').append(node);
  }
  function drawMarks(view) {
    $('marks').replaceChildren();
    const { scale, left, top } = frame(), d = canvas.width / canvas.clientWidth;
    const at = points.map(p => project(view, p.drawn)).map(p => p && [(left + p[0] * scale) / d, (top + p[1] * scale) / d]);
    if (at[0] && at[1]) {
      shape('line', { x1: at[0][0], y1: at[0][1], x2: at[1][0], y2: at[1][1] });
      if (published.unit.symbol !== '°') shape('text', { x: (at[0][0] + at[1][0]) / 2 + 8, y: (at[0][1] + at[1][1]) / 2 }, measured().distanceText);
    }
    for (const p of at) if (p) shape('circle', { cx: p[0], cy: p[1], r: 5 });
    if (aims) {
      const x = canvas.clientWidth / 2, y = canvas.clientHeight / 2;
      shape('path', { class: 'aim', d: `M${x - 12},${y}h9m6,0h9M${x},${y - 12}v9m0,6v9` });
    }
  }

  // Addresses: #view=TURN,ELEVATION and, nearer, &zoom=F,X,Y.
  let written = '', timer = 0;
  function address() {
    const view = wanted();
    return `#view=${view.turn},${view.elevation}` + (now.zoom > 1.001 ? `&zoom=${now.zoom.toFixed(2)},${now.x.toFixed(4)},${now.y.toFixed(4)}` : '');
  }
  function writeAddress() {
    clearTimeout(timer);
    timer = setTimeout(() => { if (location.hash !== (written = address())) location.replace(written); }, 200);
  }
  function readAddress() {
    if (location.hash === written) return false;
    const view = /view=(-?[\d.]+),(-?[\d.]+)/.exec(location.hash), zoom = /zoom=([\d.]+),([\d.]+),([\d.]+)/.exec(location.hash);
    if (!view) return false;
    now.turn = Number(view[1]);
    now.ring = rings.reduce((best, ring, i) => Math.abs(ring[0].elevation - view[2]) < Math.abs(rings[best][0].elevation - view[2]) ? i : best, 0);
    [now.zoom, now.x, now.y] = zoom ? [Math.max(1, Number(zoom[1])), Number(zoom[2]), Number(zoom[3])] : [1, 0.5, 0.5];
    return true;
  }
  addEventListener('hashchange', () => { if (readAddress()) { clamp(); paint(); } });

  // Hands.
  function clamp() {
    now.zoom = Math.min(mostZoom(), Math.max(1, now.zoom));
    for (const [side, all, picture] of [['x', canvas.width, published.width], ['y', canvas.height, published.height]]) {
      const half = all / 2 / (frame().scale * picture);  // of the window, in the picture
      now[side] = half >= 0.5 ? 0.5 : Math.min(1 - half, Math.max(half, now[side]));
    }
  }
  function turn(degrees) { now.turn = (now.turn + degrees + 720) % 360; paint(); }
  function step(sides) {
    const ring = rings[now.ring], at = ring.indexOf(wanted());
    now.turn = ring[(at + sides + ring.length) % ring.length].turn;
    paint();
  }
  function rise(steps) { now.ring = Math.min(rings.length - 1, Math.max(0, now.ring + steps)); paint(); }
  function zoom(factor, x = canvas.width / 2, y = canvas.height / 2) {
    const before = frame(), at = [(x - before.left) / before.scale, (y - before.top) / before.scale];
    now.zoom = Math.min(mostZoom(), Math.max(1, now.zoom * factor));
    const { scale } = frame();
    now.x = (at[0] - (x - canvas.width / 2) / scale) / published.width;
    now.y = (at[1] - (y - canvas.height / 2) / scale) / published.height;
    clamp();
    paint();
  }
  function pan(dx, dy) {
    const { scale } = frame();
    now.x -= dx / scale / published.width;
    now.y -= dy / scale / published.height;
    clamp();
    paint();
  }
  function home() { Object.assign(now, first); paint(); }
  function clear() { points = []; report(); paint(); }

  const fingers = new Map();
  let moved = 0, risen = 0, pans = false, pinch = null;
  const spot = event => {
    const box = canvas.getBoundingClientRect(), d = canvas.width / box.width;
    return { x: (event.clientX - box.left) * d, y: (event.clientY - box.top) * d };
  };
  const between = () => {
    const [a, b] = fingers.values();
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.max(1, Math.hypot(a.x - b.x, a.y - b.y)) };
  };
  canvas.addEventListener('pointerdown', event => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, spot(event));
    if (fingers.size === 1) { moved = risen = 0; pans = event.shiftKey || event.button !== 0; }
    if (fingers.size === 2) { pinch = between(); moved = 1e9; }
    if (aims) { aims = false; paint(); }
  });
  canvas.addEventListener('pointermove', event => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const at = spot(event), dx = at.x - before.x, dy = at.y - before.y;
    fingers.set(event.pointerId, at);
    if (pinch && fingers.size === 2) {
      const next = between();
      pan(next.x - pinch.x, next.y - pinch.y);
      zoom(next.apart / pinch.apart, next.x, next.y);
      pinch = next;
    } else if (fingers.size === 1 && !pinch) {
      moved += Math.abs(dx) + Math.abs(dy);
      if (moved <= 4 * density()) return;
      if (pans) return pan(dx, dy);
      // The width of the window is half a turn.
      turn(-180 * dx / canvas.width);
      risen += dy / canvas.height * 3;
      if (Math.abs(risen) >= 0.5) { rise(Math.sign(risen)); risen = 0; }
    }
  });
  function release(event) {
    const at = fingers.get(event.pointerId);
    fingers.delete(event.pointerId);
    if (at && event.type === 'pointerup' && moved <= 4 * density() && event.button === 0 && !event.shiftKey) measure(at.x, at.y);
    if (!fingers.size) pinch = null;
  }
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('contextmenu', event => event.preventDefault());
  canvas.addEventListener('wheel', event => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1, at = spot(event);
    zoom(Math.exp(-Math.max(-300, Math.min(300, event.deltaY * lines)) / 500), at.x, at.y);
  }, { passive: false });

  document.addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key, pace = canvas.height / 10, onButton = document.activeElement?.closest?.('button, a');
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (arrows[key]) {
      const [x, y] = arrows[key];
      if (event.shiftKey) pan(-pace * x, pace * y); else if (x) step(x); else rise(y);
    } else if (key === '+' || key === '=') zoom(1.25);
    else if (key === '-') zoom(0.8);
    else if (key === 'Home') home();
    else if (key === 'Escape') { aims = false; clear(); }
    else if (key === 'Enter' && !onButton) { aims = true; measure(canvas.width / 2, canvas.height / 2); }
    else return;
    event.preventDefault();
  });
  for (const button of document.querySelectorAll('[data-turn]')) button.onclick = () => step(Number(button.dataset.turn));
  for (const button of document.querySelectorAll('[data-rise]')) button.onclick = () => rise(Number(button.dataset.rise));
  for (const button of document.querySelectorAll('[data-zoom]')) button.onclick = () => zoom(button.dataset.zoom > 0 ? 1.25 : 0.8);
  $('home').onclick = home;
  $('clear').onclick = clear;
  $('link').onclick = async () => {
    const text = location.href.split('#')[0] + address();
    try { await navigator.clipboard.writeText(text); tell('the address of this view is copied'); } catch { tell(text); }
  };

  new ResizeObserver(() => {
    const box = $('view').getBoundingClientRect();
    canvas.width = Math.max(1, Math.round(box.width * density()));
    canvas.height = Math.max(1, Math.round(box.height * density()));
    clamp();
    paint();
  }).observe($('view'));
  readAddress();
})();
