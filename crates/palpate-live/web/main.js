// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** Puts the page together: the token, the socket, the panels, the picture, and the keys. */

import { countAnew, hear, startHearing } from './heard.js';
import { startGamepad } from './input/gamepad.js';
import { listenKeys } from './input/keys.js';
import { nextKind } from './input/placing.js';
import { letGo, startSteering } from './input/steer.js';
import * as actions from './panels/actions.js';
import { keepBefore } from './panels/before.js';
import { Checks } from './panels/checks.js';
import { closeDialog, isDialogOpen, openDialog } from './panels/dialog.js';
import { takeScene } from './panels/edits.js';
import { Status, takeEvents } from './panels/events.js';
import { watchFar } from './panels/far.js';
import { Header, startTheme } from './panels/header.js';
import { Help } from './panels/help.js';
import { followLink, takeAddress } from './panels/link.js';
import { dismiss, page, tell } from './panels/page.js';
import { valueAt } from './panels/schema.js';
import { Time } from './panels/play.js';
import { startProfile } from './panels/profile.js';
import { takeRecording, watchRecording } from './panels/recording.js';
import { takeSafety, watchSafety } from './panels/safety.js';
import { baseName, save, saveAs } from './panels/saving.js';
import { Selected } from './panels/selected.js';
import { Release } from './panels/release.js';
import { StopButton } from './panels/stop.js';
import { FORCES_COME_BACK, forgetStopped, release, sendAgain, startStopping, stop, takeReleased, takeStopped } from './panels/stopping.js';
import { Tabs } from './panels/tabs.js';
import { Toasts, Words } from './panels/toasts.js';
import { Touch } from './panels/touch.js';
import { Tree } from './panels/tree.js';
import { LegendButton, ViewBar } from './panels/view.js';
import { createStage } from './scene/stage.js';
import { changed, listen, lookAt, select, setTouch, setView, state, takeFrame } from './state.js';
import { html, render } from './vendor/htm-preact.js';
import { Wire } from './wire.js';

/** @param {string} id @returns {HTMLElement} */
function place(id) {
  return /** @type {HTMLElement} */ (document.getElementById(id));
}

/** @param {import('./wire.js').Message} message */
function takeMessage(message) {
  if (message.do === 'welcome') {
    state.welcome = message;
    changed('welcome');
  }
  if (message.do === 'scene') {
    keepBefore(state.scene, message);
    takeScene(message);
  }
  if (message.do === 'events') takeEvents(message.events);
  if (message.do === 'safety') takeSafety(message.stages);
  if (message.do === 'recording') takeRecording(message);
  if (message.do === 'stopped') takeStopped(message);
  if (message.do === 'released') takeReleased(message);
  if (message.do === 'clients') {
    state.clients = message.count;
    changed('clients');
  }
  // The answer to a question without a number: what failed was nobody's in particular.
  if (message.do === 'notice' || message.do === 'refused') takeNotice(message);
}

/** The message that tells what is wrong with the file. */
let aboutFile = 0;

/** @param {import('./wire.js').Message} notice */
function takeNotice({ about, message }) {
  const isAboutFile = about === 'file';
  if (isAboutFile) dismiss(aboutFile);
  const told = tell(message, 'bad');
  if (isAboutFile) aboutFile = told;
}

/** The scene that the page was made to suit last. @type {import('./wire.js').Message} */
let suited = { revision: 0, dimension: 0, text: '' };

/** What follows from a new scene: a title, and a view that suits it. */
function suitView() {
  const { scene, view } = state;
  if (!scene) return;
  document.title = `${baseName(scene.file ?? scene.name)} · palpate`;
  // A scene that was saved comes again as it was.
  if (scene.revision === suited.revision && scene.text === suited.text) return;
  const { dimension: before } = suited;
  suited = scene;
  const isPlane = scene.dimension === 2;
  if (isPlane && (view.mode === 'space' || view.mode === 'slice')) setView({ mode: 'plane' });
  if (!isPlane && before === 2 && view.mode === 'plane') setView({ mode: 'space' });
  if (state.selection !== null && (scene.by === 'open' || valueAt(state.selection) === undefined)) select(null);
  const last = scene.bodies.length - 1;
  if (view.compared.some((body) => body > last)) {
    setView({ compared: view.compared.map((body) => Math.max(0, Math.min(body, last))) });
  }
  if ((state.touch.point ?? 0) >= scene.device.points) setTouch({ point: null });
  if (scene.restarted) tell(`${scene.restarted[0].toUpperCase()}${scene.restarted.slice(1)}. ${FORCES_COME_BACK}`);
  if (scene.by === 'file') {
    dismiss(aboutFile);
    tell('The file was changed elsewhere; the page shows it as it is now.');
  }
}

/** Connects with a token; again, if the program refused the one before. @param {string} token */
function connect(token) {
  page.token = token;
  if (page.wire) {
    page.wire.token = token;
    page.wire.open();
    return;
  }
  page.wire = new Wire(token, {
    frame: (frame) => {
      const start = performance.now();
      hear(frame);
      takeFrame(frame);
      watchRecording(frame);
      watchSafety(frame);
      performance.measure('take a frame', { start });
    },
    message: takeMessage,
    connection: (connection, why) => {
      state.connection = connection;
      state.why = why ?? '';
      changed('connection');
      countAnew();
      if (connection === 'live') sendAgain();
      else forgetStopped();
      if (connection === 'live' && document.hidden) page.wire?.send({ do: 'hidden', is: true });
    },
  });
  page.stage = createStage(place('stage'), page.wire);
}

function toggleHelp() {
  if (isDialogOpen()) closeDialog();
  else openDialog(Help);
}

/** Takes a file that is dropped anywhere. */
function takeDrops() {
  addEventListener('dragover', (event) => {
    event.preventDefault();
    document.body.classList.add('dropping');
  });
  addEventListener('dragleave', (event) => {
    if (event.relatedTarget === null) document.body.classList.remove('dropping');
  });
  addEventListener('drop', (event) => {
    event.preventDefault();
    document.body.classList.remove('dropping');
    const [file] = event.dataTransfer?.files ?? [];
    if (file) void actions.openFile(file);
  });
}

const { token, given } = takeAddress();
startTheme();
startHearing();
startStopping();
render(html`<${StopButton} id="stop" />`, place('stop-place'));
startProfile();
render(html`<${Header} help=${toggleHelp} />`, place('header'));
render(html`<${Tabs} main=${place('main')} />`, place('tabs'));
render(html`<${Tree} />`, place('shapes'));
render(html`<${Touch} />`, place('touch'));
render(html`<${ViewBar} />`, place('view'));
render(html`<${LegendButton} />`, place('legend'));
render(html`<${Selected} />`, place('selected'));
render(html`<${Checks} />`, place('checks'));
render(html`<${Time} />`, place('time'));
render(html`<${Status} />`, place('status'));
render(html`<${Toasts} />`, place('toasts'));
render(html`<${Words} start=${connect} />`, place('words'));
render(html`<${Release} />`, place('release-place'));
listen(['scene'], suitView);
listen(['scene'], watchFar);
takeDrops();
startGamepad();
startSteering();
listenKeys({
  stop,
  // A window lies over what says who stopped.
  release: (event) => {
    if (!isDialogOpen()) void release(event);
  },
  hold: actions.hold,
  slow: actions.slow,
  step: actions.step,
  back: () => actions.lookBy(-1),
  forth: () => actions.lookBy(1),
  follow: () => lookAt(null),
  space: () => actions.setMode('space'),
  slice: () => actions.setMode('slice'),
  plane: () => actions.setMode('plane'),
  compare: () => actions.setMode('compare'),
  fit: () => page.stage?.setCamera('reset'),
  place: nextKind,
  letGo,
  undo: actions.undo,
  redo: actions.redo,
  save: () => void save(),
  saveAs: () => saveAs(),
  help: toggleHelp,
  useKeys: () => setTouch({ input: 'keys' }),
});
// An address that is opened in this tab differs by its fragment alone.
addEventListener('hashchange', () => location.reload());
document.addEventListener('visibilitychange', () =>
  page.wire?.send({ do: 'hidden', is: document.hidden }));

if (token === '') {
  state.connection = 'closed';
  changed('connection');
} else {
  connect(token);
}
if (given.size > 0) void followLink(given);
