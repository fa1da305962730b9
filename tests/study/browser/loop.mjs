// SPDX-License-Identifier: GPL-3.0-or-later
// Five loops of every trial, frame by frame. Both halves are on the same frame since they are one
// picture; how long the gap at a loop's end is, and what is dropped, is measured and told, not judged:
// that depends on the machine.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { answer, answersIn, consent, demonstrations, open, save, watchLoops, withStudy } from './support.mjs';

const loops = 5;
const frame = 1000 / 30;  // ms, of these clips

test('five loops of every trial', () => withStudy({}, async (server, context) => {
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  for (let i = 0; i < demonstrations.length; ++i) {
    await page.waitForSelector('video');
    const frames = await watchLoops(page, loops);
    const gaps = frames.slice(1).map((next, j) => ({ next, before: frames[j] }))
      .filter(({ next, before }) => next.mediaTime < before.mediaTime)
      .map(({ next, before }) => next.presentationTime - before.presentationTime - frame);
    const { size, dropped } = await page.$eval('video', (video) => (
      { size: [video.videoWidth, video.videoHeight], dropped: video.getVideoPlaybackQuality().droppedVideoFrames }));
    assert.deepEqual(size, [640, 320], 'both halves are in one picture');
    assert.equal(await page.locator('video').count(), 1);
    console.log(`trial ${i + 1}: ${gaps.length} loop ends, gap beyond one frame: ${gaps.map((gap) => gap.toFixed(1)).join(', ')} ms; ` +
      `${frames.length} frames seen, ${dropped} dropped`);
    await page.waitForSelector('#left');
    await answer(page);
  }
  await save(page);
  const [file] = answersIn(server);
  for (const trial of file.trials) assert.ok(trial.loops_watched >= loops, `${trial.loops_watched} loops were counted`);
}));
