// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Numbers as people type them: with a decimal comma, and with a unit that is not the field's.
 *
 * @typedef {{ factor: number, powers: Record<string, number> }} Unit the factor to SI units, and
 *   the powers of what it is made of
 */

/** Units that have a name of their own, in SI units. @type {Record<string, [number, string, number]>} */
const NAMED = {
  m: [1, 'm', 1], in: [0.0254, 'm', 1], inch: [0.0254, 'm', 1], N: [1, 'N', 1], s: [1, 's', 1],
  min: [60, 's', 1], Hz: [1, 's', -1], '°': [Math.PI / 180, 'rad', 1], deg: [Math.PI / 180, 'rad', 1],
  degrees: [Math.PI / 180, 'rad', 1], rad: [1, 'rad', 1], turn: [2 * Math.PI, 'rad', 1], '%': [0.01, '', 0], 1: [1, '', 0],
};

/** @type {Record<string, number>} */
const PREFIXES = { k: 1e3, d: 1e-1, c: 1e-2, m: 1e-3, µ: 1e-6, u: 1e-6 };
/** Units before which a prefix may stand. */
const PREFIXED = ['m', 'N', 's', 'Hz', 'rad'];

/** A unit without products. @param {string} name @returns {[number, string, number] | null} */
function simple(name) {
  if (Object.hasOwn(NAMED, name)) return NAMED[name];
  const rest = name.slice(1);
  const prefix = PREFIXES[name[0]];
  if (!prefix || !PREFIXED.includes(rest)) return null;
  const [factor, base, power] = NAMED[rest];
  return [factor * prefix, base, power];
}

/** A unit such as `kN/m` or `N·s/m`; null if it is none. @param {string} text @returns {Unit | null} */
function parsed(text) {
  const [above, ...below] = text.replace(/μ/g, 'µ').split('/');
  /** @type {Unit} */
  const unit = { factor: 1, powers: {} };
  for (const [product, sign] of /** @type {[string, number][]} */ ([[above, 1], ...below.map((one) => [one, -1])])) {
    for (const name of product.split(/[·*\s]+/).filter(Boolean)) {
      const found = simple(name);
      if (!found) return null;
      const [factor, base, power] = found;
      unit.factor *= factor ** sign;
      if (power !== 0) unit.powers[base] = (unit.powers[base] ?? 0) + sign * power;
    }
  }
  return unit;
}

/** @param {Unit} unit */
const kind = ({ powers }) =>
  Object.entries(powers).filter(([, power]) => power !== 0).sort().map(([base, power]) => base + power).join(' ');

/** What was typed into a field of a unit: the number, or what is wrong with it.
 * @param {string} text @param {string} unit of the field
 * @returns {{ value: number } | { problem: string }} */
export function read(text, unit) {
  const plain = text.trim().replace(/[−–]/g, '-').replace(/[\u2009\u202f\u00a0]/g, '');
  const example = unit === 'm' ? '0.035 or 35 mm' : unit === '°' ? '20 or 0.35 rad' : unit === '' ? '0.5' : `0.5 or 0.5 ${unit}`;
  if (plain === '') return { problem: `A number is missing: type one such as ${example}, or Esc.` };
  const [, number, given] = /^([+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[+-]?\d+)?)(.*)$/i.exec(plain) ?? [];
  if (number === undefined) return { problem: `“${text.trim()}” is not a number: type one such as ${example}, or Esc.` };
  const value = Number(number.replace(',', '.'));
  const named = given.trim();
  if (/^[\d.,]/.test(named)) return { problem: `“${text.trim()}” is more than one number: one decimal sign, no gaps.` };
  if (!Number.isFinite(value)) return { problem: `“${text.trim()}” is too large.` };
  if (named === '' || named === unit) return { value };
  const [from, to] = [parsed(named), parsed(unit)];
  if (!from) return { problem: `“${named}” is not a unit that this page knows${unit ? `: this field is in ${unit}` : ''}.` };
  if (!to || kind(from) !== kind(to)) {
    return { problem: `“${named}” does not fit: this field ${unit ? `is in ${unit}` : 'has no unit'}.` };
  }
  return { value: Number(((value * from.factor) / to.factor).toPrecision(12)) };
}
