// Puts the page together: node compose.mjs NODE_MODULES OUTPUT SCRIPT...
// One HTML document with styles, fonts, Plotly and our scripts inside; the results come later, at
// @@results@@.
import {readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';

const [packages, output, ...scripts] = process.argv.slice(2);
const here = import.meta.dirname ?? new URL('.', import.meta.url).pathname;
const own = (name) => readFileSync(join(here, name), 'utf8');

function fontFace(weight) {
  const file = `@fontsource/ibm-plex-sans/files/ibm-plex-sans-latin-${weight}-normal.woff2`;
  const data = readFileSync(join(packages, file)).toString('base64');
  return `@font-face{font-family:"IBM Plex Sans";font-weight:${weight};` +
      `src:url(data:font/woff2;base64,${data}) format("woff2")}`;
}

// A script element ends at the first "</script", even inside a string.
const inScript = (text) => text.replaceAll(/<\/(?=script)/gi, '<\\/');

const parts = {
  style: [400, 600].map(fontFace).join('\n') + '\n' + own('page.css'),
  plotly: inScript(readFileSync(join(packages, 'plotly.js-dist-min/plotly.min.js'), 'utf8')),
  scripts: inScript(`(() => {\n'use strict';\n${
      scripts.map((file) => readFileSync(file, 'utf8')).join('\n')}})();`),
};
const page =
    own('page.html').replaceAll(/@@(style|plotly|scripts)@@/g, (mark, name) => parts[name]);
writeFileSync(output, page);
