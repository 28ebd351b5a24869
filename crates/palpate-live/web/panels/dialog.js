// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** A window over the page, of which there is one at a time. */

import { html, render, useEffect, useRef } from '../vendor/htm-preact.js';
import { StopButton } from './stop.js';

/** @returns {HTMLElement} */
const overlay = () => /** @type {HTMLElement} */ (document.getElementById('overlay'));

export function closeDialog() {
  render(null, overlay());
}

/** Shows a component in the window's place. @param {any} Content given nothing */
export function openDialog(Content) {
  closeDialog();
  render(html`<${Content} />`, overlay());
}

export function isDialogOpen() {
  return overlay().childElementCount > 0;
}

/** The window itself: Esc, its button and a press beside it close it. One that is only read has the focus
 * itself, so that STOP is the next.
 * @param {{ title: string, isRead?: boolean, children?: any }} given */
export function Dialog({ title, isRead = false, children }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  useEffect(() => {
    dialog.current?.showModal();
  }, []);
  return html`<dialog class="dialog" ref=${dialog} autofocus=${isRead} tabindex=${isRead ? -1 : undefined} aria-labelledby="dialog-title" onClose=${closeDialog}
    onClick=${(/** @type {any} */ event) => event.target === dialog.current && dialog.current?.close()}>
    <${StopButton} />
    <div class="dialog-body">
      <div class="panel-head"><h2 id="dialog-title">${title}</h2><span class="gap"></span>
        <button type="button" onClick=${() => dialog.current?.close()}>close</button></div>
      ${children}
    </div>
  </dialog>`;
}
