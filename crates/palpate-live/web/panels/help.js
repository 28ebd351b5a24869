// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0
// @ts-check

/** The help over the page, with the table of keys. */

import { html } from '../vendor/htm-preact.js';
import { KEYS, MOVE_HELP } from '../input/keys.js';
import { Dialog } from './dialog.js';
import { FORCES_COME_BACK } from './stopping.js';

/** @type {[string, string][]} */
const TEXTS = [
  ['Touch', 'Press on the hand or on a surface: the hand follows the pointer, and a spring draws the device after it. The surface pushes back, so pointer and device part. While you press, the wheel or a second finger moves in depth.'],
  ['Picture', 'Drag beside the scene, or anywhere with the right button, to turn it; with Shift or the middle button to move it; the wheel or two fingers zoom. Drag the handles of the slice, of the triangle and of the circle.'],
  ['Place', 'Select a body or a shape, in the tree or by a click: arrows move it along the axes that its numbers count along, the dot in the middle moves it parallel to the screen, rings turn it, the square scales it, each about its middle, which of an operator is that of its first part. A body changes its pose; a shape its “translate” and turn, which it gets if it has none; both are scaled by a “scale” inside. A drag is one step to undo. Parts of a bend, twist, extrusion, revolution or unequal scale have no handles; a named shape has them where it is used first. “display” turns them off.'],
  ['Stop', `Esc, or the red button: all forces are zero within two ticks. A tour waits meanwhile. The red button always stops. “release” over the picture, or R, ends the stop: 1 s after this page’s last press, 2 s after that of another page. ${FORCES_COME_BACK}`],
  ['Change', 'Select a part in the tree. Drag a number sideways, type it, also with a unit such as 35 mm, or move its slider; what is wrong stands below the field. Ctrl Z drops what was typed; Esc does too, and stops all forces. Each drag is one step to undo. The program keeps edits that are not saved until it ends, also when the page is closed; before it opens another scene, the page asks.'],
  ['Look back', 'The page keeps a minute. Move the slider of the play bar, or press on a chart; “follow” returns to now. The servo goes on meanwhile.'],
  ['Record', '“record” keeps every tick, “replay” leads the hand along it, “CSV” gives it as a file, “open trace” or dropping a .csv takes one.'],
  ['Marks', 'Circle: the device; dot: the proxy, which stays on the surface; orange arrow: the force on the hand; green arrow: the normal there. Pink dots and arrows: contacts of bodies with each other, and their normals. “display” turns each on and off; “legend” in the corner of the picture says what is seen, and can be folded.'],
  ['Safety', 'Between the wanted force and the hand, stages limit how large it is, how fast it changes, how long it lasts and how much energy it gives. The line at the foot says which acts; the tab Safety explains them.'],
  ['Colours', 'Distances are negative inside, zero on the surface, positive outside. “exact” promises the distance itself, “bound” never more than it, “Lipschitz” never more than so many times it.'],
  ['Charts', 'Drag over a chart to see less time, press twice to see all. One cursor is in all four.'],
];

export function Help() {
  return html`<${Dialog} title="Help" isRead>
    <div class="help-columns">
      <table><caption>Keys</caption><tbody>
        ${[...KEYS, ...MOVE_HELP].map(({ shown, text }) => html`<tr key=${shown}>
          <th scope="row"><kbd>${shown}</kbd></th><td>${text}</td></tr>`)}
        <tr><th scope="row"><kbd>stick</kbd></th><td>of a gamepad: moves the hand; triggers: depth; B: let go</td></tr>
      </tbody></table>
      <dl>${TEXTS.map(([title, text]) => html`<dt key=${title}>${title}</dt><dd>${text}</dd>`)}</dl>
    </div>
  <//>`;
}
