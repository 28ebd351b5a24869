// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Four charts of the last seconds with one cursor.
 *
 * @typedef {import('../wire.js').Frame} Frame
 */

import { html, useEffect, useRef } from '../vendor/htm-preact.js';
import { listen, lookAt, state } from '../state.js';

/** Frames that are drawn: ten seconds. */
const FRAMES = 600;
/** Between two drawings [ms]. */
const INTERVAL = 100;

/** @type {{ title: string, unit: string, lines: { name: string, color: string,
 *   of: (frame: Frame) => number }[] }[]} */
const CHARTS = [
  { title: 'force', unit: 'N', lines: [{ name: 'force', color: '--line-1', of: (frame) => frame.force }] },
  { title: 'depth', unit: 'mm', lines: [{ name: 'depth', color: '--line-2', of: (frame) => 1000 * frame.depth }] },
  { title: 'energy', unit: 'mJ', lines: [
    { name: 'taken', color: '--line-1', of: (frame) => 1000 * frame.taken },
    { name: 'given', color: '--line-2', of: (frame) => 1000 * frame.given },
    { name: 'kept', color: '--line-3', of: (frame) => 1000 * frame.kept },
  ] },
  { title: 'tick', unit: 'µs', lines: [
    { name: 'cost', color: '--line-1', of: (frame) => 1e6 * frame.cost },
    { name: 'lateness', color: '--line-3', of: (frame) => 1e6 * frame.lateness },
  ] },
];

/** @param {string} name */
function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** @param {number} width @param {number} height @param {typeof CHARTS[number]} chart */
function options(width, height, chart) {
  const axis = () => ({
    stroke: color('--quiet'), grid: { stroke: color('--grid'), width: 1 }, ticks: { show: false },
    font: '10px Inter', size: 16, gap: 2,
  });
  return {
    width, height, padding: [8, 6, 0, 0], legend: { show: false },
    cursor: { sync: { key: 'palpate' }, y: false, points: { size: 5 }, drag: { x: true, y: false } },
    scales: { x: { time: false } },
    series: [{}, ...chart.lines.map((line) => ({ label: line.name, stroke: color(line.color), width: 1.25 }))],
    axes: [{ ...axis(), space: 60 }, { ...axis(), size: 38, space: 22 }],
  };
}

/** The frames that are drawn, and the number of the first in the history. */
function drawn() {
  const start = Math.max(0, state.history.length - FRAMES);
  return { start, frames: state.history.slice(start) };
}

export function Charts() {
  const box = useRef(/** @type {HTMLElement | null} */ (null));
  useEffect(() => {
    const places = /** @type {HTMLElement[]} */ ([...(box.current?.querySelectorAll('.plot') ?? [])]);
    const UPlot = /** @type {any} */ (globalThis).uPlot;
    /** @type {any[]} */
    let plots = [];
    const build = () => {
      plots.forEach((plot) => plot.destroy());
      plots = places.map((place, index) =>
        new UPlot(options(place.clientWidth, place.clientHeight, CHARTS[index]), [[], ...CHARTS[index].lines.map(() => [])], place));
      plots.forEach((plot) => plot.over.addEventListener('click', () => {
        const at = plot.cursor.idx;
        if (at !== null && at !== undefined && plot.select.width === 0) lookAt(drawn().start + at);
      }));
      draw();
    };
    const draw = () => {
      // Data that cannot be seen are not drawn.
      if (document.hidden || !box.current?.offsetParent) return;
      const start = performance.now();
      const { frames } = drawn();
      const times = frames.map((frame) => frame.time);
      plots.forEach((plot, index) => plot.setData([times, ...CHARTS[index].lines.map((line) => frames.map(line.of))],
        state.lookingAt === null));
      showCursor(plots[0]);
      performance.measure('charts', { start });
    };
    const timer = setInterval(() => state.lookingAt === null && draw(), INTERVAL);
    const sizes = new ResizeObserver(() => plots.forEach((plot, index) =>
      plot.setSize({ width: places[index].clientWidth, height: places[index].clientHeight })));
    build();
    places.forEach((place) => sizes.observe(place));
    const stopTheme = listen(['theme'], build);
    const stopLooking = listen(['playback'], draw);
    return () => {
      clearInterval(timer);
      sizes.disconnect();
      stopTheme();
      stopLooking();
      plots.forEach((plot) => plot.destroy());
    };
  }, []);
  return html`<div class="charts" ref=${box}>
    ${CHARTS.map(({ title, unit, lines }) => html`<figure key=${title} class="chart">
      <figcaption>${title} <span class="unit">[${unit}]</span>
        ${lines.length > 1 && lines.map(({ name, color: key }) => html`<span key=${name} class="key"
          style=${{ '--key': `var(${key})` }}>${name}</span>`)}</figcaption>
      <div class="plot" role="img" aria-label=${`${title} in ${unit} over the last ten seconds`}></div>
    </figure>`)}
  </div>`;
}

/** Puts the cursor where the page looks back to. @param {any} plot */
function showCursor(plot) {
  const { lookingAt, frame } = state;
  if (lookingAt === null || !frame || !plot) return;
  plot.setCursor({ left: plot.valToPos(frame.time, 'x'), top: 0 });
}
