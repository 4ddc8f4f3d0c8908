// The page: figures, view, tables, panels.
function header() {
  const root = element('header');
  root.append(element('h1', '', DATA.title), element('p', '', DATA.subtitle));
  if (DATA.problems.length) {
    const box = element('div', 'problems');
    for (const text of DATA.problems) box.append(element('div', '', text));
    root.append(box);
  }
  return root;
}

function figures() {
  const root = element('div', 'figures');
  for (const item of DATA.figures) {
    const box = element('div', 'figure' + (item.trend ? ' ' + item.trend : ''));
    box.append(element('div', 'label', item.label), element('div', 'value', item.value), element('div', 'note', item.note));
    root.append(box);
  }
  return root;
}

function card(title, hint, ...content) {
  const root = element('section', 'card');
  const head = element('h2', '', title);
  if (hint) head.append(element('span', 'hint', hint));
  root.append(head, ...content);
  return root;
}

function bar(times, longest) {
  const root = element('div', 'bar');
  ['moving', 'waiting', 'io'].forEach((name, k) => {
    const part = element('i', name);
    part.style.width = (longest ? 100 * times[k] / longest : 0) + '%';
    root.append(part);
  });
  return root;
}

// A table whose rows know their span of time: a click shows it, the row at the cursor is marked.
function table(data, timeline) {
  const root = element('table', data.columns.length > 12 ? 'wide' : '');
  const head = element('thead');
  const names = element('tr');
  for (const column of data.columns) names.append(element('th', column.kind === 'number' ? '' : 'text', column.name));
  head.append(names);
  const body = element('tbody');
  const marked = [];
  const longest = Math.max(0, ...data.rows.map((row) => row.bar.reduce((a, b) => a + b, 0)));
  for (const row of data.rows) {
    const line = element('tr', row.bad ? 'bad' : '');
    data.columns.forEach((column, k) => {
      const cell = element('td', { text: 'text', code: 'code' }[column.kind]);
      if (column.kind === 'bar') cell.append(bar(row.bar, longest));
      else cell.textContent = column.kind === 'text' ? row.cells[k].replaceAll('_', '_\u200b') : row.cells[k]; // may wrap there
      if (column.kind === 'code') cell.title = row.cells[k];
      if (row.trends[k]) cell.className = row.trends[k];
      line.append(cell);
    });
    if (row.spans.length) {
      line.dataset.start = row.spans[0][0];
      line.addEventListener('click', () => {
        const from = row.spans[0][0];
        const to = row.spans[row.spans.length - 1][1];
        const margin = 0.1 * (to - from) + 0.02;
        timeline.zoom(from - margin, to + margin);
        timeline.setCursor(from);
      });
      marked.push([line, row]);
    }
    body.append(line);
  }
  timeline.watch(() => {
    const t = timeline.cursor;
    for (const [line, row] of marked) {
      const now = row.spans.some(([from, to]) => from <= t && t < to);
      line.className = (row.bad ? 'bad' : '') + (now ? ' now' : '');
    }
  });
  root.append(head, body);
  const frame = element('div', 'scroll');
  frame.append(root);
  return frame;
}

function controls(timeline) {
  const root = element('div', 'controls');
  const button = element('button', '', 'Play');
  button.addEventListener('click', () => timeline.play(!timeline.playing));
  const slider = element('input');
  slider.type = 'range';
  slider.min = 0;
  slider.max = timeline.duration;
  slider.step = 'any';
  slider.value = 0;
  slider.setAttribute('aria-label', 'time');
  slider.addEventListener('input', () => { timeline.playing = false; timeline.setCursor(Number(slider.value)); });
  const rate = element('select');
  rate.setAttribute('aria-label', 'speed');
  for (const value of [0.1, 0.25, 0.5, 1, 2, 5]) {
    const option = element('option', '', value + 'x');
    option.value = value;
    if (value === 1) option.selected = true;
    rate.append(option);
  }
  rate.addEventListener('change', () => { timeline.rate = Number(rate.value); });
  const time = element('span', 'time', '0.00 s');
  timeline.watch(() => {
    slider.value = timeline.cursor;
    time.textContent = timeline.cursor.toFixed(2) + ' s';
    button.textContent = timeline.playing ? 'Pause' : 'Play';
  });
  root.append(button, slider, rate, time);
  return root;
}

function activityKey() {
  const root = element('span', 'key');
  for (const [name, text] of [['moving', 'moving'], ['waiting', 'waiting'], ['io', 'I/O']]) {
    const entry = element('span');
    entry.append(element('i', name), element('span', '', text));
    root.append(entry);
  }
  return root;
}

function main() {
  const root = document.getElementById('report');
  const timeline = new Timeline(DATA.duration);
  const view = new View3d(DATA.world, timeline);
  const viewCard = card('Robot', 'drag turns, shift-drag moves, wheel zooms', view.canvas, controls(timeline));
  viewCard.className = 'card view';
  if (!view.gl) viewCard.append(element('p', 'hint', 'This browser has no WebGL: the robot cannot be shown.'));
  const lines = card(DATA.lines.title, '', table(DATA.lines, timeline));
  lines.children[0].append(activityKey());
  const pair = element('div', 'pair');
  pair.append(viewCard, lines);
  const panels = DATA.panels.map((panel) => new Panel(panel, timeline));
  const plots = card('Over time', 'drag zooms, double click shows all, ctrl-wheel zooms around the cursor', ...panels.map((panel) => panel.root));
  root.append(header(), figures(), pair, card(DATA.motions.title, '', table(DATA.motions, timeline)), plots);
  document.addEventListener('keydown', (event) => {
    if (event.key !== ' ' || ['BUTTON', 'SELECT', 'INPUT'].includes(event.target.tagName)) return;
    event.preventDefault();
    timeline.play(!timeline.playing);
  });
  window.addEventListener('resize', () => timeline.tell());
  timeline.tell();
  return { timeline, view, panels };
}

const PAGE = main();
