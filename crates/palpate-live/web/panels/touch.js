// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** How the scene is touched, and what is felt. */

import { html, useEffect, useState } from '../vendor/htm-preact.js';
import { setSound, setVolume } from '../input/audio.js';
import { firstPad } from '../input/gamepad.js';
import { isSteering, letGo } from '../input/steer.js';
import { pullInWords } from '../scene/guides.js';
import { setTouch, state } from '../state.js';
import { ChoiceField, Switch } from './fields.js';
import { page, useTopics } from './page.js';
import { withheldInWords } from './safety.js';

/** Between two updates of the numbers [ms]: faster ones cannot be read. */
const INTERVAL = 100;
/** The longest until a hand that was let go is on its tour, after a rest of 2 s [ms]. */
const UNTIL_TOUR = 4000;
/** Bodies that are named; the others are counted. */
const NAMED = 2;

export function Touch() {
  useTopics(['touch', 'scene']);
  const { touch } = state;
  const points = state.scene?.device?.points ?? 1;
  return html`
    <div class="panel-head"><h2>Touch</h2><${TourSwitch} /></div>
    <div class="scroll" tabindex="0" role="region" aria-label="Touch settings">
    <${Readout} />
    <${ChoiceField} label="led by" value=${touch.input}
      choices=${[['pointer', 'mouse, touch, pen'], ['gamepad', padName()], ['keys', 'arrow keys']]}
      change=${(/** @type {typeof touch.input} */ input) => {
        letGo();
        setTouch({ input });
      }} />
    ${points > 1 && html`<${ChoiceField} label="point" value=${String(touch.point ?? 'all')}
      choices=${[['all', 'the middle of all'], ...Array.from({ length: points }, (_, at) => [String(at), `point ${at + 1}`])]}
      change=${(/** @type {string} */ to) => setTouch({ point: to === 'all' ? null : Number(to) })} />`}
    <div class="switches">
      <${Switch} label="rumble" help="The gamepad shakes with the force" value=${touch.rumble}
        change=${(/** @type {boolean} */ rumble) => setTouch({ rumble })} />
      <${Switch} label="vibration" help="The telephone or tablet shakes at events"
        value=${touch.vibration && 'vibrate' in navigator} disabled=${!('vibrate' in navigator)}
        change=${(/** @type {boolean} */ vibration) => setTouch({ vibration })} />
      <button class="small" aria-pressed=${String(touch.sound)} onClick=${() => setSound(!touch.sound)}>
        sound ${touch.sound ? 'on' : 'off'}</button>
      ${touch.sound && html`<input type="range" class="slider" min="0" max="1" step="0.05" value=${touch.volume}
        aria-label="Volume" onInput=${(/** @type {any} */ event) => setVolume(Number(event.currentTarget.value))} />`}
    </div>
    </div>`;
}

function padName() {
  const pad = firstPad();
  return pad ? `gamepad: ${pad.id.replace(/\s*\(.*/, '')}` : 'gamepad: none yet';
}

/** The switch of the tour, and a button that lets go of a hand that keys or a gamepad hold. */
function TourSwitch() {
  useTopics(['newest'], INTERVAL);
  const isTouring = state.newest?.touring ?? false;
  // What the tour was switched to last, until frames say so too.
  const [asked, setAsked] = useState(/** @type {{ on: boolean, until: number } | null} */ (null));
  useEffect(() => {
    if (asked?.on === isTouring) setAsked(null);
  }, [asked, isTouring]);
  const isOn = asked && performance.now() < asked.until ? asked.on : isTouring;
  return html`<span class="gap"></span>
    ${isSteering() && html`<button class="small" onClick=${letGo} title="Let go of the hand: L">let go</button>`}
    <${Switch} label="tour" value=${isOn} help="A hand that nobody leads goes along the bodies"
      change=${(/** @type {boolean} */ on) => {
        letGo();
        setAsked({ on, until: performance.now() + UNTIL_TOUR });
        page.wire?.send({ do: 'tour', on });
      }} />`;
}

/** Force, depth and body in large numbers. */
function Readout() {
  useTopics(['frame', 'scene', 'connection', 'heard'], INTERVAL);
  const { scene } = state;
  // What was felt last is no longer felt.
  const frame = state.connection === 'live' ? state.frame : null;
  const touched = frame?.points.filter((point) => point.contact) ?? [];
  const names = [...new Set(touched.map((point) => scene?.bodies?.[point.body]?.name ?? `body ${point.body}`))];
  const others = names.length > NAMED ? ` and ${names.length - NAMED} more` : '';
  const lifted = frame?.lifted ? ' while the hand is lifted to another place' : '';
  const isSlipping = touched.some((point) => point.slipping);
  const withheld = withheldInWords(frame);
  const pull = frame?.points.map(pullInWords).find(Boolean) ?? '';
  const age = state.unheard === null ? '' : ', last heard';
  return html`<dl class="readout">
    <div title="The largest of all contact points"><dt>force${age}</dt><dd><span class="large">${(frame?.force ?? 0).toFixed(2)}</span> N</dd></div>
    <div title="The largest of all contact points"><dt>depth${age}</dt><dd><span class="large">${(1000 * (frame?.depth ?? 0)).toFixed(2)}</span> mm</dd></div>
    <div class="touched" title=${lifted ? 'It passes through bodies, and feels them again where it is set down' : names.join(', ')}><dt>touches${age}</dt>
      <dd>${names.length > 0 ? `${names.slice(0, NAMED).join(', ')}${others}${isSlipping ? ', slipping' : ''}` : `nothing${lifted}`}${pull && `, ${pull}`}${withheld && `: ${withheld}`}</dd></div>
  </dl>`;
}
