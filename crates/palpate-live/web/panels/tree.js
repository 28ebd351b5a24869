// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * The tree of the scene's parts, with the keys of the ARIA pattern, and the buttons that change
 * what is selected.
 *
 * @typedef {import('./nodes.js').Part} Part
 */

import { html, useEffect, useRef, useState } from '../vendor/htm-preact.js';
import { select, state } from '../state.js';
import * as changes from './changes.js';
import { SEVERAL, listOf, partAt, partsOfScene } from './nodes.js';
import { useTopics } from './page.js';
import { valueAt } from './schema.js';

/** Members of a group that are listed at first; a thousand rows are slow. */
const MOST_ROWS = 200;

/** Rows in the order in which they are seen.
 * @param {Part[]} tree @param {Set<string>} open @param {number} most members of a group
 * @param {number} level
 * @returns {{ part: Part, level: number, isOpen: boolean, count: number, place: number }[]} */
function rowsOf(tree, open, most, level = 1) {
  return tree.slice(0, most).flatMap((part, index) => {
    const isOpen = open.has(part.pointer) && part.children.length > 0;
    const row = { part, level, isOpen, count: tree.length, place: index + 1 };
    return [row, ...(isOpen ? rowsOf(part.children, open, most, level + 1) : [])];
  });
}

/** Pointers of what holds a part. @param {string} pointer */
function holders(pointer) {
  const keys = pointer.split('/').slice(1);
  return keys.map((_, index) => `/${keys.slice(0, index).join('/')}`);
}

export function Tree() {
  useTopics(['scene', 'selection']);
  const [open, setOpen] = useState(() => new Set(['/bodies', '/bodies/0', '/bodies/0/shape']));
  const [most, setMost] = useState(MOST_ROWS);
  const list = useRef(/** @type {HTMLElement | null} */ (null));
  const tree = partsOfScene();
  const selected = state.selection === null ? null : partAt(tree, state.selection);
  useEffect(() => {
    if (state.selection) setOpen((now) => new Set([...now, ...holders(state.selection ?? '')]));
  }, [state.selection]);
  useEffect(() => {
    list.current?.querySelector('[aria-selected=true]')?.scrollIntoView({ block: 'nearest' });
  }, [selected?.pointer]);
  // A row that is removed takes the focus with it.
  const isLosingFocus = useRef(false);
  useEffect(() => {
    if (!isLosingFocus.current || document.activeElement !== document.body) return;
    isLosingFocus.current = false;
    /** @type {HTMLElement | null} */ (list.current?.querySelector('[tabindex="0"]'))?.focus();
  });
  if (!state.scene) return html`<div class="panel-head"><h2>Shapes</h2></div>`;

  const rows = rowsOf(tree, open, most);
  const at = rows.findIndex(({ part }) => part.pointer === selected?.pointer);
  const focusAt = (/** @type {number} */ index) => {
    const row = rows[Math.max(0, Math.min(index, rows.length - 1))];
    if (!row) return;
    select(row.part.pointer);
    requestAnimationFrame(() =>
      /** @type {HTMLElement | null} */ (list.current?.querySelector('[tabindex="0"]'))?.focus());
  };
  const setIsOpen = (/** @type {string} */ pointer, /** @type {boolean} */ isOpen) => setOpen((now) => {
    const next = new Set(now);
    if (isOpen) next.add(pointer);
    else next.delete(pointer);
    return next;
  });
  const key = (/** @type {KeyboardEvent} */ event) => {
    const row = rows[Math.max(at, 0)];
    if (!row || event.ctrlKey || event.altKey) return;
    const { part, level, isOpen } = row;
    const parent = rows.slice(0, at).map((one) => one.level < level).lastIndexOf(true);
    /** @type {Record<string, () => void>} */
    const does = {
      ArrowDown: () => focusAt(at + 1),
      ArrowUp: () => focusAt(at - 1),
      ArrowRight: () => (isOpen ? focusAt(at + 1) : setIsOpen(part.pointer, true)),
      ArrowLeft: () => (isOpen ? setIsOpen(part.pointer, false) : parent >= 0 && focusAt(parent)),
      Home: () => focusAt(0),
      End: () => focusAt(rows.length - 1),
      Delete: () => {
        if (!changes.canRemove(part.pointer)) return;
        isLosingFocus.current = true;
        changes.remove(part.pointer);
      },
    };
    if (event.key === 'Enter' || event.key === ' ') select(part.pointer);
    else if (does[event.key]) does[event.key]();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };

  return html`
    <div class="panel-head"><h2>Shapes</h2>
      <${AddMenu} selected=${selected} />
    </div>
    <ul class="tree" role="tree" aria-label="Parts of the scene" ref=${list} onKeyDown=${key}>
      ${rows.map(({ part, level, isOpen, count, place }, index) => {
        const isSelected = index === at;
        return html`<li key=${part.pointer} role="treeitem" class=${`tree-row ${part.kind}`}
          aria-level=${level} aria-setsize=${count} aria-posinset=${place}
          aria-selected=${isSelected ? 'true' : 'false'}
          aria-expanded=${part.children.length > 0 ? String(isOpen) : undefined}
          tabindex=${isSelected || (at < 0 && index === 0) ? 0 : -1}
          style=${{ paddingLeft: `${level * 12 - 6}px` }}
          onClick=${() => select(part.pointer)}
          onDblClick=${() => setIsOpen(part.pointer, !isOpen)}>
          <span class=${part.children.length === 0 ? 'caret none' : isOpen ? 'caret open' : 'caret'} aria-hidden="true"
            onClick=${(/** @type {Event} */ event) => {
              event.stopPropagation();
              setIsOpen(part.pointer, !isOpen);
            }}></span>
          <span class="name">${part.label}</span>
          <span class="detail">${part.detail}</span>
        </li>`;
      })}
    </ul>
    ${rows.some(({ count }) => count > most) && html`<p class="quiet">The first ${most} of a group are listed.
      <button class="small" onClick=${() => setMost(Infinity)}>list all</button></p>`}
    ${selected && html`<${Buttons} part=${selected} />`}`;
}

/** A menu that adds a primitive to what is selected, or another part to the scene.
 * @param {{ selected: Part | null }} given */
function AddMenu({ selected }) {
  const into = selected?.kind === 'shape' && listOf(valueAt(selected.inner)) ? selected.inner : null;
  const take = (/** @type {any} */ event) => {
    const [kind, name] = event.currentTarget.value.split(':');
    event.currentTarget.value = '';
    if (kind === 'primitive') changes.add(into, name);
    else if (kind) changes.addOther(name);
  };
  return html`<select class="small" aria-label="Add to the scene" value="" onChange=${take}>
    <option value="">add…</option>
    <optgroup label=${into ? 'Into the operator that is selected' : 'As a body'}>
      ${changes.primitives().map(({ name }) => html`<option key=${name} value=${`primitive:${name}`}>
        ${name.replace(/_/g, ' ')}</option>`)}
    </optgroup>
    <optgroup label="Other parts">
      ${['named shape', 'tool', 'guide', 'motion', 'view'].map((name) =>
        html`<option key=${name} value=${`other:${name}`} disabled=${name === 'tool' && valueAt('/tool') !== undefined}>
          ${name}</option>`)}
    </optgroup>
  </select>`;
}

/** What can be done with a part. @param {{ part: Part }} given */
function Buttons({ part }) {
  const { pointer, inner } = part;
  const operator = part.kind === 'shape' ? listOf(valueAt(inner)) : null;
  const place = changes.placeOf(pointer);
  const takeName = (/** @type {any} */ event) => {
    const value = event.currentTarget.value;
    event.currentTarget.value = '';
    if (value) changes.wrap(pointer, value);
  };
  return html`<div class="buttons" role="group" aria-label=${`Change ${part.label}`}>
    ${operator && html`<select class="small" aria-label="Operator" value=${operator}
      onChange=${(/** @type {any} */ event) => changes.switchOperator(inner, event.currentTarget.value)}>
      ${Object.keys(SEVERAL).map((name) => html`<option key=${name} value=${name}
        selected=${name === operator}>${name.replace(/_/g, ' ')}</option>`)}
    </select>`}
    ${part.kind === 'shape' && html`<select class="small" aria-label="Wrap in an operator" value="" onChange=${takeName}>
      <option value="">wrap in…</option>
      ${changes.wrappers().map((name) => html`<option key=${name} value=${name}>
        ${name.replace(/_degrees$/, '').replace(/_/g, ' ')}</option>`)}
    </select>`}
    ${part.kind === 'shape' && changes.canUnwrap(pointer) && html`<button class="small"
      title="Take the operator away; of several shapes the first stays"
      onClick=${() => changes.unwrap(pointer)}>unwrap</button>`}
    ${place && html`<button class="small" onClick=${() => changes.duplicate(pointer)}>copy</button>`}
    ${place && html`<button class="small" aria-label="Move up" title="Move up"
      disabled=${place.index === 0} onClick=${() => changes.move(pointer, -1)}>↑</button>`}
    ${place && html`<button class="small" aria-label="Move down" title="Move down"
      disabled=${place.index === place.list.length - 1} onClick=${() => changes.move(pointer, 1)}>↓</button>`}
    ${pointer === '/tool' && valueAt(pointer) === undefined && html`<button class="small"
      onClick=${() => changes.addOther('tool')}>add</button>`}
    ${changes.canRemove(pointer) ? html`<button class="small" onClick=${() => changes.remove(pointer)}
        title=${changes.operatorLeftAlone(pointer) ? 'The operator goes too: the other shape takes its place' : 'Del'}>remove</button>`
      : part.kind === 'body' && html`<button class="small" disabled title="A scene keeps one body">remove</button>`}
  </div>`;
}
