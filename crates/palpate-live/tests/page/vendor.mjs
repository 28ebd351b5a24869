// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

/** Whether the files of other projects are as their list says. Argument: the folder. */

import { createHash } from 'node:crypto';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

const folder = process.argv[2];
const list = readFileSync(join(folder, 'vendor.toml'), 'utf8');
const wrong = [];
const listed = new Set(['vendor.toml']);
for (const part of list.split('[[file]]').slice(1)) {
  const field = (name) => new RegExp(`^${name} = "(.*)"$`, 'm').exec(part)?.[1] ?? '';
  const file = field('file');
  listed.add(file);
  const sum = createHash('sha256').update(readFileSync(join(folder, file))).digest('hex');
  if (sum !== field('sha256')) wrong.push(`${file} has the sum ${sum}, its list says ${field('sha256')}`);
  for (const [, licence] of part.matchAll(/licence_file = "([^"]*)"/g)) {
    listed.add(licence);
    if (!existsSync(join(folder, licence))) wrong.push(`${file} has no ${licence}`);
  }
}
// Declarations of types are ours.
const others = readdirSync(folder).filter((file) => !listed.has(file) && !file.endsWith('.d.ts'));
others.forEach((file) => wrong.push(`${file} is not in vendor.toml`));
wrong.forEach((line) => console.log(line));
process.exit(wrong.length > 0 || listed.size < 5 ? 1 : 0);
