// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Fields: a number with slider and drag, a choice, a text, a switch.
 *
 * @typedef {object} NumberGiven
 * @property {string} label
 * @property {number} value
 * @property {(value: number, moving: boolean) => void} change
 * @property {string} [unit]
 * @property {number} [min]
 * @property {number} [max]
 * @property {boolean} [above] whether `min` itself is not allowed
 * @property {boolean} [whole]
 * @property {number} [scale] a typical value: gives the slider its range, the drag its speed
 * @property {boolean} [slider]
 * @property {boolean} [isNamed] whether the unit stands beside the label
 * @property {string} [help]
 * @property {string | null} [problem]
 * @property {() => void} [forget] what was refused is given up
 * @property {boolean} [own] whether the page alone keeps the number, so that no program checks it
 */

import { DROP_HELP, forgetDraft, isDraft, isDrop } from '../input/draft.js';
import { html, useEffect, useRef, useState } from '../vendor/htm-preact.js';
import { short, typed } from './numbers.js';
import { read } from './units.js';

/** Pixels of a drag across the typical value. */
const DRAG_PIXELS = 150;
/** Steps of a slider from end to end. */
const SLIDER_STEPS = 500;
/** How far a pointer moves before a press becomes a drag [px]. */
const DRAG_START = 4;

let nextId = 0;

/** A number for the ids of a field. */
export function useId() {
  return useState(() => {
    nextId += 1;
    return nextId;
  })[0];
}

/** The range of a slider: what the schema allows, else around the value. @param {NumberGiven} given */
function rangeOf({ value, min, max, scale = 0, whole, above }) {
  const reach = 2 * Math.max(Math.abs(value), scale / 2) || 1;
  const high = max ?? (whole ? Math.max(Math.ceil(reach), (min ?? 0) + 10) : reach);
  const low = min ?? -reach;
  return { low: above ? low + (high - low) / SLIDER_STEPS : low, high };
}

/** The allowed value next to one that was dragged or slid.
 * @param {number} value @param {NumberGiven} given */
function allowed(value, given) {
  const { min = -Infinity, max = Infinity, above, whole } = given;
  const lowest = above ? rangeOf(given).low : min;
  const kept = Math.min(Math.max(value, lowest), max);
  return whole ? Math.round(kept) : Number(kept.toPrecision(6));
}

/** What is wrong with a number that the page alone keeps, or null.
 * @param {number} value @param {NumberGiven} given */
function outside(value, { min = -Infinity, max = Infinity, above, whole, unit = '' }) {
  const inUnit = (/** @type {number} */ limit) => `${short(limit)}${unit && ` ${unit}`}`;
  if (whole && !Number.isInteger(value)) return 'It must be a whole number.';
  if (value < min || (above && value === min)) return `It must be ${above ? 'greater than' : 'at least'} ${inUnit(min)}.`;
  return value > max ? `It must be at most ${inUnit(max)}.` : null;
}

/** A number that is typed, dragged sideways, stepped by arrow keys, or slid.
 * @param {NumberGiven} given */
export function NumberField(given) {
  const { label, value, change, unit = '', help, slider = true, isNamed = true } = given;
  const id = useId();
  const [draft, setDraft] = useState(/** @type {number | null} */ (null));
  const [text, setText] = useState(/** @type {string | null} */ (null));
  // What is wrong with the text: it stays as it was typed until it is right or given up.
  const [wrong, setWrong] = useState(/** @type {string | null} */ (null));
  const problem = wrong ?? given.problem;
  const range = useRef(rangeOf(given));
  // A new value may be outside the range of before; while it moves the range rests.
  useEffect(() => {
    if (draft === null) range.current = rangeOf(given);
  }, [value, given.min, given.max]);
  const isMoving = useRef(false);
  // What the program has takes the draft's place, but not under a hand that still moves it, nor
  // before what was wrong with it was read.
  useEffect(() => {
    if (!isMoving.current && !given.problem) setDraft(null);
  }, [value, given.problem]);
  const shown = draft ?? value;
  const { low, high } = range.current;

  const setTyped = (/** @type {string | null} */ next) => {
    setText(next);
    setWrong(null);
  };
  const go = (/** @type {number} */ next, /** @type {boolean} */ moving) => {
    const kept = allowed(next, given);
    isMoving.current = moving;
    setTyped(null);
    setDraft(kept);
    change(kept, moving);
  };
  /** What was dropped is not entered when the focus goes. */
  const isDropped = useRef(false);
  const giveUp = () => {
    isDropped.current = true;
    forgetDraft();
    setTyped(null);
    setDraft(null);
    given.forget?.();
  };
  const finish = () => {
    if (isDropped.current || text === null || text === typed(shown)) {
      setTyped(null);
      return;
    }
    const found = read(text, unit);
    const why = 'problem' in found ? found.problem : given.own ? outside(found.value, given) : null;
    setWrong(why);
    if (why !== null || !('value' in found)) return;
    setText(null);
    if (found.value === value) {
      giveUp();
      return;
    }
    // What is typed goes to the program as it is, which says what is wrong with it.
    setDraft(found.value);
    change(found.value, false);
  };
  const key = (/** @type {KeyboardEvent} */ event) => {
    if (event.key === 'Enter') finish();
    if (event.key === 'Escape') giveUp();
    if (isDrop(event) && (isDraft(event.target) || problem)) {
      event.preventDefault();
      giveUp();
    }
    const turn = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (turn === undefined) return;
    event.preventDefault();
    const size = given.whole ? 1 : step(Math.abs(shown) || (high - low) / 20);
    go(shown + turn * size * (event.shiftKey ? 10 : 1), false);
  };
  const press = (/** @type {PointerEvent} */ event) => {
    const field = /** @type {HTMLInputElement} */ (event.currentTarget);
    if (document.activeElement === field || event.button !== 0) return;
    const perPixel = Math.max(Math.abs(shown), (high - low) / 20) / DRAG_PIXELS;
    let isDrag = false;
    let last = shown;
    const move = (/** @type {PointerEvent} */ now) => {
      const way = now.clientX - event.clientX;
      if (!isDrag && Math.abs(way) < DRAG_START) return;
      isDrag = true;
      last = shown + way * perPixel * (now.shiftKey ? 0.1 : 1);
      go(last, true);
    };
    const end = () => {
      field.removeEventListener('pointermove', move);
      field.removeEventListener('pointerup', end);
      field.removeEventListener('pointercancel', end);
      if (isDrag) {
        field.blur();
        go(last, false);
      }
    };
    field.setPointerCapture(event.pointerId);
    field.addEventListener('pointermove', move);
    field.addEventListener('pointerup', end);
    field.addEventListener('pointercancel', end);
  };
  /** Shows all digits, selected: the text that replaces the short one would lose a selection made before. */
  const focus = (/** @type {any} */ event) => {
    const input = event.currentTarget;
    setText(text ?? typed(shown));
    requestAnimationFrame(() => document.activeElement === input && input.select());
  };
  const sliderValue = (/** @type {Event} */ event) =>
    Number(/** @type {HTMLInputElement} */ (event.currentTarget).value);

  return html`<div class=${problem ? 'field wrong' : 'field'}>
    <label for=${`f${id}`} title=${help}>${label}${unit && isNamed && html` <span class="unit">[${unit}]</span>`}</label>
    <input id=${`f${id}`} class="number" type="text" inputmode="decimal" autocomplete="off"
      value=${text ?? short(shown, 6)} title=${`${help ?? label}: drag sideways, or type${unit && ', also with another unit'}. ${DROP_HELP}`}
      aria-invalid=${problem ? 'true' : undefined} aria-describedby=${problem ? `p${id}` : undefined}
      onFocus=${focus}
      onInput=${(/** @type {any} */ event) => {
        isDropped.current = false;
        setTyped(event.currentTarget.value);
      }}
      onBlur=${finish} onKeyDown=${key} onPointerDown=${press} />
    ${slider && html`<input type="range" class="slider" min=${low} max=${high}
      step=${given.whole ? 1 : step((high - low) / SLIDER_STEPS)} value=${shown} aria-label=${label}
      aria-valuetext=${`${short(shown)} ${unit}`}
      onInput=${(/** @type {Event} */ event) => go(sliderValue(event), true)}
      onChange=${(/** @type {Event} */ event) => go(sliderValue(event), false)} />`}
    ${problem && html`<p class="problem" id=${`p${id}`} role=${wrong ? 'alert' : undefined}>${problem}</p>`}
  </div>`;
}

/** A round step near a tenth of a size: 1, 2 or 5 times a power of ten. @param {number} size */
function step(size) {
  const power = 10 ** Math.floor(Math.log10(size / 10));
  const rest = size / 10 / power;
  return Number(((rest >= 5 ? 5 : rest >= 2 ? 2 : 1) * power).toPrecision(1));
}

/** Numbers side by side, one for each axis.
 * @param {{ label: string, value: number[], change: (value: number[], moving: boolean) => void,
 *   unit?: string, names?: string[], help?: string, problem?: string | null, scale?: number,
 *   min?: number, above?: boolean, forget?: () => void, own?: boolean }} given */
export function VectorField({ label, value, change, names = ['x', 'y', 'z', 'w'], ...rest }) {
  const { unit, help, problem, ...limits } = rest;
  return html`<fieldset class=${problem ? 'vector wrong' : 'vector'} title=${help}>
    <legend>${label}${unit && html` <span class="unit">[${unit}]</span>`}</legend>
    ${value.map((number, axis) => html`<${NumberField} key=${axis} label=${names[axis] ?? String(axis)}
      value=${number} slider=${false} unit=${unit} isNamed=${false} ...${limits}
      change=${(/** @type {number} */ next, /** @type {boolean} */ moving) =>
        change(value.map((old, at) => (at === axis ? next : old)), moving)} />`)}
    ${problem && html`<p class="problem">${problem}</p>`}
  </fieldset>`;
}

/** @param {{ label: string, value: string, choices: (string | [string, string])[],
 *   change: (value: string) => void, help?: string, problem?: string | null }} given */
export function ChoiceField({ label, value, choices, change, help, problem }) {
  const id = useId();
  return html`<div class=${problem ? 'field wrong' : 'field'}>
    <label for=${`f${id}`} title=${help}>${label}</label>
    <select id=${`f${id}`} value=${value} title=${help}
      onChange=${(/** @type {any} */ event) => change(event.currentTarget.value)}>
      ${choices.map((choice) => {
        const [key, name] = Array.isArray(choice) ? choice : [choice, choice.replace(/_/g, ' ')];
        return html`<option key=${key} value=${key} selected=${key === value}>${name}</option>`;
      })}
    </select>
    ${problem && html`<p class="problem">${problem}</p>`}
  </div>`;
}

/** A text that is told when it is finished.
 * @param {{ label: string, value: string, change: (value: string) => void, long?: boolean,
 *   help?: string, problem?: string | null }} given */
export function TextField({ label, value, change, long, help, problem }) {
  const id = useId();
  const end = (/** @type {any} */ event) => {
    if (event.currentTarget.value !== value) change(event.currentTarget.value);
  };
  const key = (/** @type {any} */ event) => {
    const isDropped = isDrop(event) && isDraft(event.target);
    if (isDropped) event.preventDefault();
    else if (event.key !== 'Escape') return;
    event.currentTarget.value = value;
    forgetDraft();
  };
  const Tag = long ? 'textarea' : 'input';
  return html`<div class=${problem ? 'field text wrong' : 'field text'}>
    <label for=${`f${id}`} title=${help}>${label}</label>
    <${Tag} id=${`f${id}`} rows=${long ? 3 : undefined} value=${value} title=${DROP_HELP} onChange=${end} onKeyDown=${key} />
    ${problem && html`<p class="problem">${problem}</p>`}
  </div>`;
}

/** @param {{ label: string, value: boolean, change: (value: boolean) => void, help?: string,
 *   disabled?: boolean }} given */
export function Switch({ label, value, change, help, disabled }) {
  return html`<label class="switch" title=${help}>
    <input type="checkbox" checked=${value} disabled=${disabled}
      onChange=${(/** @type {any} */ event) => change(event.currentTarget.checked)} />
    <span>${label}</span>
  </label>`;
}
