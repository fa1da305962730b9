// SPDX-License-Identifier: GPL-3.0-or-later
// Five loops of every trial, frame by frame. Both halves are on the same frame since they are one
// picture; how long the gap at a loop's end is, and what is dropped, is measured and told, not judged:
// that depends on the machine.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { answer, answersIn, browse, consent, demonstrations, killServers, open, scratch, serve } from './support.mjs';

const loops = 5;
const frame = 1000 / 30;  // ms, of these clips

test('five loops of every trial', async () => {
  const server = await serve(scratch());
  const { browser, context } = await browse();
  try {
    const page = await open(context, server.address);
    await page.waitForSelector('#start');
    await consent(page);
    for (let i = 0; i < demonstrations.length; ++i) {
      await page.waitForSelector('video');
      const seen = await page.evaluate((wanted) => new Promise((resolve) => {
        const frames = [];
        let ends = 0;
        const video = document.querySelector('video');
        const note = (now, { mediaTime, presentationTime }) => {
          if (frames.length > 0 && mediaTime < frames.at(-1).mediaTime) ++ends;
          frames.push({ mediaTime, presentationTime });
          if (ends > wanted) resolve({ frames, size: [video.videoWidth, video.videoHeight], quality: video.getVideoPlaybackQuality().droppedVideoFrames });
          else video.requestVideoFrameCallback(note);
        };
        video.requestVideoFrameCallback(note);
      }), loops);
      const gaps = seen.frames.slice(1).map((next, j) => ({ next, before: seen.frames[j] }))
        .filter(({ next, before }) => next.mediaTime < before.mediaTime)
        .map(({ next, before }) => next.presentationTime - before.presentationTime - frame);
      assert.ok(gaps.length > loops, 'loops were seen');
      assert.deepEqual(seen.size, [640, 320], 'both halves are in one picture');
      assert.equal(await page.locator('video').count(), 1);
      console.log(`trial ${i + 1}: ${gaps.length} loop ends, gap beyond one frame: ${gaps.map((gap) => gap.toFixed(1)).join(', ')} ms; ` +
        `${seen.frames.length} frames seen, ${seen.quality} dropped`);
      await page.waitForSelector('#left');
      await answer(page);
    }
    await page.click('#next');
    await page.click('#save');
    await page.waitForSelector('#code');
    const [file] = answersIn(server);
    for (const trial of file.trials) assert.ok(trial.loops_watched >= loops, `${trial.loops_watched} loops were counted`);
  } finally {
    await browser.close();
    killServers();
  }
});
