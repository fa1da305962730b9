// SPDX-License-Identifier: GPL-3.0-or-later
// Questions of the researcher's own and what is asked besides the choice, on a JATOS server.

import assert from 'node:assert/strict';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { jatosStudy } from './jatos_study.mjs';
import { answerTrials, browse, consent, demonstrations, open, save } from './support.mjs';

const { folder, run, jatos } = await jatosStudy({
  preference: 'graded', confidence: 3, click_where: true, reason: 50,
  questionnaire_before: [{ name: 'age', kind: 'number', text: 'How old are you?', min: 18, max: 120, required: true }],
  questionnaire_after: [{ name: 'words', kind: 'text', text: 'What else?' }],
}, 1);
after(jatos.close);

test('everything is asked, kept over a reload, and brought back', async () => {
  const { browser, context } = await browse();
  try {
    const page = await open(context, jatos.address('one'));
    await page.waitForSelector('#start');
    await page.check('#consent');
    await page.click('#start');
    await page.fill('#question-age', '44');
    await page.click('#next');
    await page.waitForSelector('video');
    await page.reload();
    await page.click('#continue');
    for (let i = 0; i < demonstrations.length; ++i) {
      await page.waitForSelector('#grade-1');
      await page.keyboard.press(String(3 + i));
      await page.click('#confidence-2');
      await page.click('#where-none');
      await page.fill('#reason', `reason ${i}`);
      await page.keyboard.press('Enter');
    }
    await page.fill('#question-words', 'Nothing');
    await save(page);
    assert.deepEqual(page.problems, []);
  } finally {
    await browser.close();
  }
  writeFileSync(join(folder, 'results.txt'), `${JSON.stringify(jatos.runs.get('one').result)}\n`);
  run('import', '--jatos', 'results.txt', '--key', 'study.key.json', '--answers', 'answers');
  const [name] = readdirSync(join(folder, 'answers')).filter((file) => file.endsWith('.json'));
  const { trials, questionnaires } = JSON.parse(readFileSync(join(folder, 'answers', name), 'utf8'));
  assert.deepEqual(trials.map(({ choice, preference, confidence, reason }) => [choice, preference, confidence, reason]),
    [['left', -1, 2, 'reason 0'], ['tie', 0, 2, 'reason 1'], ['right', 1, 2, 'reason 2']]);
  assert.equal(questionnaires.before.age.answer, 44);
  assert.equal(questionnaires.after.words.answer, 'Nothing');
});

test('the language is the participant\'s', async () => {
  const two = await jatosStudy({ languages: ['en', 'sv'] }, 1);
  const { browser, context } = await browse({ locale: 'en-GB' });
  try {
    const page = await open(context, two.jatos.address('one'));
    await page.waitForSelector('#language-sv');
    await page.click('#language-sv');
    await page.waitForSelector('#language-en');
    await consent(page);
    await page.reload();
    await page.waitForSelector('#continue');
    assert.equal(await page.textContent('#continue'), 'Fortsätt');
    await page.click('#continue');
    await answerTrials(page);
    await save(page);
    assert.deepEqual(page.problems, []);
  } finally {
    await browser.close();
    two.jatos.close();
  }
  writeFileSync(join(two.folder, 'results.txt'), `${JSON.stringify(two.jatos.runs.get('one').result)}\n`);
  two.run('import', '--jatos', 'results.txt', '--key', 'study.key.json', '--answers', 'answers');
  const [name] = readdirSync(join(two.folder, 'answers')).filter((file) => file.endsWith('.json'));
  const { language, study } = JSON.parse(readFileSync(join(two.folder, 'answers', name), 'utf8'));
  assert.deepEqual([language, study.language], ['sv', 'en, sv']);
});
