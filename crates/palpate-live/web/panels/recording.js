// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** Recording every tick, replaying it, and traces as files. */

import { changed } from '../state.js';
import { count } from './numbers.js';
import { ask, dismiss, download, fileName, page, tell, tellError } from './page.js';

/** More bytes than the header and one row have. */
const LONGEST_LINES = 4096;

/** What the program told of the newest recording. @type {{ isOn: boolean, rows: number, most: number } | null} */
let told = null;
let isRecording = false;
let isReplaying = false;
/** The message that offers what was recorded. */
let offer = 0;

/** How much was recorded, or is so far: "12 300 of at most 200 000 rows"; empty while nobody knows. */
export function recorded() {
  return told?.rows ? `${count(told.rows)} of at most ${count(told.most)} rows` : '';
}

/** Takes what the program tells of its recording.
 * @param {import('../wire.js').Message} message */
export function takeRecording({ is_on: isOn, rows, most }) {
  if (told?.isOn && !isOn) {
    offer = tell(`Recorded ${count(rows)} rows.`, 'word', [
      { name: 'Replay', run: () => void replay(true) }, { name: 'Export CSV', run: () => void downloadTrace() },
    ]);
  }
  if (isOn) dismiss(offer);
  told = { isOn, rows, most };
  changed('playback');
}

/** Takes note of what frames say of recording and replaying. @param {import('../wire.js').Frame} frame */
export function watchRecording(frame) {
  if (isReplaying && !frame.replaying) tell('The replay is over.');
  if (frame.replaying) dismiss(offer);
  if (isReplaying !== frame.replaying) changed('playback');
  isRecording = frame.recording;
  isReplaying = frame.replaying;
}

/** Begins to record, or ends it. */
export function record() {
  page.wire?.send({ do: 'record', on: !isRecording });
}

/** Leads the hand along what was recorded, or ends it. @param {boolean} on */
export function replay(on) {
  return ask({ do: 'replay', on });
}

/** Asks for the trace, or gives one. @param {RequestInit} [request] */
const answerTo = (request) => fetch(`trace.csv?token=${encodeURIComponent(page.token)}`, request).catch(() => {
  throw new Error('The program is not connected.');
});

/** Gives what was recorded as a CSV file. */
export async function downloadTrace() {
  try {
    const answer = await answerTo();
    if (!answer.ok) throw new Error(await reason(answer, 'the program gives no trace'));
    const trace = await answer.blob();
    // A trace begins with the names of its columns.
    const [, row] = (await trace.slice(0, LONGEST_LINES).text()).split('\n');
    if (row) download(trace, fileName('.trace.csv'));
    else tell('There is no recording yet: press record first.', 'bad');
  } catch (error) {
    tellError(error);
  }
}

/** Gives a trace to the program, to be replayed. @param {File} file */
export async function openTrace(file) {
  const answer = await answerTo({ method: 'POST', body: file, headers: { 'Content-Type': 'text/csv' } });
  if (!answer.ok) throw new Error(`${file.name}: ${await reason(answer, 'the program does not take it')}`);
  dismiss(offer);
  offer = tell(`${file.name} is ready to be replayed.`, 'word', [{ name: 'Replay', run: () => void replay(true) }]);
}

/** Why the program did not do it. @param {Response} answer @param {string} otherwise */
async function reason(answer, otherwise) {
  if (answer.status === 503) return 'The program is busy: try again.';
  if (answer.status === 413) return 'it is larger than 64 MiB';
  return (await answer.text()).trim() || otherwise;
}
