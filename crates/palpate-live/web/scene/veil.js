// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Which marks lie behind bodies: what is seen at the place of such a mark is nearer than the mark.
 *
 * @typedef {import('../input/pointer.js').Place} Place
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./pick.js').Hit} Hit
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ key: string, point: Vector, radius: number }} Mark `radius` is how far bodies reach into it
 *   without hiding it [m]
 */

import { state } from '../state.js';
import { newest } from './newest.js';
import { MOST_PLACES } from './pick.js';
import { setting } from './setting.js';
import { slice } from './slice.js';
import { norm, subtract } from './vectors.js';

/** Marks that are looked at together, and the time until the next are [ms]: by the card, and by the
 * core, which takes 120 messages a second. */
const LOOKS = { card: { most: MOST_PLACES, pause: 60 }, core: { most: 8, pause: 600 } };
/** How far behind a surface a mark still lies on it, over the size of the scene. */
const NEAR = 0.01;
/** A mark that moves less than this is not looked at again, over the size of the scene. */
const STEP = 0.002;

/** @param {(view: View, places: Place[]) => Promise<(Hit | null | undefined)[] | null>} pick
 * @param {() => void} changed */
export function createVeil(pick, changed) {
  /** How each mark was seen, empty until that is told; whether it was hidden; and when it was looked at [ms].
   * @type {Map<string, { seen: string, isHidden: boolean, at: number }>} */
  const known = new Map();
  /** Whether a mark lies behind a body. @param {string} key */
  const hides = (key) => known.get(key)?.isHidden ?? false;
  const look = newest(async (/** @type {{ view: View, marks: (Mark & { seen: string })[] }} */ { view, marks }) => {
    const { most, pause } = state.hasCard ? LOOKS.card : LOOKS.core;
    const { lens } = view;
    const { eye } = lens.basis;
    const tolerance = NEAR * setting().size;
    const lookedAt = (/** @type {Mark} */ { key }) => known.get(key)?.at ?? 0;
    // Marks that move in each frame leave the others their turn.
    const looked = [...marks].sort((a, b) => lookedAt(a) - lookedAt(b)).slice(0, most)
      .map((mark) => ({ ...mark, place: lens.project(mark.point) }));
    const at = performance.now();
    for (const { key } of looked) known.set(key, { seen: '', isHidden: hides(key), at });
    const places = looked.map(({ place }) => place ?? { x: 0, y: 0 });
    try {
      const hits = await pick(view, places);
      hits?.forEach((hit, index) => {
        if (hit === undefined) return;
        const { key, point, radius, seen, place } = looked[index];
        const far = norm(subtract(point, eye)) - Math.max(radius, tolerance);
        const isHidden = place !== null && hit !== null && norm(subtract(hit.point, eye)) < far;
        known.set(key, { seen, isHidden, at });
      });
      changed();
    } finally {
      await new Promise((resolve) => { setTimeout(resolve, pause); });
    }
  });
  return {
    hides,
    /** Looks at those marks again that moved, or all if the viewer did. @param {View | undefined} view
     * @param {Mark[]} marks */
    look(view, marks) {
      if (!view || view.isFlat || !view.isWhole) {
        known.clear();
        return;
      }
      const { eye, forward } = view.lens.basis;
      const { revision } = state.scene ?? {};
      const sight = JSON.stringify([eye, forward, revision, view.hasPlane && slice.frame]);
      const step = STEP * setting().size;
      const moved = marks.map((mark) => ({ ...mark, seen: `${mark.point.map((part) => Math.round(part / step))} ${sight}` }))
        .filter(({ key, seen }) => known.get(key)?.seen !== seen);
      if (moved.length > 0) look({ view, marks: moved });
    },
  };
}
