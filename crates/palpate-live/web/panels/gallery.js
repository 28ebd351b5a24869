// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** Scenes to begin with, made from the program's own catalogue. */

import { state } from '../state.js';
import { exampleOf } from './changes.js';

/** Between the middles of two primitives, and the largest length of one [m]. */
const SPACING = 0.15;
const SIZE = 0.05;

/** Every primitive of a dimension that has bounds, side by side. @param {number} dimension */
function everyPrimitive(dimension) {
  const entries = (state.welcome?.catalogue ?? [])
    .filter((/** @type {any} */ entry) => entry.dimension === dimension && entry.bounded);
  const columns = Math.ceil(Math.sqrt(1.6 * entries.length));
  const rows = Math.ceil(entries.length / columns);
  return {
    palpate: 1,
    dimension,
    description: 'Every primitive that has bounds.',
    bodies: entries.map((/** @type {any} */ entry, /** @type {number} */ index) => {
      const x = (index % columns) - (columns - 1) / 2;
      const y = (rows - 1) / 2 - Math.floor(index / columns);
      const place = [SPACING * x, SPACING * y, 0].slice(0, dimension);
      return { name: entry.name, shape: exampleOf(entry, SIZE), pose: { translation: place } };
    }),
  };
}

/** A solid that is drilled, with a ring around it: operators to switch. */
const drilled = {
  palpate: 1,
  dimension: 3,
  description: 'A box with two holes and a ring in smooth union: select an operator and switch it.',
  bodies: [{
    name: 'drilled box',
    shape: { width: 0.01, smooth_union: [
      { difference: [
        { rounded_cuboid: { size: [0.12, 0.1, 0.08], rounding: 0.008 } },
        { cylinder: { radius: 0.02, height: 0.2 } },
        { rotate_degrees: { axis: [1, 0, 0], angle: 90 }, of: { cylinder: { radius: 0.018, height: 0.2 } } },
      ] },
      { rotate_degrees: { axis: [0, 0, 1], angle: 25 }, of: { torus: { ring_radius: 0.08, radius: 0.012 } } },
    ] },
    material: 'wood',
  }],
};

/** The cone and the cube of the article. */
const cone = {
  palpate: 1,
  dimension: 3,
  description: 'A cone and a cube: select their union and switch it to intersection or difference.',
  bodies: [{
    name: 'cone and cube',
    shape: { union: [{ cone: { radius: 0.035, height: 0.09 } }, { cuboid: { size: [0.05, 0.05, 0.05] } }] },
    material: 'wood',
  }],
};

/** Two cones with the same surface. */
const pairOfCones = {
  palpate: 1,
  dimension: 3,
  description: 'A cone with exact distances and one with approximate ones: compare their isolines.',
  bodies: [
    { name: 'cone, exact', shape: { cone: { radius: 0.04, height: 0.09 } }, pose: { translation: [-0.06, 0, 0] } },
    { name: 'cone, approximate', shape: { cone_approximation: { radius: 0.04, height: 0.09 } },
      pose: { translation: [0.06, 0, 0] } },
  ],
};

/** The window of the memoir's program: its pixels are millimetres. */
const views = [{ name: 'window', center: [0.96, 0.54], width: 1.92, height: 1.08, spacing: 0.02 }];

/** What the memoir's program shows first. */
const memoir = {
  palpate: 1,
  dimension: 2,
  description: 'What the memoir’s program shows first: a star in smooth union with a circle.',
  bodies: [{
    name: 'star and circle',
    shape: { width: 0.00025, profile: 'quadratic', smooth_union: [
      { translate: [1, 0.53], of: { regular_star: { branches: 12, outer_radius: 0.3, inner_radius: 0.21213203435596423 } } },
      { translate: [0.75, 0.68], of: { ball: { radius: 0.2 } } },
    ] },
  }],
  views,
};

/** The two shapes of the memoir's program, with its window. */
const star = {
  palpate: 1,
  dimension: 2,
  description: 'The star and the circle of the memoir, as two bodies to compare.',
  bodies: [
    { name: 'star', shape: { regular_star: { branches: 12, outer_radius: 0.3, inner_radius: 0.21 } },
      pose: { translation: [1.2, 0.53] } },
    { name: 'circle', shape: { ball: { radius: 0.2 } }, pose: { translation: [0.6, 0.6] } },
  ],
  views,
};

/** The gallery: names, and what makes each scene. @type {[string, () => object][]} */
export const GALLERY = [
  ['drilled box', () => drilled],
  ['cone and cube', () => cone],
  ['exact and approximate', () => pairOfCones],
  ['the memoir’s star', () => memoir],
  ['star and circle', () => star],
  ['primitives of space', () => everyPrimitive(3)],
  ['primitives of the plane', () => everyPrimitive(2)],
];
