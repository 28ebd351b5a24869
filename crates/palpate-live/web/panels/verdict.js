// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** An answer of the program in words: what is proven beside what a local method says. */

import { SEPARATION, isFound, isFoundOfPair, touchOf } from '../plane/drawn.js';
import { METHODS, PAIR_METHODS, toys } from '../plane/toys.js';
import { html } from '../vendor/htm-preact.js';
import { count, short, time } from './numbers.js';

/** What has no place in a table of numbers. */
const DRAWN = ['id', 'do', 'path'];

const LENGTHS = ['value', 'lower', 'upper', 'radius'];
const POINTS = ['best', 'point', 'centre', 'contact'];

/** The names of methods. @type {Record<string, string>} */
const NAMES = { ...METHODS, ...PAIR_METHODS };

/** @param {string} key @param {any} value @returns {string} */
function written(key, value) {
  if (value === null) return '–';
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  if (key === 'method') return NAMES[value] ?? value;
  if (typeof value === 'string') return value.replace(/_/g, ' ');
  if (typeof value === 'number') {
    if (key === 'time') return time(value);
    if (LENGTHS.includes(key)) return `${short(value, 5)} m`;
    return Number.isInteger(value) ? count(value) : short(value, 4);
  }
  const numbers = value.map((/** @type {number} */ one) => short(one, 5)).join(', ');
  return POINTS.includes(key) ? `${numbers} m` : numbers;
}

/** Numbers of a table: of a contact its point, of the best between two bodies its point and its normal.
 * @param {[string, any]} entry @returns {[string, any][]} */
function numbersOf([key, value]) {
  if (key === 'contact') return [[key, value && value.point_a]];
  return key === 'best' && !Array.isArray(value) ? Object.entries(value) : [[key, value]];
}

/** @param {{ title: string, answer: any }} given */
function Table({ title, answer }) {
  if (typeof answer !== 'object' || !answer) return null;
  const rows = Object.entries(answer).filter(([key]) => !DRAWN.includes(key)).flatMap(numbersOf)
    .map(([key, value]) => [key.replace(/_/g, ' '), written(key, value)]);
  if (rows.length === 0) return null;
  return html`<table><caption>${title}</caption><tbody>
    ${rows.map(([key, text]) => html`<tr key=${key}><th scope="row">${key}</th><td>${text}</td></tr>`)}
  </tbody></table>`;
}

/** A local search with how it ended. Only of the memoir's descent does the page know how many
 * iterations it had. @param {any} local */
function withEnd(local) {
  if (local.method !== 'naive' || typeof local.steps !== 'number') return local;
  const isUsedUp = local.steps >= toys.iterations;
  return { ended: isUsedUp ? 'iterations used up' : 'before its iterations were used up: no step was left', ...local };
}

/** What the answers say about each other, in sentences. @param {string} toy @param {any} result
 * @returns {{ text: string, isRight: boolean }[]} */
function sentences(toy, result) {
  const { certified, local, enclosing } = result;
  const said = [];
  const upper = certified?.upper;
  const all = [local].flat().filter((one) => typeof one?.value === 'number');
  if (typeof upper === 'number' && all.length > 0 && toy === 'pair') {
    const found = all.filter((one) => isFoundOfPair(one, certified)).length;
    const isRight = found > 0;
    const what = isOfOverlap(all[0], certified) ? 'a point in both bodies' : 'the proven minimum';
    said.push({ isRight, text: `${found} of ${all.length} ${all.length === 1 ? 'start' : 'starts'} found ${what}` });
  } else if (typeof upper === 'number' && all.length > 0) {
    const isRight = isFound(all[0].value, certified);
    said.push({ isRight, text: isRight ? 'the local method found the proven minimum'
      : `the local method misses the proven minimum by ${short(all[0].value - upper)} m` });
  }
  if (enclosing && typeof upper === 'number') {
    const isRight = !enclosing.excludes || certified.lower > 0;
    said.push({ isRight, text: !enclosing.excludes ? 'the enclosing circle cannot exclude a touch'
      : `the enclosing circle excludes a touch${isRight ? ', rightly' : ', wrongly'}` });
  }
  if (toy === 'ball') {
    const { touches, memoir_test: memoir } = result;
    const isRight = memoir === touches;
    said.push({ isRight, text: `${touchOf(touches).word}; the memoir’s test says ${
      isRight ? 'the same' : touches === null ? touchOf(memoir).word : 'otherwise'}` });
  }
  if (toy === 'sweep') {
    const { touches, lower, upper } = result;
    const [free, met] = [lower, upper].map((at) => `${short(at, 5)} s`);
    said.push({ isRight: touches !== null, text: touchOf(touches).word + (touches === null ? `; proven free before ${free}`
      : touches ? ` first between ${free} and ${met}` : ' on its way') });
  }
  return said;
}

/** Whether a search asks only for a point in both bodies, and nothing of depth.
 * @param {any} local @param {any} certified */
const isOfOverlap = ({ method }, certified) => method === 'alternating_projection' && certified.upper <= 0;

/** What became of a start. @param {any} local @param {number} index @param {any} certified */
function startTitle(local, index, certified) {
  const name = `start ${index + 1}`;
  if (!certified || typeof local.value !== 'number') return name;
  const isFoundHere = isFoundOfPair(local, certified);
  if (isOfOverlap(local, certified)) return `${name} found ${isFoundHere ? 'a point' : 'no point'} in both bodies`;
  const gap = SEPARATION * local.value;
  return isFoundHere ? `${name} found the minimum` : `${name} misses it by ${short(gap - certified.upper)} m`;
}

/** What is proven, and beside it what one local method says, in a line.
 * @param {any} certified @param {any[]} locals */
function inShort(certified, locals) {
  if (!certified) return '';
  const bounds = [certified.lower, certified.upper].map((bound) => short(bound, 4));
  const proven = `proven: ${[...new Set(bounds)].join(' to ')} m`;
  return locals.length === 1 && typeof locals[0].value === 'number' ? `${proven}; local: ${short(locals[0].value, 4)} m` : proven;
}

/** @param {{ toy: string, result: any }} given */
export function Verdict({ toy, result }) {
  if (!result) return null;
  const { certified, local, enclosing, ...rest } = result;
  // Bounds of a time, which the sentence tells.
  if (toy === 'sweep') ['lower', 'upper', 'touches'].forEach((key) => delete rest[key]);
  if (toy === 'pair') delete rest.contact;
  const said = sentences(toy, result);
  const locals = [local ?? []].flat();
  const state = said.length === 0 ? '' : said.every(({ isRight }) => isRight) ? 'right' : 'wrong';
  return html`<div class=${`verdict ${state}`} role="status" aria-label=${`Verdict of ${toy}`}>
    ${said.map(({ text }) => html`<b key=${text}>${text}</b>`)}
    ${said.length > 0 && html`<p>${inShort(certified, locals)}</p>`}
    <details><summary>numbers</summary>
    <${Table} title="proven" answer=${certified} />
    ${locals.map((one, index) => html`<${Table} key=${index} answer=${withEnd(one)}
      title=${toy === 'pair' ? startTitle(one, index, certified) : 'local'} />`)}
    <${Table} title="enclosing circle" answer=${enclosing} />
    <${Table} title="answer" answer=${rest} />
    </details>
  </div>`;
}
