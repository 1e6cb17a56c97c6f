// The colours of the figures: those of the style sheet in the current theme.

const COLOUR_NAMES = [
  'ink', 'muted', 'line', 'axis', 'surface', 'mean', 'band', 'forward', 'backward', 'zone',
  'series-1', 'series-2', 'series-3', 'series-4', 'series-5', 'series-6', 'fail'
];

function palette() {
  const probe = document.createElement('span');
  document.body.append(probe);
  const colours = {};
  for (const name of COLOUR_NAMES) {
    probe.style.color = `var(--${name})`;
    colours[name] = getComputedStyle(probe).color;
  }
  probe.remove();
  colours.series = [1, 2, 3, 4, 5, 6].map((number) => colours[`series-${number}`]);
  return colours;
}

const prefersDark = matchMedia('(prefers-color-scheme: dark)');

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : prefersDark.matches;
}

// The choice is stored if the browser allows it for a local file.
function storedTheme() {
  try {
    return localStorage.getItem('abbe-theme');
  } catch {
    return null;
  }
}

function storeTheme(theme) {
  try {
    localStorage.setItem('abbe-theme', theme);
  } catch {
    // Without storage the page follows the system at the next opening.
  }
}

function connectThemeButton(button, redraw) {
  const show = () => {
    button.setAttribute('aria-pressed', String(isDark()));
    redraw();
  };
  const stored = storedTheme();
  if (stored) document.documentElement.dataset.theme = stored;
  button.addEventListener('click', () => {
    const theme = isDark() ? 'light' : 'dark';
    document.documentElement.dataset.theme = theme;
    storeTheme(theme);
    show();
  });
  prefersDark.addEventListener('change', show);
  button.setAttribute('aria-pressed', String(isDark()));
}
