// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/**
 * What is felt, as sound: the force as a low tone that opens with it, a rustle while slipping,
 * and a tap for each event. Only what works without a secure context.
 */

import { listen, setTouch, state } from '../state.js';
import { level } from './gamepad.js';

/** The tone of the least and the greatest force, and up to where its filter is open [Hz]. */
const TONE = { least: 70, greatest: 190 };
const OPEN = { least: 120, greatest: 1520 };
/** The middle of the rustle [Hz]. */
const RUSTLE = 900;
/** How loud tone and rustle are at the greatest force. */
const LOUD = { tone: 0.5, rustle: 0.25 };
/** How fast tone and loudness follow [s]. */
const FOLLOW = 0.03;
/** A tap: its length [s], the tone that it falls from and to [Hz], how loud it is at the least and the
 * greatest force, and when it is over. */
const TAP = { length: 0.06, from: 320, to: 110, least: 0.3, greatest: 0.8, silent: 0.001 };

/** @param {{ least: number, greatest: number }} range @param {number} part from 0 to 1 */
const within = ({ least, greatest }, part) => least + (greatest - least) * part;

/** @type {{ context: AudioContext, out: GainNode, tone: OscillatorNode, filter: BiquadFilterNode,
 *   force: GainNode, rustle: GainNode } | null} */
let sound = null;

/** @param {AudioContext} context @param {number} seconds */
function noise(context, seconds) {
  const buffer = context.createBuffer(1, seconds * context.sampleRate, context.sampleRate);
  const samples = buffer.getChannelData(0);
  for (let at = 0; at < samples.length; at += 1) samples[at] = 2 * Math.random() - 1;
  return buffer;
}

function build() {
  const context = new AudioContext();
  const out = context.createGain();
  out.gain.value = state.touch.volume;
  const limit = context.createDynamicsCompressor();
  out.connect(limit).connect(context.destination);

  const tone = context.createOscillator();
  tone.type = 'sawtooth';
  const filter = context.createBiquadFilter();
  filter.type = 'lowpass';
  const force = context.createGain();
  force.gain.value = 0;
  tone.connect(filter).connect(force).connect(out);
  tone.start();

  const source = context.createBufferSource();
  source.buffer = noise(context, 1);
  source.loop = true;
  const rustle = context.createGain();
  rustle.gain.value = 0;
  const band = context.createBiquadFilter();
  band.type = 'bandpass';
  band.frequency.value = RUSTLE;
  source.connect(band).connect(rustle).connect(out);
  source.start();
  return { context, out, tone, filter, force, rustle };
}

function follow() {
  if (!sound || !state.touch.sound) return;
  const now = sound.context.currentTime;
  const strength = state.frame?.stopped || state.lookingAt !== null ? 0 : Math.sqrt(level());
  const isSlipping = state.frame?.points.some((point) => point.slipping) ?? false;
  sound.tone.frequency.setTargetAtTime(within(TONE, strength), now, FOLLOW);
  sound.filter.frequency.setTargetAtTime(within(OPEN, strength), now, FOLLOW);
  sound.force.gain.setTargetAtTime(LOUD.tone * strength, now, FOLLOW);
  sound.rustle.gain.setTargetAtTime(isSlipping ? LOUD.rustle * strength : 0, now, FOLLOW);
}

function tap() {
  if (!sound || !state.touch.sound) return;
  const { context, out } = sound;
  const now = context.currentTime;
  const end = now + TAP.length;
  const body = context.createOscillator();
  const fade = context.createGain();
  body.frequency.setValueAtTime(TAP.from, now);
  body.frequency.exponentialRampToValueAtTime(TAP.to, end);
  fade.gain.setValueAtTime(within(TAP, level()), now);
  fade.gain.exponentialRampToValueAtTime(TAP.silent, end);
  body.connect(fade).connect(out);
  body.start(now);
  body.stop(end);
}

/** Turns sound on or off. To be called where a person presses a button, and nowhere else: browsers
 * let a page sound after that alone. @param {boolean} on */
export function setSound(on) {
  setTouch({ sound: on });
  if (on && !sound) {
    sound = build();
    let heard = state.events[state.events.length - 1]?.number ?? 0;
    listen(['frame', 'heard', 'connection'], follow);
    listen(['events'], () => {
      const fresh = state.events.filter((event) => event.number > heard);
      heard = fresh[fresh.length - 1]?.number ?? heard;
      if (fresh.some((event) => /touch|pop|stick/i.test(event.kind))) tap();
    });
  }
  if (on) void sound?.context.resume();
  else void sound?.context.suspend();
}

/** @param {number} volume from 0 to 1 */
export function setVolume(volume) {
  setTouch({ volume });
  sound?.out.gain.setTargetAtTime(volume, sound.context.currentTime, FOLLOW);
}
