// Puts the page together: node compose.mjs NODE_MODULES OUTPUT SCRIPT...
// One HTML document with styles, fonts, Plotly, uPlot and our scripts inside, and a policy that lets no
// other script run; the results come later, at @@results@@, and the page's own server at @@connect@@.
import {createHash} from 'node:crypto';
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
  style: [400, 600].map(fontFace).join('\n') + '\n' +
      readFileSync(join(packages, 'uplot/dist/uPlot.min.css'), 'utf8') + '\n' + own('page.css'),
  plotly: inScript(readFileSync(join(packages, 'plotly.js-dist-min/plotly.min.js'), 'utf8')),
  uplot: inScript(readFileSync(join(packages, 'uplot/dist/uPlot.iife.min.js'), 'utf8')),
  scripts: inScript(`(() => {\n'use strict';\n${
      scripts.map((file) => readFileSync(file, 'utf8')).join('\n')}})();`),
};
parts.hashes = [parts.plotly, parts.uplot, parts.scripts]
                   .map((text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`)
                   .join(' ');
const page = own('page.html').replaceAll(
    /@@(style|plotly|uplot|scripts|hashes)@@/g, (mark, name) => parts[name]);
writeFileSync(output, page);
