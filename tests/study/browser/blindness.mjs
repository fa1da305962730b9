// SPDX-License-Identifier: GPL-3.0-or-later
// Nothing that a participant's browser receives tells one method from the other.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { answer, answersIn, browse, consent, demonstrations, killServers, open, save, scratch, serve, telling } from './support.mjs';

// Takes the whole study and returns all that the browser received and what is left in it.
async function takePart(server) {
  const { browser, context } = await browse();
  try {
    const received = [];
    context.on('response', (response) => received.push((async () => ({
      url: response.url(), headers: await response.allHeaders(),
      text: /video/.test(response.headers()['content-type']) ? '' : await response.text().catch(() => ''),
    }))()));
    const page = await open(context, server.address);
    await page.waitForSelector('#start');
    await consent(page);
    const documents = [];
    const token = await page.evaluate(() => JSON.parse(localStorage.getItem('study')).token);
    const session = await (await fetch(new URL('api/session', server.address), { headers: { Authorization: `Bearer ${token}` } })).json();
    const media = [];
    for (const trial of session.trials) {
      const response = await fetch(new URL(trial.mp4, server.address));
      media.push({ trial, headers: Object.fromEntries(response.headers), bytes: Buffer.from(await response.arrayBuffer()) });
    }
    for (let i = 0; i < demonstrations.length; ++i) {
      await page.waitForSelector('#left');
      documents.push(await page.content());
      await answer(page);
    }
    documents.push(await page.evaluate(() => JSON.stringify([{ ...localStorage }, { ...sessionStorage }, document.cookie])));
    await save(page);
    documents.push(await page.content());
    assert.deepEqual(await context.cookies(), []);
    return { received: await Promise.all(received), documents, media };
  } finally {
    await browser.close();
  }
}

test('two participants with opposite sides receive the same, but for the pictures', async () => {
  const server = await serve(scratch());
  const people = [await takePart(server), await takePart(server)];
  const files = answersIn(server).sort((a, b) => a.participant_number - b.participant_number);
  assert.deepEqual(files.map(({ participant_number: number }) => number), [0, 1]);
  killServers();

  for (const { received, documents, media } of people) {
    assert.ok(received.length > 10, 'something was received');
    for (const { url, headers, text } of received) {
      assert.doesNotMatch(url + JSON.stringify(headers), telling);
      // jsPsych has words of its own; what matters is what we send.
      if (!/\/jspsych[a-z-]*\.js$/.test(url)) assert.doesNotMatch(text, telling, url);
      for (const name of ['etag', 'last-modified', 'server', 'set-cookie']) assert.equal(headers[name], undefined, `${url} ${name}`);
    }
    for (const text of documents) assert.doesNotMatch(text, telling);
    for (const { bytes } of media) assert.doesNotMatch(bytes.toString('latin1'), /pinch|baseline|no_contact/i);
    assert.equal(new Set(media.map(({ trial }) => Object.keys(trial).join())).size, 1);
  }

  const names = people.flatMap(({ media }) => media.map(({ trial }) => trial.mp4));
  assert.equal(new Set(names).size, names.length, 'no name is given twice');
  for (const demonstration of demonstrations) {
    const [a, b] = files.map((file, i) => {
      const index = file.trials.findIndex((trial) => trial.demonstration === demonstration);
      return { ...people[i].media[index], left: file.trials[index].left };
    });
    assert.notEqual(a.left, b.left, `${demonstration}: opposite sides`);
    assert.deepEqual(a.headers, b.headers, `${demonstration}: same headers, size among them`);
    assert.notDeepEqual(a.bytes, b.bytes);
  }
});
