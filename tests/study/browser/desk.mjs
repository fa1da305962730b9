// SPDX-License-Identifier: GPL-3.0-or-later
// The researcher's desk.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { answer, answersIn, assertAccessible, browse, consent, demonstrations, killServers, open, openSessions, picture, scratch, serve } from './support.mjs';

async function withDesk(options, body) {
  const server = await serve(scratch(), options);
  const { browser, context } = await browse(options.context);
  try {
    await body(server, context, await open(context, server.researcher));
  } finally {
    await browser.close();
    killServers();
  }
}

// A whole session in a context of its own; resolves to the withdrawal code.
async function takePart(server) {
  const { browser, context } = await browse();
  try {
    const page = await open(context, server.address);
    await page.waitForSelector('#start');
    await consent(page);
    for (let i = 0; i < demonstrations.length; ++i) {
      await page.waitForSelector('#left');
      await (i + 1 < demonstrations.length ? answer(page, 'left') : page.click('#left'));
    }
    await page.click('#next');
    await page.click('#save');
    return await page.textContent('#code');
  } finally {
    await browser.close();
  }
}

test('who runs, what was answered (blind), downloads, withdrawal, preview', () => withDesk({}, async (server, context, desk) => {
  desk.on('dialog', (dialog) => dialog.accept());
  await desk.getByText('Nobody is taking part').waitFor();
  await desk.getByText('Nobody has finished yet').waitFor();
  await assertAccessible(desk, 'empty');
  const running = await open(context, server.address);
  await running.waitForSelector('#start');
  await consent(running);
  await desk.getByText('0 of 3').waitFor();
  const code = await takePart(server);
  await desk.getByText('1 running, 1 finished').waitFor();
  await desk.getByText('Sides: left 3, right 0.').waitFor();
  assert.doesNotMatch(await desk.textContent('main'), /pinch|baseline/, 'blind');
  await assertAccessible(desk, 'with answers');
  await picture(desk, 'desk-blind');
  await desk.click('#reveal');
  await desk.getByText(/^(pinch|baseline) 1$/).first().waitFor();
  await assertAccessible(desk, 'revealed');
  await picture(desk, 'desk-revealed');

  const [file] = await Promise.all([desk.waitForEvent('download'), desk.getByText('Table (CSV)').click()]);
  assert.equal(readFileSync(await file.path(), 'utf8').trim().split('\n').length, 1 + demonstrations.length);
  const [zip] = await Promise.all([desk.waitForEvent('download'), desk.getByText('All answers (zip)').click()]);
  assert.equal(readFileSync(await zip.path()).toString('latin1', 0, 2), 'PK');

  await desk.getByText('Show', { exact: true }).click();
  await desk.getByText('Trial 1 of 3').waitFor();
  await desk.waitForFunction(() => document.querySelector('.preview video')?.currentTime > 0.2);
  await assertAccessible(desk, 'preview');
  await desk.getByText('Next', { exact: true }).click();
  await desk.getByText('Trial 2 of 3').waitFor();
  await desk.waitForFunction(() => document.querySelector('.preview video')?.currentTime > 0.2);
  await picture(desk, 'desk-preview');

  await desk.fill('#code', 'nonsense');
  await desk.getByText('Remove the answers').click();
  await desk.getByText('no withdrawal code').waitFor();
  await desk.fill('#code', code);
  await desk.getByText('Remove the answers').click();
  await desk.getByText('are removed').waitFor();
  assert.deepEqual(answersIn(server), []);
  await desk.getByText('Release', { exact: true }).click();
  await desk.getByText('0 running, 0 finished').waitFor();
  assert.deepEqual(openSessions(server), []);
  assert.deepEqual(desk.problems.filter((problem) => !/40[49]|422/.test(problem)), []);
}));

test('without the token it says so', () => withDesk({}, async (server, context) => {
  const page = await open(context, `${server.researcher.split('#')[0]}#${'0'.repeat(32)}`);
  await page.getByText('This needs the token').waitFor();
  assert.equal(await page.isVisible('#reveal'), false);
}));

for (const [width, height] of [[1920, 1080], [1366, 768], [1280, 720]]) {
  for (const language of ['en', 'sv']) {
    test(`the desk at ${width} x ${height}, ${language}`, () => withDesk(
      { config: { language }, context: { viewport: { width, height } } }, async (server, context, desk) => {
        await desk.getByRole('heading', { name: language === 'en' ? 'Taking part now' : 'Deltar just nu' }).waitFor();
        const running = await open(context, server.address);
        await running.waitForSelector('#start');
        await consent(running);
        await desk.waitForSelector('td');
        await picture(desk, `desk-${width}-${language}`);
        assert.equal(await desk.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true, 'nothing is cut off');
        await assertAccessible(desk, language);
        await desk.getByText(language === 'en' ? 'Svenska' : 'English').click();
        await desk.getByRole('heading', { name: language === 'en' ? 'Deltar just nu' : 'Taking part now' }).waitFor();
      }));
  }
}

test('one computer for many participants', () => withDesk({ config: { shared_computer: true, demonstrations: [demonstrations[0]] } },
  async (server, context) => {
    const page = await open(context, server.address);
    for (let i = 1; i <= 2; ++i) {
      await page.waitForSelector('#start');
      await consent(page);
      await page.waitForSelector('#left');
      await page.click('#left');
      await page.click('#next');
      await page.click('#save');
      await page.waitForSelector('#next-participant');
      await page.reload();
      await page.click('#next-participant');
      assert.equal(answersIn(server).length, i);
    }
    await page.waitForSelector('#start');
  }));
