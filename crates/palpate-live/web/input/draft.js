// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** What was typed into a field and not entered yet. */

/** Fields that are typed into. */
export const TYPED = 'input:not([type=checkbox], [type=range], [type=file]), textarea';

/** What the hint of a field says of keys. */
export const DROP_HELP = 'Ctrl Z drops what was typed; so does Esc, which stops all forces too';

/** The field with what was typed and not entered yet. @type {EventTarget | null} */
let draft = null;

/** Takes note of what is typed, until it is entered. */
export function watchDraft() {
  addEventListener('input', ({ target }) => {
    draft = target instanceof Element && target.matches(TYPED) ? target : null;
  });
  addEventListener('focusout', forgetDraft);
  addEventListener('keydown', ({ key, target }) => {
    if (key === 'Enter' && target instanceof HTMLInputElement) draft = null;
  });
}

/** Whether a field holds what was typed and not entered yet. @param {EventTarget | null} field */
export const isDraft = (field) => field !== null && field === draft;

/** What was typed is entered or dropped. */
export function forgetDraft() {
  draft = null;
}

/** Whether a key drops what was typed, and nothing else. @param {KeyboardEvent} event */
export function isDrop({ key, ctrlKey, metaKey, shiftKey, altKey }) {
  return (ctrlKey || metaKey) && !shiftKey && !altKey && key.toLowerCase() === 'z';
}
