// SPDX-License-Identifier: GPL-3.0-or-later
// The study on a JATOS server: the archive, whole sessions with what stands for JATOS, and the answers brought back.

import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { jatosStudy } from './jatos_study.mjs';
import { answer, browse, consent, demonstrations, open, picture, program, save, telling } from './support.mjs';

const { folder, run, entries, study, assets, jatos } = await jatosStudy({ repetitions: 2 }, 2);
after(jatos.close);

async function withRun(name, body) {
  const { browser, context } = await browse();
  try {
    await body(await open(context, jatos.address(name)));
  } finally {
    await browser.close();
  }
}

async function answerRest(page) {
  await page.waitForSelector('#left, #next');
  while (await page.locator('#next').count() === 0) {
    await answer(page);
    await page.waitForSelector('#left, #next');
  }
}

test('the archive is as JATOS documents it, and tells no method', () => {
  assert.equal(study.version, '3');
  assert.equal(study.data.dirName, 'moving_cables');
  const uuid = /^[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}$/;
  for (const { uuid: id } of [study.data, ...study.data.componentList, ...study.data.batchList]) assert.match(id, uuid);
  assert.equal(typeof study.data.componentList[0].jsonData, 'string');
  assert.ok(entries.has(`moving_cables/${study.data.componentList[0].htmlFilePath}`));
  const folders = new Set([...entries.keys()].filter((name) => name.includes('/')).map((name) => name.split('/')[0]));
  assert.deepEqual([...folders], ['moving_cables'], 'one folder');
  const sizes = new Set();
  for (const [name, bytes] of entries) {
    assert.doesNotMatch(name, telling);
    if (name.endsWith('.mp4')) sizes.add(bytes.length);
    if (!/\/jspsych[a-z-]*\.js$/.test(name) && !name.includes('/media/')) assert.doesNotMatch(bytes.toString(), telling, name);
  }
  assert.equal(sizes.size, 1, 'all clips have one size');
  for (const number of [0, 1]) {
    const plan = JSON.parse(assets.get(`plans/${number}.json`));
    assert.equal(plan.length, 2 * demonstrations.length);
    assert.equal(new Set(plan.map(({ mp4 }) => mp4)).size, plan.length, 'no name is shown twice');
    for (const { mp4 } of plan) assert.ok(assets.has(mp4));
  }
});

test('a whole session with a reload, a result that is refused at first, and a contested plan', () => withRun('first', async (page) => {
  jatos.intrusions = 1;
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForSelector('#left');
  await answer(page, 'right');
  await page.reload();
  await page.waitForSelector('#continue');
  await page.click('#continue');
  await page.waitForSelector('video');
  assert.equal(await page.textContent('#remaining'), `${2 * demonstrations.length - 1} left to answer`);
  await answerRest(page);
  await page.fill('#thoughts', 'Bra\n"så"');
  await page.click('#next');
  jatos.failures = 2;
  await page.click('#save');
  await page.waitForSelector('#retry');
  assert.equal(jatos.runs.get('first').result, null);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#download')]);
  await download.saveAs(join(folder, 'downloaded.json'));
  await page.waitForSelector('#code');
  await picture(page, '20-jatos-thanks');
  const { state, result } = jatos.runs.get('first');
  assert.equal(state, 'finished');
  assert.equal(result.withdrawal_code, await page.textContent('#code'));
  assert.equal(result.number, 0);
  const plans = jatos.requests.filter(({ path }) => path.startsWith('plans/')).map(({ path }) => path);
  assert.deepEqual([...new Set(plans)], ['plans/0.json'], 'only its own plan is fetched');
}));

test('who leaves gives the plan back; who starts anew too; then the study is full', async () => {
  await withRun('leaver', async (page) => {
    await page.waitForSelector('#start');
    await consent(page);
    await page.waitForSelector('#left');
    assert.equal(jatos.runs.get('leaver').session.study.number, 1);
    await page.click('#exit');
    await page.click('#leave');
    await page.waitForFunction(() => /left the study/.test(document.querySelector('h1').textContent));
  });
  assert.deepEqual(jatos.runs.get('leaver'), { state: 'aborted', session: {}, result: null });
  await withRun('second', async (page) => {
    await page.waitForSelector('#start');
    await consent(page);
    await page.reload();
    await page.click('#anew');
    await page.click('#anew-confirm');
    await page.waitForSelector('#start');
    await consent(page);
    await answerRest(page);
    await save(page);
    assert.deepEqual(page.problems, []);
  });
  assert.equal(jatos.runs.get('second').result.number, 1);
  await withRun('third', async (page) => {
    await page.waitForSelector('#start');
    await page.check('#consent');
    await page.click('#start');
    await page.waitForFunction(() => /All places/.test(document.querySelector('#stage').textContent));
  });
});

test('the results become answer files that the statistics read', () => {
  const results = ['first', 'second'].map((name) => JSON.stringify(jatos.runs.get(name).result));
  writeFileSync(join(folder, 'results.txt'), `${results.join('\n')}\n`);
  const bring = () => run('import', '--jatos', 'results.txt', '--key', 'study.key.json', '--answers', 'answers');
  assert.match(bring(), /^2 participants imported, 0 were there already/);
  assert.match(bring(), /^0 participants imported, 2 were there already/);
  const plan = JSON.parse(run('plan', '--participants', '2', '--seed', '7', '--config', 'study.json', '--json', '-')).participants;
  for (const name of readdirSync(join(folder, 'answers'))) {
    const file = JSON.parse(readFileSync(join(folder, 'answers', name), 'utf8'));
    const planned = plan[file.participant_number].trials;
    assert.deepEqual(file.trials.map((trial) => [trial.demonstration, trial.left]),
      planned.map(({ demonstration, pinch }) => [demonstration, pinch === 'left' ? 'pinch' : 'baseline']));
    if (file.participant_number === 0) {
      assert.deepEqual(file.trials.map(({ choice }) => choice).slice(0, 2), ['right', 'left']);
      assert.equal(file.resumed_count, 1);
      assert.equal(file.free_text.thoughts, 'Bra\n"så"');
    }
    for (const trial of file.trials) assert.equal(trial.clip, `${trial.demonstration}.left-${trial.left}.mp4`);
  }
  assert.match(run('import', '--jatos', 'downloaded.json', '--key', 'study.key.json', '--answers', 'downloaded'), /^1 participant imported/);
  execFileSync(program, ['analyse', 'answers', '--out', 'report', '--no-figures'], { cwd: folder, stdio: 'ignore' });
  run('withdraw', '--answers', 'answers', jatos.runs.get('first').result.withdrawal_code);
  assert.equal(readdirSync(join(folder, 'answers')).length, 1);
});

test('results that cannot be are refused, with file, line and reason, and nothing is written', () => {
  const good = jatos.runs.get('second').result;
  const bring = (change) => {
    const result = structuredClone(good);
    change(result);
    writeFileSync(join(folder, 'wrong.txt'), `${JSON.stringify(good)}\n\n${JSON.stringify(result)}\n`);
    return spawnSync(program, ['study', 'import', '--jatos', 'wrong.txt', '--key', 'study.key.json', '--answers', 'none'], { cwd: folder, encoding: 'utf8' });
  };
  for (const [change, reason] of [
    [(result) => { result.number = 2; }, /number/],
    [(result) => { result.study = 'another'; }, /another archive/],
    [(result) => { result.answers.pop(); }, /left to answer/],
    [(result) => { result.answers[1].choice = 'both'; }, /choice/],
    [(result) => { result.participant = '../../escape'; }, /participant/],
    [(result) => { result.extra = 1; }, /extra/],
    [(result) => { result.free_text = { other: 'x' }; }, /other/],
    [(result) => { result.answers[0].encoding = 'avi'; }, /encoding/],
  ]) {
    const { status, stderr } = bring(change);
    assert.equal(status, 1, String(change));
    assert.match(stderr, /wrong\.txt:3/);
    assert.match(stderr, reason);
    assert.ok(!readdirSync(folder).includes('none'));
  }
});
