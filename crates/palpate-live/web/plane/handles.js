// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Handles of the toys: what is near a place of the page, and what a drag of it does.
 *
 * @typedef {import('../scene/camera.js').Lens} Lens
 * @typedef {import('../input/pointer.js').Drag} Drag
 * @typedef {import('../input/pointer.js').Place} Place
 */

import { inSpace, rounded } from '../scene/vectors.js';
import { setToys, toys } from './toys.js';

/** The names of an element's vertices. */
export const LETTERS = 'ABC';

/** The middle of the element. */
export function middleOfElement() {
  const { corners } = toys;
  return [0, 1].map((axis) => corners.reduce((sum, corner) => sum + corner[axis], 0) / corners.length);
}

/** @typedef {{ point: number[], name: string, drag: (point: number[], last: number[]) => void }} Handle */

/** The handles that are shown, each with its name. @returns {Handle[]} */
export function handles() {
  const { shown, corners, ball, pair } = toys;
  const list = [];
  const hasElement = shown.element || shown.sweep;
  if (hasElement) {
    corners.forEach((point, index) => list.push({
      point,
      name: `Vertex ${LETTERS[index]}`,
      drag: (/** @type {number[]} */ to) =>
        setToys({ corners: toys.corners.map((corner, i) => (i === index ? to : corner)) }),
    }));
  }
  if (shown.sweep && corners.length > 0) {
    const from = middleOfElement();
    list.push({
      point: [from[0] + toys.by[0], from[1] + toys.by[1]],
      name: 'Motion in 1 s',
      drag: (/** @type {number[]} */ to) => {
        const middle = middleOfElement();
        setToys({ by: [to[0] - middle[0], to[1] - middle[1]] });
      },
    });
  }
  if (hasElement && corners.length > 1) {
    list.push({
      point: middleOfElement(),
      name: 'Move the element',
      drag: (/** @type {number[]} */ to, /** @type {number[]} */ last) =>
        setToys({ corners: toys.corners.map(([x, y]) => [x + to[0] - last[0], y + to[1] - last[1]]) }),
    });
  }
  if (shown.ball) {
    const { centre, radius } = ball;
    list.push({
      point: [centre[0] + radius * Math.SQRT1_2, centre[1] + radius * Math.SQRT1_2],
      name: 'Radius of the circle',
      drag: (/** @type {number[]} */ to) => setToys({
        ball: {
          centre: toys.ball.centre,
          radius: Math.hypot(to[0] - toys.ball.centre[0], to[1] - toys.ball.centre[1]),
        },
      }),
    }, {
      point: centre,
      name: 'Move the circle',
      drag: (/** @type {number[]} */ to) => setToys({ ball: { ...toys.ball, centre: to } }),
    });
  }
  if (shown.pair) {
    pair.starts.forEach((point, index) => list.push({
      point,
      name: `Start ${index + 1}`,
      drag: (/** @type {number[]} */ to) => setToys({
        pair: { ...toys.pair, starts: toys.pair.starts.map((s, i) => (i === index ? to : s)) },
      }),
    }));
  }
  return list;
}

/** The handle near a place, or null where there is none.
 * @param {Lens} lens @param {Place} place @param {number} reach in pixels @returns {Handle | null} */
export function toyAt(lens, place, reach) {
  const distance = (/** @type {number[]} */ point) => {
    const seen = lens.project(inSpace(point));
    return seen ? Math.hypot(seen.x - place.x, seen.y - place.y) : Infinity;
  };
  const [nearest] = handles()
    .map((handle) => ({ handle, away: distance(handle.point) }))
    .sort((a, b) => a.away - b.away);
  return nearest && nearest.away <= reach ? nearest.handle : null;
}

/** The drag of the handle near a place, or null where there is none.
 * @param {() => Lens} lens @param {Place} place @param {number} reach in pixels
 * @returns {Drag | null} */
export function toyDrag(lens, place, reach) {
  const nearest = toyAt(lens(), place, reach);
  if (!nearest) return null;
  const seen = lens().project(inSpace(nearest.point)) ?? { ...place };
  const [offX, offY] = [seen.x - place.x, seen.y - place.y];
  let last = nearest.point;
  return {
    move({ x, y }) {
      const to = rounded(lens().at(x + offX, y + offY, [0, 0, 0]), lens().pixel([0, 0, 0])).slice(0, 2);
      nearest.drag(to, last);
      last = to;
    },
  };
}

/** Adds a start of the search between two bodies, where nothing but its place matters.
 * @param {number[]} point @param {number} pixel the size of a pixel [m] */
export function addStart(point, pixel) {
  setToys({ pair: { ...toys.pair, starts: [...toys.pair.starts, rounded(point, pixel)] } });
}
