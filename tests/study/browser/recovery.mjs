// SPDX-License-Identifier: GPL-3.0-or-later
// Reloads, lost connections, killed servers, full disks: nothing that was confirmed is lost.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { answer, answersIn, answerTrials, assertAccessible, browse, consent, demonstrations, killServers, open, openSessions, picture, save, scratch, serve } from './support.mjs';

async function answerAll(page, count) {
  await answerTrials(page, count);
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
  await assertAccessible(page, 'resume');
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

test('a reload after saving shows the code again; somebody else begins by a button', () => withBrowser(async (context) => {
  const server = await serve(scratch());
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await answerAll(page);
  await page.click('#save');
  await page.waitForSelector('#code');
  assert.equal(await page.locator('#next-participant').count(), 0, 'not a computer that many share');
  const code = await page.textContent('#code');
  await page.reload();
  await page.waitForSelector('#code');
  assert.equal(await page.textContent('#code'), code);
  assert.equal(await page.locator('#start').count(), 0);
  assert.deepEqual(await page.evaluate(() => JSON.parse(localStorage.study).answers), [], 'no answers are left in the browser');
  await assertAccessible(page, 'saved before');
  await picture(page, '21-saved-before');
  assert.equal(answersIn(server).length, 1);
  assert.deepEqual(openSessions(server), []);
  await page.click('#next-participant');
  await page.waitForSelector('#start');
  assert.equal(await page.evaluate(() => localStorage.study), undefined);
  assert.deepEqual(page.problems, []);
  await server.kill();
}));

test('a browser closed before saving was confirmed shows the code when it comes back', () => withBrowser(async (context) => {
  const server = await serve(scratch());
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await answerAll(page);
  await page.route('**/api/save', async (route) => {
    await route.fetch();
    await route.abort();
  });
  await page.click('#save');
  await page.waitForSelector('#retry');
  await page.close();
  const again = await open(context, server.address);
  await again.waitForSelector('#code');
  assert.equal(answersIn(server).length, 1);
  await server.kill();
}));

test('loading shows how much has come, and a lost server', () => withBrowser(async (context) => {
  const server = await serve(scratch());
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  let isLost = true;
  await page.route('**/media/**', (route) => (isLost ? route.abort() : route.continue()));
  await page.check('#consent');
  await page.click('#start');
  await page.waitForFunction(() => /connection/.test(document.querySelector('#notice').textContent));
  assert.match(await page.textContent('#stage'), /0 % loaded/);
  await assertAccessible(page, 'loading without a server');
  await picture(page, '20-loading-lost');
  isLost = false;
  await page.waitForSelector('video');
  assert.equal(await page.textContent('#notice'), '');
  await server.kill();
}));

test('a clip of which nothing comes any more is fetched again', () => withBrowser(async (context) => {
  const server = await serve(scratch());
  // Half a minute of silence, in a third of a second.
  await context.addInitScript(() => {
    const wait = window.setTimeout;
    window.setTimeout = (call, delay, ...rest) => wait(call, delay === 30000 ? 300 : delay, ...rest);
  });
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  let asked = 0;
  await page.route('**/media/**', (route) => (++asked > 1 ? route.continue() : undefined));
  await page.check('#consent');
  await page.click('#start');
  await page.waitForSelector('video');
  assert.ok(asked > 1);
  await server.kill();
}));

test('a clip that cannot be played is tried again, then told, and a reload goes on', () => withBrowser(async (context) => {
  const server = await serve(scratch());
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  let isBroken = true;
  await page.route('**/media/**', (route) => (isBroken ? route.fulfill({ contentType: 'video/mp4', body: 'no clip' }) : route.continue()));
  await page.check('#consent');
  await page.click('#start');
  await page.waitForFunction(() => /reload the page/.test(document.querySelector('#stage').textContent));
  await assertAccessible(page, 'a clip that cannot be played');
  isBroken = false;
  await page.reload();
  await page.click('#continue');
  await answerTrials(page);
  await save(page);
  assert.equal(answersIn(server).length, 1);
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
  await assertAccessible(page, 'start anew');
  await picture(page, '19-anew');
  await page.click('#anew-cancel');
  assert.deepEqual(openSessions(server), [before], 'asked, and nothing was removed');
  await page.click('#anew');
  await page.click('#anew-confirm');
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
  await assertAccessible(page, 'no connection');
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
  await assertAccessible(page, 'not saved');
  await picture(page, '13-not-saved');
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#download')]);
  const downloaded = readFileSync(await download.path(), 'utf8'), kept = JSON.parse(downloaded);
  assert.equal(kept.answers.length, demonstrations.length, 'what can be downloaded is complete');
  const { token } = await page.evaluate(() => JSON.parse(localStorage.getItem('study')));
  const [participant, secret] = token.split('.');
  assert.ok(!downloaded.includes(secret), 'who is given the file cannot go on in the participant\'s place');
  assert.equal(kept.participant, participant, 'but it says whose the answers are');
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
    method: 'POST', headers: { 'Content-Type': 'application/json', Authorization: `Bearer ${token}` }, body: '{"free_text":{}}',
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

// A small disk at `folder`, or why there can be none.
function mountSmallDisk(folder) {
  mkdirSync(folder, { recursive: true });
  try {
    execFileSync('mount', ['-t', 'tmpfs', '-o', 'size=256k', 'tmpfs', folder], { stdio: 'pipe' });
    return '';
  } catch (error) {
    return `no disk can be mounted here: ${error.stderr}`;
  }
}

// Answers and saves while the disk takes nothing, and again when it does.
async function withDisk(context, folder, breakIt, mendIt) {
  const server = await serve(folder);
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForSelector('#left');
  breakIt();
  await page.click('#right');
  await page.waitForFunction(() => /cannot be stored/.test(document.querySelector('#notice').textContent));
  await assertAccessible(page, 'not kept');
  await picture(page, '14-not-kept');
  assert.equal(await page.textContent('#remaining'), '3 left to answer', 'it does not go on');
  mendIt();
  await page.waitForFunction(() => document.querySelector('#remaining').textContent === '2 left to answer');
  assert.equal(await page.textContent('#notice'), '');
  await answerAll(page, 2);
  breakIt();
  await page.click('#save');
  await page.waitForSelector('#retry');
  await page.click('#retry');
  await page.waitForSelector('#retry');
  assert.equal(await page.locator('#code').count(), 0);
  assert.deepEqual(answersIn(server), []);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#download')]);
  assert.equal(JSON.parse(readFileSync(await download.path(), 'utf8')).answers.length, 3, 'what can be downloaded is complete');
  mendIt();
  await page.waitForSelector('#code');
  assert.deepEqual(answersIn(server).map(({ trials }) => trials.map(({ choice }) => choice)), [['right', 'left', 'left']]);
  assert.match(server.output, /NOT SAVED.*(No space left|Read-only)/);
  await server.kill();
}

test('a full disk: told, nothing lost, saved when there is room', (t) => withBrowser(async (context) => {
  const folder = scratch();
  const answers = join(folder, 'answers');
  const why = mountSmallDisk(answers);
  if (why) return t.skip(why);
  const ballast = join(answers, 'ballast');
  const fill = () => assert.throws(() => { for (;;) writeFileSync(ballast, 'x'.repeat(1024), { flag: 'a' }); }, /ENOSPC/);
  try {
    return await withDisk(context, folder, fill, () => rmSync(ballast));
  } finally {
    killServers();
    execFileSync('umount', ['--lazy', answers]);
  }
}));

test('a disk that becomes read-only: told, nothing lost, saved when it is not any more', (t) => withBrowser(async (context) => {
  const folder = scratch();
  const answers = join(folder, 'answers');
  const why = mountSmallDisk(answers);
  if (why) return t.skip(why);
  const remount = (how) => execFileSync('mount', ['-o', `remount,${how}`, answers]);
  try {
    return await withDisk(context, folder, () => remount('ro'), () => remount('rw'));
  } finally {
    killServers();
    execFileSync('umount', ['--lazy', answers]);
  }
}));
