// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** An answer of the program in words: what is proven beside what a local method says. */

import { html } from '../vendor/htm-preact.js';
import { count, short, time } from './numbers.js';

/** What has no place in a table of numbers. */
const DRAWN = ['id', 'do', 'path', 'cells', 'boxes'];

const LENGTHS = /_m$|^(value|minimum|lower|upper|gap|separation|distance|depth|radius|bounds|bracket|tolerance|error)$/;

/** @param {string} key @param {any} value @returns {string | null} */
function written(key, value) {
  if (value === null) return '–';
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  if (typeof value === 'string') return value.replace(/_/g, ' ');
  if (typeof value === 'number') {
    if (key === 'ns' || key.endsWith('_ns')) return time(value / 1e9);
    if (key.endsWith('_s') || key === 'time') return time(value);
    if (LENGTHS.test(key)) return `${short(value, 5)} m`;
    return Number.isInteger(value) ? count(value) : short(value, 4);
  }
  if (Array.isArray(value) && value.length > 0 && value.length < 4 && value.every((one) => typeof one === 'number')) {
    const isRange = LENGTHS.test(key);
    const inner = value.map((one) => short(one, 5)).join(isRange ? ' to ' : ', ');
    return isRange || key.includes('point') || key === 'at' ? `${inner} m` : inner;
  }
  if (value && typeof value.lower === 'number') return `${short(value.lower, 5)} to ${short(value.upper, 5)} m`;
  return null;
}

/** @param {{ title: string, answer: any }} given */
function Table({ title, answer }) {
  if (typeof answer !== 'object' || !answer) return null;
  const rows = Object.entries(answer).filter(([key]) => !DRAWN.includes(key))
    .map(([key, value]) => [key.replace(/_m$|_ns$/, '').replace(/^ns$/, 'time').replace(/_/g, ' '), written(key, value)])
    .filter(([, text]) => text !== null);
  if (rows.length === 0) return null;
  return html`<table><caption>${title}</caption><tbody>
    ${rows.map(([key, text]) => html`<tr key=${key}><th scope="row">${key}</th><td>${text}</td></tr>`)}
  </tbody></table>`;
}

/** A number, or the upper end of bounds. @param {any} answer @param {string} end */
function boundOf(answer, end) {
  const direct = answer?.[end] ?? answer?.distance?.[end] ?? answer?.minimum?.[end] ?? answer?.separation?.[end];
  return typeof direct === 'number' ? direct : null;
}

/** How far the local method is from what is proven [m]; null if that is not known.
 * @param {any} certified @param {any} local */
function missBy(certified, local) {
  const upper = boundOf(certified, 'upper');
  const value = local?.value ?? local?.minimum ?? local?.distance;
  return upper === null || typeof value !== 'number' ? null : value - upper;
}

/** @param {{ toy: string, result: any }} given */
export function Verdict({ toy, result }) {
  if (!result) return null;
  const { certified, local, enclosing, ...rest } = result;
  const miss = missBy(certified, local);
  const tolerance = Math.abs(boundOf(certified, 'upper') ?? 0) * 1e-3 + 1e-9;
  const isMissed = miss !== null && miss > tolerance;
  const locals = Array.isArray(local) ? local : local ? [local] : [];
  return html`<div class=${miss === null ? 'verdict' : isMissed ? 'verdict wrong' : 'verdict right'} role="status"
    aria-label=${`Verdict of ${toy}`}>
    ${miss !== null && html`<b>${isMissed ? `the local method misses the least distance by ${short(miss)} m`
      : 'the local method found the proven minimum'}</b>`}
    <${Table} title="proven" answer=${certified} />
    ${locals.map((one, index) => html`<${Table} key=${index} answer=${one}
      title=${locals.length > 1 ? `local, start ${index + 1}` : 'local method'} />`)}
    <${Table} title="enclosing circle" answer=${enclosing} />
    <${Table} title=${certified ? 'both' : 'proven'} answer=${rest} />
  </div>`;
}
