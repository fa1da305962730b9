// SPDX-License-Identifier: GPL-3.0-or-later
// Whole sessions as participants have them.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { answer, answersIn, answerTrials, assertAccessible, assertAllIsOnTheScreen, consent, demonstrations, open, openSessions, picture, save, withStudy } from './support.mjs';

test('with the mouse, from beginning to end, every page accessible', () => withStudy({}, async (server, context) => {
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await assertAccessible(page, 'information');
  await picture(page, '1-information');
  await page.click('#start');
  assert.match(await page.textContent('#stage'), /tick the box/, 'no consent, no start');
  assert.deepEqual(openSessions(server), []);
  await page.route('**/media/**', async (route) => {
    await page.waitForSelector('progress');
    await assertAccessible(page, 'loading');
    await picture(page, '2-loading');
    await route.continue();
  }, { times: 1 });
  await consent(page);
  await page.waitForFunction(() => document.querySelector('video')?.currentTime > 0.5);
  await assertAccessible(page, 'first loop');
  await picture(page, '2-first-loop');
  const choices = [];
  for (let i = 0; i < demonstrations.length; ++i) {
    const side = i % 2 === 0 ? 'left' : 'right';
    await page.waitForSelector('#left');
    if (i === 0) {
      await assertAccessible(page, 'trial');
      await picture(page, '3-choice');
    }
    assert.equal(await page.locator('video').count(), 1, 'one video element holds both clips');
    choices.push(side);
    await answer(page, side);
  }
  await page.waitForSelector('#next');
  await assertAccessible(page, 'questions');
  await page.fill('#common_details', 'Tjocklek: "åäö"\n<b>&amp;</b>');
  await picture(page, '4-questions');
  await page.click('#next');
  await page.waitForSelector('#save');
  await assertAccessible(page, 'save');
  await picture(page, '5-save');
  assert.deepEqual(answersIn(server), [], 'nothing is saved before the button is pressed');
  await page.click('#save');
  await page.waitForSelector('#code');
  await assertAccessible(page, 'thanks');
  await picture(page, '6-thanks');
  assert.match(await page.textContent('#code'), /^[0-9A-HJKMNP-TV-Z]{4}(-[0-9A-HJKMNP-TV-Z]{4}){2}$/);

  const [file, ...others] = answersIn(server);
  assert.deepEqual(others, []);
  assert.deepEqual(file.trials.map(({ choice }) => choice), choices);
  assert.deepEqual(file.trials.map(({ demonstration }) => demonstration).sort(), demonstrations);
  assert.deepEqual(file.trials.map(({ position }) => position), [1, 2, 3]);
  assert.equal(file.free_text.common_details, 'Tjocklek: "åäö"\n<b>&amp;</b>');
  for (const trial of file.trials) {
    assert.equal(trial.input, 'mouse');
    assert.ok(trial.loops_watched >= 1);
    assert.deepEqual(trial.playback_errors, []);
    assert.equal(trial.clip, `${trial.demonstration}.left-${trial.left}.mp4`);
    assert.deepEqual([trial.window_width_px, trial.window_height_px, trial.clip_width_px, trial.clip_height_px], [1280, 720, 640, 320]);
  }
  assert.deepEqual(openSessions(server), []);
  assert.deepEqual(page.problems, []);
}));

test('with the keyboard only', () => withStudy({ language: 'sv' }, async (server, context) => {
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  assert.equal(await page.getAttribute('html', 'lang'), 'sv');
  // Tab to the element of an id, and say that it shows that it has the focus.
  const tabTo = async (id) => {
    for (let i = 0; i < 30; ++i) {
      await page.keyboard.press('Tab');
      if (await page.evaluate(() => document.activeElement.id) === id) {
        assert.notEqual(await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle), 'none', `${id}: visible focus`);
        return;
      }
    }
    assert.fail(`${id} cannot be reached with the Tab key`);
  };
  await tabTo('consent');
  await page.keyboard.press('Space');
  await picture(page, '7-swedish');
  await tabTo('start');
  await page.keyboard.press('Enter');
  await page.waitForSelector('video');
  const expected = ['left', 'right', 'left'];
  for (const [i, key] of ['ArrowLeft', 'ArrowRight', 'Tab'].entries()) {
    await page.waitForSelector('#left');
    await assertAccessible(page, 'Swedish trial');
    const remaining = await page.textContent('#remaining');
    if (key === 'Tab') {
      await tabTo('left');
      await page.keyboard.press('Enter');
    } else {
      await page.keyboard.press(key);
    }
    await page.waitForFunction((before) => document.querySelector('#remaining')?.textContent !== before, remaining, `trial ${i}`);
  }
  await page.waitForSelector('#next');
  await tabTo('next');
  await page.keyboard.press('Enter');
  await page.waitForSelector('#save');
  await tabTo('save');
  await page.keyboard.press('Space');
  await page.waitForSelector('#code');
  const [file] = answersIn(server);
  assert.deepEqual(file.trials.map(({ choice }) => choice), expected);
  assert.deepEqual(new Set(file.trials.map(({ input }) => input)), new Set(['keyboard']));
  assert.equal(file.language, 'sv');
  assert.deepEqual(page.problems, []);
}));

// Holds the first clip at its third frame until `release`, however slow the machine is. What the page shows is written down
// at every frame, before anything else sees it.
const holdFirstClip = (context) => context.addInitScript(() => {
  window.seen = [];
  const callback = HTMLVideoElement.prototype.requestVideoFrameCallback;
  const watched = new WeakSet();
  HTMLVideoElement.prototype.requestVideoFrameCallback = function request(handler) {
    if (!watched.has(this)) {
      watched.add(this);
      const note = (now, { mediaTime }) => {
        window.seen.push({ mediaTime, buttons: document.querySelectorAll('#left, #right').length });
        if (window.seen.length === 3) this.playbackRate = 0;
        callback.call(this, note);
      };
      callback.call(this, note);
    }
    return callback.call(this, handler);
  };
});
const release = (page) => page.$eval('video', (video) => { video.playbackRate = 1; });

test('no buttons and no keys before the first loop has ended', () => withStudy({}, async (server, context) => {
  await holdFirstClip(context);
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForFunction(() => window.seen.length > 2);
  for (const key of ['ArrowLeft', 'ArrowRight', 'Enter', 'Space']) await page.keyboard.press(key);
  await release(page);
  await page.waitForSelector('#left');
  const seen = await page.evaluate(() => window.seen);
  const loopEnd = seen.findIndex(({ mediaTime }, i) => i > 0 && mediaTime < seen[i - 1].mediaTime);
  const until = loopEnd < 0 ? seen : seen.slice(0, loopEnd + 1);
  assert.ok(until.length > 3, 'frames were seen');
  assert.ok(until.every(({ buttons }) => buttons === 0), 'no button while the first loop plays');
  assert.equal(await page.textContent('#remaining'), '3 left to answer', 'keys did nothing');
  await page.keyboard.press('ArrowLeft');
  await page.waitForFunction(() => document.querySelector('#remaining').textContent === '2 left to answer');
  assert.deepEqual(page.problems, []);
}));

test('leaving asks once and keeps nothing', () => withStudy({}, async (server, context) => {
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForSelector('#left');
  await answer(page);
  await page.click('#exit');
  await assertAccessible(page, 'exit');
  await picture(page, '8-exit');
  await page.keyboard.press('ArrowRight');
  await page.click('#stay');
  assert.equal(await page.textContent('#remaining'), '2 left to answer', 'keys do nothing while it asks');
  assert.equal(openSessions(server).length, 1);
  await page.click('#exit');
  await page.click('#leave');
  await page.waitForFunction(() => /left the study/.test(document.querySelector('h1').textContent));
  await assertAccessible(page, 'left');
  await picture(page, '9-left');
  assert.deepEqual(openSessions(server), []);
  assert.deepEqual(answersIn(server), []);
  await page.reload();
  await page.waitForSelector('#start');
  assert.deepEqual(page.problems, []);
}));

test('a small screen is told kindly', () => withStudy({}, async (server, context) => {
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  assert.match(await page.textContent('#stage'), /too small/);
  assert.equal(await page.isDisabled('#start'), true);
  await assertAccessible(page, 'small');
  await picture(page, '10-small');
}, { viewport: { width: 800, height: 500 } }));

// As Chromium zooms: fewer CSS pixels of the window, not of the screen. From some zoom on the page scrolls.
for (const [width, height, zoom] of [[1920, 1080, 2], [1366, 768, 2], [1368, 768, 4]]) {
  test(`a zoom of ${100 * zoom} % keeps nobody out, ${width} x ${height}`, () => withStudy({}, async (server, context) => {
    const page = await open(context, server.address);
    await page.waitForSelector('#start');
    assert.equal(await page.isDisabled('#start'), false);
    assert.doesNotMatch(await page.textContent('#stage'), /too small/);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is to the side of the window');
    await assertAccessible(page, 'zoomed information');
    await picture(page, `zoom-${width}-${zoom}-information`);
    await consent(page);
    for (const key of ['ArrowLeft', 'ArrowRight', 'ArrowLeft']) {
      await page.waitForSelector('#left');
      if (zoom === 2) await assertAllIsOnTheScreen(page);
      const { isWide, isOver } = await page.evaluate(() => {
        const [left, arrows, right] = ['#left', '.arrows', '#right'].map((selector) => document.querySelector(selector).getBoundingClientRect());
        const isBeside = left.right < arrows.left && arrows.right < right.left, isUnder = arrows.top >= left.bottom && left.right < right.left;
        return { isWide: document.documentElement.scrollWidth > innerWidth, isOver: !isBeside && !isUnder };
      });
      assert.deepEqual([isWide, isOver], [false, false], 'nothing is to the side of the window or lies over another');
      await assertAccessible(page, 'zoomed trial');
      await picture(page, `zoom-${width}-${zoom}-choice`);
      const remaining = await page.textContent('#remaining');
      await page.keyboard.press(key);
      await page.waitForFunction((before) => document.querySelector('#remaining')?.textContent !== before, remaining);
    }
    await save(page);
    const [file] = answersIn(server);
    assert.deepEqual(file.trials.map(({ choice }) => choice), ['left', 'right', 'left']);
    for (const trial of file.trials) {
      assert.deepEqual([trial.window_width_px, trial.window_height_px, trial.device_pixel_ratio], [width / zoom, height / zoom, zoom]);
      if (zoom === 2) assert.deepEqual([trial.clip_width_px, trial.clip_height_px], [640 / zoom, 320 / zoom], 'as large on the screen as without');
      assert.ok(trial.clip_width_px >= 320 / zoom, 'and never smaller than half of that');
    }
    assert.deepEqual(page.problems, []);
  }, { viewport: { width: width / zoom, height: height / zoom }, screen: { width, height }, deviceScaleFactor: zoom }));
}

test('a touch screen is told kindly', () => withStudy({}, async (server, context) => {
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  assert.match(await page.textContent('#stage'), /computer with a mouse or a keyboard/);
  assert.equal(await page.isDisabled('#start'), true);
  await picture(page, '18-touch');
}, { viewport: { width: 1400, height: 900 }, hasTouch: true, isMobile: true }));

test('a browser without H.264 plays the other encoding; practice comes first', () => withStudy({ training: ['03-drop'] }, async (server, context) => {
  await context.addInitScript(() => {
    const canPlayType = HTMLMediaElement.prototype.canPlayType;
    HTMLMediaElement.prototype.canPlayType = function canPlay(type) {
      return type.startsWith('video/mp4') ? '' : canPlayType.call(this, type);
    };
  });
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  assert.match(await page.textContent('#remaining'), /practice/);
  const sizes = new Set();
  for (let i = 0; i <= demonstrations.length; ++i) {
    await page.waitForSelector('#left');
    assert.deepEqual(await page.$eval('video', (video) => [video.videoWidth, video.videoHeight]), [640, 320]);
    sizes.add(await page.$eval('video', (video) => `${video.getBoundingClientRect().width} x ${video.getBoundingClientRect().height}`));
    if (i > 0) assert.equal(await page.textContent('#remaining'), i === 3 ? 'The last one' : `${4 - i} left to answer`, 'practice is not counted');
    await answer(page);
  }
  assert.equal(sizes.size, 1, 'practice has the size of the rest');
  await save(page);
  const [file] = answersIn(server);
  assert.deepEqual(file.trials.map(({ kind }) => kind), ['training', 'main', 'main', 'main']);
  for (const { clip } of file.trials) assert.match(clip, /\.webm$/);
  assert.deepEqual(page.problems, []);
}));

// Hides the page, or shows it again, as far as a page can know.
const hide = (page, isHidden) => page.evaluate((value) => {
  Object.defineProperty(document, 'hidden', { configurable: true, get: () => value });
  document.dispatchEvent(new Event('visibilitychange'));
}, isHidden);

// Jumps to the middle of the clip, and returns how many buttons there are once it has begun anew.
const jump = (page) => page.$eval('video', (video) => new Promise((resolve) => {
  let last = 0;
  video.requestVideoFrameCallback(function note(now, { mediaTime }) {
    // What the page does at this frame, it has done before the timeout.
    if (mediaTime < last) return setTimeout(() => resolve(document.querySelectorAll('#left, #right').length));
    last = mediaTime;
    return video.requestVideoFrameCallback(note);
  });
  video.currentTime = video.duration / 2;
  video.playbackRate = 1;
}));

test('what is not seen does not count: a hidden page waits, and a jump is no loop', () => withStudy({}, async (server, context) => {
  await holdFirstClip(context);
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForFunction(() => window.seen.length > 2);
  const { at, share } = await page.evaluate(() => (
    { at: document.querySelector('video').currentTime, share: document.querySelector('.wait progress').value }));
  assert.ok(share > 0 && share < 1, `the first loop's progress: ${share}`);
  await hide(page, true);
  await release(page);
  await page.waitForTimeout(4000);  // two loops
  assert.equal(await page.$eval('video', (video) => video.paused), true);
  assert.ok(await page.$eval('video', (video) => video.currentTime) - at < 0.1, 'it did not play');
  assert.equal(await page.locator('#left').count(), 0);
  await page.$eval('video', (video) => { video.playbackRate = 0; });
  await hide(page, false);
  await page.waitForFunction(() => !document.querySelector('video').paused);
  assert.equal(await jump(page), 0, 'the end of a loop that was jumped over');
  await page.waitForSelector('#left');
  await answer(page);
  assert.deepEqual(page.problems, []);
}));

for (const [width, height] of [[1920, 1080], [1366, 768], [1280, 720]]) {
  for (const language of ['en', 'sv']) {
    test(`the page at ${width} x ${height}, ${language}`, () => withStudy({ language }, async (server, context) => {
      const page = await open(context, server.address);
      const name = `look-${width}-${language}`;
      await page.waitForSelector('#start');
      await picture(page, `${name}-information`);
      await consent(page);
      await page.waitForFunction(() => document.querySelector('video')?.currentTime > 0.5);
      await picture(page, `${name}-first-loop`);
      await page.waitForSelector('#left');
      await picture(page, `${name}-choice`);
      const boxes = await page.evaluate(() => Object.fromEntries(['#left', '#right', '.arrows', 'video', 'h1'].map((selector) => {
        const { left, right, top, bottom } = document.querySelector(selector).getBoundingClientRect();
        return [selector, { left, right, top, bottom, middle: (left + right) / 2 }];
      })));
      const { video } = boxes;
      const quarter = (video.right - video.left) / 4;
      assert.ok(Math.abs(boxes['#left'].middle - video.left - quarter) < 1, 'the left button is under the left clip');
      assert.ok(Math.abs(boxes['#right'].middle - video.right + quarter) < 1, 'the right button is under the right clip');
      assert.ok(boxes['#left'].right < boxes['.arrows'].left && boxes['.arrows'].right < boxes['#right'].left, 'nothing lies over another');
      assert.ok(boxes.h1.bottom <= video.top && boxes['#left'].top >= video.bottom && boxes['#left'].bottom <= height, 'all is on the screen');
      await server.kill();
      await page.click('#left');
      await page.waitForFunction(() => document.querySelector('#notice').textContent !== '');
      await picture(page, `${name}-lost`);
      const { notice, question, bottom } = await page.evaluate(() => ({
        notice: document.querySelector('#notice').getBoundingClientRect().bottom,
        question: document.querySelector('h1').getBoundingClientRect().top,
        bottom: document.querySelector('.choices').getBoundingClientRect().bottom,
      }));
      assert.ok(notice <= question, 'the banner is off the question');
      assert.ok(bottom <= height, 'and nothing is pushed off the screen');
    }, { viewport: { width, height } }));
  }
}

test('a few clips are fetched ahead, not all', () => withStudy({ repetitions: 4 }, async (server, context) => {
  const page = await open(context, server.address);
  const fetched = new Set();
  page.on('request', (request) => { if (request.url().includes('/media/')) fetched.add(request.url()); });
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForSelector('#left');
  assert.ok(fetched.size <= 3, `${fetched.size} of 12 clips`);
  for (let i = 0; i < 12; ++i) {
    await page.waitForSelector('#left');
    assert.ok(fetched.size <= i + 3, `${fetched.size} clips in trial ${i}`);
    await answer(page);
  }
  assert.equal(fetched.size, 12);
  await page.waitForSelector('#next');
  assert.deepEqual(page.problems, []);
}));

test('who has saved in another window is told so, not that nothing is kept', () => withStudy({}, async (server, context) => {
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await answerTrials(page);
  await page.waitForSelector('#next');
  // The other window saves just before this one leaves.
  const code = await page.evaluate(async () => {
    const { token } = JSON.parse(localStorage.getItem('study'));
    const reply = await fetch('api/save', {
      method: 'POST', headers: { 'Content-Type': 'application/json', Authorization: `Bearer ${token}` }, body: '{"free_text":{}}',
    });
    return (await reply.json()).code;
  });
  await page.click('#exit');
  await page.click('#leave');
  await page.waitForSelector('#code');
  assert.equal(await page.textContent('#code'), code);
  assert.equal(answersIn(server).length, 1);
}));
