// Panels: made of what the server says there is. No technique and no parameter is named here.
import { send, state } from './app.mjs';
import { drawProfile } from './profile.mjs';

const parts = {};  // by name of a panel, its body
const rows = new Map();  // by name of a parameter, its control

export function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith('on')) node[key] = value;
    else if (value === true) node.setAttribute(key, '');
    else if (value !== false && value !== undefined) node.setAttribute(key, value);
  }
  node.append(...children);
  return node;
}

function panel(title, open = false) {
  const body = element('div');
  const whole = element('details', { open, id: `panel-${title.replace(/\W+/g, '-').toLowerCase()}` }, element('summary', {}, title), body);
  parts[title] = body;
  return whole;
}

export function build(root) {
  root.append(panel('Technique', true), panel('Parameters', true), panel('Colour', true), panel('Classes'), panel('Light'), panel('Shadows'),
    panel('Eye-dome lighting'), panel('Picture'), panel('Analysis'), panel('Items'), panel('Clip box'), panel('Measure'), panel('Camera path'),
    panel('Save'), panel('Scene'));
  buildMeasure();
  buildPath();
  buildSave();
}

export function update(news) {
  if (news.techniques || news.technique || news.notes) techniques();
  if (news.controls) controls();
  if (news.color || news.picked) colors();
  if (news.scene !== undefined) { classes(); scene(); clip(); }
  if (news.draw) items();
  if (news.clip !== undefined) clip();
  if (news.path) parts.pathText.textContent = `${state.path.keys} keys`;
  if (news.path) parts.play.textContent = state.path.playing ? 'Stop' : 'Play';
  if (news.profile !== undefined) drawProfile(parts.profile, state.profile);
}

const note = text => element('p', { class: 'note' }, text);

function techniques() {
  const list = element('div', { class: 'techniques', role: 'group', 'aria-label': 'technique' });
  for (const each of state.techniques ?? [])
    list.append(element('button', { title: each.summary, 'aria-pressed': String(each.name === state.technique?.name), onclick: () => send({ do: 'technique', name: each.name }) }, each.name));
  keepFocus(parts.Technique, [list, ...(state.technique?.reason ? [note(`chosen: ${state.technique.reason}`)] : []), ...(state.notes ?? []).map(note)]);
}

// New content in the place of the old; the keyboard stays where it was.
function keepFocus(body, children) {
  const all = () => [...body.querySelectorAll('button,input,select')];
  const at = all().indexOf(document.activeElement);
  body.replaceChildren(...children);
  if (at >= 0) all()[at]?.focus();
}

// A slider that spans several powers of ten moves by them.
const toSlider = (c, v) => c.logarithmic ? Math.log(Math.max(v, c.low) / c.low) / Math.log(c.high / c.low) : (v - c.low) / (c.high - c.low || 1);
const ofSlider = (c, t) => c.logarithmic ? c.low * (c.high / c.low) ** t : c.low + t * (c.high - c.low);
const rounded = (c, v) => c.kind === 'integer' ? String(Math.round(v)) : String(Number(v.toPrecision(4)));

function makeControl(c) {
  const id = `p-${c.name}`, set = value => send({ do: 'set', name: c.name, value });
  const row = element('div', { class: 'control' });
  let show;
  if (c.kind === 'boolean') {
    const box = element('input', { type: 'checkbox', id, onchange: () => set(box.checked ? 'true' : 'false') });
    show = now => { box.checked = now.value === 'true'; };
    row.append(element('label', { for: id, title: c.help }, c.label), box);
  } else if (c.kind === 'choice') {
    const box = element('select', { id, onchange: () => set(box.value) }, ...c.choices.map(each => element('option', {}, each)));
    show = now => { box.value = now.value; };
    row.append(element('label', { for: id, title: c.help }, c.label), box);
  } else if (c.kind === 'integer' || c.kind === 'real') {
    const slider = element('input', { type: 'range', id: `${id}-slider`, min: 0, max: 1, step: 0.001, 'aria-label': `${c.label}, slider` });
    const box = element('input', { type: 'number', id, step: 'any' });
    let latest = c;
    slider.oninput = () => { box.value = rounded(latest, ofSlider(latest, Number(slider.value))); set(box.value); };
    box.onchange = () => { if (box.value !== '') set(box.value); };
    show = now => {
      latest = now;
      const value = Number(now.value);
      if (document.activeElement !== slider) slider.value = Number.isFinite(value) ? toSlider(now, value) : 0;
      if (document.activeElement !== box) box.value = Number.isFinite(value) ? String(Number(value.toPrecision(now.auto ? 4 : 6))) : '';
    };
    row.append(element('label', { for: id, title: c.help }, c.label), element('span', { class: 'number' }, slider, box));
  } else {
    const box = element('input', { type: 'text', id, onchange: () => set(box.value) });
    show = now => { if (document.activeElement !== box) box.value = now.value; };
    row.append(element('label', { for: id, title: c.help }, c.label), box);
  }
  const auto = element('button', { title: 'let it find its own value', onclick: () => set('auto') }, 'auto');
  const back = element('button', { title: `back to ${c.default}`, 'aria-label': `${c.label}: back to ${c.default}`, onclick: () => send({ do: 'reset', name: c.name }) }, '×');
  row.append(element('span', { class: 'tools' }, auto, back));
  row.show = now => {
    show(now);
    row.classList.toggle('changed', now.changed);
    auto.hidden = now.auto === undefined;
    auto.setAttribute('aria-pressed', String(now.auto === true));
    back.hidden = !now.changed;
  };
  return row;
}

let shownNames = '';
function controls() {
  const names = state.controls.map(c => `${c.group} ${c.name}`).join();
  if (names !== shownNames) {
    shownNames = names;
    rows.clear();
    const groups = new Map();
    for (const c of state.controls) {
      const title = parts[c.group] ? c.group : 'Parameters';
      if (!groups.has(title)) groups.set(title, []);
      const row = makeControl(c);
      rows.set(c.name, row);
      groups.get(title).push(row);
    }
    for (const title of ['Parameters', 'Light', 'Shadows', 'Eye-dome lighting', 'Picture', 'Analysis']) parts[title].replaceChildren(...(groups.get(title) ?? []));
    parts.Parameters.append(element('button', { onclick: () => send({ do: 'reset', name: '' }) }, 'All to their defaults'));
  }
  for (const c of state.controls) rows.get(c.name)?.show(c);
}

function field(label, value, hint, name) {
  const id = `color-${name}`;
  const box = element('input', { type: 'text', id, value, placeholder: hint, onchange: () => send({ do: 'color', name, value: box.value }) });
  return element('div', { class: 'control' }, element('label', { for: id }, label), box);
}

function choice(label, value, options, name) {
  const id = `color-${name}`;
  const box = element('select', { id, onchange: () => send({ do: 'color', name, value: box.value }) },
    ...options.map(each => element('option', { value: each, selected: each === value }, each || 'automatic')));
  return element('div', { class: 'control' }, element('label', { for: id }, label), box);
}

function colors() {
  const color = state.color;
  if (!color) return;
  const all = [choice('colour by', color.color_by, color.sources, 'color_by')];
  if (color.color_by === 'auto' && color.source) all.push(note(`auto: ${color.source}`));
  if (color.bar) {
    const ramp = element('div', { class: 'ramp', role: 'img', 'aria-label': `from ${color.low} to ${color.high}` });
    ramp.style.background = `linear-gradient(to right, ${color.bar.join()})`;
    all.push(choice('map', color.colormap, ['', ...color.colormaps], 'colormap'), ramp,
      element('div', { class: 'ends' }, element('span', {}, color.low), element('span', {}, color.high)),
      field('range', color.color_range, `${color.low},${color.high}`, 'color_range'));
  }
  for (const each of color.swatches ?? []) {
    const swatch = element('span', { class: 'swatch' });
    swatch.style.background = each.color;
    all.push(element('div', { class: 'row' }, swatch, each.label, element('span', { class: 'note' }, each.points.toLocaleString('en'))));
  }
  all.push(field('background', color.background_color, 'automatic', 'background_color'), field('one colour', color.point_color, 'automatic', 'point_color'),
    field('exposure', color.exposure, 'automatic', 'exposure'));
  const legend = element('input', { type: 'checkbox', id: 'legend', checked: color.legend, onchange: () => send({ do: 'legend', on: legend.checked }) });
  all.push(element('div', { class: 'row' }, legend, element('label', { for: 'legend' }, 'legend in the picture')));
  keepFocus(parts.Colour, all);
}

function classes() {
  const list = state.scene?.classes ?? [];
  document.getElementById('panel-classes').hidden = !list.length;
  keepFocus(parts.Classes, list.map(each => {
    const swatch = element('span', { class: 'swatch' }), id = `class-${each.id}`;
    swatch.style.background = each.color;
    const box = element('input', { type: 'checkbox', id, checked: each.shown, onchange: () => send({ do: 'class', id: each.id, shown: box.checked }) });
    return element('div', { class: 'row' }, box, swatch, element('label', { for: id }, each.name === `class ${each.id}` ? each.name : `${each.id} ${each.name}`), element('span', { class: 'note' }, each.points.toLocaleString('en')));
  }));
}

function items() {
  const list = state.draw ?? [], commit = next => send({ do: 'draw', rows: next });
  const edit = (i, change) => commit(list.map((each, k) => k === i ? { ...each, ...change } : each));
  const body = list.map((each, i) => {
    const on = element('input', { type: 'checkbox', checked: each.visible, 'aria-label': `${each.rule} is drawn`, onchange: () => edit(i, { visible: on.checked }) });
    const text = element('input', { type: 'text', value: each.rule, 'aria-label': 'SELECTION: TECHNIQUE name=value', onchange: () => edit(i, { rule: text.value }) });
    return element('div', { class: 'row' }, on, text, element('button', { 'aria-label': `remove ${each.rule}`, onclick: () => commit(list.filter((_, k) => k !== i)) }, '×'));
  });
  const fresh = element('input', { type: 'text', placeholder: 'class 6: surface disc_scale=2', 'aria-label': 'a new item' });
  body.push(element('div', { class: 'row' }, fresh, element('button', { onclick: () => { if (fresh.value) commit([...list, { rule: fresh.value, visible: true }]); } }, 'Add')));
  keepFocus(parts.Items, body);
}

function clip() {
  const box = state.clip ?? (state.scene?.box ? state.scene.box.flat() : null);
  if (!box) return;
  const fields = box.map((value, i) => element('input', { type: 'number', step: 'any', value: Number(value.toPrecision(9)), 'aria-label': `${'xyz'[i % 3]} ${i < 3 ? 'from' : 'to'}`, onchange: () => send({ do: 'clip', box: fields.map(each => Number(each.value)) }) }));
  const grid = element('div', { class: 'six' });
  for (let i = 0; i < 3; ++i) grid.append('xyz'[i], fields[i], fields[i + 3]);
  keepFocus(parts['Clip box'], [grid, element('button', { disabled: !state.clip, onclick: () => send({ do: 'clip', box: null }) }, 'No box')]);
}

function buildMeasure() {
  const width = element('input', { type: 'number', value: 1, min: 0, step: 'any', id: 'corridor' });
  const canvas = element('canvas', { id: 'profile', width: 640, height: 260, hidden: true });
  parts.profile = canvas;
  parts.Measure.append(note('Click: a point and what it holds. A second click: the distance. Ctrl and click: a longer line.'),
    element('div', { class: 'row' }, element('label', { for: 'corridor' }, 'corridor'), width, element('button', { onclick: () => send({ do: 'profile', width: Number(width.value) }) }, 'Profile'),
      element('button', { onclick: () => send({ do: 'clear' }) }, 'Clear')), canvas);
}

function buildPath() {
  parts.pathText = note('0 keys');
  parts.play = element('button', { onclick: () => send({ do: 'path', what: state.path?.playing ? 'stop' : 'play' }) }, 'Play');
  const seconds = element('input', { type: 'number', value: 2, min: 0.1, step: 'any', id: 'seconds', onchange: () => send({ do: 'path', what: 'seconds', value: Number(seconds.value) }) });
  parts['Camera path'].append(parts.pathText, element('div', { class: 'row' }, element('button', { onclick: () => send({ do: 'path', what: 'add' }) }, 'Add this view'), parts.play,
    element('button', { onclick: () => send({ do: 'path', what: 'clear' }) }, 'Clear')), element('div', { class: 'row' }, element('label', { for: 'seconds' }, 'seconds a key'), seconds));
}

function buildSave() {
  const size = element('input', { type: 'text', id: 'shot-size', placeholder: '3840x2160' });
  parts.Save.append(element('div', { class: 'row' }, element('label', { for: 'shot-size' }, 'size'), size, element('button', { id: 'shoot-size', onclick: () => {
    const found = /^\s*(\d+)\s*[x×,]\s*(\d+)\s*$/.exec(size.value);
    if (found) send({ do: 'shoot', width: Number(found[1]), height: Number(found[2]) });
  } }, 'Save PNG')), note('The bytes are those of the copied command.'));
}

function scene() {
  const s = state.scene;
  if (!s) return;
  const body = [note(`${(state.files ?? []).join(', ')}`), note(`${s.formats}: ${s.points_read.toLocaleString('en')} points, ${s.points_shown.toLocaleString('en')} shown`), note(`up ${s.up}, unit ${s.unit}`)];
  if (s.crs) body.push(note(s.crs));
  if (s.is_room) {
    const whole = element('input', { type: 'checkbox', id: 'whole', checked: s.whole, onchange: () => send({ do: 'whole', on: whole.checked }) });
    body.push(element('div', { class: 'row' }, whole, element('label', { for: 'whole' }, 'whole room')));
  }
  keepFocus(parts.Scene, body);
}
