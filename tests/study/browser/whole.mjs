// SPDX-License-Identifier: GPL-3.0-or-later
// The study as it is delivered: all demonstrations at full size, from the information to the report. Tells, for every
// trial, how long the gap at a loop's end was and what was dropped; it judges neither, since both depend on the machine.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { answer, answersIn, assertAllIsOnTheScreen, browse, consent, killServers, open, picture, program, root, save, scratch, serve, watchLoops } from './support.mjs';

const loops = 5;
const milliseconds = (seconds) => (1000 * seconds).toFixed(1).padStart(7);

// Takes the whole study in a window of this size and watches this many loops of each trial.
async function takePart(server, [width, height], wanted) {
  const { browser, context } = await browse({ viewport: { width, height }, screen: { width, height } });
  try {
    const page = await open(context, server.address);
    await page.waitForSelector('#start');
    await picture(page, `whole-${width}-information`);
    await consent(page);
    const trials = Number((await page.textContent('#remaining')).match(/\d+/)[0]);
    for (let i = 0; i < trials; ++i) {
      await page.waitForSelector('video');
      if (i === 0) await picture(page, `whole-${width}-first-loop`);
      if (wanted > 1) await watchLoops(page, wanted);
      await page.waitForSelector('#left');
      await assertAllIsOnTheScreen(page);
      await picture(page, `whole-${width}-trial-${i + 1}`);
      await answer(page, i % 2 === 0 ? 'left' : 'right');
    }
    await save(page);
    await picture(page, `whole-${width}-thanks`);
    assert.deepEqual(page.problems, []);
  } finally {
    await browser.close();
  }
}

test('all demonstrations at full size, twice, and what the answers say', async () => {
  const folder = scratch();
  const clipsFolder = join(process.env.PINCHLAB_CLIPS ?? tmpdir(), 'study-clips-whole');
  const server = await serve(folder, { clipsFolder, cwd: root });
  try {
    await takePart(server, [1920, 1080], loops);
    await takePart(server, [1280, 720], 1);
  } finally {
    killServers();
  }
  const demonstrations = readdirSync(join(root, 'demos')).filter((name) => /^\d\d-.*\.json$/.test(name)).map((name) => name.slice(0, -5)).sort();
  const files = answersIn(server).sort((a, b) => a.participant_number - b.participant_number);
  assert.equal(files.length, 2);
  for (const { trials } of files) {
    assert.deepEqual(trials.map(({ demonstration }) => demonstration).sort(), demonstrations);
    for (const trial of trials) assert.deepEqual(trial.playback_errors, [], trial.demonstration);
  }
  const [first, second] = files;
  console.log(`${first.trials[0].clip_width_px} x ${first.trials[0].clip_height_px} px, gap at a loop's end beyond the clip's own time:`);
  console.log('demonstration                loops  median ms   max ms   frames  dropped');
  for (const trial of first.trials) {
    assert.ok(trial.loops_watched >= loops, `${trial.loops_watched} loops`);
    assert.deepEqual([trial.clip_width_px, trial.clip_height_px], [1920, 960], 'one pixel on one');
    assert.ok(trial.frame_count > 0);
    console.log(`${trial.demonstration.padEnd(29)} ${String(trial.loops_watched).padStart(4)}    ${milliseconds(trial.loop_gap_median_s)}  ` +
      `${milliseconds(trial.loop_gap_max_s)}  ${String(trial.frame_count).padStart(7)}  ${String(trial.dropped_frames).padStart(7)}`);
  }
  for (const trial of second.trials) {
    assert.ok(trial.clip_width_px >= 1180 && trial.clip_width_px === 2 * trial.clip_height_px, `${trial.clip_width_px} px wide`);
  }
  execFileSync(program, ['analyse', server.answers, '--out', join(folder, 'report')], { stdio: 'ignore' });
  const report = JSON.parse(readFileSync(join(folder, 'report', 'report.json'), 'utf8'));
  assert.match(JSON.stringify(report), /01-roll-over/);
});
