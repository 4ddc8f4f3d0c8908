'use strict';
// The report's data: one JSON text; its arrays are little-endian, in base64.
const DATA = JSON.parse(document.getElementById('data').textContent);

function decode(item) {
  const text = atob(item.data);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  const kinds = { f4: Float32Array, i1: Int8Array, u2: Uint16Array, u4: Uint32Array };
  return new kinds[item.type](bytes.buffer);
}

const ARRAYS = DATA.arrays.map(decode);

// A curve's values: 16 bits of the way from its lowest to its highest.
function unpacked(item) {
  return Float32Array.from(ARRAYS[item.y], (part) => item.low + (item.high - item.low) * part / 65535);
}

function element(tag, className, text) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

// Index of the last time that is not after t; -1 before the first.
function indexAt(times, t) {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle + 1; else high = middle;
  }
  return low - 1;
}
