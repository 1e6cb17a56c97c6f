// The live page as the operator meets it: node live.test.mjs ABBE_PROGRAM MACHINE_FILE WORK_FOLDER.
// A sweep of the virtual rig over Modbus, seen by two browsers. Screenshots for a person to look at
// are left in WORK_FOLDER/screenshots.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {join, resolve} from 'node:path';
import {after, before, test} from 'node:test';
import {setTimeout as pause} from 'node:timers/promises';

import {openBrowser} from './browser.mjs';

const program = resolve(process.argv[2]);
const work = resolve(process.argv[4]);
const browser = await openBrowser(join(work, 'packages'));
const axe = readFileSync(join(work, 'packages/node_modules/axe-core/axe.min.js'), 'utf8');
const screenshots = join(work, 'screenshots');
const SPEED = 1;
const DESKTOP = {width: 1280, height: 900};
const PHONE = {width: 390, height: 844};
const children = [];

function start(...words) {
  const child = spawn(program, words.map(String));
  child.said = '';
  child.stdout.on('data', (text) => child.said += text);
  child.stderr.on('data', (text) => child.said += text);
  child.done = new Promise((done) => child.on('exit', done));
  children.push(child);
  return child;
}

async function until(condition, what, seconds = 40) {
  for (const end = Date.now() + 1000 * seconds; Date.now() < end; await pause(50)) {
    if (await condition()) return;
  }
  assert.fail(`not within ${seconds} s: ${what()}`);
}

// The address that a command prints.
async function urlOf(child) {
  await until(() => /live page: (\S+)/.test(child.said), () => child.said);
  return /live page: (\S+)/.exec(child.said)[1];
}

// The rig with a short sweep of the demonstration machine; the machine file of its clients.
async function startRig(name, ...more) {
  const folder = join(work, name);
  rmSync(folder, {recursive: true, force: true});
  mkdirSync(folder, {recursive: true});
  const sweep = '[sweep]\npasses = 1\ndwell_s = 0.9\nsettle_s = 0.1\n[sweep.X]\nfirst_mm = 0.0\n' +
      'last_mm = 60.0\nstep_mm = 5.0\n\n';
  const text = readFileSync(process.argv[3], 'utf8').replace(/^\[sweep\]\n[^]*?(?=^# The linkage)/m, sweep)
                   .replace(/^max_skew_ms = .*/m, 'max_skew_ms = 2000.0')
                   .replace(/^stale_ms = .*/m, 'stale_ms = 2000.0');
  const machine = join(folder, 'machine.toml'), ready = join(folder, 'ready');
  writeFileSync(machine, text);
  start('rig', '--machine', machine, '--seed', 7, '--port', 0, '--speed', SPEED, '--ready-file', ready, ...more);
  await until(() => existsSync(ready) && readFileSync(ready, 'utf8').endsWith('\n'), () => 'the rig');
  writeFileSync(machine, text.replace(/^port = .*/gm, `port = ${readFileSync(ready, 'utf8').trim()}`));
  return {machine, out: join(folder, 'out'), rig: children.at(-1)};
}

async function open(url, options = {}) {
  const context = await browser.newContext({viewport: DESKTOP, ...options});
  const page = await context.newPage();
  page.setDefaultTimeout(100000);  // on a computer that does other work
  page.complaints = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) page.complaints.push(message.text());
  });
  page.on('pageerror', (error) => page.complaints.push(String(error)));
  page.on('request', (request) => {
    if (!request.url().startsWith(new URL(url).origin) && !/^(data|blob):/.test(request.url()))
      page.complaints.push(`asks for ${request.url()}`);
  });
  await page.goto(url);
  return page;
}

// What makes the page wider than the screen.
const tooWide = (page) => page.evaluate(() => {
  const width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth <= width) return [];
  return [...document.querySelectorAll('main *')].filter((one) => one.getBoundingClientRect().right > width + 1)
      .slice(0, 6).map((one) => `${one.outerHTML.slice(0, 100)} ${one.getBoundingClientRect().right}`);
});

async function seriousFindings(page) {
  await page.evaluate(axe);
  const {violations} = await page.evaluate(() => window.axe.run());
  return violations.filter(({impact}) => ['serious', 'critical'].includes(impact))
      .map(({id, nodes}) => `${id}: ${nodes.map(({html}) => html.slice(0, 120)).join(' | ')}`);
}

before(() => mkdirSync(screenshots, {recursive: true}));
after(async () => {
  children.forEach((child) => child.kill('SIGKILL'));
  await browser.close();
});

test('a sweep, seen by two browsers from its first row to its report', async () => {
  const {machine, out} = await startRig('live_sweep');
  const sweep = start('sweep', '--axis', 'X', '--machine', machine, '--out', out, '--clock-speed', SPEED, '--live');
  const url = await urlOf(sweep);
  const [wide, phone] = await Promise.all([open(url), open(url, {viewport: PHONE, hasTouch: true, isMobile: true, colorScheme: 'dark'})]);
  await wide.waitForSelector('.strip canvas');
  assert.equal(await wide.locator('meter').count(), 5);
  for (const page of [wide, phone]) await page.waitForSelector('section.result .note:has-text("So far")');
  const facts = await wide.locator('#live-facts').textContent();
  for (const name of ['Time', 'Left', 'Done', 'Rows', 'Feed', 'Temperature, column']) assert.ok(facts.includes(name), facts);
  const gap = Number(await wide.locator('#live-gaps tbody td').first().textContent());
  assert.ok(gap > 0 && gap < 200, String(gap));
  // The growing section has stations of the forward half, and a band.
  const stations = await wide.waitForFunction(() => {
    const data = document.querySelector('section.result:has(.note) .plot')?.data ?? [];
    return data.some(({name}) => name === '95 % band') && data.find(({name}) => name === 'mean')?.x.length;
  });
  assert.ok(await stations.jsonValue() >= 3);
  // Keyboard: from the address bar to the time shown.
  await wide.locator('#live-strips button').first().focus();
  await wide.keyboard.press('Tab');
  await wide.keyboard.press('Tab');
  await wide.keyboard.press('Enter');
  assert.equal(await wide.locator('#live-strips button[aria-pressed="true"]').textContent(), 'All');
  await wide.screenshot({path: join(screenshots, 'live_wide.png'), fullPage: true});
  await phone.screenshot({path: join(screenshots, 'live_phone_dark.png'), fullPage: true});
  assert.deepEqual(await tooWide(phone), []);

  for (const page of [wide, phone]) await page.waitForSelector('html[data-live="ended"]');
  assert.equal(await sweep.done, 0, sweep.said);
  const rows = readFileSync(join(out, 'sweep_X.csv'), 'utf8').split('\n').filter((line) => /^\d/.test(line)).length;
  for (const page of [wide, phone]) {
    assert.match(await page.locator('#live-status').textContent(), /^Finished; the page is saved as .*report\.html$/);
    assert.equal(await page.locator('section.result h2').textContent(), 'X axis');
    assert.equal(await page.locator('section.result .note:has-text("So far")').count(), 0);
    // Nothing is lost between recording and page.
    const shown = await page.locator('#live-facts div:has(dt:text-is("Rows")) dd').textContent();
    assert.equal(Number(shown.replace(/\D/g, '')), rows);
    assert.equal(await page.locator('#live-trouble').textContent(), '');
    assert.deepEqual(await seriousFindings(page), []);
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  }
  assert.ok(existsSync(join(out, 'report.html')));
});

test('the server is killed and comes back; another version is said', async () => {
  const folder = join(work, 'live_folder');
  rmSync(folder, {recursive: true, force: true});
  mkdirSync(folder);
  const write = (name, axis) => writeFileSync(join(folder, name), JSON.stringify({command: 'align', axis, verdict: 'ready'}));
  write('a.json', 'X');
  const first = start('live', folder);
  const url = await urlOf(first);
  const port = new URL(url).port;
  const page = await open(url);
  await page.waitForSelector('h2:has-text("Setting up for the X axis")');
  write('b.json', 'Y');
  await page.waitForSelector('h2:has-text("Setting up for the Y axis")');
  assert.deepEqual(page.complaints, []);
  first.kill('SIGKILL');
  await page.waitForSelector('#live-trouble:has-text("No connection since")');
  write('c.json', 'Z');
  const second = start('live', folder, '--live-port', port);
  await urlOf(second);
  await page.waitForSelector('h2:has-text("Setting up for the Z axis")');
  assert.equal(await page.locator('section.result').count(), 3);
  assert.equal(await page.locator('#live-trouble').textContent(), '');

  second.kill('SIGKILL');
  await second.done;
  const other = createServer((request, response) => {
    response.writeHead(200, {'Content-Type': 'text/event-stream'});
    response.write('event: hello\ndata: {"session":"other","version":"9.9.9"}\n\n');
  });
  await new Promise((listening) => other.listen(port, '127.0.0.1', listening));
  await page.waitForSelector('#live-trouble:has-text("the server is abbe 9.9.9 by now: load the page anew")');
  other.closeAllConnections();
  other.close();
  // What the browser itself says of a server that is away is no complaint of the page.
  assert.deepEqual(page.complaints.filter((text) => !/ERR_(CONNECTION|INCOMPLETE|EMPTY)/.test(text)), []);
  await page.context().close();
});

test('an alignment asks at the terminal and shows on the page', async () => {
  const {machine, out} = await startRig('live_align', '--hands');
  const align = start('align', '--axis', 'X', '--machine', machine, '--out', out, '--clock-speed', SPEED, '--live', '--as-is');
  const page = await open(await urlOf(align));
  await page.waitForSelector('#live-status:has-text("At the terminal: move X to 0 mm")');
  await page.waitForSelector('.strip canvas');
  align.stdin.write('\n');
  await page.waitForSelector('#live-status:has-text("move X to 60 mm")');
  const rig = children.at(-2);
  rig.stdin.write('move X 60\n');
  await pause(1500);  // 50 mm/s
  align.stdin.write('\n');
  await page.waitForSelector('html[data-live="ended"]');
  await page.waitForSelector('h2:has-text("Setting up for the X axis")');
  assert.match(await page.locator('section.result .summary').textContent(), /^The whole travel lies within/);
  assert.deepEqual(await seriousFindings(page), []);
  await page.screenshot({path: join(screenshots, 'live_align.png'), fullPage: true});
  assert.deepEqual(page.complaints, []);
  assert.equal(await align.done, 0, align.said);
});
