// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What the page knows, in one place, and who wants to know when it changes.
 *
 * @typedef {import('./wire.js').Frame} Frame
 * @typedef {import('./wire.js').Message} Message
 * @typedef {'connection' | 'welcome' | 'scene' | 'frame' | 'newest' | 'selection' | 'view' |
 *   'events' | 'safety' | 'theme' | 'playback' | 'touch' | 'clients' | 'problems' | 'heard' | 'stop'} Topic
 * @typedef {'space' | 'slice' | 'plane' | 'compare'} ViewMode
 */

/** Frames that are kept to look back: a minute. */
export const KEPT_FRAMES = 3600;

/** A proxy that is slower rests [m/s]. */
const RESTING = 1e-3;

export const state = {
  /** @type {'connecting' | 'live' | 'lost' | 'closed'} */
  connection: 'connecting',
  /** For how long a connected program was not heard [ms]; null while it is. @type {number | null} */
  unheard: null,
  /** Why the connection was lost. */
  why: '',
  /** @type {Message | null} the answer to `hello` */
  welcome: null,
  /** @type {Message | null} the newest `scene` */
  scene: null,
  /** How many scenes were opened: that of an edit, or one that was saved, is still the same. */
  opened: 0,
  /** @type {Message | null} how the newest scene is drawn */
  way: null,
  /** @type {Frame | null} the newest frame, or that looked back to */
  frame: null,
  /** What the servo does now. @type {Frame | null} */
  newest: null,
  /** @type {Frame[]} the last frames, one a tick, oldest first */
  history: [],
  /** Where in the history the page looks; null while it follows. @type {number | null} */
  lookingAt: null,
  /** What the servo did, oldest first, the last 200. @type {Message[]} */
  events: [],
  /** The stages of the safety chain in their order: in how many ticks each has acted, and when
   * that was seen to grow last, on the clock of `performance.now()`.
   * @type {{ name: string, ticks: number, largest: number, acted: number }[]} */
  safety: [],
  /** Whether the page draws by itself: else the program draws space, and the page maps of planes. */
  hasCard: true,
  /** Pages that are open on this program. */
  clients: 1,
  /** What was wrong with the last refused edit, by JSON pointer. @type {Map<string, string>} */
  problems: new Map(),
  touch: {
    /** What leads the hand. @type {'pointer' | 'gamepad' | 'keys'} */
    input: 'pointer',
    /** The contact point that leads; null for the middle of all. @type {number | null} */
    point: null,
    rumble: true,
    vibration: true,
    sound: false,
    volume: 0.4,
  },
  /** The JSON pointer of the selected part of the scene. @type {string | null} */
  selection: null,
  view: {
    /** @type {ViewMode} */
    mode: 'space',
    /** @type {'inside' | 'distance' | 'gradient' | 'promise'} */
    map: 'distance',
    positiveInside: false,
    asInMemoir: false,
    sineFactor: 1,
    channels: { red: true, green: true, blue: true },
    isolines: true,
    /** Between isolines [m]; null for a spacing that suits the view. @type {number | null} */
    spacing: null,
    /** The length over which the gradient is taken from differences [m]; null for the least that the
     * card's precision allows. @type {number | null} */
    offset: null,
    shown: {
      contacts: true, normals: true, proof: false, forces: true, bounds: false, names: true,
      spring: true, handles: true,
    },
    /** The two bodies that are compared. */
    compared: [0, 1],
  },
};

/** @type {Map<Topic, Set<() => void>>} */
const listeners = new Map();

/** Calls `listener` after each change; gives a function that ends that.
 * @param {Topic[]} topics @param {() => void} listener */
export function listen(topics, listener) {
  for (const topic of topics) {
    if (!listeners.has(topic)) listeners.set(topic, new Set());
    listeners.get(topic)?.add(listener);
  }
  return () => topics.forEach((topic) => listeners.get(topic)?.delete(listener));
}

/** Tells that a topic changed. @param {Topic} topic */
export function changed(topic) {
  listeners.get(topic)?.forEach((listener) => listener());
}

/** Friction that holds a proxy has it slip until the force is well below its limit: only where the
 * proxy moves too is it felt. @param {Frame} frame @param {Frame | undefined} last */
function takeSlips(frame, last) {
  const seconds = last ? frame.time - last.time : 0;
  frame.points.forEach((point, index) => {
    const before = last?.points[index]?.proxy ?? point.proxy;
    const way = Math.hypot(...point.proxy.map((place, axis) => place - before[axis]));
    point.slipping &&= point.contact && seconds > 0 && way > RESTING * seconds;
  });
}

/** Takes a frame into the history; shows it unless the page looks back. @param {Frame} frame */
export function takeFrame(frame) {
  const { history } = state;
  const last = history[history.length - 1];
  const isOfOther = last !== undefined && frame.tick < last.tick;
  if (isOfOther) history.length = 0;
  takeSlips(frame, last);
  if (frame.tick !== last?.tick) history.push(frame);
  if (history.length > KEPT_FRAMES) {
    history.shift();
    if (state.lookingAt !== null) state.lookingAt = Math.max(0, state.lookingAt - 1);
  }
  state.newest = frame;
  changed('newest');
  // Of a servo that has ended nothing is kept.
  if (isOfOther && state.lookingAt !== null) lookAt(null);
  if (state.lookingAt === null) {
    state.frame = frame;
    changed('frame');
  }
}

/** Looks at a frame of the history, or follows the newest. @param {number | null} index */
export function lookAt(index) {
  const { history } = state;
  state.lookingAt = index === null ? null : Math.max(0, Math.min(index, history.length - 1));
  state.frame = state.lookingAt === null ? state.newest : history[state.lookingAt];
  changed('playback');
  changed('frame');
}

/** Changes the view. @param {Partial<typeof state.view>} change */
export function setView(change) {
  Object.assign(state.view, change);
  changed('view');
}

/** Changes how the scene is touched. @param {Partial<typeof state.touch>} change */
export function setTouch(change) {
  Object.assign(state.touch, change);
  changed('touch');
}

/** Selects a part of the scene by its JSON pointer. @param {string | null} pointer */
export function select(pointer) {
  state.selection = pointer;
  changed('selection');
}
