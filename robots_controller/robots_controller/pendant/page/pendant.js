// What only a browser can do: it notices that a button is held, and says so again and again.
const pendant = (() => {
  const PERIOD = 40; // ms between two signs of a press; without them the robot stops
  const NUMBERS = 44; // px, of the line numbers
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
    if (!line || !connected()) return;
    const number = event.target === line && event.offsetX < NUMBERS;
    emitEvent(number ? 'pendant_breakpoint' : 'pendant_cursor', Number(line.dataset.line));
  });

  const remember = (name, value) => {
    document.cookie = `${name}=${value}; path=/; max-age=31536000; samesite=strict`;
  };

  let scene = {id: '', url: ''};
  const showScene = () => {
    const dark = document.body.classList.contains('body--dark');
    const element = document.getElementById(scene.id);
    if (element) element.src = scene.url && dark ? `${scene.url}?darkMode` : scene.url;
  };

  return {
    // The 3D view, in the theme of the page.
    showScene(id, url) {
      scene = {id, url};
      showScene();
    },
    // Marks lines of the program: where it is, where it fails, where it is held, and what was found.
    mark({line, motion, failed, cursor, breakpoints, findings}) {
      const source = document.getElementById('source');
      if (!source) return;
      for (const one of source.children) {
        const number = Number(one.dataset.line);
        one.classList.toggle('moving', number === motion);
        one.classList.toggle('running', number === line && !failed);
        one.classList.toggle('failed', number === line && failed);
        one.classList.toggle('cursor', number === cursor);
        one.classList.toggle('breakpoint', breakpoints.includes(number));
        one.classList.toggle('found', number in findings);
        one.title = findings[number] ?? '';
      }
      source.querySelector(`[data-line="${line || cursor}"]`)?.scrollIntoView({block: 'nearest'});
    },
    // Completes the names of functions in an editor, with what they do.
    async complete(id, functions) {
      const {StateEffect, EditorState, tooltips} = await import('nicegui-codemirror');
      const view = await new Promise((resolve) => {
        const look = () => {
          const editor = getElement(id)?.editor;
          if (editor) resolve(editor); else setTimeout(look, 50);
        };
        look();
      });
      const source = (context) => {
        const word = context.matchBefore(/\w+/);
        if (!word && !context.explicit) return null;
        const options = functions.map((one) => ({...one, type: 'function'}));
        return {from: word ? word.from : context.pos, options, validFor: /^\w*$/};
      };
      const completion = EditorState.languageData.of(() => [{autocomplete: source}]);
      // Below the page: the panel would cut off what is longer than it.
      const extensions = [completion, tooltips({parent: document.getElementById('tooltips')})];
      view.dispatch({effects: StateEffect.appendConfig.of(extensions)});
      if (document.body.classList.contains('body--dark')) getElement(id).setTheme('vscodeDark');
      view.focus();
    },
    switchTheme() {
      const dark = document.body.classList.contains('body--dark');
      Quasar.Dark.set(!dark);
      remember('theme', dark ? 'light' : 'dark');
      showScene();
    },
    setLanguage(code) {
      remember('language', code);
      window.location.reload();
    },
  };
})();
