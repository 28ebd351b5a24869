// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Whether the scene hides the falling ball: what is seen at its place is nearer than the ball.
 *
 * @typedef {import('../scene/panels.js').View} View
 * @typedef {import('../input/pointer.js').Place} Place
 */

import { newest } from '../scene/newest.js';
import { inSpace, norm, subtract } from '../scene/vectors.js';
import { state } from '../state.js';
import { fall, moment, placeAt } from './fall.js';

/** @param {(view: View, place: Place) => Promise<{ point: number[] } | null>} pick
 * @param {() => void} changed */
export function createVeil(pick, changed) {
  let isHiding = false;
  let looked = '';
  const look = newest(async (/** @type {{ view: View, ball: number[] }} */ { view, ball }) => {
    const { lens } = view;
    const place = lens.project(ball);
    const hit = place && await pick(view, place);
    const { eye } = lens.basis;
    const isNearer = hit !== null && norm(subtract(hit.point, eye)) < norm(subtract(ball, eye)) - fall.radius;
    if (isNearer === isHiding) return;
    isHiding = isNearer;
    changed();
  });
  return {
    get isHiding() {
      return isHiding;
    },
    /** Looks again, if the ball or the viewer moved. @param {View | undefined} view */
    look(view) {
      const ball = fall.isShown ? placeAt(moment()) : null;
      if (!ball || !view || view.isFlat) {
        isHiding = false;
        looked = '';
        return;
      }
      const key = [...ball, ...view.lens.basis.eye, ...view.lens.basis.forward, state.scene?.revision].join(' ');
      if (key === looked) return;
      looked = key;
      look({ view, ball: inSpace(ball) });
    },
  };
}
