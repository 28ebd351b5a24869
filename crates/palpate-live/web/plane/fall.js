// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * A ball that falls onto the scene, as in the memoir: where it begins, what the program says of
 * its way, and which moment of it is shown. The program is asked again when the ball or the scene
 * changed: one question at a time, the newest wins.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('../scene/setting.js').Setting} Setting
 * @typedef {{ step: number, path: number[][], bounces: { time: number, centre: number[],
 *   normal: number[], speed: number }[], end: string, evaluations: number, time: number }} Fall
 */

import { reasonOf } from '../panels/page.js';
import { asking, newest } from '../scene/newest.js';
import { inSpace, rounded } from '../scene/vectors.js';
import { listen, state } from '../state.js';

/** How long a whole fall is to take on the page, and how short or long it may [s]. */
const SHOWN = { best: 3, least: 2, most: 4 };
/** The least time between two questions [ms]. */
const PAUSE = 60;
/** A fall is played once nothing has changed for this time [ms]. */
const SETTLE = 350;
/** The radius of the ball, and its way to the scene's bounds, over the size of the scene. */
const RADIUS = 0.035;
const ABOVE = 0.15;

export const fall = {
  isShown: false,
  /** Whether a click on the picture places the ball. */
  isPlacedByClick: true,
  /** Where it begins [m]. @type {number[]} */
  centre: [],
  radius: 0.05,
  gravity: 9.81,
  restitution: 0.5,
  /** The newest answer. @type {Fall | null} */
  answer: null,
  /** Why there is none. */
  refused: '',
  /** The moment that is shown [s]; null for the end. @type {number | null} */
  at: null,
  isPlaying: false,
};

/** @type {Set<() => void>} */
const listeners = new Set();
/** @type {ReturnType<typeof asking> | null} */
let questions = null;
let settling = 0;
/** When the moment that is shown was shown [ms]. */
let shownAt = 0;

/** Calls `listener` after each change of the ball, of the answer or of the moment that is shown.
 * @param {() => void} listener */
export function listenFall(listener) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

const tell = () => listeners.forEach((listener) => listener());

/** How long the fall takes [s]. */
export const lasts = () => (fall.answer ? Math.max(fall.answer.path.length - 1, 0) * fall.answer.step : 0);

/** By how much the fall is slowed on the page: below 1 it is sped up. */
export function slowing() {
  const time = lasts();
  if (time === 0 || (time >= SHOWN.least && time <= SHOWN.most)) return 1;
  const exact = SHOWN.best / time;
  return exact >= 2 ? Math.round(exact) : Number(exact.toPrecision(2));
}

/** The moment that is shown [s]. */
export const moment = () => Math.min(fall.at ?? Infinity, lasts());

/** Where the ball is at a time, or null without an answer. @param {number} time [s] */
export function placeAt(time) {
  const { path, step } = fall.answer ?? { path: [], step: 1 };
  if (path.length === 0) return null;
  const at = Math.min(Math.max(time / step, 0), path.length - 1);
  const [from, to] = [path[Math.floor(at)], path[Math.ceil(at)]];
  return from.map((part, axis) => part + (at % 1) * (to[axis] - part));
}

/** The ball at the moment that is shown, for whether bodies hide it.
 * @returns {import('../scene/veil.js').Mark[]} */
export function markOfBall() {
  const place = fall.isShown ? placeAt(moment()) : null;
  return place ? [{ key: 'ball', point: inSpace(place), radius: fall.radius }] : [];
}

/** Plays the fall from its beginning. */
export function playFall() {
  Object.assign(fall, { at: 0, isPlaying: lasts() > 0 });
  shownAt = performance.now();
  tell();
}

/** Shows a moment. @param {number | null} time [s] */
export function showMoment(time) {
  Object.assign(fall, { at: time, isPlaying: false });
  tell();
}

/** Goes on with a fall that is played. @param {number} now [ms] */
export function stepFall(now) {
  if (!fall.isPlaying) return;
  const at = (fall.at ?? 0) + (now - shownAt) / 1000 / slowing();
  shownAt = now;
  fall.isPlaying = at < lasts();
  fall.at = fall.isPlaying ? at : null;
  tell();
}

/** Changes the ball, and asks again if that changes its way. @param {Partial<typeof fall>} change */
export function setFall(change) {
  Object.assign(fall, change);
  if (Object.keys(change).some((key) => key !== 'isPlacedByClick')) renew();
  tell();
}

function renew() {
  clearTimeout(settling);
  if (!fall.isShown || fall.centre.length === 0) return;
  Object.assign(fall, { at: null, isPlaying: false });
  ask(undefined);
}

const ask = newest(async () => {
  if (!questions || state.connection !== 'live') return;
  const { centre, radius, gravity, restitution } = fall;
  try {
    fall.answer = await questions.ask({ do: 'fall', centre, radius, gravity, restitution });
    fall.refused = '';
  } catch (error) {
    fall.answer = null;
    fall.refused = reasonOf(error);
  }
  // Who asked for less movement plays a fall by the button.
  if (!matchMedia('(prefers-reduced-motion: reduce)').matches) {
    clearTimeout(settling);
    settling = window.setTimeout(playFall, SETTLE);
  }
  tell();
  await new Promise((resolve) => { setTimeout(resolve, PAUSE); });
}, () => questions?.giveUp());

/** Places the ball above a point of a scene, higher than all of it.
 * @param {number[]} point @param {Setting} setting */
export function placeAbove(point, { box, size, dimension }) {
  const centre = [point[0], box.high[1] + ABOVE * size, point[2] ?? 0];
  setFall({ centre: rounded(centre, size / 1000).slice(0, dimension) });
}

/** Lays the ball into another scene. @param {Setting} setting */
export function layFall(setting) {
  fall.answer = null;
  fall.radius = Number((RADIUS * setting.size).toPrecision(2));
  placeAbove(setting.centre, setting);
}

/** Asks over this connection from now on, and again with each scene. @param {Wire} connection */
export function connectFall(connection) {
  questions = asking(connection);
  listen(['scene'], () => {
    questions?.giveUp();
    renew();
  });
}
