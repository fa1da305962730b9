// SPDX-License-Identifier: GPL-3.0-or-later
// What a configuration turns on.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { answer, answersIn, answerTrials, assertAccessible, consent, open, openSessions, picture, save, withStudy } from './support.mjs';

test('practice and an attention check, by their names alone', () => withStudy({ training: ['01-roll-over'], attention_checks: ['03-drop'] }, async (server, context) => {
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  for (let i = 0; i < 5; ++i) {
    await page.waitForSelector('#left');
    if (i === 0) {
      await assertAccessible(page, 'practice');
      await picture(page, '15-practice');
    }
    assert.equal(/practice/.test(await page.textContent('#remaining')), i === 0, 'only practice is said to be such');
    await picture(page, `16-trial-${i}`);
    await answer(page);
  }
  await save(page);
  const [{ trials }] = answersIn(server);
  assert.deepEqual(trials.map(({ kind }) => kind).sort(), ['attention', 'main', 'main', 'main', 'training']);
  assert.equal(trials[0].kind, 'training');
  assert.ok(trials[1].kind !== 'attention', 'a check is never the first that counts');
  const check = trials.find(({ kind }) => kind === 'attention');
  assert.equal(check.demonstration, '03-drop-upside-down');
  assert.equal(check.clip, `03-drop.check-${check.expected}.mp4`);
  assert.deepEqual([check.left, check.right], ['check', 'check']);
  assert.deepEqual(page.problems, []);
}));

test('one-time links: who has one starts, once', () => withStudy({ one_time_links: true, participant_limit: 2 }, async (server, context, browser) => {
  const links = [...server.output.matchAll(/One-time link +(\S+)/g)].map(([, link]) => link);
  assert.equal(new Set(links).size, 2);
  const refusal = async (address) => {
    const other = await browser.newContext();
    const page = await open(other, address);
    await page.waitForSelector('#start');
    await page.check('#consent');
    await page.click('#start');
    await page.waitForFunction(() => document.querySelector('.wrong[role=alert]').textContent !== '');
    await assertAccessible(page, 'refused');
    await picture(page, '17-link');
    const text = await page.textContent('.wrong[role=alert]');
    await other.close();
    return text;
  };
  assert.match(await refusal(server.address), /personal link/);
  const page = await open(context, links[1]);
  await page.waitForSelector('#start');
  await consent(page);
  assert.match(await refusal(links[1]), /used already/, 'while it is running');
  await page.reload();
  await page.click('#continue');
  await answerTrials(page);
  await save(page);
  assert.equal(answersIn(server)[0].participant_number, 1, 'the number is the link’s');
  assert.match(await refusal(links[1]), /used already/, 'after it was saved');
  const code = await page.textContent('#code');
  await page.reload();
  await page.waitForSelector('#code');
  assert.equal(await page.textContent('#code'), code);
  assert.equal(await page.locator('#next-participant').count(), 0);
  await page.goto(links[0]);
  await page.waitForSelector('#start');
  assert.match(await refusal(new URL(`?link=${'0'.repeat(32)}`, server.address).href), /used already/, 'a link that nobody was given');
  assert.deepEqual(openSessions(server), []);
}));

for (const [width, height] of [[1920, 1080], [1366, 768], [1280, 720]]) {
  test(`the language is the participant's, ${width} x ${height}`, () => withStudy({
    languages: ['en', 'sv'], controller: 'University of X, Department of Y', contact: 'A. B., ab@x.example', consent_version: '2 (2026-11-01)',
  }, async (server, context) => {
    const page = await open(context, server.address);
    await page.waitForSelector('#start');
    const language = () => page.evaluate(() => document.documentElement.lang);
    assert.equal(await language(), 'sv', 'the one that the browser asks for');
    assert.match(await page.textContent('#stage'), /Ansvarig.+University of X/);
    await assertAccessible(page, 'Swedish information');
    await picture(page, `languages-${width}-sv`);
    await page.click('#language-en');
    await page.waitForSelector('#language-sv');
    assert.equal(await language(), 'en');
    assert.match(await page.textContent('#stage'), /Version of this information: 2 \(2026-11-01\)/);
    await assertAccessible(page, 'English information');
    await picture(page, `languages-${width}-en`);
    await consent(page);
    await page.reload();
    await page.waitForSelector('#continue');
    assert.equal(await language(), 'en', 'what was chosen stays');
    assert.equal(await page.textContent('#continue'), 'Go on');
    await page.click('#continue');
    await answerTrials(page);
    await save(page);
    const [file] = answersIn(server);
    assert.equal(file.language, 'en');
    assert.equal(file.study.language, 'en, sv');
    assert.equal(file.study.consent_version, '2 (2026-11-01)');
    assert.deepEqual(page.problems, []);
  }, { locale: 'sv-SE', viewport: { width, height } }));
}

test('chosen levels: one clip at a time, and a reload goes on', () => {
  const pair = (name, level) => ({ level, left: `${name}.left-pinch.mp4`, right: `${name}.left-baseline.mp4` });
  const series = [{ name: 'squeeze', clips: [pair('01-roll-over', 0.1), pair('03-drop', 0.2), pair('07-driven-roller', 0.3)] }];
  return withStudy({ demonstrations: undefined, series, adaptive_trials: 4 }, async (server, context) => {
    const page = await open(context, server.address);
    const fetched = new Set();
    page.on('request', (request) => { if (request.url().includes('/media/')) fetched.add(request.url()); });
    await page.waitForSelector('#start');
    await consent(page);
    for (let i = 0; i < 4; ++i) {
      if (i === 2) {
        await page.reload();
        await page.click('#continue');
      }
      await page.waitForSelector('#left');
      assert.equal(fetched.size, i + 1, 'which clip comes next is not known before');
      await (i < 3 ? answer(page, i % 2 === 0 ? 'left' : 'right') : page.click('#left'));
    }
    await save(page);
    const [file] = answersIn(server);
    assert.equal(file.plan.adaptive, 'psi');
    assert.equal(file.trials.length, 4);
    for (const { level } of file.trials) assert.ok([0.1, 0.2, 0.3].includes(level));
    assert.deepEqual(page.problems, []);
  });
});
