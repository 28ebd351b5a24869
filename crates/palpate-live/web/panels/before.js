// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * Scenes whose place another took, so that a person gets back to them: first of all that with which
 * the program was started.
 *
 * @typedef {import('../wire.js').Message} Message
 * @typedef {{ name: string, file: string | null, text: string, isEdited: boolean }} Before
 */

import { state } from '../state.js';
import { GALLERY } from './gallery.js';
import { baseName } from './saving.js';

/** Scenes that are kept, beside the first. */
const MOST = 4;

/** The first scene, and then the others, newest last. @type {Before[]} */
let kept = [];

/** Keeps a scene whose place another takes. @param {Message | null} before @param {Message} scene */
export function keepBefore(before, scene) {
  if (!before || scene.by !== 'open' || scene.text === before.text) return;
  const { file, text, is_saved: isSaved } = before;
  const name = baseName(file ?? before.name);
  if (isSaved && GALLERY.some(([made]) => made === name)) return;
  const one = { name, file, text, isEdited: !isSaved };
  const at = kept.findIndex((other) => other.name === name && other.file === file);
  if (at >= 0) kept[at] = one;
  else kept = [...kept.slice(0, 1), ...kept.slice(1).slice(1 - MOST), one];
}

/** The scenes that were open before, without that which is open now. */
export const openedBefore = () => kept.filter(({ text }) => text !== state.scene?.text);
