// How the page writes numbers: node number.test.mjs NUMBER_JS ONE_MINUTE_JS.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {test} from 'node:test';
import vm from 'node:vm';

const source = process.argv.slice(2).map((file) => readFileSync(file, 'utf8')).join('\n');
const {fixed, placesFor, rounded, significant, typical, lengthUnit, positionText, unitText, counted,
       keptText} =
    vm.runInNewContext(`${source};({fixed, placesFor, rounded, significant, typical, lengthUnit,
        positionText, unitText, counted, keptText})`);
const pair = (value, U) => {
  const text = rounded(value, U);
  return [text.value, text.U];
};

test('a value ends where two digits of its uncertainty end', () => {
  assert.deepEqual(pair(42.3456, 1.23), ['42.3', '1.2']);
  assert.deepEqual(pair(-0.012344, 0.00067), ['\u22120.01234', '0.00067']);
  assert.deepEqual(pair(1234.6, 67.8), ['1235', '68']);
  assert.deepEqual(pair(1234.5, 678), ['1230', '680']);
});

test('rounding up may cost the uncertainty a place', () => {
  assert.deepEqual(pair(5.4321, 0.0996), ['5.43', '0.10']);
  assert.deepEqual(pair(5.4321, 9.96), ['5', '10']);
});

test('zero has no sign and a missing number is a dash', () => {
  assert.equal(fixed(-0.001, 2), '0.00');
  assert.equal(fixed(-0.4, 0), '0');
  assert.equal(fixed(null, 2), '\u2013');
  assert.equal(significant(Number.NaN), '\u2013');
  assert.equal(positionText(-0), '0');
});

test('a value without an uncertainty keeps three digits', () => {
  assert.deepEqual(pair(0.0123456, Number.NaN), ['0.0123', '']);
  assert.equal(significant(134.6), '135');
  assert.equal(significant(0), '0.00');
});

test('binary digits of a position are not shown', () => {
  assert.equal(positionText(0.1 + 0.2), '0.3');
  assert.equal(positionText(60), '60');
  assert.equal(positionText(-12.5), '\u221212.5');
});

test('a list of uncertainties counts by its root mean square', () => {
  assert.equal(typical([3, 4, null]), Math.sqrt(12.5));
  assert.equal(typical(2), 2);
});

test('places never grow without limit', () => assert.equal(placesFor(1e-300, 2), 12));

test('lengths below a micrometre are in nanometres', () => {
  assert.equal(lengthUnit(0.9e-6).name, 'nm');
  assert.equal(lengthUnit(-1.1e-6).name, '\u00b5m');
});

test('units are written as standards write them', () => {
  assert.deepEqual(
      ['um', 'urad', 'Hz', 'rad', 'mm', 'ms', 'mm/min', 'ppm/degC', 'nm/mm^2'].map(unitText),
      ['\u00b5m', '\u00b5rad', 'Hz', 'rad', 'mm', 'ms', 'mm/min', 'ppm/\u00b0C', 'nm/mm\u00b2']);
  assert.equal(unitText(undefined), undefined);
});

test('one thing has no plural', () => {
  assert.deepEqual(
      [0, 1, 2].map((count) => counted(count, 'limit')), ['0 limits', '1 limit', '2 limits']);
  assert.equal(keptText(1), 'the one limit that was measured is kept');
  assert.equal(keptText(2), 'all 2 limits that were measured are kept');
});
