// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The falling ball: where it begins, how it bounces, and how its fall is played. */

import {
  fall, lasts, listenFall, moment, playFall, setFall, showMoment, slowing,
} from '../plane/fall.js';
import { state } from '../state.js';
import { html, useEffect, useReducer } from '../vendor/htm-preact.js';
import { NumberField, Switch, VectorField } from './fields.js';
import { count, extent, servoTime, short, time } from './numbers.js';
import { page, useTopics } from './page.js';

/** Between two updates [ms]. */
const INTERVAL = 80;

/** How a fall ends, in words. @type {Record<string, string>} */
const ENDS = {
  rests: 'comes to rest',
  leaves: 'leaves the scene',
  time: 'still moves, and longer ways are not computed',
  inside: 'begins inside a body, so it does not fall',
  budget: 'is left on its way: the proof used up its evaluations',
};

/** Draws anew when the ball changes, at most every `INTERVAL`. */
function useFall() {
  const [, redraw] = useReducer((/** @type {number} */ times) => times + 1, 0);
  useEffect(() => {
    let timer = 0;
    const stop = listenFall(() => {
      timer ||= setTimeout(() => {
        timer = 0;
        redraw(undefined);
      }, INTERVAL);
    });
    return () => {
      stop();
      clearTimeout(timer);
    };
  }, []);
}

/** How fast the fall is played, in words. */
function pace() {
  const factor = slowing();
  if (factor === 1) return 'in real time';
  return factor > 1 ? `slowed ${short(factor)}×` : `sped up ${short(1 / factor)}×`;
}

/** What became of the fall, in words. */
function outcome() {
  const { answer } = fall;
  if (!answer) return '';
  const { bounces, end } = answer;
  const times = `${count(bounces.length)} ${bounces.length === 1 ? 'bounce' : 'bounces'}`;
  const words = ENDS[end] ?? end;
  if (end === 'inside') return `The ball ${words}.`;
  const fastest = Math.max(...bounces.map(({ speed }) => speed));
  const speed = bounces.length > 0 ? `, at most ${short(fastest)} m/s` : '';
  const first = bounces.length > 0 ? `, the first after ${time(bounces[0].time)}` : '';
  return `After ${time(lasts())} the ball ${words}: ${times}${first}${speed}.`;
}

/** Each bounce with its time and its speed. @param {{ bounces: import('../plane/fall.js').Fall['bounces'] }} given */
function Bounces({ bounces }) {
  if (bounces.length === 0) return null;
  return html`<div class="bounces" tabindex="0" role="region" aria-label="Bounces"><table>
    <thead><tr><th scope="col">bounce</th><th scope="col">time <span class="unit">[s]</span></th>
      <th scope="col">speed <span class="unit">[m/s]</span></th></tr></thead>
    <tbody>${bounces.map((bounce, index) => html`<tr key=${index}><th scope="row">${index + 1}</th>
      <td>${bounce.time.toFixed(6)}</td><td>${short(bounce.speed)}</td></tr>`)}</tbody>
  </table></div>`;
}

export function FallingBall() {
  useTopics(['scene']);
  useFall();
  const scale = extent(state.scene?.bounds);
  const { isShown, centre, radius, restitution, gravity, answer, refused, isPlacedByClick } = fall;
  const last = lasts();
  return html`<div class="profile fall" role="region" aria-label="Falling ball" tabindex="0">
    <div class="form">
      <div class="switches">
        <${Switch} label="falling ball" value=${isShown} help="A ball that falls onto the scene; each touch is proven to be the first"
          change=${(/** @type {boolean} */ is) => {
            setFall({ isShown: is });
            if (is) page.stage?.showBall();
          }} />
        <${Switch} label="a click places it" value=${isPlacedByClick} disabled=${!isShown}
          help="In space, above the point that is clicked; drag the ball to move it"
          change=${(/** @type {boolean} */ is) => setFall({ isPlacedByClick: is })} />
        <button class="small" disabled=${!isShown} title="Above what is in the middle of the picture"
          onClick=${() => page.stage?.placeBall()}>place it above the middle</button>
      </div>
      ${isShown && html`<${VectorField} label="it begins at" unit="m" value=${centre} scale=${scale}
          change=${(/** @type {number[]} */ to) => setFall({ centre: to })} />
        <${NumberField} label="radius" unit="m" value=${radius} min=${0} above slider=${false} scale=${scale / 10}
          change=${(/** @type {number} */ to) => setFall({ radius: to })} />
        <${NumberField} label="restitution" value=${restitution} min=${0} max=${1} slider=${false}
          help="The part of the speed that a bounce gives back"
          change=${(/** @type {number} */ to) => setFall({ restitution: to })} />
        <${NumberField} label="gravity" unit="m/s²" value=${gravity} min=${0} above slider=${false} scale=${9.81}
          change=${(/** @type {number} */ to) => setFall({ gravity: to })} />`}
    </div>
    ${isShown && html`<div class="form">
      ${refused && html`<p class="problem">${refused}</p>`}
      ${answer && html`<div class="switches">
          <button class="small" onClick=${playFall} disabled=${last === 0}>play again</button>
          <input type="range" class="slider scrub" min="0" max=${last} step=${answer.step} value=${moment()}
            disabled=${last === 0} aria-label="Moment of the fall" aria-valuetext=${servoTime(moment())}
            onInput=${(/** @type {any} */ event) => showMoment(Number(event.currentTarget.value))} />
          <span class="unit time-shown">${servoTime(moment())}</span>
          <span class="quiet">${pace()}</span>
        </div>
        <div class=${`verdict ${answer.end === 'budget' ? 'wrong' : 'right'}`} role="status" aria-label="Outcome of the fall">
          <b>${outcome()}</b>
          <table><tbody>
            <tr><th scope="row">evaluations</th><td>${count(answer.evaluations)}</td></tr>
            <tr><th scope="row">computed in</th><td>${time(answer.time)}</td></tr>
          </tbody></table>
        </div>`}
    </div>
    ${answer && html`<${Bounces} bounces=${answer.bounces} />`}`}
  </div>`;
}
