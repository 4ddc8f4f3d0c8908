// One time axis for all panels: what is shown of it, the cursor, and playing.
class Timeline {
  constructor(duration) {
    this.duration = duration;
    this.start = 0;
    this.end = duration;
    this.cursor = 0;
    this.playing = false;
    this.rate = 1;
    this.watchers = [];
  }

  watch(watcher) { this.watchers.push(watcher); }

  tell() { for (const watcher of this.watchers) watcher(); }

  setCursor(t) {
    this.cursor = Math.min(Math.max(t, 0), this.duration);
    this.tell();
  }

  zoom(start, end) {
    const shortest = Math.min(0.01, this.duration);
    let length = Math.min(Math.max(end - start, shortest), this.duration);
    this.start = Math.min(Math.max(start, 0), this.duration - length);
    this.end = this.start + length;
    this.tell();
  }

  zoomAround(t, factor) {
    this.zoom(t - (t - this.start) * factor, t + (this.end - t) * factor);
  }

  reset() { this.zoom(0, this.duration); }

  play(on) {
    this.playing = on;
    if (!on) { this.tell(); return; }
    if (this.cursor >= this.duration) this.cursor = 0;
    let last = performance.now();
    const step = (now) => {
      if (!this.playing) return;
      this.setCursor(this.cursor + (now - last) / 1000 * this.rate);
      last = now;
      if (this.cursor >= this.duration) this.play(false); else requestAnimationFrame(step);
    };
    this.tell();
    requestAnimationFrame(step);
  }
}
