// SPDX-License-Identifier: GPL-3.0-or-later
// The researcher's own questions, before the trials and after them.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { answersIn, answerTrials, assertAccessible, open, openSessions, picture, save, withStudy } from './support.mjs';

const questions = {
  en: {
    age: 'How old are you?', sight: 'Do you see well at the distance of your screen?', yes: ['Yes', 'With glasses or lenses, which I wear now', 'No'],
    ease: 'How easy was it to decide?', low: 'Very hard', high: 'Very easy', words: 'What did you look at?',
  },
  sv: {
    age: 'Hur gammal är du?', sight: 'Ser du bra på avståndet till skärmen?', yes: ['Ja', 'Med glasögon eller linser, som jag har på mig', 'Nej'],
    ease: 'Hur lätt var det att bestämma sig?', low: 'Mycket svårt', high: 'Mycket lätt', words: 'Vad tittade du på?',
  },
};

function configOf(language) {
  const { age, sight, yes, ease, low, high, words } = questions[language];
  return {
    language,
    questionnaire_before: [
      { name: 'age', kind: 'number', text: age, min: 18, max: 120, whole: true, required: true },
      { name: 'sight', kind: 'choice', text: sight, choices: yes, required: true },
    ],
    questionnaire_after: [
      { name: 'ease', kind: 'scale', text: ease, points: 7, low, high, required: true },
      { name: 'words', kind: 'text', text: words, longest: 200 },
    ],
  };
}

// In the browser: what is redrawn is told to be redrawn 75 times a second, however busy the machine is.
function redrawnAt75Hz() {
  const request = window.requestAnimationFrame.bind(window);
  let last = null, count = 0;
  window.requestAnimationFrame = (handler) => request((now) => {
    if (now !== last) ++count;
    last = now;
    handler(1000 * count / 75);
  });
}

async function begin(page) {
  await page.waitForSelector('#start');
  await page.check('#consent');
  await page.click('#start');
  await page.waitForSelector('#question-age');
}

for (const [width, height] of [[1366, 768], [1280, 720]]) {
  for (const language of ['en', 'sv']) {
    test(`questions by the keyboard, ${language}, ${width} x ${height}`, () => withStudy(configOf(language), async (server, context) => {
      const { yes } = questions[language];
      const page = await open(context, server.address);
      await begin(page);
      await assertAccessible(page, 'before');
      assert.equal(await page.evaluate(() => document.activeElement.tagName), 'H1', 'a screen reader begins at the heading');
      await page.keyboard.press('Tab');
      await page.keyboard.type('17');
      await page.focus('#next');
      await page.keyboard.press('Enter');
      assert.equal(await page.evaluate(() => document.activeElement.id), 'question-age', 'the first that is wrong has the focus');
      assert.match(await page.textContent('#question-age-wrong'), /18.+120/);
      assert.notEqual(await page.textContent('#question-sight-wrong'), '');
      await assertAccessible(page, 'before, wrong');
      await picture(page, `questionnaire-${width}-${language}-before-wrong`);
      await page.keyboard.press('Control+A');
      await page.keyboard.type('44');
      await page.keyboard.press('Tab');
      await page.keyboard.press('Space');
      await page.keyboard.press('ArrowDown');
      assert.deepEqual(await page.$$eval('.questions .wrong', (all) => all.map(({ textContent }) => textContent)), ['', ''], 'what was put right is right');
      await picture(page, `questionnaire-${width}-${language}-before`);
      await page.keyboard.press('Tab');
      assert.equal(await page.evaluate(() => document.activeElement.id), 'next');
      await page.keyboard.press('Enter');
      await answerTrials(page);
      await page.waitForSelector('#question-ease');
      await assertAccessible(page, 'after');
      assert.equal(await page.locator('#common_details').count(), 0, 'the two usual questions are replaced');
      await page.click('#next');
      assert.equal(await page.evaluate(() => document.activeElement.id), 'question-ease-1');
      await page.keyboard.press('ArrowRight');
      await page.fill('#question-words', ' The pulleys.\n<b>&amp;</b> ');
      await picture(page, `questionnaire-${width}-${language}-after`);
      await save(page);
      const [file] = answersIn(server);
      assert.equal(file.questionnaires.before.age.answer, 44);
      assert.equal(file.questionnaires.before.sight.answer, yes[1]);
      assert.equal(file.questionnaires.after.ease.answer, 2);
      assert.equal(file.questionnaires.after.words.answer, 'The pulleys.\n<b>&amp;</b>');
      assert.deepEqual(file.free_text, {});
      assert.deepEqual(page.problems, []);
    }, { viewport: { width, height } }));
  }
}

test('an answer that is taken back is not kept', () => withStudy({
  questionnaire_before: [
    { name: 'age', kind: 'number', text: 'How old are you?', min: 18, max: 120, whole: true, required: true },
    { name: 'note', kind: 'text', text: 'Anything else?', longest: 200 },
  ],
}, async (server, context) => {
  const page = await open(context, server.address);
  await begin(page);
  await page.fill('#question-note', 'my name');
  await page.click('#next');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'question-age', 'the age is missing');
  await page.fill('#question-note', '');
  await page.fill('#question-age', '44');
  await page.click('#next');
  await answerTrials(page);
  await save(page);
  const [file] = answersIn(server);
  assert.deepEqual(Object.keys(file.questionnaires.before), ['age']);
}));

for (const [width, height] of [[1366, 768], [1280, 720]]) {
  for (const language of ['en', 'sv']) {
    test(`the screen is measured, ${language}, ${width} x ${height}`, () => withStudy({ language, measure_screen: true }, async (server, context) => {
      await context.addInitScript(redrawnAt75Hz);
      const page = await open(context, server.address);
      await page.waitForSelector('#start');
      await page.check('#consent');
      await page.click('#start');
      await page.waitForSelector('#card-width');
      await assertAccessible(page, 'screen');
      await picture(page, `screen-${width}-${language}`);
      const card = () => page.$eval('.card', (element) => [element.getBoundingClientRect().width, element.getBoundingClientRect().height]);
      await page.click('#next');
      assert.equal(await page.evaluate(() => document.activeElement.id), 'card-width', 'a width that nobody touched is no answer');
      assert.notEqual(await page.textContent('#card-wrong'), '');
      await page.keyboard.press('End');
      const [widest] = await card();
      assert.equal(widest, 1000, 'the sheet holds the largest');
      await page.fill('#card-width', '428');
      const [across, down] = await card();
      assert.ok(Math.abs(across / down - 85.6 / 53.98) < 0.01, `${across} x ${down}`);
      await page.fill('#distance', '6');
      await page.click('#next');
      assert.match(await page.textContent('#distance-wrong'), /20.+300/);
      await assertAccessible(page, 'screen, wrong');
      await page.fill('#distance', '57.5');
      await page.evaluate(() => new Promise((resolve) => {
        let left = 31;  // redrawings, as many as a measurement needs
        requestAnimationFrame(function next() { --left > 0 ? requestAnimationFrame(next) : resolve(); });
      }));
      await page.click('#next');
      await answerTrials(page);
      await save(page);
      const [{ questionnaires: { screen } }] = answersIn(server);
      assert.equal(screen.px_per_mm.answer, 5);
      assert.equal(screen.viewing_distance_mm.answer, 575);
      assert.equal(screen.refresh_rate_hz.answer, 75);
      assert.deepEqual(page.problems, []);
    }, { viewport: { width, height } }));
  }
}

test('what was answered is asked once; leaving keeps nothing', () => withStudy(configOf('en'), async (server, context) => {
  const page = await open(context, server.address);
  await begin(page);
  await page.reload();
  await page.click('#continue');
  await page.fill('#question-age', '30');
  await page.check('#question-sight-1');
  await page.click('#next');
  await page.waitForSelector('video');
  await page.reload();
  await page.click('#continue');
  await answerTrials(page);
  await page.check('#question-ease-7');
  await page.click('#next');
  await page.waitForSelector('#save');
  await page.reload();
  await page.click('#continue');
  await page.waitForSelector('#save');
  await page.click('#exit');
  await page.click('#leave');
  await page.waitForFunction(() => /left the study/.test(document.querySelector('h1').textContent));
  assert.deepEqual(openSessions(server), []);
  await page.reload();
  await begin(page);
  await page.click('#exit');
  await page.click('#leave');
  await page.waitForFunction(() => /left the study/.test(document.querySelector('h1').textContent));
  assert.deepEqual(openSessions(server), []);
  assert.deepEqual(answersIn(server), []);
  assert.deepEqual(page.problems, []);
}));
