// What only a browser can do: it notices that a button is held, and says so again and again.
const pendant = (() => {
  const PERIOD = 40; // ms between two signs of a press; without them the robot stops
  let press = null;
  let number = 0;

  const connected = () => window.socket?.connected && window.did_handshake;

  // Signs come from the thread that also notices the release: a page that hangs sends none.
  function sign() {
    if (!connected()) {
      end(); // nothing may be kept until the connection is back
      return;
    }
    emitEvent('pendant_hold', press.number, press.key);
  }

  function begin(element) {
    end();
    if (!connected()) return;
    press = {number: ++number, key: element.dataset.press, element};
    press.timer = setInterval(sign, PERIOD);
    element.classList.add('held');
    sign();
  }

  function end() {
    if (press === null) return;
    clearInterval(press.timer);
    press.element.classList.remove('held');
    press = null;
    if (connected()) emitEvent('pendant_release');
  }

  const pressed = (event) => event.target.closest?.('[data-press]');

  document.addEventListener('pointerdown', (event) => {
    const element = pressed(event);
    if (!element || event.button !== 0) return;
    element.setPointerCapture(event.pointerId);
    begin(element);
  });
  for (const type of ['pointerup', 'pointercancel', 'lostpointercapture', 'visibilitychange']) {
    document.addEventListener(type, end);
  }
  for (const type of ['blur', 'pagehide', 'freeze']) window.addEventListener(type, end);
  document.addEventListener('contextmenu', (event) => {
    if (pressed(event)) event.preventDefault(); // of a finger that stays
  });

  document.addEventListener('keydown', (event) => {
    if (event.key === 'Escape') {
      end();
      if (connected()) emitEvent('pendant_stop');
    } else if ((event.key === ' ' || event.key === 'Enter') && pressed(event)) {
      event.preventDefault();
      if (!event.repeat) begin(pressed(event));
    }
  }, true);
  document.addEventListener('keyup', (event) => {
    if (event.key === ' ' || event.key === 'Enter') end();
  });
  // The 3D view would take the stop key with it.
  window.addEventListener('blur', () => setTimeout(() => {
    if (document.activeElement?.tagName === 'IFRAME') {
      document.activeElement.blur();
      window.focus();
    }
  }));

  document.addEventListener('click', (event) => {
    const line = event.target.closest?.('#source [data-line]');
    if (line && connected()) emitEvent('pendant_cursor', Number(line.dataset.line));
  });

  const remember = (name, value) => {
    document.cookie = `${name}=${value}; path=/; max-age=31536000; samesite=strict`;
  };

  return {
    // Marks the line of the program and that of the motion, and follows the former.
    mark(line, motion, failed) {
      const source = document.getElementById('source');
      if (!source) return;
      source.querySelectorAll('.running, .moving, .failed').forEach((one) => {
        one.classList.remove('running', 'moving', 'failed');
      });
      source.querySelector(`[data-line="${motion}"]`)?.classList.add('moving');
      const shown = source.querySelector(`[data-line="${line}"]`);
      shown?.classList.add(failed ? 'failed' : 'running');
      shown?.scrollIntoView({block: 'nearest'});
    },
    // Marks the line after which motions are inserted.
    cursor(line) {
      const source = document.getElementById('source');
      source?.querySelector('.cursor')?.classList.remove('cursor');
      source?.querySelector(`[data-line="${line}"]`)?.classList.add('cursor');
    },
    switchTheme() {
      const dark = document.body.classList.contains('body--dark');
      Quasar.Dark.set(!dark);
      remember('theme', dark ? 'light' : 'dark');
    },
    setLanguage(code) {
      remember('language', code);
      window.location.reload();
    },
  };
})();
