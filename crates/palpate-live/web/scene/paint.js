// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Paints the whole overlay.
 *
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ target: Vector | null, contacts: any, labels: import('./labels.js').Labels,
 *   probe: import('./probe.js').Probed | null }} Shown
 */

import { paintToys } from '../plane/drawn.js';
import { state } from '../state.js';
import { paintAxes, paintHandles, paintLegend, paintOutline, paintScale, paintTitle } from './legend.js';
import { paintBodies, paintContacts, paintHand, paintProbe } from './overlay.js';
import { setting } from './setting.js';
import { corners, handles, slice } from './slice.js';

/** On maps, whose colours are light in both themes. */
const ON_MAP = { ink: '#171a1f', halo: 'rgba(255, 255, 255, 0.82)', muted: '#595f69' };

/** Where the legend, the title and the scale of a panel are.
 * @param {import('./camera.js').Rect} rect @returns {import('./labels.js').Taken[]} */
const texts = ({ x, y, width, height }) => [
  { x: x + width - 75, y: y + 50, wide: 150, high: 110 },
  { x: x + width / 2, y: y + height - 25, wide: width, high: 50 },
  { x: x + 40, y: y + 40, wide: 80, high: 80 },
];

/** @param {CanvasRenderingContext2D} context @param {View[]} views @param {Shown} shown
 * @param {import('./ink.js').Inks} theme @param {number} ratio pixels a CSS pixel */
export function paintAll(context, views, shown, theme, ratio) {
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, context.canvas.width, context.canvas.height);
  const current = setting();
  views.forEach((view, number) => {
    const { lens: { rect }, isFlat, isWhole } = view;
    const inks = isFlat ? ON_MAP : theme;
    context.save();
    context.beginPath();
    context.rect(rect.x, rect.y, rect.width, rect.height);
    context.clip();
    const isCut = view.hasPlane && !isFlat;
    if (isCut) paintOutline(context, view, corners(), inks);
    const names = isWhole ? paintBodies(context, view, current, inks) : [];
    if (view.hasLines) shown.labels.paint(context, view, number, ON_MAP, [...names, ...texts(rect)]);
    if (isWhole) {
      paintContacts(context, view, shown.contacts, inks);
      if (isFlat && current.dimension === 2) paintToys(context, view.lens, inks);
      paintHand(context, view, shown.target, inks);
    }
    if (isCut && state.view.mode === 'slice') paintHandles(context, view, handles(), slice.frame.origin, inks);
    if (shown.probe?.view === number) paintProbe(context, view, shown.probe, inks);
    if (number === 0) paintAxes(context, view, inks);
    paintLegend(context, view, inks);
    paintScale(context, view, slice.frame.origin, inks);
    paintTitle(context, view, inks);
    context.restore();
  });
}
