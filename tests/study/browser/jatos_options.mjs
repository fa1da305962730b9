// SPDX-License-Identifier: GPL-3.0-or-later
// Questions of the researcher's own and what is asked besides the choice, on a JATOS server.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { fakeJatos } from './fake_jatos.mjs';
import { browse, clips, demonstrations, open, program, scratch } from './support.mjs';
import { unzip } from './unzip.mjs';

const folder = scratch();
const run = (...options) => execFileSync(program, ['study', ...options], { cwd: folder, encoding: 'utf8' });
writeFileSync(join(folder, 'study.json'), JSON.stringify({
  format: 'pinchlab-study 1', demonstrations, preference: 'graded', confidence: 3, click_where: true, reason: 50,
  questionnaire_before: [{ name: 'age', kind: 'number', text: 'How old are you?', min: 18, max: 120, required: true }],
  questionnaire_after: [{ name: 'words', kind: 'text', text: 'What else?' }],
}));
run('export', '--jatos', 'study.jzip', '--clips', clips(), '--participants', '1', '--seed', '7', '--config', 'study.json', '--no-webm');
const entries = unzip(readFileSync(join(folder, 'study.jzip')));
const study = JSON.parse(entries.get('moving_cables.jas'));
const input = JSON.parse(study.data.componentList[0].jsonData);
const assets = new Map([...entries].filter(([name]) => name.startsWith('moving_cables/')).map(([name, bytes]) => [name.slice('moving_cables/'.length), bytes]));
const jatos = await fakeJatos({ assets, input });
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
    await page.click('#next');
    await page.click('#save');
    await page.waitForSelector('#code');
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
