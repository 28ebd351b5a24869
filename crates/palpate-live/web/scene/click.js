// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What a click on the stage does: it places a toy, or selects the body that is seen there.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('../input/pointer.js').Place} Place
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ point: Vector, body: number }} Hit
 */

import { fall, placeAbove, setFall } from '../plane/fall.js';
import { addStart } from '../plane/handles.js';
import { toys } from '../plane/toys.js';
import { select } from '../state.js';
import { askPoint } from './probe.js';
import { numberOf, setting } from './setting.js';
import { rounded } from './vectors.js';

/** How near a surface counts as touched where the card does not know the body: over the size of the
 * scene on what it drew, and else in pixels. */
const NEAR = { drawn: 0.02, pixels: 2 };

/** @param {Wire} wire
 * @param {(view: View, place: Place) => Promise<Hit | null>} pick
 * @param {(view: View, place: Place) => Promise<Vector | null>} seenAt
 * @returns {(view: View, place: Place) => Promise<void>} */
export function createClick(wire, pick, seenAt) {
  /** The number of the body at a point of the picture; −1 beside all. @param {View} view
   * @param {Vector} point @param {number} near how near a surface counts as touched [m] */
  async function bodyAt(view, point, near) {
    const { distance, body } = await askPoint(wire, view, point);
    return distance <= near ? numberOf(body) : -1;
  }

  return async (view, place) => {
    const current = setting();
    if (current.dimension === 2 && view.isWhole && toys.shown.pair) {
      const { lens } = view;
      addStart(lens.at(place.x, place.y, [0, 0, 0]).slice(0, 2), lens.pixel([0, 0, 0]));
      return;
    }
    const hit = view.isFlat ? null : await pick(view, place);
    const point = hit?.point ?? await seenAt(view, place);
    const places = fall.isShown && fall.isPlacedByClick && view.isWhole;
    if (places && current.dimension === 3) {
      placeAbove(point ?? view.lens.at(place.x, place.y, current.centre), current);
      return;
    }
    if (!point) return;
    // Of what is drawn from samples, the card may not know the body, nor where its surface is
    // to less than their distance.
    const near = hit ? NEAR.drawn * current.size : NEAR.pixels * view.lens.pixel(point);
    const body = hit && hit.body >= 0 ? hit.body : await bodyAt(view, point, near);
    if (body >= 0) select(`/bodies/${body}`);
    else if (places) setFall({ centre: rounded(point, view.lens.pixel(point)).slice(0, 2) });
  };
}
