// SPDX-License-Identifier: GPL-3.0-or-later
// A study with short clips, its server, and a browser in front of it.

import assert from 'node:assert/strict';
import { spawn, execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

export const root = new URL('../../..', import.meta.url).pathname;
export const program = process.env.PINCHLAB_PROGRAM ?? join(root, 'build/release/pinchlab');
const chromiumPath = process.env.CHROMIUM ?? '/usr/bin/chromium';
process.setMaxListeners(50);
const skipped = 77;  // what CTest takes for "skipped"
export const patience = 120000;  // ms; a busy machine is slow, not wrong

function skip(reason) {
  console.log(`SKIPPED: ${reason}`);
  process.exit(skipped);
}

if (!existsSync(chromiumPath)) skip(`${chromiumPath} is not installed (apt-get install chromium)`);
let playwright;
try {
  playwright = await import('playwright-core');
} catch {
  skip('playwright-core is not installed (npm ci --prefix tests/study/browser)');
}
const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
if (!existsSync(join(root, 'study/page/node_modules/jspsych'))) skip('jsPsych is not installed (npm ci --prefix study/page)');

export const demonstrations = ['01-roll-over', '03-drop', '07-driven-roller'];

// Words of methods, of this project, and of the demonstrations' files.
export const telling = new RegExp(`pinch|baseline|no_contact|left-|${demonstrations.join('|')}`, 'i');

/** A folder of this test's own, removed at the end. */
export function scratch() {
  const folder = mkdtempSync(join(tmpdir(), 'study-'));
  process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/** Renders pairs of clips of `seconds` each, once for all tests of a build, and returns their folder. */
export function clips(seconds = 2) {
  const cache = join(process.env.PINCHLAB_CLIPS ?? tmpdir(), `study-clips-${seconds}s`);
  const made = mkdtempSync(join(tmpdir(), 'study-clips-'));
  try {
    for (const name of demonstrations) {
      const scene = JSON.parse(readFileSync(join(root, 'demos', `${name}.json`), 'utf8'));
      delete scene.$schema;
      delete scene.poster_time_s;
      scene.duration_s = seconds;
      writeFileSync(join(made, `${name}.json`), JSON.stringify(scene));
    }
    const scenes = demonstrations.map((name) => join(made, `${name}.json`));
    for (const codec of ['h264', 'vp9']) {
      execFileSync(program, ['render', ...scenes, '--out', cache, '--size', '320x320', '--fps', '30', '--only-side-by-side',
        '--attention-checks', '--codec', codec],
        { stdio: ['ignore', 'inherit', 'pipe'] });
    }
  } finally {
    rmSync(made, { recursive: true, force: true });
  }
  return cache;
}

const running = new Set();

/** Ends every server that is left, so that a failed test does not wait for it. */
export function killServers() {
  for (const child of running) child.kill('SIGKILL');
  running.clear();
}
process.on('exit', killServers);

/**
 * Starts the server, on a port that is free or on `port`, with the short clips or with those of `clipsFolder`. Resolves
 * when it listens.
 */
export async function serve(folder, { port = 0, config = {}, clipsFolder, cwd = folder, answers = join(folder, 'answers'), isPilot = false } = {}) {
  const configFile = join(folder, 'study.json');
  writeFileSync(configFile, JSON.stringify({ format: 'pinchlab-study 1', demonstrations: clipsFolder ? undefined : demonstrations, ...config }));
  const child = spawn(program, ['study', 'serve', '--clips', clipsFolder ?? clips(), '--answers', answers, '--port', String(port), '--seed', '7',
    '--config', configFile, '--no-webm', ...(isPilot ? ['--pilot'] : [])], { cwd, stdio: ['ignore', 'pipe', 'inherit'] });
  running.add(child);
  const server = { child, answers, output: '' };
  server.ended = new Promise((resolve) => { child.on('exit', resolve); });
  await new Promise((resolve, reject) => {
    child.stdout.on('data', (bytes) => {
      server.output += bytes;
      if (server.output.includes('Ctrl-C ends')) resolve();
    });
    server.ended.then(() => reject(new Error(`the server ended: ${server.output}`)));
  });
  server.address = server.output.match(/Participants open +(\S+)/)[1];
  server.researcher = server.output.match(/You can watch at +(\S+)/)[1];
  server.port = Number(new URL(server.address).port);
  server.kill = async () => {
    child.kill('SIGKILL');
    await server.ended;
  };
  return server;
}

/** The answer files that are there, parsed. */
export function answersIn(server) {
  return readdirSync(server.answers).filter((name) => name.endsWith('.json'))
    .map((name) => JSON.parse(readFileSync(join(server.answers, name), 'utf8')));
}

export function openSessions(server) {
  return readdirSync(join(server.answers, '.running')).filter((name) => name.endsWith('.json') && name !== 'study.json');
}

/** A browser with a profile of its own. */
export async function browse(options = {}) {
  const browser = await playwright.chromium.launch({
    executablePath: chromiumPath,
    args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
      '--disable-component-update', '--disable-sync'],
  });
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, ...options });
  context.setDefaultTimeout(patience);
  return { browser, context };
}

/** A study of that configuration and a browser in front of it; both end with `body(server, context, browser)`. */
export async function withStudy(config, body, contextOptions = {}, serveOptions = {}) {
  const server = await serve(scratch(), { config, ...serveOptions });
  const { browser, context } = await browse(contextOptions);
  try {
    await body(server, context, browser);
  } finally {
    await browser.close();
    killServers();
  }
}

/** A page whose every problem is kept in `page.problems`. */
export async function open(context, address) {
  const page = await context.newPage();
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error' || message.type() === 'warning') page.problems.push(message.text());
  });
  await page.goto(address);
  return page;
}

/** From the information page to the first trial. */
export async function consent(page) {
  await page.check('#consent');
  await page.click('#start');
  await page.waitForSelector('video');
}

/** Answers the trial that is shown and waits for what comes after it. */
export async function answer(page, side = 'left') {
  const remaining = await page.textContent('#remaining');
  await page.click(`#${side}`);
  await page.waitForFunction((before) => document.querySelector('#remaining')?.textContent !== before, remaining);
}

/** Answers so many trials, one after the other. */
export async function answerTrials(page, count = demonstrations.length) {
  for (let i = 0; i < count; ++i) {
    await page.waitForSelector('#left');
    await answer(page);
  }
}

/** Leaves the questions after the trials, saves, and waits for the withdrawal code. */
export async function save(page) {
  await page.click('#next');
  await page.click('#save');
  await page.waitForSelector('#code');
}

/** Says that the page has nothing that keeps people out. */
export async function assertAccessible(page, where) {
  // By the debugger, which the content security policy does not bind.
  await page.evaluate(axe);
  const rules = { 'label-content-name-mismatch': { enabled: true } };  // who speaks to a button says what is written on it
  const violations = await page.evaluate(async (options) => (await window.axe.run(options)).violations.map(
    ({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(' ')}`), { rules });
  assert.deepEqual(violations, [], where);
}

/**
 * Waits until `wanted` loops of the clip that is shown were seen. A loop of which the machine, being busy, showed less than
 * nine tenths (frames half a second of the clip apart show nothing between) is none, on the page as here. Resolves to all
 * frames that were seen: when they are in the clip, s, and when they were shown, ms.
 */
export function watchLoops(page, wanted) {
  return page.evaluate((count) => new Promise((resolve) => {
    const video = document.querySelector('video');
    const frames = [];
    let last = null, shown = 0, loops = 0;
    video.requestVideoFrameCallback(function note(now, { mediaTime, presentationTime }) {
      frames.push({ mediaTime, presentationTime });
      const isEnd = last !== null && mediaTime < last;
      const step = last === null ? 0 : mediaTime - last + (isEnd ? video.duration : 0);  // s
      if (step <= 0.5) shown += step;
      if (isEnd) {
        if (shown >= 0.9 * video.duration) ++loops;
        if (loops === count) return resolve(frames);
        shown = 0;
      }
      last = mediaTime;
      return video.requestVideoFrameCallback(note);
    });
  }), wanted);
}

/** Says that question, clips and buttons are all on the screen, and that a question of a few words takes one line. */
export async function assertAllIsOnTheScreen(page) {
  const { top, question, bottom, height, width, clips } = await page.evaluate(() => {
    const box = (selector) => document.querySelector(selector).getBoundingClientRect();
    return { top: box('h1').top, question: box('h1').height, bottom: Math.max(box('#left').bottom, box('#right').bottom),
      height: innerHeight, width: document.documentElement.scrollWidth - innerWidth, clips: box('video').width };
  });
  assert.ok(top >= 0 && bottom <= height && width <= 0, `from ${top} to ${bottom} of ${height} px; ${width} px too wide; clips ${clips} px wide`);
  assert.ok(question < 40, `the question is ${question} px high`);
}

/** Keeps a screenshot where PINCHLAB_SCREENSHOTS says. */
export async function picture(page, name) {
  const folder = process.env.PINCHLAB_SCREENSHOTS;
  if (!folder) return;
  mkdirSync(folder, { recursive: true });
  await page.screenshot({ path: join(folder, `${name}.png`) });
}

