// SPDX-License-Identifier: GPL-3.0-or-later
// A study that was exported for JATOS, on what stands for a JATOS server.

import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fakeJatos } from './fake_jatos.mjs';
import { clips, demonstrations, program, scratch } from './support.mjs';
import { unzip } from './unzip.mjs';

/**
 * Exports a study of that configuration and serves it. Returns its folder (with study.key.json), `run` for the program's
 * study commands there, the archive's entries, the study that it describes, its assets, and the server.
 */
export async function jatosStudy(config, participants) {
  const folder = scratch();
  const run = (...options) => execFileSync(program, ['study', ...options], { cwd: folder, encoding: 'utf8' });
  writeFileSync(join(folder, 'study.json'), JSON.stringify({ format: 'pinchlab-study 1', demonstrations, ...config }));
  run('export', '--jatos', 'study.jzip', '--clips', clips(), '--participants', String(participants), '--seed', '7', '--config', 'study.json', '--no-webm');
  const entries = unzip(readFileSync(join(folder, 'study.jzip')));
  const study = JSON.parse(entries.get('moving_cables.jas'));
  const own = 'moving_cables/';
  const assets = new Map([...entries].filter(([name]) => name.startsWith(own)).map(([name, bytes]) => [name.slice(own.length), bytes]));
  const jatos = await fakeJatos({ assets, input: JSON.parse(study.data.componentList[0].jsonData) });
  return { folder, run, entries, study, assets, jatos };
}
