// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** Edits that are not saved, when another scene is to take their place: a person decides. */

import { state } from '../state.js';
import { html, useState } from '../vendor/htm-preact.js';
import { Dialog, closeDialog, openDialog } from './dialog.js';
import { settled } from './edits.js';
import { reasonOf, useTopics } from './page.js';
import { baseName, saveAs, write } from './saving.js';

/** Puts another scene in this one's place: at once, or if this one has edits that are not saved,
 * when a person has saved or discarded them.
 * @param {string} next the name of the other scene @param {() => Promise<void>} replace */
export async function replaceScene(next, replace) {
  await settled();
  if (!state.scene || state.scene.is_saved) await replace();
  else openDialog(() => html`<${Unsaved} next=${next} replace=${replace} />`);
}

/** @param {{ next: string, replace: () => Promise<void> }} given */
function Unsaved({ next, replace }) {
  useTopics(['scene']);
  const [refused, setRefused] = useState('');
  const { name, file } = state.scene ?? { name: '', file: null };
  const open = () => {
    closeDialog();
    void replace();
  };
  const save = async (/** @type {boolean} */ force) => {
    try {
      await write({ force });
      open();
    } catch (error) {
      setRefused(reasonOf(error));
    }
  };
  const saveOther = () => saveAs(() => void replace());
  return html`<${Dialog} title="The scene is not saved">
    <div class="save-as">
      <p>${baseName(file ?? name)} has edits that are not saved. ${next} would take its place, and undo does not
        bring the edits back.</p>
      ${refused && html`<p class="problem" role="alert">${refused}</p>`}
      <div class="buttons">
        <button autofocus onClick=${file === null ? saveOther : () => void save(false)}>${
          file === null ? 'Save as…, then open' : 'Save, then open'}</button>
        ${refused && html`<button onClick=${() => void save(true)}>Save all the same</button>
          <button onClick=${saveOther}>Save as…</button>`}
        <button onClick=${open}>Discard the edits</button>
        <button onClick=${closeDialog}>Cancel</button>
      </div>
    </div>
  <//>`;
}
