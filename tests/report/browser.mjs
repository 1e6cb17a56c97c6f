// A browser for the page tests, or a reason why there is none.
import {spawnSync} from 'node:child_process';
import {copyFileSync, existsSync, mkdirSync, readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const CHROMIUM = '/usr/bin/chromium';
const SKIPPED = 77;  // SKIP_RETURN_CODE of the test

function skip(reason) {
  console.log(`SKIPPED: ${reason}`);
  process.exit(SKIPPED);
}

// Fetches the pinned packages into `folder` when they are not there yet, or others are.
function fetchPackages(folder) {
  const here = dirname(fileURLToPath(import.meta.url));
  const textOf = (file) => existsSync(file) ? readFileSync(file, 'utf8') : '';
  const wanted = textOf(join(here, 'package-lock.json'));
  if (existsSync(join(folder, 'node_modules/axe-core/package.json')) &&
      textOf(join(folder, 'package-lock.json')) === wanted) {
    return;
  }
  mkdirSync(folder, {recursive: true});
  for (const name of ['package.json', 'package-lock.json']) {
    copyFileSync(join(here, name), join(folder, name));
  }
  const npm = spawnSync(
      'npm', ['ci', '--ignore-scripts', '--no-audit', '--no-fund'],
      {cwd: folder, encoding: 'utf8'});
  if (npm.status === 0) return;
  const reason = npm.error?.message ?? npm.stderr.split('\n')[0];
  skip(
      `npm ci could not fetch playwright-core (${reason}): apt-get install npm, allow the network`);
}

export async function openBrowser(package_folder) {
  if (!existsSync(CHROMIUM)) skip(`${CHROMIUM} not found: apt-get install chromium`);
  fetchPackages(package_folder);
  const {chromium} = createRequire(join(package_folder, 'from.js'))('playwright-core');
  return chromium.launch({
    executablePath: CHROMIUM,
    headless: true,
    args: [
      '--no-sandbox', '--disable-gpu', '--no-first-run', '--disable-background-networking',
      '--disable-component-update', '--disable-sync'
    ]
  });
}
