// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The field at a point that is typed: what the probe under the pointer tells, without a pointer. */

import { boxOf } from '../scene/setting.js';
import { state } from '../state.js';
import { html, useEffect, useState } from '../vendor/htm-preact.js';
import { Switch, VectorField } from './fields.js';
import { extent, short } from './numbers.js';
import { page, reasonOf, useTopics } from './page.js';

/** @param {number[]} vector */
const inWords = (vector) => `(${vector.slice(0, state.scene?.dimension).map((part) => short(part, 4)).join(', ')})`;

export function Point() {
  useTopics(['scene']);
  const [isOut, setIsOut] = useState(false);
  return html`<div class="check">
    <${Switch} label="Point" help="The field at a point" value=${isOut} change=${setIsOut} />
    ${isOut && html`<${Asked} key=${state.scene?.dimension} />`}
  </div>`;
}

function Asked() {
  const { scene } = state;
  const box = boxOf(scene?.bounds);
  const [at, setAt] = useState(() => Array.from({ length: scene?.dimension ?? 3 }, (_, axis) => box?.high[axis] ?? 0));
  const [answer, setAnswer] = useState(/** @type {any} */ (null));
  const [refused, setRefused] = useState('');
  useEffect(() => {
    let isOld = false;
    page.wire?.ask({ do: 'ask', question: { question: 'point', at } }).then((told) => {
      if (isOld) return;
      setAnswer(told.answer);
      setRefused('');
    }, (error) => !isOld && setRefused(reasonOf(error)));
    return () => {
      isOld = true;
    };
  }, [at.join(' '), scene?.revision]);
  const rows = answer ? [
    ['distance', `${short(answer.distance, 5)} m`], ['gradient', inWords(answer.gradient)],
    ['nearest surface', answer.surface ? `${inWords(answer.surface)} m` : '–'], ['no surface within', `${short(answer.safe_radius, 4)} m`],
    ['body', answer.body ?? '–'], ['promise', answer.promise],
  ] : [];
  return html`<${VectorField} label="point" unit="m" own value=${at} scale=${extent(scene?.bounds)} change=${setAt} />
    ${refused && html`<p class="problem">${refused}</p>`}
    <div class="verdict" role="status" aria-label="The field at the point"><table><tbody>
      ${rows.map(([key, text]) => html`<tr key=${key}><th scope="row">${key}</th><td>${text}</td></tr>`)}
    </tbody></table></div>`;
}
