// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Paints the whole overlay.
 *
 * @typedef {import('./panels.js').View} View
 * @typedef {import('./vectors.js').Vector} Vector
 * @typedef {{ target: Vector | null, contacts: any, labels: import('./labels.js').Labels,
 *   probe: import('./probe.js').Probed | null, notes: import('./texts.js').Taken[],
 *   legendTop: number, isDrawn: boolean, hides: (key: string) => boolean }} Shown `notes` are texts that lie over the picture,
 *   the legend begins at `legendTop`,
 *   `isDrawn` tells whether the program drew it, `hides` whether a mark lies behind a body
 */

import { paintToys } from '../plane/drawn.js';
import { paintFall } from '../plane/falling.js';
import { state } from '../state.js';
import { isDark } from './colors.js';
import { paintGrips } from './grips.js';
import { paintGuides } from './guides.js';
import {
  MARGIN, paintAxes, paintHandles, paintLegend, paintOutline, paintScale, paintTitle,
} from './legend.js';
import { clearMarks, paintMarks } from './marks.js';
import { hoveredBody, paintBodies, paintContacts, paintHand, paintProbe, selectedBody } from './overlay.js';
import { hasMap } from './panels.js';
import { setting } from './setting.js';
import { corners, handles, slice } from './slice.js';
import { Texts } from './texts.js';

/** On maps: the colours of marks are dark, and have a light halo in both themes. */
const ON_MAP = {
  light: { ink: '#171a1f', halo: 'rgba(255, 255, 255, 0.82)', paper: 'rgba(255, 255, 255, 0.82)', muted: '#595f69' },
  dark: { ink: '#eceef2', halo: 'rgba(236, 238, 242, 0.62)', paper: 'rgba(14, 16, 20, 0.82)', muted: '#a3a9b3' },
};
/** Below the legend of marks: the title and the scale. */
const BELOW = 60;

/** Where the title, the scale and the axes of a panel are.
 * @param {import('./camera.js').Rect} rect @param {View} view @returns {import('./texts.js').Taken[]} */
const fixed = ({ x, y, width, height }, { title }) => [
  { x: x + width - 60, y: y + height - 18, wide: 120, high: 36 },
  { x: x + 40, y: y + 40, wide: 80, high: 80 },
  ...(title ? [{ x: x + width / 2, y: y + height - MARGIN - 24, wide: 200, high: 20 }] : []),
];

/** @param {CanvasRenderingContext2D} context @param {View[]} views @param {Shown} shown
 * @param {import('./ink.js').Inks} theme @param {number} ratio pixels a CSS pixel */
export function paintAll(context, views, shown, theme, ratio) {
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, context.canvas.width, context.canvas.height);
  const current = setting();
  const onMap = isDark() ? ON_MAP.dark : ON_MAP.light;
  views.forEach((view, number) => {
    const { lens: { rect }, isFlat, isWhole } = view;
    const inks = isFlat ? onMap : theme;
    context.save();
    context.beginPath();
    context.rect(rect.x, rect.y, rect.width, rect.height);
    context.clip();
    clearMarks();
    const isCut = view.hasPlane && !isFlat;
    if (isCut) paintOutline(context, view, corners(), inks);
    const texts = new Texts(context, rect, inks, [...shown.notes, ...fixed(rect, view)]);
    if (isWhole) {
      paintGuides(context, view, current, inks);
      paintBodies(context, view, current, texts, inks, {
        outlined: shown.isDrawn || !isFlat ? selectedBody() : -1,
        hovered: hoveredBody(view, shown.probe),
      });
      paintContacts(context, view, shown.contacts, inks, shown.hides);
      if (isFlat && current.dimension === 2) paintToys(context, view.lens, texts, inks);
      paintFall(context, view.lens, texts, inks, shown.hides('ball'));
      paintGrips(context, view.lens, isFlat, texts, inks);
      paintHand(context, view, shown.target, texts, inks, shown.hides);
    }
    if (isCut && state.view.mode === 'slice') paintHandles(context, view, handles(), slice.frame.origin, inks);
    if (shown.probe?.view === number) paintProbe(context, view, shown.probe, texts, inks);
    if (number === 0) paintAxes(context, view, inks);
    const right = rect.x + rect.width - MARGIN;
    const top = Math.max(rect.y + MARGIN, shown.legendTop + 4);
    const end = hasMap(view) ? paintLegend(context, view, top, inks) : top;
    texts.taken.push({ x: right - 65, y: (top + end) / 2, wide: 130, high: end - top });
    const marks = paintMarks(context, right, end + 4, rect.y + rect.height - BELOW, inks);
    if (marks) texts.taken.push(marks);
    paintScale(context, view, slice.frame.origin, inks);
    paintTitle(context, view, inks);
    texts.paint();
    if (hasMap(view) && view.hasLines) shown.labels.paint(view, number, texts, onMap);
    context.restore();
  });
}
