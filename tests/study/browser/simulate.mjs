// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated participants in a browser, by jsPsych's simulation mode: page, server, answers, statistics, and the truth had
// back.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { answersIn, consent, open, program, withStudy } from './support.mjs';

const truth = { '01-roll-over': 0.85, '03-drop': 0.5, '07-driven-roller': 0.25 };  // shares for pinch
const people = 40;

// Marsaglia's xorshift, so that every run draws the same.
function dice(seed) {
  let state = seed;
  return () => {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    return (state >>> 0) / 2 ** 32;
  };
}

// Takes part as `simulation` says; resolves to the problems of the page.
async function takePart(browser, server, simulation) {
  const context = await browser.newContext();
  try {
    await context.addInitScript((given) => { window.simulation = given; }, simulation);
    const page = await open(context, server.address);
    await page.waitForSelector('#start');
    await page.check('#consent');
    await page.click('#start');
    await page.waitForSelector('#code');
    return page.problems;
  } finally {
    await context.close();
  }
}

test(`${people} participants: what the statistics say is the truth`, () => withStudy({}, async (server, context, browser) => {
  const folder = join(server.answers, '..');
  const run = (...options) => execFileSync(program, options, { cwd: folder, encoding: 'utf8' });
  const plan = JSON.parse(run('study', 'plan', '--participants', String(people), '--seed', '7', '--config', 'study.json', '--json', '-')).participants;
  const uniform = dice(20261122);
  for (const { trials } of plan) {
    const answers = trials.map(({ demonstration, pinch }) => {
      const other = pinch === 'left' ? 'right' : 'left';
      return { choice: uniform() < truth[demonstration] ? pinch : other, reaction_time_s: 1.5 };
    });
    assert.deepEqual(await takePart(browser, server, { mode: 'data-only', answers }), []);
  }
  const files = answersIn(server);
  assert.deepEqual(files.map(({ participant_number: number }) => number).sort((a, b) => a - b), plan.map((_, number) => number));
  for (const { pilot, trials } of files) {
    assert.equal(pilot, true);
    for (const { reaction_time_s: seconds, loops_watched: loops } of trials) assert.deepEqual([seconds, loops], [1.5, 0]);
  }
  run('analyse', 'answers', '--no-figures', '--out', 'report');
  const report = JSON.parse(readFileSync(join(folder, 'report/report.json'), 'utf8'));
  for (const { name, low_read: low, high_read: high, share, p_read: p } of report.demonstrations) {
    assert.ok(low <= truth[name] && truth[name] <= high, `${name}: ${share} (${low} to ${high})`);
    assert.equal(p < 0.01, truth[name] !== 0.5, `${name}: p = ${p}`);
  }
  assert.ok(report.cochran_q.p < 0.001, 'the demonstrations differ');
}, {}, { isPilot: true }));

test('seen and pressed: everything that can be asked', () => withStudy({ preference: 'graded', confidence: 5, click_where: true, reason: 50 }, async (server, context, browser) => {
  const answers = [
    { choice: 'right', preference: 2, confidence: 4, reaction_time_s: 0.2 },
    { choice: 'tie', preference: 0, confidence: 1, reaction_time_s: 0.2 },
    { choice: 'left', preference: -3, confidence: 5, reaction_time_s: 0.2 },
  ];
  assert.deepEqual(await takePart(browser, server, { mode: 'visual', answers }), []);
  const [{ trials }] = answersIn(server);
  assert.deepEqual(trials.map(({ choice, preference, confidence }) => [choice, preference, confidence]), [['right', 2, 4], ['tie', 0, 1], ['left', -3, 5]]);
  for (const { loops_watched: loops, frame_count: frames, reaction_time_s: seconds, clip_width_px: width } of trials) {
    assert.ok(loops >= 1 && frames > 30 && width > 0, 'the clip was really shown');
    assert.ok(seconds >= 0.2, `${seconds} s`);
  }
}, {}, { isPilot: true }));

test('who is left to dice answers too', () => withStudy({ confidence: 3 }, async (server, context, browser) => {
  assert.deepEqual(await takePart(browser, server, { mode: 'data-only' }), []);
  const [{ trials }] = answersIn(server);
  for (const { choice, confidence } of trials) assert.ok(['left', 'right'].includes(choice) && confidence >= 1 && confidence <= 3);
}, {}, { isPilot: true }));

test('a study that is no pilot takes no notice', () => withStudy({}, async (server, context) => {
  await context.addInitScript(() => { window.simulation = { mode: 'data-only' }; });
  const page = await open(context, server.address);
  await page.waitForSelector('#start');
  await consent(page);
  await page.waitForSelector('#left');
  assert.equal(await page.textContent('#remaining'), '3 left to answer');
  assert.deepEqual(page.problems, []);
}));
