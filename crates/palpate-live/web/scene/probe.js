// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The probe that follows the pointer: what the field says at a place, from the program, which
 * knows it in full precision.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ at: Vector, value: number, gradient: Vector, nearest: Vector | null, safe: number,
 *   promise: string, body: string | null, view: number }} Probed
 */

import { state } from '../state.js';
import { newest } from './newest.js';
import { length } from './units.js';
import { add, inSpace, norm, subtract } from './vectors.js';

/** The least time between two questions [ms]; where the core follows the line of sight too, twice that. */
const PAUSE = 50;

/** What the field of a view says at a point of it. @param {Wire} wire @param {View} view
 * @param {Vector} at */
export async function askPoint(wire, { isWhole, only, shift }, at) {
  const { dimension = 3, bodies = [] } = state.scene ?? {};
  const body = isWhole ? null : bodies[only]?.name;
  const question = { question: 'point', at: add(at, shift).slice(0, dimension), body };
  return (await wire.ask({ do: 'ask', question })).answer;
}

export class Probe {
  /** @param {Wire} wire @param {() => void} changed */
  constructor(wire, changed) {
    this.wire = wire;
    this.changed = changed;
    /** @type {Probed | null} */
    this.probed = null;
    this.place = 0;
    this.ask = newest(this.fetch.bind(this));
  }

  /** Asks about the place that `find` finds, in the view of this number.
   * @param {() => Promise<Vector | null>} find @param {View} view @param {number} number */
  follow(find, view, number) {
    this.place += 1;
    this.ask({ find, view, number, place: this.place });
  }

  leave() {
    this.place += 1;
    this.probed = null;
    this.changed();
  }

  /** @param {{ find: () => Promise<Vector | null>, view: View, number: number, place: number }} asked */
  async fetch({ find, view, number, place }) {
    const at = await find();
    if (at) {
      const answer = await askPoint(this.wire, view, at);
      if (place !== this.place && !this.probed) return;
      this.probed = {
        at,
        value: answer.distance,
        gradient: inSpace(answer.gradient),
        nearest: answer.surface ? subtract(inSpace(answer.surface), view.shift) : null,
        safe: answer.safe_radius ?? 0,
        promise: answer.promise,
        body: answer.body,
        view: number,
      };
    } else if (place === this.place) {
      this.probed = null;
    }
    this.changed();
    await new Promise((resolve) => { setTimeout(resolve, state.hasCard ? PAUSE : 2 * PAUSE); });
  }

  /** What was found, in words. */
  get words() {
    if (!this.probed) return '';
    const { at, value, gradient, safe, promise, body } = this.probed;
    const dimension = state.scene?.dimension ?? 3;
    const sign = state.view.positiveInside ? -1 : 1;
    const direction = gradient.slice(0, dimension).map((part) => (sign * part).toFixed(2)).join(', ');
    return [
      `at (${at.slice(0, dimension).map(length).join(', ')})${body ? ` of ${body}` : ''}`,
      `f ${length(sign * value)}   ∇f (${direction})   |∇f| ${norm(gradient).toFixed(2)}`,
      `safe ball ${length(safe)}   ${promise}`,
    ].join('\n').replaceAll('-', '−');
  }
}
