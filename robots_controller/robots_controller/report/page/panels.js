// Panels: plots over the shared time axis. Kinds: lines, steps (numbers that hold), logic (on and off), spans.
const LEFT = 62;
const RIGHT = 12;
const AXIS = 20;
const ROW = 24;
const ACTIVITY_COLOURS = { moving: '#0b8a83', waiting: '#c9d1d9', io: '#e8890c' };

function ticks(low, high, count) {
  const raw = (high - low) / Math.max(count, 1);
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= raw * 0.999);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return { found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

class Panel {
  constructor(panel, timeline) {
    this.panel = panel;
    this.timeline = timeline;
    this.series = panel.series.map((item) => ({ ...item, t: ARRAYS[item.t], y: unpacked(item), shown: true }));
    this.root = element('div', 'panel');
    const head = element('div', 'head');
    head.append(element('b', '', panel.title));
    this.values = [];
    if (panel.kind === 'lines') {
      for (const item of this.series) head.append(this.legend(item));
    }
    this.canvas = element('canvas');
    this.canvas.setAttribute('aria-label', panel.title);
    this.root.append(head, this.canvas);
    this.height = panel.kind === 'lines' ? 138 : Math.max(panel.rows || this.series.length, 1) * ROW + AXIS + 4;
    this.canvas.style.height = this.height + 'px';
    this.listen();
    timeline.watch(() => this.draw());
  }

  legend(item) {
    const entry = element('span', 'legend');
    const swatch = element('i');
    swatch.style.background = item.colour;
    const value = element('em', '', '');
    value.style.minWidth = '58px';
    entry.append(swatch, element('span', '', item.name), value);
    entry.addEventListener('click', () => {
      item.shown = !item.shown;
      entry.className = item.shown ? 'legend' : 'legend off';
      this.draw();
    });
    this.values.push(value);
    return entry;
  }

  listen() {
    const canvas = this.canvas;
    const time = (event) => {
      const box = canvas.getBoundingClientRect();
      const part = (event.clientX - box.left - LEFT) / Math.max(box.width - LEFT - RIGHT, 1);
      return this.timeline.start + part * (this.timeline.end - this.timeline.start);
    };
    canvas.addEventListener('pointerdown', (event) => {
      this.drag = time(event);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!this.timeline.playing) this.timeline.setCursor(time(event));
    });
    canvas.addEventListener('pointerup', (event) => {
      const from = this.drag;
      const to = time(event);
      this.drag = undefined;
      const shown = this.timeline.end - this.timeline.start;
      if (from !== undefined && Math.abs(to - from) > 0.01 * shown) {
        this.timeline.zoom(Math.min(from, to), Math.max(from, to));
      }
    });
    canvas.addEventListener('dblclick', () => this.timeline.reset());
    canvas.addEventListener('wheel', (event) => {
      if (!event.ctrlKey && !event.shiftKey) return;  // the page scrolls
      event.preventDefault();
      this.timeline.zoomAround(time(event), Math.exp(0.002 * (event.deltaY || event.deltaX)));
    }, { passive: false });
  }

  draw() {
    const ratio = window.devicePixelRatio || 1;
    const width = this.canvas.clientWidth;
    if (!width) return;
    this.width = width;
    if (this.canvas.width !== Math.round(width * ratio)) this.canvas.width = Math.round(width * ratio);
    if (this.canvas.height !== Math.round(this.height * ratio)) this.canvas.height = Math.round(this.height * ratio);
    const pen = this.canvas.getContext('2d');
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, this.height);
    pen.font = '11px system-ui, sans-serif';
    pen.lineWidth = 1;
    this.drawTimes(pen);
    if (this.panel.kind === 'lines') this.drawLines(pen);
    else if (this.panel.kind === 'spans') this.drawSpans(pen);
    else this.drawRows(pen);
    this.drawCursor(pen);
  }

  x(t) {
    const { start, end } = this.timeline;
    return LEFT + (t - start) / (end - start) * (this.width - LEFT - RIGHT);
  }

  get bottom() { return this.height - AXIS; }

  clipped(pen, paint) {
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, 0, this.width - LEFT - RIGHT, this.bottom + 1);
    pen.clip();
    paint();
    pen.restore();
  }

  drawTimes(pen) {
    const { start, end } = this.timeline;
    const { found, digits } = ticks(start, end, this.width / 110);
    pen.textAlign = 'center';
    pen.textBaseline = 'top';
    for (const t of found) {
      const x = Math.round(this.x(t)) + 0.5;
      pen.strokeStyle = '#edf0f3';
      this.upright(pen, x);
      pen.fillStyle = '#7b8794';
      pen.fillText(t.toFixed(digits) + ' s', x, this.bottom + 4);
    }
    pen.strokeStyle = '#c3cbd3';
    pen.strokeRect(LEFT + 0.5, 2.5, this.width - LEFT - RIGHT - 1, this.bottom - 3);
  }

  upright(pen, x) {
    pen.beginPath();
    pen.moveTo(x, 2);
    pen.lineTo(x, this.bottom);
    pen.stroke();
  }

  level(pen, y) {
    pen.beginPath();
    pen.moveTo(LEFT, y);
    pen.lineTo(this.width - RIGHT, y);
    pen.stroke();
  }

  range() {
    let [low, high] = this.panel.range || [Infinity, -Infinity];
    for (const item of this.series) {
      if (!item.shown) continue;
      low = Math.min(low, item.low);
      high = Math.max(high, item.high);
    }
    if (!(low < high)) { low = (Number.isFinite(low) ? low : 0) - 1; high = low + 2; }
    const margin = 0.06 * (high - low);
    return [low - margin, high + margin];
  }

  drawLines(pen) {
    const [low, high] = this.range();
    const y = (value) => this.bottom - (value - low) / (high - low) * (this.bottom - 4) - 1;
    const { found, digits } = ticks(low, high, 4);
    pen.textAlign = 'right';
    pen.textBaseline = 'middle';
    for (const value of found) {
      pen.strokeStyle = '#edf0f3';
      this.level(pen, Math.round(y(value)) + 0.5);
      pen.fillStyle = '#7b8794';
      pen.fillText(value.toFixed(digits), LEFT - 6, y(value));
    }
    this.clipped(pen, () => {
      pen.strokeStyle = '#e03131';
      pen.setLineDash([5, 4]);
      for (const mark of this.panel.marks || []) this.level(pen, y(mark));
      pen.setLineDash([]);
      for (const item of this.series) if (item.shown) this.drawCurve(pen, item, y);
    });
    pen.save();
    pen.translate(12, this.bottom / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = 'center';
    pen.fillStyle = '#5f6c7b';
    pen.fillText(this.panel.unit, 0, 0);
    pen.restore();
  }

  // As many points as there are pixels; of more, the lowest and highest of each column: no peak is lost.
  drawCurve(pen, item, y) {
    const { start, end } = this.timeline;
    const first = Math.max(indexAt(item.t, start), 0);
    const last = Math.min(indexAt(item.t, end) + 1, item.t.length - 1);
    pen.strokeStyle = item.colour;
    pen.lineWidth = item.dashed ? 1 : 1.4;
    pen.setLineDash(item.dashed ? [4, 3] : []);
    pen.beginPath();
    const columns = this.width - LEFT - RIGHT;
    if (last - first < 2 * columns) {
      for (let i = first; i <= last; i++) pen.lineTo(this.x(item.t[i]), y(item.y[i]));
    } else {
      for (let i = first; i <= last;) {
        const column = Math.floor(this.x(item.t[i]));
        let least = i;
        let most = i;
        for (; i <= last && Math.floor(this.x(item.t[i])) === column; i++) {
          if (item.y[i] < item.y[least]) least = i;
          if (item.y[i] > item.y[most]) most = i;
        }
        for (const k of [Math.min(least, most), Math.max(least, most)]) pen.lineTo(column, y(item.y[k]));
      }
    }
    pen.stroke();
    pen.setLineDash([]);
    pen.lineWidth = 1;
  }

  drawRows(pen) {
    const digital = this.panel.kind === 'logic';
    pen.textBaseline = 'middle';
    this.series.forEach((item, row) => {
      const top = 4 + row * ROW + 4;
      const base = top + ROW - 9;
      pen.textAlign = 'right';
      pen.fillStyle = '#323f4b';
      pen.fillText(item.name, LEFT - 6, (top + base) / 2, LEFT - 8);
      let low = 0;
      let high = 1;
      if (!digital) { low = Math.min(0, ...item.y); high = Math.max(...item.y, low + 1e-9); }
      const y = (value) => base - (value - low) / (high - low) * (base - top);
      this.clipped(pen, () => {
        const step = (paint) => {
          for (let i = 0; i < item.t.length; i++) {
            const from = Math.max(item.t[i], 0);
            const to = i + 1 < item.t.length ? item.t[i + 1] : this.timeline.duration;
            paint(this.x(from), this.x(to), item.y[i], i);
          }
        };
        pen.globalAlpha = 0.16;
        pen.fillStyle = item.colour;
        step((from, to, value) => pen.fillRect(from, y(value), to - from, y(0) - y(value)));
        pen.globalAlpha = 1;
        pen.strokeStyle = item.colour;
        pen.lineWidth = 1.3;
        pen.beginPath();
        step((from, to, value) => { pen.lineTo(from, y(value)); pen.lineTo(to, y(value)); });
        pen.stroke();
        pen.lineWidth = 1;
        if (!digital) {
          pen.textAlign = 'left';
          pen.fillStyle = '#5f6c7b';
          step((from, to, value) => { if (to - from > 30 && value) pen.fillText(String(+value.toFixed(3)), from + 4, y(value) + 6); });
        }
      });
    });
  }

  drawSpans(pen) {
    pen.textBaseline = 'middle';
    this.panel.lanes.forEach((lane, row) => {
      const top = 4 + row * ROW + 2;
      pen.textAlign = 'right';
      pen.fillStyle = '#323f4b';
      pen.fillText(lane.name, LEFT - 6, top + ROW / 2 - 2);
      this.clipped(pen, () => {
        pen.textAlign = 'center';
        for (const [start, end, line, activity] of lane.spans) {
          const from = this.x(start);
          const width = Math.max(this.x(end) - from, 0.5);
          pen.fillStyle = ACTIVITY_COLOURS[activity];
          pen.fillRect(from, top, width > 2 ? width - 1 : width, ROW - 5);
          if (width > 20 && line) {
            pen.fillStyle = activity === 'waiting' ? '#323f4b' : '#ffffff';
            pen.fillText(line, from + width / 2, top + ROW / 2 - 2);
          }
        }
      });
    });
  }

  drawCursor(pen) {
    const { cursor } = this.timeline;
    this.series.forEach((item, k) => {
      if (!this.values[k]) return;
      const i = Math.max(indexAt(item.t, cursor), 0);
      const { scale, offset, unit } = item.show;
      const value = item.y.length ? item.y[i] * scale + offset : NaN;
      this.values[k].textContent = Number.isFinite(value) ? value.toPrecision(4).replace(/e.*/, '') + ' ' + unit : '';
      // A curve has 16 bits: what is smaller than that is nothing.
      if (Math.abs(value) < Math.max(1e-4, 3e-5 * (item.high - item.low) * Math.abs(scale))) this.values[k].textContent = '0 ' + unit;
    });
    if (this.drag !== undefined) {
      pen.fillStyle = 'rgba(11, 114, 133, 0.12)';
      pen.fillRect(this.x(this.drag), 3, this.x(cursor) - this.x(this.drag), this.bottom - 4);
    }
    const x = Math.round(this.x(cursor)) + 0.5;
    if (x < LEFT || x > this.width - RIGHT) return;
    pen.strokeStyle = '#e03131';
    this.upright(pen, x);
  }
}
