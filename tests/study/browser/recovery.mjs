// SPDX-License-Identifier: GPL-3.0-or-later
// Reloads, lost connections, killed servers, full disks: nothing that was confirmed is lost.

import assert from 'node:assert/strict';
import { readFileSync, renameSync } from 'node:fs';
import { test } from 'node:test';
import { answer, answersIn, browse, consent, demonstrations, killServers, open, openSessions, picture, scratch, serve } from './support.mjs';

async function answerAll(page, count = demonstrations.length) {
  for (let i = 0; i < count; ++i) {
    await page.waitForSelector('#left');
    await answer(page);
  }
  await page.click('#next');
  await page.waitForSelector('#save');
}

async function withBrowser(body) {
  const { browser, context } = await browse();
  try {
    await body(context);
  } finally {
    await browser.close();
    killServers();
  }
}

test('a reload asks, and goes on at the same trial', () => withBrowser(async (context) => {
  const server = await serve(scratch());
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForSelector('#left');
  await answer(page);
  await page.reload();
  await page.waitForSelector('#continue');
  await picture(page, '11-resume');
  await page.click('#continue');
  await page.waitForSelector('video');
  assert.equal(await page.textContent('#remaining'), '2 left to answer');
  await answerAll(page, 2);
  await page.click('#save');
  await page.waitForSelector('#code');
  const [file] = answersIn(server);
  assert.equal(file.resumed_count, 1);
  assert.equal(file.trials.length, 3);
  await server.kill();
}));

test('starting anew after a reload keeps nothing of before', () => withBrowser(async (context) => {
  const server = await serve(scratch());
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  const [before] = openSessions(server);
  await page.reload();
  await page.click('#anew');
  await page.waitForSelector('#start');
  assert.deepEqual(openSessions(server), []);
  await consent(page);
  assert.notEqual(openSessions(server)[0], before);
  await server.kill();
}));

test('a server killed between trials loses nobody', () => withBrowser(async (context) => {
  const folder = scratch();
  let server = await serve(folder);
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForSelector('#left');
  await answer(page);
  await page.waitForSelector('#left');
  await server.kill();
  await page.click('#right');
  await page.waitForFunction(() => /connection/.test(document.querySelector('#notice').textContent));
  await picture(page, '12-connection');
  server = await serve(folder, { port: server.port });
  await page.waitForFunction(() => document.querySelector('#remaining')?.textContent === 'The last one');
  assert.equal(await page.textContent('#notice'), '');
  await answerAll(page, 1);
  await page.click('#save');
  await page.waitForSelector('#code');
  const [file] = answersIn(server);
  assert.deepEqual(file.trials.map(({ choice }) => choice), ['left', 'right', 'left']);
  await server.kill();
}));

test('a server killed before and after saving: saved once, with one code', () => withBrowser(async (context) => {
  const folder = scratch();
  let server = await serve(folder);
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await answerAll(page);
  await server.kill();
  await page.click('#save');
  await page.waitForSelector('#retry');
  assert.match(await page.textContent('#stage'), /not saved yet/);
  await picture(page, '13-not-saved');
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#download')]);
  const kept = JSON.parse(readFileSync(await download.path(), 'utf8'));
  assert.equal(kept.answers.length, demonstrations.length, 'what can be downloaded is complete');
  server = await serve(folder, { port: server.port });
  // The confirmation of the first attempt that arrives is lost on its way.
  let lost = 0;
  await page.route('**/api/save', async (route) => {
    if (lost > 0) return route.continue();
    await route.fetch().then(() => { ++lost; }, () => {});
    return route.abort();
  });
  await page.waitForSelector('#code');
  assert.equal(lost, 1);
  assert.equal(answersIn(server).length, 1);
  assert.deepEqual(openSessions(server), []);
  const code = await page.textContent('#code');
  await server.kill();
  server = await serve(folder, { port: server.port });
  const again = await fetch(new URL('api/save', server.address), {
    method: 'POST', headers: { 'Content-Type': 'application/json', Authorization: `Bearer ${kept.token}` }, body: '{"free_text":{}}',
  });
  assert.deepEqual([again.status, await again.json()], [200, { done: true, code }], 'also after a restart');
  assert.equal(answersIn(server).length, 1);
  await server.kill();
}));

test('a folder that is gone: told, tried again, saved when it is back', () => withBrowser(async (context) => {
  const server = await serve(scratch());
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await answerAll(page);
  const away = `${server.answers}-away`;
  renameSync(server.answers, away);
  await page.click('#save');
  await page.waitForSelector('#retry');
  assert.equal(await page.locator('#code').count(), 0);
  renameSync(away, server.answers);
  await page.evaluate(() => document.querySelector('#retry')?.click());  // unless it was tried again by itself
  await page.waitForSelector('#code');
  assert.equal(answersIn(server).length, 1);
  assert.match(server.output, /NOT SAVED/);
  await server.kill();
}));
