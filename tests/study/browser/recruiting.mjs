// SPDX-License-Identifier: GPL-3.0-or-later
// Participants who are sent by a site, and sent back to it.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { answer, answersIn, answerTrials, assertAccessible, browse, consent, killServers, open, openSessions, picture, scratch, serve } from './support.mjs';

const site = 'https://app.example.org';
const recruiting = {
  preset: 'prolific',
  completion_url: `${site}/done?cc=C1&id={participant}`,
  completion_code: 'C1',
  declined_url: `${site}/declined?id={participant}`,
  screen_out_url: `${site}/unsuitable?session={session}`,
  full_url: `${site}/full`,
};

async function withStudy(config, contextOptions, body) {
  const server = await serve(scratch(), { config: { recruiting, ...config } });
  const { browser, context } = await browse(contextOptions);
  await context.route(`${site}/**`, (route) => route.fulfill({ contentType: 'text/html', body: '<title>the site</title>' }));
  try {
    await body(server, context, browser);
  } finally {
    await browser.close();
    killServers();
  }
}

const address = (server, participant, study = 'S1', session = 'T1') =>
  `${server.address}?PROLIFIC_PID=${participant}&STUDY_ID=${study}&SESSION_ID=${session}`;

for (const [width, height] of [[1366, 768], [1280, 720]]) {
  for (const language of ['en', 'sv']) {
    test(`from the site and back to it, ${language}, ${width} x ${height}`, () => withStudy({ language }, { viewport: { width, height } }, async (server, context) => {
      const page = await open(context, address(server, 'p-1'));
      await page.waitForSelector('#start');
      assert.match(await page.textContent('#stage'), language === 'en' ? /stored with your answers/ : /sparas tillsammans med dina svar/);
      assert.equal(await page.getAttribute('#back-declined', 'href'), `${site}/declined?id=p-1`);
      assert.equal(await page.isVisible('#back-screen_out'), false);
      await assertAccessible(page, 'information');
      await picture(page, `recruiting-${width}-${language}-information`);
      await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
      await picture(page, `recruiting-${width}-${language}-information-end`);
      await consent(page);
      await page.waitForSelector('#left');
      await answer(page);
      await page.reload();  // the session is found by the id
      await page.click('#continue');
      await answerTrials(page, 2);
      await page.click('#next');
      await page.click('#save');
      await page.waitForSelector('#back-completed');
      assert.match(await page.textContent('#code'), /-/);
      assert.equal(await page.textContent('#completion-code'), 'C1');
      await assertAccessible(page, 'thanks');
      await picture(page, `recruiting-${width}-${language}-thanks`);
      assert.deepEqual(answersIn(server)[0].recruited, { participant: 'p-1', study: 'S1', session: 'T1' });
      const code = await page.textContent('#code');
      await page.reload();
      await page.waitForSelector('#back-completed');
      assert.deepEqual([await page.textContent('#code'), await page.textContent('#completion-code')], [code, 'C1']);
      assert.equal(await page.locator('#next-participant').count(), 0);
      await page.goto(address(server, 'p-2'));
      await page.waitForSelector('#start');
      await page.goto(address(server, 'p-1'));
      await page.waitForSelector('#back-completed');
      await page.focus('#back-completed');
      await page.keyboard.press('Enter');
      await page.waitForURL(`${site}/done?cc=C1&id=p-1`);
      assert.deepEqual(page.problems, []);
    }));
  }
}

test('once with an id; another id at the same browser is somebody else', () => withStudy({ participant_limit: 2 }, {}, async (server, context) => {
  const page = await open(context, address(server, 'p-1'));
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForSelector('#left');
  await page.goto(address(server, 'p-2'));
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForSelector('#left');
  assert.equal(openSessions(server).length, 2);
  const refusal = async (participant) => {
    await page.goto(address(server, participant));
    await page.evaluate(() => localStorage.clear());
    await page.reload();
    await page.waitForSelector('#start');
    await page.check('#consent');
    await page.click('#start');
    await page.waitForFunction(() => document.querySelector('.wrong[role=alert]').textContent !== '');
    await assertAccessible(page, participant);
    await picture(page, `recruiting-refused-${participant}`);
    return page.textContent('.wrong[role=alert]');
  };
  assert.match(await refusal('p-2'), /taken part already/);
  assert.match(await refusal('p-3'), /All places/);
  assert.equal(await page.getAttribute('#back-full', 'href'), `${site}/full`);
}));

test('without an id nothing starts; a small window leads back; who leaves is sent back', () => withStudy({}, {}, async (server, context) => {
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  assert.match(await page.textContent('.wrong[role=status]'), /lacks your id/);
  assert.equal(await page.isDisabled('#start'), true);
  await assertAccessible(page, 'no id');
  await picture(page, 'recruiting-no-id');
  await page.goto(address(server, '{{%PROLIFIC_PID%}}'));
  await page.waitForSelector('#start');
  assert.equal(await page.isDisabled('#start'), true, 'a name that the site did not fill in');
  await page.goto(address(server, 'p-1', 'S1', 'T 1'));
  await page.waitForSelector('#start');
  await page.setViewportSize({ width: 800, height: 500 });
  await page.waitForSelector('#back-screen_out', { state: 'visible' });
  assert.equal(await page.getAttribute('#back-screen_out', 'href'), `${site}/unsuitable?session=T%201`);
  await assertAccessible(page, 'small');
  await picture(page, 'recruiting-small');
  await page.goto(address(server, 'p-1'));
  await page.setViewportSize({ width: 1280, height: 720 });
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForSelector('#left');
  await page.click('#exit');
  await page.click('#leave');
  await page.waitForSelector('#back-declined');
  await assertAccessible(page, 'left');
  await picture(page, 'recruiting-left');
  assert.deepEqual(openSessions(server), []);
  await page.click('#back-declined');
  await page.waitForURL(`${site}/declined?id=p-1`);
  assert.deepEqual(page.problems, []);
}));
