// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The stage: the scene, drawn when the camera, the field or the view changes, and the overlay
 * above it, drawn with each frame of the servo.
 *
 * @typedef {import('../wire.js').Wire} Wire
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {import('../input/pointer.js').Place} Place
 */

import { createHand } from '../input/hand.js';
import { createPointer } from '../input/pointer.js';
import { boundsOfToys } from '../plane/bounds.js';
import { connectFall, fall, layFall, listenFall, markOfBall, placeAbove, stepFall } from '../plane/fall.js';
import { toyAt } from '../plane/handles.js';
import { connectToys, layToys, listenToys } from '../plane/toys.js';
import { changed, listen, state } from '../state.js';
import { Flat, Orbit } from './camera.js';
import { createClick } from './click.js';
import { askContacts } from './contacts.js';
import { Elements } from './elements.js';
import { gripAt } from './grips.js';
import { Labels } from './labels.js';
import { Layer } from './layer.js';
import { fitLegend } from './marks.js';
import { marksOf } from './overlay.js';
import { paintAll } from './paint.js';
import { hasMap, isFlat, viewsOf } from './panels.js';
import { createPick } from './pick.js';
import { Pictures } from './pictures.js';
import { REACH, createPress } from './press.js';
import { Probe } from './probe.js';
import { comparison, holding, setting } from './setting.js';
import { listenSlice, meet, slice } from './slice.js';
import { Source } from './source.js';
import { along, inSpace } from './vectors.js';
import { createVeil } from './veil.js';
import { Views } from './views.js';

/** Room around a ball that begins to fall in pixels, and how the camera steps back for it. */
const ROOM = 30;
const STEP_BACK = 1.08;
const STEPS_BACK = 24;
/** Skip background picks while the core has worked on one question for this long [ms]. */
const BUSY = 300;

/** Builds the stage into a container.
 * @param {HTMLElement} container @param {Wire} wire */
export function createStage(container, wire) {
  const elements = new Elements(container);
  const cameras = { orbit: new Orbit(), flat: new Flat() };
  const named = new Views(cameras.orbit, cameras.flat);
  /** @type {View[]} */
  let views = [];
  let isSceneChanged = true;
  let isOverlayChanged = true;
  let isPressed = false;
  let requested = 0;
  /** What the camera was laid for last. */
  let laidFor = '';
  /** Of which opened scene the checks and the ball were laid out. @type {number | null} */
  let toysLaidFor = null;
  let wasFlat = false;
  /** Where the pointer leads the hand. @type {Vector | null} */
  let target = null;
  /** @type {any} */
  let contacts = null;

  const layer = new Layer(elements.scene, (what, why) => {
    if (what === 'gone') withoutCard();
    if (what === 'error') source.fail(why ?? '');
    if (what !== 'error') source.update(setting());
    sceneChanged();
  });
  /** @type {import('./fields.js').Field | null} */
  let field = null;
  const source = new Source(wire, (made) => {
    field = made;
    sceneChanged();
  });
  const pictures = new Pictures(wire, elements.picture, overlayChanged);
  const labels = new Labels(wire, overlayChanged);
  const probe = new Probe(wire, overlayChanged);
  const pick = createPick(layer, wire);
  const hand = createHand(wire);
  if (!layer.gl) withoutCard();

  function request() {
    if (requested === 0) requested = requestAnimationFrame(frame);
  }

  function sceneChanged() {
    isSceneChanged = true;
    overlayChanged();
  }

  function overlayChanged() {
    isOverlayChanged = true;
    request();
  }

  function withoutCard() {
    state.hasCard = false;
    elements.useCard(false);
    pictures.resize();
  }

  /** The scene as it is shown: bodies that are compared lie where they are drawn. */
  function current() {
    const whole = setting();
    const isComparing = state.view.mode === 'compare' && whole.bodies.length > 1;
    return isComparing ? comparison(whole, state.view.compared) : whole;
  }

  function frame() {
    requested = 0;
    stepFall(performance.now());
    if (isSceneChanged) {
      isSceneChanged = false;
      cameras.flat.frame = slice.frame;
      views = viewsOf(setting(), cameras, elements.rect);
      if (fitLegend(views[0].lens.rect)) changed('view');
      if (state.hasCard && field) layer.show(views.map(({ panel }) => panel), field);
      // Before the first scene nobody knows how it is to be drawn.
      const isDrawn = source.isDrawn && state.connection === 'live' && state.scene !== null;
      elements.useCard(!source.isDrawn);
      if (isDrawn) pictures.ask({ views, flat: cameras.flat, setting: setting() });
      if (views.some(hasMap)) labels.renew(views, cameras.flat);
    }
    if (!source.isDrawn && layer.step(isPressed)) request();
    if (isOverlayChanged) {
      isOverlayChanged = false;
      elements.note(source.words, source.why);
      elements.read(probe.words);
      const shown = {
        target, contacts, labels, probe: probe.probed, notes: elements.notes,
        isDrawn: source.isDrawn,
        hides: veil.hides,
        legendTop: elements.legendTop,
      };
      veil.look(views[0], [...markOfBall(), ...marksOf(contacts)]);
      paintAll(elements.context, views, shown, elements.inks, elements.ratio);
    }
  }

  /** Takes the shape of the panels. */
  function measure() {
    const [{ lens: { rect } }] = viewsOf(setting(), cameras, elements.rect);
    named.aspect = rect.width / rect.height;
  }

  /** Looks at another scene as a whole; one that was edited stays where it is. Whether it was
   * another. */
  function takeScene() {
    const { mode, compared } = state.view;
    const comparing = mode === 'compare' ? compared.join() : '';
    const key = `${state.opened} ${comparing}`;
    const shown = current();
    cameras.orbit.size = shown.size;
    cameras.flat.size = shown.size;
    if (key === laidFor || !state.scene) return false;
    laidFor = key;
    measure();
    // Another view of the same scene keeps what was dragged.
    if (state.opened !== toysLaidFor) {
      toysLaidFor = state.opened;
      if (shown.dimension === 2) layToys(shown.centre, shown.size);
      layFall(setting());
    }
    named.reset(shown);
    if (fall.isShown) showBall();
    return true;
  }

  /** Steps back until the beginning of the fall is seen. */
  function showBall() {
    const { rect } = viewsOf(setting(), cameras, elements.rect)[0].lens;
    const camera = isFlat(setting()) ? cameras.flat : cameras.orbit;
    const isSeen = () => {
      const place = camera.lens(rect).project(inSpace(fall.centre));
      return place && Math.min(place.x - rect.x, rect.x + rect.width - place.x, place.y - rect.y,
        rect.y + rect.height - place.y) > ROOM;
    };
    for (let step = 0; step < STEPS_BACK && !isSeen(); step += 1) camera.height *= STEP_BACK;
    sceneChanged();
  }

  /** The number of the view at a place. @param {Place} place */
  function viewAt(place) {
    return views.findIndex(({ lens: { rect } }) => place.x >= rect.x && place.y >= rect.y
      && place.x < rect.x + rect.width && place.y < rect.y + rect.height);
  }

  /** The point of the scene that is seen at a place. @param {View} view @param {Place} place */
  async function seenAt(view, { x, y }) {
    if (view.isFlat) return view.lens.at(x, y, cameras.flat.frame.origin);
    const cut = view.hasPlane ? meet(view.lens, x, y) : null;
    if (cut) return cut;
    return (await glance(view, [{ x, y }]))?.[0]?.point ?? null;
  }

  /** @param {View} view @param {Place} place */
  const pickAt = async (view, place) => (await pick(view, [place]))?.[0] ?? null;

  /** Picks as well, unless the core would have to and has no time.
   * @param {View} view @param {Place[]} places */
  const glance = async (view, places) =>
    (state.hasCard || wire.slow(BUSY).length === 0 ? pick(view, places) : null);

  const veil = createVeil(glance, overlayChanged);

  /** The handle of a toy or of the selected part at a place, or null. @param {View} view @param {Place} place */
  function handleAt({ lens, isFlat: isPlane, isWhole }, place) {
    if (!isWhole) return null;
    const toy = isPlane && state.scene?.dimension === 2 ? toyAt(lens, place, REACH.mouse) : null;
    return toy ?? gripAt(() => lens, isPlane, place, REACH.mouse);
  }

  /** Tells of a handle under the pointer. @param {{ name: string } | null} handle */
  function showHandle(handle) {
    elements.overlay.style.cursor = handle ? 'grab' : '';
    elements.overlay.title = handle?.name ?? '';
  }

  function fit() {
    elements.resize();
    elements.dress();
    layer.resize();
    pictures.resize();
    sceneChanged();
  }

  createPointer(elements.overlay, {
    press: createPress({
      cameras,
      hand,
      view: (place) => views[viewAt(place)] ?? views[0],
      pick: pickAt,
      hides: veil.hides,
      click: createClick(wire, pickAt, seenAt),
      changed: sceneChanged,
      show(point) {
        target = point;
        overlayChanged();
      },
    }),
    hover(place) {
      const number = place ? viewAt(place) : -1;
      const view = views[number];
      showHandle(place && view ? handleAt(view, place) : null);
      if (!place || !view || isPressed || state.connection !== 'live') probe.leave();
      else probe.follow(() => seenAt(view, place), view, number);
    },
    zoom({ x, y }, factor) {
      const view = views[viewAt({ x, y })] ?? views[0];
      const camera = view?.isFlat ? cameras.flat : cameras.orbit;
      if (view) camera.zoom(factor, x, y, view.lens.rect);
      sceneChanged();
    },
    pan(place, across, down) {
      const view = views[viewAt(place)] ?? views[0];
      const camera = view?.isFlat ? cameras.flat : cameras.orbit;
      if (view) camera.pan(across, down, view.lens.rect);
      sceneChanged();
    },
  });

  listen(['scene'], () => {
    probe.leave();
    takeScene();
    source.update(setting());
    askContacts(wire, (answer) => {
      contacts = answer;
      overlayChanged();
    });
    sceneChanged();
  });
  listen(['view'], () => {
    probe.leave();
    const isOther = takeScene();
    const isFlatNow = isFlat(setting());
    // Zooming in a map may have put the 3D camera inside the scene; step out.
    if (wasFlat && !isFlatNow) named.stepOut(current());
    wasFlat = isFlatNow;
    if (isOther && source.kind === 'samples') source.renew();
    askContacts(wire, (answer) => {
      contacts = answer;
      overlayChanged();
    });
    sceneChanged();
  });
  listen(['connection'], sceneChanged);
  const dress = () => {
    elements.dress();
    sceneChanged();
  };
  listen(['theme'], dress);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', dress);
  listen(['frame', 'playback'], overlayChanged);
  listen(['selection'], sceneChanged);
  listenSlice(sceneChanged);
  listenToys(overlayChanged);
  connectToys(wire);
  listenFall(overlayChanged);
  connectFall(wire);
  // Programs are compiled between drags, wherever on the page they are.
  for (const type of ['pointerdown', 'pointerup', 'pointercancel']) {
    window.addEventListener(type, (event) => {
      isPressed = event.type === 'pointerdown';
      request();
    }, { capture: true });
  }
  new ResizeObserver(fit).observe(container);
  takeScene();
  source.update(setting());
  fit();

  return {
    hand,
    /** Leads the hand to a point, which is shown; without one it lets go. @param {Vector | null} point */
    lead(point) {
      target = point;
      if (point) hand.lead(point);
      else hand.release();
      overlayChanged();
    },
    fit,
    /** @param {string} name `reset`, `x`, `y`, `z`, `in`, `out` or a view of the scene */
    setCamera(name) {
      measure();
      const shown = current();
      named.show(name, shown, state.view.mode === 'compare' ? shown : holding(shown, boundsOfToys(shown.dimension)));
      sceneChanged();
    },
    /** The picture with all that lies over it. @returns {Promise<Blob>} */
    exportPng() {
      if (!source.isDrawn && layer.gl) layer.present();
      return elements.export(source.isDrawn);
    },
    /** How fast the scene is drawn: the time of a moving picture [ms], the part of the pixels
     * that it has along each side, and whether it is complete. */
    stats: () => ({ time: layer.lastTime, scale: layer.scale, isStill: layer.isDone }),
    /** Unit vectors in space to the right, up and away from the viewer. */
    axes() {
      measure();
      const { right, up, forward } = views[0].lens.basis;
      return { right, up, away: forward };
    },
    /** Lays the ball above what is in the middle of the picture. */
    placeBall() {
      const { orbit, flat } = cameras;
      const { origin, right, up } = flat.frame;
      const middle = isFlat(setting())
        ? along(along(origin, right, flat.centre[0]), up, flat.centre[1]) : orbit.target;
      placeAbove(middle, setting());
      showBall();
    },
    showBall,
  };
}
