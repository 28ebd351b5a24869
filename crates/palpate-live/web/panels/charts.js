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
import { short } from './numbers.js';
import { useTopics } from './page.js';

/** Frames that are drawn: ten seconds. */
const FRAMES = 600;
/** Between two drawings [ms]. */
const INTERVAL = 100;

/** The charts; `least` is the least height of one, so that what is zero throughout is not drawn large.
 * @type {{ title: string, unit: string, least: number, lines: { name: string, color: string,
 *   of: (frame: Frame) => number }[] }[]} */
const CHARTS = [
  { title: 'force', unit: 'N', least: 0.1, lines: [{ name: 'force', color: '--line-1', of: (frame) => frame.force }] },
  { title: 'depth', unit: 'mm', least: 0.1, lines: [{ name: 'depth', color: '--line-2', of: (frame) => 1000 * frame.depth }] },
  { title: 'energy', unit: 'mJ', least: 0.1, lines: [
    { name: 'taken', color: '--line-1', of: (frame) => 1000 * frame.taken },
    { name: 'given', color: '--line-2', of: (frame) => 1000 * frame.given },
    { name: 'kept', color: '--line-3', of: (frame) => 1000 * frame.kept },
  ] },
  { title: 'tick', unit: 'µs', least: 10, lines: [
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
    scales: { x: { time: false }, y: { range: (/** @type {any} */ _, /** @type {number | null} */ low,
      /** @type {number | null} */ high) => rangeOf(low ?? 0, high ?? 0, chart.least) } },
    hooks: { draw: [paintMoment] },
    series: [{}, ...chart.lines.map((line) => ({ label: line.name, stroke: color(line.color), width: 1.25 }))],
    axes: [{ ...axis(), space: 60 }, { ...axis(), size: 38, space: 22,
      values: (/** @type {any} */ _, /** @type {number[]} */ places) => places.map((place) => short(place, 4)) }],
  };
}

/** The range of an axis that holds these values and zero. @param {number} low @param {number} high
 * @param {number} least */
function rangeOf(low, high, least) {
  const top = high <= 0 && low < 0 ? 0 : Math.max(high, low + least, least);
  return [low < 0 ? Math.min(1.08 * low, top - least) : 0, 1.08 * top];
}

/** The tick with which what is drawn begins while the page looks back. */
let firstTick = 0;

/** The frames that are drawn, and the number of the first in the history: the newest, or while the
 * page looks back those of before, as long as the frame looked at is one of them. */
function drawn() {
  const { history, lookingAt } = state;
  const newest = Math.max(0, history.length - FRAMES);
  let start = newest;
  if (lookingAt !== null) {
    start = Math.max(0, history.findIndex(({ tick }) => tick >= firstTick));
    if (lookingAt < start || lookingAt >= start + FRAMES) start = lookingAt - FRAMES / 2;
    start = Math.max(0, Math.min(start, newest));
  }
  firstTick = history[start]?.tick ?? 0;
  return { start, frames: history.slice(start, start + FRAMES) };
}

/** Draws a line at the time that the page looks back to. @param {any} plot */
function paintMoment(plot) {
  const { lookingAt, frame } = state;
  if (lookingAt === null || !frame) return;
  const { ctx: context, bbox } = plot;
  const at = Math.round(plot.valToPos(frame.time, 'x', true));
  if (at < bbox.left || at > bbox.left + bbox.width) return;
  context.save();
  context.fillStyle = color('--warn');
  context.fillRect(at - devicePixelRatio, bbox.top, 2 * devicePixelRatio, bbox.height);
  context.restore();
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
      const before = firstTick;
      const { frames } = drawn();
      // What a person has zoomed in on stays while the page looks back at it.
      const isSame = state.lookingAt !== null && before === firstTick;
      const times = frames.map((frame) => frame.time);
      plots.forEach((plot, index) => {
        plot.setData([times, ...CHARTS[index].lines.map((line) => frames.map(line.of))], !isSame);
        if (isSame) plot.redraw(false);
      });
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
      <${Caption} ...${{ title, unit, lines }} />
      <div class="plot" role="img" aria-label=${`${title} in ${unit} over the last ten seconds`}></div>
    </figure>`)}
  </div>`;
}

/** A chart's name, and its values now or at the time that is looked at.
 * @param {{ title: string, unit: string, lines: typeof CHARTS[number]['lines'] }} given */
function Caption({ title, unit, lines }) {
  useTopics(['frame'], INTERVAL);
  const { frame } = state;
  return html`<figcaption>${title} <span class="unit">[${unit}]</span>
    ${lines.map(({ name, color: key, of }) => html`<span key=${name} class="key" style=${{ '--key': `var(${key})` }}>
      ${lines.length > 1 && name} ${frame ? short(of(frame)) : '–'}</span>`)}</figcaption>`;
}
