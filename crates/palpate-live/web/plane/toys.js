// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The toys of the memoir, in the plane: an element that is dragged, a circle, a second field and
 * an element that moves. Each is asked about again when it, the method or the scene changed: one
 * question at a time, the newest wins.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {'element' | 'ball' | 'pair' | 'sweep'} Toy
 */

import { reasonOf } from '../panels/page.js';
import { asking, newest } from '../scene/newest.js';
import { listen, state } from '../state.js';

/** Local methods for an element, by the names that the program knows. */
export const METHODS = {
  naive: 'memoir’s descent',
  projected_gradient: 'projected gradient',
  frank_wolfe: 'Frank–Wolfe',
  golden_section: 'golden section',
  macklin: 'Macklin',
};

/** How the memoir's descent finds gradients: as the memoir has it, first. */
export const GRADIENTS = {
  dichotomy: 'dichotomy',
  adaptive_dichotomy: 'dichotomy, adaptive',
  differences: 'differences',
  closest_vector: 'closest vector',
  exact: 'of the formula',
};

/** Local methods for a pair of bodies. */
export const PAIR_METHODS = {
  alternating_projection: 'projection in turns',
  minimax_proximal: 'proximal minimax',
  sum_descent: 'descent of the sum',
};

export const toys = {
  /** Which toys are out. @type {Record<Toy, boolean>} */
  shown: { element: false, ball: false, pair: false, sweep: false },
  /** One to three corners [m]: a point, a segment or a triangle. @type {number[][]} */
  corners: [],
  ball: { centre: [0, 0], radius: 0.1 },
  /** The two bodies whose separation is searched for, and where local descents start. */
  pair: { a: 0, b: 1, starts: /** @type {number[][]} */ ([]), method: 'minimax_proximal' },
  /** How the element moves in a second [m]. */
  by: [0, 0],
  /** The local method, one of `METHODS`. */
  method: 'projected_gradient',
  /** α, the length of a step over the element's size; null leaves it to the program.
   * @type {number | null} */
  alpha: null,
  /** µ, nearer than which steps get no shorter [m]; null leaves it to the program.
   * @type {number | null} */
  mu: null,
  /** How the memoir's descent finds gradients, one of `GRADIENTS`. */
  gradient: 'dichotomy',
  iterations: 64,
  /** Where the local search starts in the element: weights of its corners.
   * @type {number[] | null} */
  start: null,
  /** The step of the path that is looked at; null for the last. @type {number | null} */
  at: null,
  /** The newest answers. @type {Record<Toy, any>} */
  results: { element: null, ball: null, pair: null, sweep: null },
  /** Why there is no answer. @type {Record<Toy, string>} */
  refused: { element: '', ball: '', pair: '', sweep: '' },
};

/** @type {Set<() => void>} */
const listeners = new Set();
/** Over the connection, of each toy. @type {Record<string, ReturnType<typeof asking>>} */
const questions = {};

/** Calls `listener` after each change of a toy or of an answer. @param {() => void} listener */
export function listenToys(listener) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

const tell = () => listeners.forEach((listener) => listener());

/** Changes toys, and asks again. @param {Partial<typeof toys>} change */
export function setToys(change) {
  Object.assign(toys, change);
  // Where the path is looked at changes no answer.
  const isQuestion = Object.keys(change).some((key) => key !== 'at');
  if (isQuestion) askAll();
  tell();
}

/** Lays the toys into another scene. @param {number[]} centre
 * @param {number} size of the scene [m] */
export function layToys(centre, size) {
  const [x, y] = centre;
  const at = (/** @type {number} */ across, /** @type {number} */ above) =>
    [x + across * size, y + above * size];
  setToys({
    corners: [at(-0.42, -0.3), at(-0.2, -0.34), at(-0.3, -0.12)],
    ball: { centre: at(0.36, -0.3), radius: 0.08 * size },
    by: [0.4 * size, 0.2 * size],
    pair: { ...toys.pair, a: 0, b: 1, starts: [] },
  });
}

/** @param {Toy} toy @returns {import('../wire.js').Message} */
function question(toy) {
  const { corners, ball, pair, by, method, alpha, mu, gradient, iterations, start } = toys;
  if (toy === 'ball') {
    return { do: 'ask', question: { question: 'point', at: ball.centre, radius: ball.radius } };
  }
  if (toy === 'pair') return { do: toy, ...pair };
  if (toy === 'sweep') return { do: toy, corners, by };
  const chosen = Object.entries({ alpha, mu, start }).filter(([, value]) => value !== null);
  const found = method === 'naive' ? { gradient } : {};
  return { do: toy, corners, method, iterations, ...found, ...Object.fromEntries(chosen) };
}

/** Asks about a toy. @param {Toy} toy */
async function ask(toy) {
  if (!questions[toy] || state.connection !== 'live') return;
  try {
    const told = await questions[toy].ask(question(toy));
    toys.results[toy] = toy === 'ball' ? { ...told.answer.ball, time: told.time } : told;
    toys.refused[toy] = '';
  } catch (error) {
    toys.results[toy] = null;
    toys.refused[toy] = reasonOf(error);
  }
  tell();
}

/** @type {Record<Toy, (toy: Toy) => void>} */
const asks = {
  element: newest(ask, () => questions.element.giveUp()),
  ball: newest(ask, () => questions.ball.giveUp()),
  pair: newest(ask, () => questions.pair.giveUp()),
  sweep: newest(ask, () => questions.sweep.giveUp()),
};

function askAll() {
  for (const toy of /** @type {Toy[]} */ (Object.keys(toys.shown))) {
    const isReady = toy === 'pair' ? (state.scene?.bodies?.length ?? 0) > 1 : toys.corners.length > 0;
    if (toys.shown[toy] && isReady && state.scene?.dimension === 2) asks[toy](toy);
  }
}

/** Asks over this connection from now on, and again with each scene. @param {Wire} connection */
export function connectToys(connection) {
  for (const toy of Object.keys(toys.shown)) questions[toy] = asking(connection);
  listen(['scene'], () => {
    // What is asked about the scene of before counts no longer.
    for (const { giveUp } of Object.values(questions)) giveUp();
    askAll();
  });
}
