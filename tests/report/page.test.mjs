// The report page as a reader meets it: node page.test.mjs ABBE_PROGRAM WORK_FOLDER.
// Screenshots for a person to look at are left in WORK_FOLDER/screenshots.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {mkdirSync, readFileSync, rmSync, statSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {after, before, test} from 'node:test';
import {pathToFileURL} from 'node:url';

import {openBrowser} from './browser.mjs';
import {BACKLASH, BOW, LIFT, STRETCH, writeSamples} from './sample_results.mjs';

const program = resolve(process.argv[2]);
const work = resolve(process.argv[3]);
const browser = await openBrowser(join(work, 'packages'));
const screenshots = join(work, 'screenshots');
const folder = join(work, 'results');
const page_file = join(work, 'elsewhere', 'report.html');
const READY = 'html[data-ready="true"]';
const DESKTOP = {
  width: 1280,
  height: 900
};
const PHONE = {
  width: 390,
  height: 844
};
let sample_names;

before(() => {
  for (const old of [screenshots, folder, join(work, 'elsewhere')])
    rmSync(old, {recursive: true, force: true});
  mkdirSync(screenshots, {recursive: true});
  mkdirSync(join(work, 'elsewhere'), {recursive: true});
  sample_names = writeSamples(folder);
  const run = spawnSync(program, ['report', folder, '--out', page_file], {encoding: 'utf8'});
  assert.equal(run.status, 0, run.stderr);
  assert.equal(run.stdout, `${page_file}\n`);
  assert.match(run.stderr, /cut_short\.json: left out: .*\n.*package\.json: left out: /);
});

after(() => browser.close());

// Opens the page offline and collects everything that a clean page does not do.
async function open(options = {}) {
  const context = await browser.newContext({viewport: DESKTOP, offline: true, ...options});
  const page = await context.newPage();
  const complaints = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('request', (request) => {
    if (!/^(file|data|blob):/.test(request.url())) complaints.push(`asks for ${request.url()}`);
  });
  await page.goto(pathToFileURL(page_file).href);
  await page.waitForSelector(READY, {timeout: 60000});
  return {page, complaints};
}

// Runs `use` on a page opened with `options`; tests with the same options share it, because opening
// one costs seconds.
const opened = new Map();
async function withPage(options, use) {
  const key = JSON.stringify(options);
  if (!opened.has(key)) opened.set(key, await open(options));
  const {page, complaints} = opened.get(key);
  await use(page);
  assert.deepEqual(complaints, []);
}

const overflow = (page) => page.evaluate(
    () => document.documentElement.scrollWidth - document.documentElement.clientWidth);

test(
    'every result has its section, in the order of the kinds',
    () => withPage({}, async (page) => {
      const titles = await page.locator('main section.result > h2').allTextContents();
      assert.equal(titles.length, sample_names.length);
      assert.deepEqual(titles, [
        'Diagnosis: what the simulation lacks', 'Diagnosis: what the simulation lacks', 'Error map',
        'Limits: <img src=x onerror="window.escaped = true">',
        'X axis', 'X axis', 'Y axis', 'Z axis', 'X axis: positioning', 'Circular test, XY plane',
        'Square path', 'Calibration of the linkage',
        'Performance simulation: circle', 'Corrected program: part_corrected.ngc', 'Export: isg',
        'Investigation', 'Plan: what these runs would show', 'Trend: EYX and C0Y',
        'What changed: campaign 1 to 5',
        'rig-compare \u00b7 X'
      ]);
      assert.equal(await page.title(), 'Geometric errors of demo-mill');
      assert.equal(await page.locator('nav a').count(), sample_names.length + 2);
      await page.screenshot({path: join(screenshots, 'desktop_light.png'), fullPage: true});
    }));

test(
    'the title says when, who and with what, and that a part is simulated',
    () => withPage({}, async (page) => {
      assert.match(
          await page.locator('#protocol').textContent(),
          /^Measured 2\d Nov 2026.* \u00b7 Operator A\. Smith \u00b7 Serial numbers mill 4711, head P-12 \u00b7 Contains simulated readings$/);
    }));

test(
    'text in a result stays text',
    () => withPage({}, async (page) => {
      assert.equal(await page.evaluate(() => window.escaped), undefined);
      assert.ok((await page.locator('main').textContent()).includes('</script><script>'));
    }));

test('files that are no results are named', () => withPage({}, async (page) => {
                                              const note =
                                                  await page.locator('#overview [role=note]').textContent();
                                              assert.match(note, /cut_short\.json/);
                                              assert.match(note, /package\.json/);
                                            }));

test(
    'every figure is drawn and told in words',
    () => withPage({}, async (page) => {
      const figures = await page.locator('.plot').evaluateAll(
          (plots) => plots.map(
              (plot) => ({
                about: plot.getAttribute('aria-label'),
                traces: plot.data.filter((trace) => trace.x.length > 0).length,
                drawn: plot.querySelectorAll('.scatterlayer .trace, .barlayer .trace, .hm').length,
                height: plot.getBoundingClientRect().height,
              })));
      // Three whole sweeps of 5 + 2 + 2 + 1 + 2 panels, one early one with its roll, one
      // positioning test, polar plot, space and harmonics of two circles, one square, residuals
      // before and after and the cells of a calibration; a map in space, its slices and their
      // uncertainty, 18 functions and the squarenesses; a performance simulation; where a cause shows, twice; two
      // trends and a changed curve.
      assert.equal(figures.length, 3 * 12 + 1 + 1 + 2 * 3 + 1 + 3 + (1 + 6 + 19) + 1 + 2 + 2 + 1);
      for (const {about, traces, drawn, height} of figures) {
        assert.ok(about.length > 20, about);
        assert.ok(traces > 0 && drawn >= traces, about);
        assert.ok(height >= 200, about);
      }
    }));

test(
    'numbers are rounded by their uncertainty',
    () => withPage({}, async (page) => {
      // The bow of X in Z: 1.5 um by each line, u = 0.035 um, so U95 = 0.070 um gives three
      // decimals.
      const row = page.locator('#result-6 table.cards tr', {hasText: 'EZX'});
      const text = await row.textContent();
      assert.equal(text.split('1.500\u00b10.070').length - 1, 3, text);
      assert.equal(
          await page.locator('#result-6 table.cards tr', {hasText: 'EAX'})
              .locator('td')
              .nth(-1)
              .textContent(),
          '0.62');
    }));

test(
    'the minimum zone is as wide as the bow is high',
    () => withPage({}, async (page) => {
      const plot = page.locator('#result-6 .plot[aria-label*="EZX"][aria-label*="minimum zone"]');
      const zone =
          await plot.evaluate((div) => div.data.find((trace) => trace.name === 'Minimum zone'));
      const width = Math.abs(zone.y[0] - zone.y.at(-1));
      assert.ok(Math.abs(width - BOW * 1e6) < 1e-9, String(width));
    }));

test(
    'the line through the end points meets the ends of the curve',
    () => withPage({}, async (page) => {
      const plot = page.locator('#result-6 .plot[aria-label*="EYX"][aria-label*="minimum zone"]');
      const [ends, measured] = await plot.evaluate(
          (div) => ['End points', 'measured'].map(
              (name) => div.data.find((trace) => trace.name === name).y));
      for (const at of [0, -1]) {
        assert.ok(
            Math.abs(ends.at(at) - measured.at(at)) < 1e-9, `${ends.at(at)} ${measured.at(at)}`);
      }
    }));

// The radius of a trace, least and most, in mm.
const radii = (plot, name) => plot.evaluate((div, name) => {
  const {x, y} = div.data.find((trace) => trace.name === name);
  const r = x.map((at, index) => Math.hypot(at, y[index]));
  return [Math.min(...r), Math.max(...r)];
}, name);

test(
    'the slider of a circle magnifies its deviation',
    () => withPage({}, async (page) => {
      const group = page.locator('section.group', {hasText: 'The circle, its deviation'});
      const plot = group.locator('.plot').first();
      const slider = group.getByRole('slider', {name: 'Magnification'});
      const first = await slider.inputValue();
      for (const [at, magnification] of [[0, 10], [6, 1000]]) {
        await slider.fill(String(at));
        assert.equal(
            Number((await group.locator('output').textContent()).replace(/[^0-9]/g, '')),
            magnification);
        const [least, most] = await radii(plot, 'counter-clockwise');
        // Half the backlash beside t = 0, where the shear is 0.02 um.
        assert.ok(
            Math.abs(most - 10 - magnification * BACKLASH / 2 * 1e3) <
                0.2 * magnification * BACKLASH * 1e3,
            `${most} at ${magnification}`);
        assert.ok(least < 10 - magnification * BACKLASH / 2 * 1e3 * 0.9, `${least}`);
      }
      await slider.focus();
      await page.keyboard.press('ArrowLeft');
      assert.match(await slider.getAttribute('aria-valuetext'), /500/);
      await slider.fill(first);
    }));

test(
    'the plot of a circle names its axes, and where and which way each sense goes',
    () => withPage({}, async (page) => {
      const group = page.locator('section.group', {hasText: 'The circle, its deviation'});
      const notes = await group.locator('.plot').first().evaluate(
          (div) => div.layout.annotations.map(({text, x, y, ax, ay}) => ({text, x, y, ax, ay})));
      const named = (text) => notes.find((note) => note.text.startsWith(text));
      assert.ok(named('+X').x > 10 && Math.abs(named('+X').y) < 1e-9);
      assert.ok(named('+Y').y > 10 && Math.abs(named('+Y').x) < 1e-9);
      for (const [name, way, angle] of [['ccw', 1, 0.5], ['cw', -1, 179.5]]) {
        const {x, y, ax, ay} = named(`${name} from`);
        // From the start on, the way that the sense turns.
        assert.ok(Math.abs(Math.atan2(ay, ax) * 180 / Math.PI - angle) < 1e-9, name);
        assert.ok(way * (ax * y - ay * x) > 0, name);
      }
    }));

test(
    'a path in space keeps its handedness',
    () => withPage({}, async (page) => {
      const group = page.locator('section.group', {hasText: 'The path in space'}).last();
      const nominal = await group.locator('.plot').first().evaluate((div) => {
        const {x, y} = div.data.find((trace) => trace.name === 'nominal');
        return [0, 50, 100].map((index) => [x[index], y[index]]);
      });
      // Seen from above, a square that turns X towards Y goes round counter-clockwise.
      const [a, b, c] = nominal;
      assert.ok((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) > 0, `${nominal}`);
    }));

test(
    'what the data could not tell of a circle is no number',
    () => withPage({}, async (page) => {
      const section = page.locator('section.result', {hasText: 'Circular test'});
      const unseen = section.locator('tr', {hasText: 'Servo lag'}).first();
      assert.match(await unseen.textContent(), /not seen/);
      assert.equal(await unseen.locator('.quantity').count(), 0);
      assert.match(
          await section.locator('tr', {hasText: 'Backlash'}).first().textContent(),
          /4\.000.*0\.060/);
    }));

test(
    'a figure of a circle has its uncertainty and says how the linkage was read',
    () => withPage({}, async (page) => {
      const section = page.locator('section.result', {hasText: 'Circular test'});
      const row = section.locator('tr', {hasText: 'G(b)'}).first();
      assert.match(await row.textContent(), /5\.62\u00b10\.20/);
      assert.match(await section.locator('dl').textContent(), /linkage\.toml.*0\.200/);
    }));

test(
    'a diagnosis tells what it found, what else it could be and what it cannot show',
    () => withPage({}, async (page) => {
      const section = page.locator('section.result', {hasText: 'Backlash, axis X; Probe gain'});
      assert.match(await section.locator('.summary').textContent(), /Backlash, axis X; Probe gain/);
      const backlash = section.locator('section.group', {hasText: 'Backlash, axis X'}).first();
      assert.match(await backlash.locator('tr', {hasText: 'Width'}).textContent(), /6\.020\u00b10\.080/);
      assert.match(await backlash.locator('dl').textContent(), /over 99\.9.*Preload or replace/);
      assert.match(
          await backlash.locator('dl').textContent(), /shows 3\.00.\u00b5m without it, 0\.14.*1\.900 without it.*held-out rows 1\.880 without it, 1\.030/);
      const rivals = section.locator('tr', {hasText: 'Probe crosstalk'}).first();
      assert.match(await rivals.textContent(), /probe b and probe c.*62\.0.*move the gap.*99\.9/);
      const [left, hidden] = await section.locator('[role=note]').allTextContents();
      assert.match(left, /Probe d is offset where time is 481\.1 to 500\.8.s, by 0\.224/);
      assert.match(hidden, /Squareness, axes X and Z/);
      // Little by its rms, and why that is no contradiction of 62 %.
      const small = section.locator('section.group', {hasText: 'Probe gain'}).first();
      assert.match(
          await small.locator('dl').textContent(),
          /held-out rows 0\.971 without it, 0\.970 with it.*these 1.240 rows falls by 2\.41: an rms is a mean over all rows/);
      const gain = section.locator('tr', {hasText: 'held-out rows'});
      assert.match(await gain.textContent(), /1.240.*1\.880.*1\.030/);
    }));

test(
    'beside what is unexplained a diagnosis gives no advice',
    () => withPage({}, async (page) => {
      const section = page.locator('section.result', {hasText: 'is not certain beside what is left'});
      assert.match(
          await section.locator('.summary').textContent(),
          /What would explain part of it: Backlash, axis X/);
      const text = await section.textContent();
      assert.match(text, /How it shows/);
      assert.doesNotMatch(text, /What to check|What to do/);
      // Ten runs that scatter are one line, and each a row behind it.
      const left = await section.locator('[role=note]').first().locator('li').allTextContents();
      assert.equal(left.length, 4);
      assert.match(
          left[1],
          /^12_run_of_day_12, 11_run_of_day_11, .* and 6 more scatter beyond their stated noise by.0\.80*.to.1\.70*.*p at most.0\.001/);
      assert.match(left[2], /^04_run_of_day_4 and 03_run_of_day_3 are correlated/);
      assert.match(left[3], /^Probe c scatters where nothing moves by 5\.1.*loose mounting/);
      await section.getByText('Each of these 10').click();
      assert.equal(await section.locator('details[open] tbody tr', {hasText: 'run_of_day'}).count(), 10);
      await section.screenshot({path: join(screenshots, 'diagnosis_in_part.png')});
    }));

test(
    'a plan tells what runs would show and what they would confuse',
    () => withPage({}, async (page) => {
      const section = page.locator('section.result', {hasText: 'what these runs would show'});
      const folded = section.locator('details.fold');
      assert.equal(await folded.getAttribute('open'), null);
      assert.equal(await folded.locator('table').count(), 2);
      assert.match(await section.locator('.summary').textContent(), /Of 4 causes, 3 would/);
      const lag = section.locator('tr', {hasText: 'Servo lag, axis X'});
      assert.match(await lag.textContent(), /Delay from 0\.0750 ms \(usual: 0\.500\)40/);
      assert.match(
          await section.locator('table', {hasText: 'not be seen'}).textContent(), /Probe gain.*Delta from 0\.0480 \(usual.*1\.3/);
      assert.match(
          await section.locator('[role=note]').textContent(),
          /Servo lag, axis X; Clock skew, linkage \(cosine 0\.971/);
    }));

test(
    'an investigation is a time line of its runs',
    () => withPage({}, async (page) => {
      const section = page.locator('section.result', {hasText: 'Time line of the runs'}).or(
          page.locator('section.result', {has: page.locator('ol.timeline')}));
      assert.match(
          await section.locator('.summary').textContent(),
          /After 30(\.0)? minutes and 2 runs the verdict is explained, certain/);
      const runs = section.locator('.timeline li');
      assert.equal(await runs.count(), 2);
      assert.match(await runs.nth(1).textContent(), /13 to 30.*Sweep X.*explained; backlash:X 1\.000/);
      // The bars are as long as the runs took: 10 and 3 of 30 min.
      const widths = await runs.nth(0).locator('.part').evaluateAll(
          (parts) => parts.map((part) => part.getBoundingClientRect().width));
      assert.ok(Math.abs(widths[0] / widths[1] - 10 / 3) < 0.05, widths.join());
      await section.screenshot({path: join(screenshots, 'investigation.png')});
    }));

test(
    'a calibration tells what it found, pose by pose, and what it could not see',
    () => withPage({}, async (page) => {
      const section = page.locator('section.result', {hasText: 'Calibration of the linkage'});
      assert.match(await section.locator('.summary').textContent(), /100.*0\.280.*2 of 5/);
      // 312.4 um with u = 4.1 um: U95 = 8.2 um leaves one decimal.
      assert.match(
          await section.locator('tr', {hasText: 'link.link_1'}).textContent(), /312\.4\u00b18\.2/);
      assert.match(
          await section.locator('table', {hasText: 'do not determine'}).textContent(), /run_out\.c/);
      const [before, after] = await section.locator('.plot').evaluateAll(
          (plots) => plots.slice(0, 2).map((plot) => plot.data.map(({y}) => Math.max(...y))));
      assert.deepEqual(before, [100]);
      assert.ok(after[0] <= 0.3 && after[1] > 0.39 && after[1] <= 0.4, String(after));
    }));

test(
    'the slider of the mapping cells magnifies their shift',
    () => withPage({}, async (page) => {
      const group = page.locator('section.group', {hasText: 'Mapping cells'});
      const slider = group.getByRole('slider', {name: 'Magnification'});
      await slider.fill('6');  // 1000
      const stems = await group.locator('.plot').evaluate(
          (div) => div.data.find((trace) => trace.name === 'shift').y);
      // Pairs of ends and a gap; the last cell is lifted by 2 um, which points up.
      assert.ok(Math.abs(stems.at(-2) - stems.at(-3) - 2) < 1e-9, String(stems.slice(-3)));
      assert.ok(Math.abs(stems[1] - stems[0]) < 1e-9);
    }));

const mapSection = (page) =>
    page.locator('section.result', {has: page.locator('h2', {hasText: 'Error map'})});

test(
    'a map says loudly what it does not know and which run contradicts',
    () => withPage({}, async (page) => {
      const section = mapSection(page);
      const note = await section.locator('.note').textContent();
      assert.match(note, /CONTRADICTION: sweep_X\.csv .*chi-square 40\.2 of 12/);
      assert.match(note, /U\u2089\u2085 here is 1\.8 times as large/);
      assert.match(note, /REVERSAL: EBX forward minus backward \u221213\.21 \u00b1 0\.12\u00a0\u00b5rad/);
      assert.match(note, /DOES NOT FIT: what is left of volume\.csv/);
      assert.match(note, /SCATTER: the places of volume\.csv scatter along Z alone.*of EZZ contains 2\.9\u00a0\u00b5m rms/);
      assert.match(note, /SCALE: PRIOR ONLY\..*20.ppm/);
      assert.match(note, /no run determines ECX, ECY and ECZ/);
      const runs = section.locator('table', {hasText: 'does each fit'});
      // 4988.2 / 4900, and 1 -+ 2 sqrt(2 / 4900).
      assert.match(await runs.textContent(), /1\.0180\.96 to 1\.04/);
      assert.match(
          await section.locator('table', {hasText: 'What determined'})
              .locator('tr', {hasText: 'ECX'})
              .textContent(),
          /PRIOR ONLY/);
      // The corner that lies furthest: 6 um of stretch and 5 um of lift.
      assert.match(await section.locator('.summary').textContent(), /up to 7\.81/);
    }));

test(
    'the arrows of a map follow magnification and component',
    () => withPage({}, async (page) => {
      const group = mapSection(page).locator('section.group', {hasText: 'over the volume'}).first();
      await group.getByRole('slider', {name: 'Magnification'}).fill('6');  // 1000
      const last = () => group.locator('.plot').evaluate((div) => {
        const {x, y} = div.data.find((trace) => trace.name === 'error');
        return [x.at(-2) - x.at(-3), y.at(-2) - y.at(-3)];
      });
      const [dx, dz] = [0.06 * STRETCH * 1e6, LIFT * 1e6];  // mm, magnified
      const isNear = ([x, y], [to_x, to_y]) =>
          assert.ok(Math.hypot(x - to_x, y - to_y) < 1e-9, `${x} ${y} ${to_x} ${to_y}`);
      isNear(await last(), [-0.906 * dx, 0.198 * dx + 0.883 * dz]);
      await group.getByRole('button', {name: 'Z', exact: true}).click();
      isNear(await last(), [0, 0.883 * dz]);
      assert.equal(
          await group.getByRole('button', {name: 'All three'}).getAttribute('aria-pressed'),
          'false');
    }));

test(
    'a slice shows its component at its place',
    () => withPage({}, async (page) => {
      const group = mapSection(page).locator('section.group', {hasText: 'Slices'}).first();
      await group.getByRole('button', {name: 'X', exact: true}).click();
      await group.getByRole('slider', {name: 'Through'}).fill('10');
      assert.match(await group.locator('output').textContent(), /X.60, Y.60, Z.60.mm/);
      const slices = await group.locator('.plot').evaluateAll(
          (plots) => plots.map((plot) => ({z: plot.data[0].z, most: plot.data[0].zmax})));
      assert.equal(slices.length, 6);
      const [xy, yz, zx] = slices;  // rows go up, columns across
      assert.ok(Math.abs(xy.z[3][10] - 6) < 1e-9 && xy.z[3][0] === 0);
      assert.ok(Math.abs(yz.z[0][0] - 6) < 1e-9);
      assert.ok(Math.abs(zx.z[10][2] - 6) < 1e-9 && zx.z[0][2] === 0);
      assert.ok(Math.abs(xy.most - 6) < 1e-9);
      assert.ok(Math.abs(slices[3].z[5][5] - 0.4) < 1e-9);  // U95 = 2 u
    }));

test(
    'each of the 21 errors has its band and what determined it',
    () => withPage({}, async (page) => {
      const group = mapSection(page).locator('section.group', {hasText: 'The 21 errors'}).first();
      const exx = group.locator('figure', {hasText: 'EXX'});
      assert.match(await exx.locator('.unit').first().textContent(), /sweep/);
      const [band, line] = await exx.locator('.plot').evaluate((div) => div.data.map(({y}) => y));
      assert.ok(Math.abs(line.at(-1) - 6) < 1e-9);
      assert.ok(Math.abs(Math.max(...band) - 6 - 1.2) < 1e-9);
      assert.match(
          await group.locator('figure', {hasText: 'ECZ'}).locator('.unit').first().textContent(),
          /prior only/);
    }));

test(
    'the first screen says pass or fail, the largest errors, what to do, what to measure',
    () => withPage({}, async (page) => {
      const minute = page.locator('#one-minute');
      assert.match(
          await minute.locator('.minute-verdict').textContent(),
          /fail\s*1 of 3 limits: XY circularity/);
      const [errors, todo, next] = await minute.locator('.minute-part').all();
      assert.equal(await errors.locator('li').count(), 3);
      // What each does over the longest travel decides: angles times it, lengths as they are.
      const effects = await page.evaluate(() => {
        const {map} = JSON.parse(document.getElementById('results').textContent)
                          .results.find(({result}) => result.command === 'fuse').result;
        const spans = ['x', 'y', 'z'].map((axis) => map.grid[axis].at(-1) - map.grid[axis][0]);
        return Object.entries(map.errors)
            .map(([name, {unit, value}]) => [name, Math.max(...[value].flat().map(Math.abs)) *
                                                       (unit === 'rad' ? Math.max(...spans) : 1)])
            .sort((one, other) => other[1] - one[1]);
      });
      assert.deepEqual(
          await errors.locator('a').allTextContents(), effects.slice(0, 3).map(([name]) => name));
      assert.match(await errors.textContent(), /EXX positioning of X 6\.0\u00b11\.2/);
      assert.match(await todo.textContent(), /What to do.+:/);
      assert.match(await next.textContent(), /What to measure next.*volumetric.*not measured yet/);
      // On the first screen, whole.
      await page.evaluate(() => window.scrollTo(0, 0));
      const box = await minute.boundingBox();
      assert.ok(box.y + box.height <= DESKTOP.height, JSON.stringify(box));
      for (const link of await minute.locator('a').all()) {
        const target = (await link.getAttribute('href')).slice(1);
        assert.equal(await page.locator(`section[id="${target}"]`).count(), 1, target);
      }
      await page.screenshot({path: join(screenshots, 'one_minute_wide.png')});
    }));

for (const [name, options] of [['phone', {viewport: PHONE, hasTouch: true, isMobile: true}], ['dark', {colorScheme: 'dark'}]]) {
  test(`the first screen on a ${name} page`, () => withPage(options, async (page) => {
         await page.evaluate(() => window.scrollTo(0, 0));
         assert.ok(await page.locator('#one-minute .minute-verdict').isVisible());
         assert.ok(await overflow(page) <= 0);
         const verdict = await page.locator('#one-minute .minute-verdict').boundingBox();
         assert.ok(verdict.y + verdict.height < 0.6 * page.viewportSize().height, JSON.stringify(verdict));
         await page.screenshot({path: join(screenshots, `one_minute_${name}.png`)});
       }));
}

test(
    'pass and fail stand on top of the page, what fails first',
    () => withPage({}, async (page) => {
      const first = page.locator('#overview table').first();
      assert.equal(await first.locator('caption').textContent(), 'Pass and fail');
      const rows = await first.locator('tbody tr').allTextContents();
      assert.equal(rows.length, 4);
      // 6.1 with U95 = 0.40: two digits of it.
      assert.match(rows[0], /^XY circularity \(linkage, R 20 mm, F 300\).*fail6\.10\u00b10\.405\.00/);
      assert.match(rows[1], /X positioning A.*undecided7\.90/);
      assert.match(rows[2], /EYX straightness.*pass2\.34\u00b10\.123\.00/);
      assert.match(rows[3], /volumetric.*not measured/);
      const section = page.locator('section.result', {hasText: 'Figures and their limits'});
      assert.match(
          await section.locator('.summary').textContent(),
          /Of 4 limits 1 within their limits, 1 beyond them, 1 undecided.*1 not measured/);
      assert.match(await section.locator('tr', {hasText: 'positioning'}).textContent(), /none stated/);
      await page.locator('#overview').screenshot({path: join(screenshots, 'history_on_top.png')});
    }));

test(
    'a trend is drawn with band and limit, and says when the limit is reached',
    () => withPage({}, async (page) => {
      const section = page.locator('section.result', {hasText: 'Rate of change and limit'});
      assert.match(
          await section.locator('.summary').textContent(),
          /EYX straightness reaches its limit about 30 Nov 2026/);
      const row = section.locator('tr', {hasText: 'EYX straightness'}).first();
      assert.match(await row.textContent(), /1\.50\u00b10\.30drifts.*30 Nov 2026 \(23 Nov 2026 to 11 Dec 2026\)/);
      const traces = (name) => section.locator('.plot').evaluateAll(
          (plots, wanted) => plots.map((plot) => plot.data.filter((trace) => trace.name === wanted)), name);
      const limits = await traces('limit');
      assert.deepEqual(limits.map((list) => list.map(({y}) => y[0])), [[6], [30, -30]]);
      const bands = await section.locator('.plot').evaluateAll(
          (plots) => plots.map((plot) => Math.max(...plot.data.find(({fill}) => fill === 'toself').y)));
      assert.ok(Math.abs(bands[0] - 6.2) < 1e-9, String(bands));
      const [fitted] = (await traces('fitted'))[0];
      assert.ok(Math.abs(fitted.y.at(-1) - 6) < 1e-9);
      assert.equal((await traces('left out'))[1][0].x.length, 1);
      assert.deepEqual((await traces('measured'))[0][0].error_y.array, [0.2, 0.2, 0.2, 0.2, 0.2]);
      await section.getByRole('button', {name: 'Limit'}).click();
      assert.deepEqual((await traces('limit')).map((list) => list.length), [0, 0]);
      await section.getByRole('button', {name: 'Limit'}).click();
      assert.match(await section.locator('[role=note]').textContent(), /dated before it.*dated in the future/);
      await section.screenshot({path: join(screenshots, 'history_trend.png')});
    }));

test(
    'a comparison says what changed and where along the travel',
    () => withPage({}, async (page) => {
      const section = page.locator('section.result', {hasText: 'What changed: campaign'});
      assert.match(await section.locator('.summary').textContent(), /1 of 2 differences is significant.*below 5/);
      assert.match(
          await section.locator('tr', {hasText: 'EYX curve'}).textContent(),
          /at 30.mm.*0\.202\.202\.00\u00b10\.30.*below 0\.0001yeshead/);
      assert.match(await section.locator('tr', {hasText: 'XY circularity'}).textContent(), /0\.62no/);
      assert.match(await section.locator('[role=note]').textContent(), /Servo lag, X/);
      assert.match(await section.locator('dl').first().textContent(), /before <b>service<\/b>/);
      const y = await section.locator('.plot').evaluate((div) => div.data.find(({name}) => name === 'change').y);
      assert.deepEqual(y, [0, 1, 2, 1, 0]);
      await section.screenshot({path: join(screenshots, 'history_compare.png')});
    }));

test(
    'before and after of a correction stand side by side',
    () => withPage({}, async (page) => {
      const section = page.locator('section.result', {hasText: 'Performance simulation'});
      assert.match(
          await section.locator('tr', {hasText: 'G XY'}).first().textContent(), /12\.400\.80/);
      const bars = await section.locator('.plot').evaluate((div) => div.data.map(({y}) => y));
      assert.deepEqual(bars, [[12.4, 6.1], [0.8, 0.5]]);
    }));

test(
    'the values of a figure can be read as a table',
    () => withPage({}, async (page) => {
      const first = page.locator('#result-6 figure').first();
      await first.locator('summary').click();
      await first.locator('tbody tr').first().waitFor();
      assert.equal(await first.locator('tbody tr').count(), 61);
    }));

test('dark and light by choice and by preference', async () => {
  const look = (page) => page.evaluate(() => ({
                                         page: getComputedStyle(document.body).backgroundColor,
                                         figure: document.querySelector('.plot').layout.font.color,
                                       }));
  await withPage({}, async (page) => {  // light: Playwright's default
    const light = await look(page);
    const choice = page.getByRole('button', {name: 'Dark'});
    await choice.click();
    const dark = await look(page);
    assert.notEqual(light.page, dark.page);
    assert.notEqual(light.figure, dark.figure);
    assert.equal(await choice.getAttribute('aria-pressed'), 'true');
    await page.screenshot({path: join(screenshots, 'desktop_dark.png'), fullPage: true});
    await withPage(
        {colorScheme: 'dark'}, async (other) => assert.deepEqual(await look(other), dark));
    await choice.click();
    assert.deepEqual(await look(page), light);
  });
});

test('text is legible in both themes', async () => {
  for (const colorScheme of ['light', 'dark']) {
    await withPage(colorScheme === 'dark' ? {colorScheme} : {}, async (page) => {
      const contrasts = await page.evaluate(() => {
        const luminance = (colour) =>
            colour.match(/[\d.]+/g)
                .slice(0, 3)
                .map((part) => part / 255)
                .map((part) => part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4)
                .reduce((sum, part, index) => sum + part * [0.2126, 0.7152, 0.0722][index], 0);
        const of = (selector, key) =>
            luminance(getComputedStyle(document.querySelector(selector))[key]);
        const ground = of('body', 'backgroundColor');
        return ['body', '.intro', 'main a', '.code', '.plus-minus', '.verdict.pass', '.verdict.fail',
                '.verdict.undecided'].map((selector) => {
          const [low, high] = [of(selector, 'color'), ground].sort((a, b) => a - b);
          return (high + 0.05) / (low + 0.05);
        });
      });
      // WCAG 2.2, 1.4.3: 4.5 for text of normal size.
      for (const contrast of contrasts) assert.ok(contrast >= 4.5, `${colorScheme}: ${contrasts}`);
    });
  }
});

test(
    'all controls are reached and used by the keyboard',
    () => withPage({}, async (page) => {
      await page.reload();
      await page.waitForSelector(READY, {timeout: 60000});
      await page.keyboard.press('Tab');
      assert.equal(await page.evaluate(() => document.activeElement.className), 'skip');
      const expected = await page.locator('button, summary, nav a').count();
      const reached = new Set();
      for (let step = 0; step < 2 * expected + 100; ++step) {
        const control = await page.evaluate(() => {
          const active = document.activeElement;
          if (active === document.body) return null;
          const all = [...document.querySelectorAll('button, summary, nav a')];
          return {index: all.indexOf(active), outline: getComputedStyle(active).outlineStyle};
        });
        if (control === null) break;
        assert.notEqual(control.outline, 'none');
        if (control.index >= 0) reached.add(control.index);
        await page.keyboard.press('Tab');
      }
      assert.equal(reached.size, expected);

      const forward = page.locator('#result-6').getByRole('button', {name: 'Forward'}).first();
      const plot = page.locator('#result-6 .plot').first();
      const traces = () => plot.evaluate((div) => div.data.length);
      const few = await traces();
      await forward.focus();
      await page.keyboard.press('Space');
      assert.equal(await forward.getAttribute('aria-pressed'), 'true');
      assert.equal(await traces(), few + 1);
    }));

test(
    'fits a phone',
    () => withPage({viewport: PHONE, hasTouch: true, isMobile: true}, async (page) => {
      assert.equal(await overflow(page), 0);
      await page.screenshot({path: join(screenshots, 'phone.png'), fullPage: true});
      await page.setViewportSize({...PHONE, width: 320});
      await page.waitForTimeout(500);  // the figures follow the width a moment later
      assert.equal(await overflow(page), 0);
    }));

test(
    'prints on light paper, figures within the page',
    () => withPage({colorScheme: 'dark'}, async (page) => {
      const pdf = await page.pdf({
        path: join(screenshots, 'print.pdf'),
        preferCSSPageSize: true,
        tagged: true,
        outline: true
      });
      const text = pdf.toString('latin1');
      const pages = text.match(/\/Type\s*\/Page\b/g).length;
      assert.ok(pages >= sample_names.length, `${pages} pages`);
      // The outline tells where each heading stands, from the lower end of its page, in points. A heading with the first
      // lines of what follows takes more than 30 mm.
      const heights = [...text.matchAll(/\/XYZ [-\d.]+ ([-\d.]+)/g)].map(([, y]) => Number(y));
      assert.ok(heights.length > sample_names.length, `${heights.length} headings`);
      const lowest = (14 + 30) / 25.4 * 72;
      assert.deepEqual(heights.filter((y) => y < lowest), []);

      await page.emulateMedia({media: 'print'});
      await page.setViewportSize(
          {width: 688, height: 1017});  // A4 less 14 mm margins, at 96 px an inch
      await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
      assert.equal(
          await page.evaluate(() => getComputedStyle(document.body).backgroundColor),
          'rgb(255, 255, 255)');
      const too_wide = await page.locator('.plot').evaluateAll(
          (plots) => plots
                         .filter(
                             (plot) => plot.querySelector('svg').getBoundingClientRect().right >
                                 innerWidth)
                         .length);
      assert.equal(too_wide, 0);
      await page.screenshot({path: join(screenshots, 'print.png'), fullPage: true});
      await page.evaluate(() => dispatchEvent(new Event('afterprint')));
    }));

test('the page is one file that names no other place to load from', () => {
  const text = readFileSync(page_file, 'utf8');
  assert.equal(text.match(/<(?:script|link|img|iframe)[^>]+(?:src|href)=["']?https?:/gi), null);
  assert.ok(statSync(page_file).size < 8e6);
});
