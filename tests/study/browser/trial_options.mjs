// SPDX-License-Identifier: GPL-3.0-or-later
// What a study asks in each trial besides the choice: by the mouse and by the keyboard.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { answersIn, assertAccessible, consent, open, picture, save, withStudy } from './support.mjs';

// Says that nothing is cut off, and that the clips have not changed their size.
async function assertFits(page, video) {
  const now = await page.evaluate(() => {
    const clips = document.querySelector('video').getBoundingClientRect();
    const parts = [...document.querySelectorAll('.asked > *')].map((part) => part.getBoundingClientRect());
    return {
      size: [clips.width, clips.height], bottom: Math.max(...parts.map(({ bottom }) => bottom)) - innerHeight,
      left: Math.min(...parts.map(({ left }) => left)), right: Math.max(...parts.map(({ right }) => right)) - innerWidth,
      top: Math.min(...parts.map(({ top }) => top)) - clips.bottom,
    };
  });
  assert.deepEqual(now.size, video);
  assert.ok(now.bottom <= 0 && now.left >= 0 && now.right <= 0 && now.top >= -1, JSON.stringify(now));
}

const sizeOf = (page) => page.$eval('video', (video) => [video.getBoundingClientRect().width, video.getBoundingClientRect().height]);

for (const [width, height] of [[1366, 768], [1280, 720]]) {
  for (const language of ['en', 'sv']) {
    const config = { language, preference: 'graded', confidence: 5, reason: 100, click_where: true };
    test(`everything is asked, ${language}, ${width} x ${height}`, () => withStudy(config, async (server, context) => {
      const page = await open(context, server.address);
      const name = `asked-${width}-${language}`;
      await page.waitForSelector('#start');
      await consent(page);
      await page.waitForSelector('#grade-1');
      const video = await sizeOf(page);
      await assertAccessible(page, 'grades');
      await assertFits(page, video);
      await picture(page, `${name}-1-grades`);
      // With the mouse.
      await page.click('#grade-6');
      await page.waitForSelector('#confidence-1');
      await assertAccessible(page, 'confidence');
      await assertFits(page, video);
      await picture(page, `${name}-2-confidence`);
      await page.click('#confidence-5');
      await page.waitForSelector('#where');
      await assertAccessible(page, 'where');
      await assertFits(page, video);
      await picture(page, `${name}-3-where`);
      const box = await page.locator('#where').boundingBox();
      await page.mouse.click(box.x + 0.875 * box.width, box.y + 0.25 * box.height);
      await page.waitForSelector('#reason');
      await assertAccessible(page, 'reason');
      await assertFits(page, video);
      await page.fill('#reason', 'The cable is thin: "<b>å</b>"');
      await picture(page, `${name}-4-reason`);
      await page.click('#reason-next');
      // With the keyboard; digits that are held down or written are no choices.
      await page.waitForSelector('#grade-1');
      await page.keyboard.press('8');
      await page.keyboard.press('4');
      await page.waitForSelector('#confidence-1');
      await page.keyboard.press('Tab');
      await page.keyboard.press('Tab');
      await page.keyboard.press('Enter');
      await page.waitForSelector('#where');
      assert.equal(await page.evaluate(() => document.activeElement.id), 'where');
      for (let i = 0; i < 5; ++i) await page.keyboard.press('ArrowRight');
      await page.keyboard.press('ArrowUp');
      await picture(page, `${name}-5-cross`);
      await page.keyboard.press('Enter');
      await page.waitForSelector('#reason');
      assert.equal(await page.evaluate(() => document.activeElement.id), 'reason');
      await page.keyboard.type('1 2');
      await page.keyboard.press('Enter');
      // As little as can be.
      await page.waitForSelector('#grade-1');
      await page.keyboard.press('1');
      await page.waitForSelector('#confidence-1');
      await page.keyboard.press('1');
      await page.click('#where-none');
      await page.click('#reason-next');
      await save(page);
      const [{ trials, study }] = answersIn(server);
      assert.match(study.options_sha256, /^[0-9a-f]{64}$/);
      assert.deepEqual(trials.map(({ choice, preference, confidence, reason, input }) => [choice, preference, confidence, reason, input]), [
        ['right', 2, 5, 'The cable is thin: "<b>å</b>"', 'mouse'], ['tie', 0, 2, '1 2', 'keyboard'], ['left', -3, 1, undefined, 'keyboard']]);
      const [one, two, three] = trials;
      assert.equal(one.where_side, 'right');
      assert.ok(Math.abs(one.where_x - 0.75) < 0.01 && Math.abs(one.where_y - 0.25) < 0.01, `${one.where_x}, ${one.where_y}`);
      assert.ok(one.where_time_s >= 0 && one.where_time_s <= 2.1);
      assert.equal(two.where_side, 'left');
      assert.ok(Math.abs(two.where_x - 0.7) < 1e-9 && Math.abs(two.where_y - 0.48) < 1e-9, `${two.where_x}, ${two.where_y}`);
      assert.equal(three.where_side, undefined);
      assert.deepEqual(page.problems, []);
    }, { viewport: { width, height } }));
  }
}

test('confidence alone, after a choice of two; a reload asks the trial again', () => withStudy({ confidence: 9 }, async (server, context) => {
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  for (let i = 0; i < 3; ++i) {
    await page.waitForSelector('#left');
    await page.keyboard.press('ArrowRight');
    await page.waitForSelector('#confidence-9');
    if (i === 1) {
      await page.reload();
      await page.click('#continue');
      await page.waitForSelector('#left');
      await page.click('#left');
    }
    // Digits do nothing while the page asks whether to leave.
    await page.click('#exit');
    await page.keyboard.press('3');
    await page.click('#stay');
    await page.keyboard.press('9');
    await page.waitForFunction(() => !document.querySelector('#confidence-9'));
  }
  await save(page);
  const [{ trials }] = answersIn(server);
  assert.deepEqual(trials.map(({ choice, confidence }) => [choice, confidence]), [['right', 9], ['left', 9], ['right', 9]]);
  assert.deepEqual(page.problems, []);
}));
