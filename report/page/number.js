// Numbers for people: units, and rounding by the uncertainty.

const MINUS = '\u2212';
const THIN_SPACE = '\u2009';
const COVERAGE = 2;  // U95 = 2 u, unless a result states another factor

// How an SI unit is shown: shown value = value * scale.
const SHOWN_UNITS = {
  rad: {name: '\u00b5rad', scale: 1e6},
  m: {name: '\u00b5m', scale: 1e6},
  position: {name: 'mm', scale: 1e3},
};
const NANOMETRE = {
  name: 'nm',
  scale: 1e9
};

// A unit of a result (um, ppm/degC, nm/mm^2) with the special characters that files avoid.
const unitText = (unit) =>
    unit?.replace(/^u(?=m|rad)/, '\u00b5').replace('degC', '\u00b0C').replace('^2', '\u00b2');

const shownUnit = (si) => SHOWN_UNITS[si] ?? {name: si ?? '', scale: 1};

// Lengths of probes: nanometres while all of them are below a micrometre.
const lengthUnit = (largest) => Math.abs(largest) < 1e-6 ? NANOMETRE : SHOWN_UNITS.m;

// "1 limit", "3 limits".
const counted = (count, what) => `${count} ${what}${count === 1 ? '' : 's'}`;

// Rounded to `decimals` places (negative: tens, hundreds), with a proper minus sign and none on
// zero.
function fixed(value, decimals) {
  if (value === null || !Number.isFinite(value)) return '\u2013';
  const power = 10 ** Math.max(0, -decimals);
  const text = (Math.round(value / power) * power || 0);
  const rounded = decimals > 0 ? value.toFixed(decimals) : text.toFixed(0);
  return /^-[0.]*$/.test(rounded) ? rounded.slice(1) : rounded.replace('-', MINUS);
}

// Decimal places that leave `digits` significant digits of `value`, after rounding.
function placesFor(value, digits) {
  if (!(Math.abs(value) > 0)) return digits - 1;
  const exponent = Number(Math.abs(value).toExponential(digits - 1).split('e')[1]);
  return Math.min(12, digits - 1 - exponent);
}

// Three significant digits, for numbers of unknown uncertainty.
const significant = (value, digits = 3) => fixed(value, placesFor(value, digits));

// A position without the digits of its binary form: 12, 12.5, 0.
const positionText = (value) =>
    isNumber(value) ? String(Number(value.toFixed(4)) || 0).replace('-', MINUS) : '\u2013';

// Value and U95, both rounded to two significant digits of U95: {value: "42.3", U: "1.2"}.
function rounded(value, U) {
  if (!(U > 0) || !Number.isFinite(U)) return {value: significant(value), U: ''};
  const places = placesFor(U, 2);
  return {value: fixed(value, places), U: fixed(U, places)};
}

const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);
const numbers = (list) => (list ?? []).filter(isNumber);
const largest = (list) => numbers(list).reduce((most, value) => Math.max(most, Math.abs(value)), 0);
const rangeOf = (list) => Math.max(...numbers(list)) - Math.min(...numbers(list));
const scaled = (list, scale) => (list ?? []).map((value) => isNumber(value) ? value * scale : null);
// One uncertainty, or the root mean square of one per station.
function typical(u) {
  const list = numbers(Array.isArray(u) ? u : [u]);
  return list.length ? Math.sqrt(list.reduce((sum, one) => sum + one * one, 0) / list.length) : NaN;
}
