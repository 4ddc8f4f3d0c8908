// As much of a browser as the report's page uses: elements that remember, canvases that count what is drawn.
const drawn = [];

function recorder(canvas, kind) {
  const counts = { canvas, kind, calls: {} };
  drawn.push(counts);
  return new Proxy({}, {
    get(target, name) {
      if (name in target) return target[name];
      if (/^[A-Z_0-9]+$/.test(String(name))) return 1;  // constants of WebGL
      return (...values) => {
        counts.calls[name] = (counts.calls[name] || 0) + 1;
        for (const value of values) {
          if (typeof value === 'number' && !Number.isFinite(value)) throw new Error(`${kind}.${String(name)} got ${value}`);
        }
        return name.startsWith('get') || name.startsWith('create') ? {} : undefined;
      };
    },
    set(target, name, value) { target[name] = value; return true; },
  });
}

class Element {
  constructor(tag) {
    this.tagName = tag.toUpperCase();
    this.children = [];
    this.style = {};
    this.dataset = {};
    this.attributes = {};
    this.className = '';
    this.listeners = {};
    this.clientWidth = 900;
    this.clientHeight = 400;
    this.ownText = '';
    this.contexts = {};
  }
  get textContent() { return this.ownText + this.children.map((child) => child.textContent).join(''); }
  set textContent(text) { this.ownText = String(text); this.children = []; }
  append(...items) {
    for (const item of items) {
      if (!(item instanceof Element)) throw new Error('only elements are appended');
      this.children.push(item);
    }
  }
  setAttribute(name, value) { this.attributes[name] = String(value); }
  addEventListener(name, listener) { (this.listeners[name] = this.listeners[name] || []).push(listener); }
  dispatch(name, event) {
    for (const listener of this.listeners[name] || []) {
      listener({ preventDefault() {}, pointerId: 1, clientX: 0, clientY: 0, target: this, ...event });
    }
  }
  getBoundingClientRect() { return { left: 0, top: 0, width: this.clientWidth, height: this.clientHeight }; }
  setPointerCapture() {}
  getContext(kind) { return this.contexts[kind] = this.contexts[kind] || recorder(this, kind); }
}

function all(root, test) {
  return [...(test(root) ? [root] : []), ...root.children.flatMap((child) => all(child, test))];
}

const CODES = new Uint8Array(128);
[...'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/'].forEach((c, i) => { CODES[c.charCodeAt(0)] = i; });

function atob(text) {
  const bytes = [];
  const length = text.replace(/=+$/, '').length;
  for (let i = 0, bits = 0, held = 0; i < length; i++) {
    held = ((held << 6) | CODES[text.charCodeAt(i)]) & 0xffffff;
    bits += 6;
    if (bits >= 8) { bits -= 8; bytes.push((held >> bits) & 255); }
  }
  const parts = [];
  for (let i = 0; i < bytes.length; i += 8192) parts.push(String.fromCharCode(...bytes.slice(i, i + 8192)));
  return parts.join('');
}

let now = 0;
let frames = [];
const window = { devicePixelRatio: 1, addEventListener() {} };
const performance = { now: () => now };
function requestAnimationFrame(step) { frames.push(step); }
function nextFrame(milliseconds) {
  now += milliseconds;
  const due = frames;
  frames = [];
  for (const step of due) step(now);
}
const byId = {};
const document = {
  createElement: (tag) => new Element(tag),
  getElementById: (id) => byId[id] = byId[id] || new Element('div'),
  addEventListener() {},
};
