// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** Lengths in words, and round spacings. */

const UNITS = [
  { name: 'km', metres: 1000 },
  { name: 'm', metres: 1 },
  { name: 'mm', metres: 1e-3 },
  { name: 'µm', metres: 1e-6 },
];

/** The unit that suits a length [m]. @param {number} metres */
function unitFor(metres) {
  const size = Math.abs(metres);
  return UNITS.find((unit) => size >= 0.0999 * unit.metres && unit.name !== 'km')
    ?? UNITS[UNITS.length - 1];
}

/** A length [m] with three digits and its unit. @param {number} metres */
export function length(metres) {
  if (!Number.isFinite(metres)) return '–';
  if (metres === 0) return '0 m';
  const unit = unitFor(metres);
  const value = metres / unit.metres;
  const decimals = Math.max(0, Math.min(3, 2 - Math.floor(Math.log10(Math.abs(value)))));
  return `${value.toFixed(decimals).replace('-', '−')} ${unit.name}`;
}

/** A multiple of `spacing` [m] with as many digits as the spacing needs, in the spacing's unit.
 * @param {number} metres @param {number} spacing */
export function level(metres, spacing) {
  const unit = unitFor(spacing * 10);
  const decimals = Math.max(0, -Math.floor(Math.log10((spacing / unit.metres) * 1.000001)));
  const text = (metres / unit.metres).toFixed(decimals).replace('-', '−');
  return `${text} ${unit.name}`;
}

/** The least 1, 2 or 5 times a power of ten that is at least `value`. @param {number} value */
export function roundUp(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  const factor = [1, 2, 5, 10].find((step) => step * power >= value * 0.999999) ?? 10;
  return factor * power;
}
