// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/**
 * The live page in a browser, served by the program. Arguments: the program, the folder of the
 * scenes, and the folder for pictures. The cases share one browser, each with a context of its own.
 */

import connection from './cases/connection.mjs';
import editing from './cases/editing.mjs';
import fields from './cases/fields.mjs';
import heard from './cases/heard.mjs';
import memoir from './cases/memoir.mjs';
import sizes from './cases/sizes.mjs';
import stop from './cases/stop.mjs';
import touch from './cases/touch.mjs';
import { run } from './harness.mjs';
import { closing } from './shared.mjs';

const cases = [...connection, ...touch, ...editing, ...fields, ...memoir, ...stop, ...heard, ...sizes];

await run(cases.map(([name, work]) => [name, () => closing(work)]));
