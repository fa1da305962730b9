// SPDX-License-Identifier: GPL-3.0-or-later
// Everything around the trials. A page is a function that fills an element and returns a promise of
// what the participant did there.

import { Refused, SessionGone } from './errors.js';
import { make } from './make.js';

// Pixels of the screen, not CSS pixels: the zoom that some need to read must not keep them out, and takes nothing from the
// clips, which are shown by pixels of the screen too.
const smallest = { width: 1280, height: 720 };  // as it is told
const smallestWindow = { width: 1200, height: 540 };  // a screen has bars besides the window

const paragraphs = (text) => text.split('\n\n').map((part) => make('p', {}, part));

// A sheet of paper in the middle; its heading takes the focus, so that a screen reader begins there.
export function sheet(stage, heading, ...children) {
  const title = make('h1', { tabindex: -1 }, heading);
  stage.replaceChildren(make('div', { class: 'sheet' }, title, ...children));
  window.scrollTo(0, 0);
  title.focus();
}

/** A jsPsych plugin that shows one of the pages; `page` gets the element and returns a promise. */
export class PagePlugin {
  static info = {
    name: 'page',
    version: '1.0.0',
    parameters: { page: { type: jsPsychModule.ParameterType.FUNCTION } },
    data: { result: { type: jsPsychModule.ParameterType.OBJECT } },
  };

  constructor(jsPsych) {
    this.jsPsych = jsPsych;
  }

  trial(display, { page }) {
    page(display).then((result) => this.jsPsych.finishTrial({ result }), (error) => failed(display, page.texts, error));
  }

  /** Goes on at once; questions that need an answer are left to who drives the browser. */
  simulate(trial, mode, options, onLoad) {
    const display = this.jsPsych.getDisplayElement();
    this.trial(display, trial);
    onLoad();
    display.querySelector('#next, #save')?.click();
  }
}

/** The end where something went wrong. */
export function failed(stage, texts, error) {
  console.error(error);
  sheet(stage, texts.title, make('p', {}, error instanceof SessionGone ? texts.session_gone : texts.problem));
}

function startProblem(texts, error, site) {
  if (!(error instanceof Refused)) return texts.busy;
  if (error.status === 403 && !site.recruiting) return location.search ? texts.used_link : texts.no_link;
  return { 403: texts.recruiting_no_id, 409: texts.full, 410: texts.recruiting_again, 422: texts.recruiting_no_id }[error.status] ?? texts.busy;
}

const isTouchOnly = () => matchMedia('(pointer: coarse)').matches && !matchMedia('(any-pointer: fine)').matches;
const isSmall = () => innerWidth * devicePixelRatio < smallestWindow.width || innerHeight * devicePixelRatio < smallestWindow.height;

function fullScreen() {
  document.documentElement.requestFullscreen?.().catch(() => { /* then without */ });
}

/**
 * Information and consent. Resolves to the new session, or to { wanted }: another of the languages. `site`: where the
 * participant comes from; `language`: that of the texts, if there is a choice; `others`: [language, its name in it].
 */
export function information(stage, texts, backend, site, language, others = []) {
  return new Promise((resolve) => {
    const tick = make('input', { type: 'checkbox', id: 'consent' });
    const problem = make('p', { class: 'wrong', role: 'alert' });
    const windowHint = make('p', { class: 'wrong', role: 'status' });
    const start = make('button', { type: 'button', id: 'start' }, texts.start);
    const wayOut = make('div', { class: 'row', hidden: true }, ...site.back('screen_out'));
    const checkWindow = () => {
      const isUnfit = isTouchOnly() || isSmall();
      wayOut.hidden = !isUnfit || wayOut.childElementCount === 0;
      const hint = site.isMissing ? texts.recruiting_no_id : isTouchOnly() ? texts.touch_screen : isSmall()
        ? texts.small_window.replace('{width}', smallest.width).replace('{height}', smallest.height) : '';
      if (windowHint.textContent !== hint) windowHint.textContent = hint;
      start.disabled = hint !== '';
    };
    start.addEventListener('click', async () => {
      problem.textContent = tick.checked ? '' : texts.consent_missing;
      if (!tick.checked) {
        tick.focus();
        return;
      }
      fullScreen();
      start.disabled = true;
      try {
        const session = await backend.start(language);
        removeEventListener('resize', checkWindow);
        resolve(session);
      } catch (error) {
        problem.textContent = startProblem(texts, error, site);
        if (error instanceof Refused && error.status === 409) problem.append(' ', ...site.back('full'));
        start.disabled = false;
      }
    });
    const choices = others.map(([other, name]) => make('button', {
      type: 'button', class: 'quiet', lang: other, id: `language-${other}`,
      onclick() { removeEventListener('resize', checkWindow); resolve({ wanted: other }); },
    }, name));
    sheet(stage, texts.information_heading, ...(choices.length > 0 ? [make('div', { class: 'row' }, ...choices)] : []), windowHint, wayOut, ...paragraphs(texts.information_body), ...paragraphs(texts.information_rights),
      ...paragraphs(texts.information_questions), make('label', { class: 'tick' }, tick, texts.consent), problem,
      make('div', { class: 'row' }, start, ...site.back('declined', texts.recruiting_decline)), make('p', { class: 'hint' }, texts.keyboard_hint));
    addEventListener('resize', checkWindow);
    checkWindow();
  });
}

// A button that asks once before it does what it says.
function askingButton(texts, name, ids, onConfirm) {
  const dialog = make('dialog', { 'aria-labelledby': `${name}-heading` },
    make('h1', { id: `${name}-heading` }, texts[`${name}_heading`]), make('p', {}, texts[`${name}_body`]),
    make('div', { class: 'row' },
      make('button', { type: 'button', id: ids.cancel, onclick: () => dialog.close() }, texts[`${name}_cancel`]),
      make('button', { type: 'button', id: ids.confirm, class: 'quiet', onclick() { dialog.close(); onConfirm(); } }, texts[`${name}_confirm`])));
  const button = make('button', { type: 'button', id: ids.button, class: 'quiet', onclick: () => dialog.showModal() },
    texts[ids.label]);
  return make('span', { class: name }, button, dialog);
}

/** After a reload. Resolves to true to go on, false to start anew. */
export function askResume(stage, texts) {
  return new Promise((resolve) => {
    sheet(stage, texts.resume_heading, make('p', {}, texts.resume_body), make('div', { class: 'row' },
      make('button', { type: 'button', id: 'continue', onclick() { fullScreen(); resolve(true); } }, texts.resume_continue),
      askingButton(texts, 'anew', { button: 'anew', confirm: 'anew-confirm', cancel: 'anew-cancel', label: 'resume_new' },
        () => resolve(false))));
  });
}

const longestSilence = 30000;  // ms, without a byte of a clip: the connection is gone, though nobody has said so

// Fetches a clip, and again until it is whole. `onProgress` gets the share that is there, `onTrouble` whether the server
// is lost.
async function download(url, onProgress, onTrouble) {
  for (let attempt = 1; ; ++attempt) {
    const silence = new AbortController();
    let timer = 0;
    const heard = () => {
      clearTimeout(timer);
      timer = setTimeout(() => silence.abort(), longestSilence);
    };
    try {
      heard();
      const response = await fetch(url, { cache: 'no-store', signal: silence.signal });
      if (response.status === 404) throw new SessionGone();
      if (!response.ok) throw new Error(`status ${response.status}`);
      const total = Number(response.headers.get('Content-Length'));
      const parts = [];
      let loaded = 0;
      for (const reader = response.body.getReader(); ;) {
        const { done, value } = await reader.read();
        if (done) break;
        heard();
        onTrouble(false);
        parts.push(value);
        loaded += value.length;
        onProgress(total > 0 ? loaded / total : 0);
      }
      if (total > 0 && loaded !== total) throw new Error('cut short');
      return new Blob(parts, { type: response.headers.get('Content-Type') });
    } catch (error) {
      if (error instanceof SessionGone) throw error;
      onTrouble(true);
      await new Promise((again) => setTimeout(again, Math.min(500 * attempt, 5000)));
    } finally {
      clearTimeout(timer);
    }
  }
}

// H.264 where the browser has it, VP9 elsewhere.
function playableEncoding(trials) {
  const video = document.createElement('video');
  if (video.canPlayType('video/mp4; codecs="avc1.640028"')) return 'mp4';
  return video.canPlayType('video/webm; codecs="vp9"') && trials.every(({ webm }) => webm) ? 'webm' : null;
}

/**
 * The clips of a session's trials. A few are fetched ahead, one after the other; a clip that was seen is given back, so
 * that the longest study needs the memory of a few clips.
 */
export class Clips {
  constructor(session, encoding, onTrouble) {
    this.trials = session.trials;
    this.ahead = session.ahead ?? 3;  // 1 where which clip comes next follows from the answers
    this.encoding = encoding;
    this.onTrouble = onTrouble;
    this.urls = new Map();  // of trials, by index: promises
    this.shares = new Map();  // that have come, 0 to 1
    this.last = Promise.resolve();  // the download that was begun last
    this.onProgress = () => {};
  }

  /** Begins to fetch the clips of trial `index` and those after it. */
  want(index) {
    for (let i = index; i < Math.min(index + this.ahead, this.trials.length); ++i) {
      if (this.urls.has(i)) continue;
      const url = this.last.then(async () => URL.createObjectURL(await download(this.trials[i][this.encoding], (share) => {
        this.shares.set(i, share);
        this.onProgress();
      }, this.onTrouble)));
      this.last = url.catch(() => {});  // told by whoever needs it
      this.urls.set(i, url);
    }
  }

  /** The address of a clip, once it is there; `onShare` hears how much is, until then. It has to be wanted first. */
  async url(index, onShare) {
    this.onProgress = () => onShare(this.shares.get(index) ?? 0);
    this.onProgress();
    try {
      return await this.urls.get(index);
    } finally {
      this.onProgress = () => {};
    }
  }

  async release(index) {
    const url = this.urls.get(index);
    this.urls.delete(index);
    if (url) URL.revokeObjectURL(await url);
  }
}

/** Fetches the clips of the first trials that are left. Resolves to Clips. `onTrouble` hears whether the server is lost. */
export async function preload(stage, texts, session, site, onTrouble) {
  const encoding = playableEncoding(session.trials.slice(session.next));
  if (!encoding) {
    sheet(stage, texts.preload_heading, make('p', { class: 'wrong' }, texts.no_video), ...site.back('screen_out'));
    return new Promise(() => {});
  }
  const clips = new Clips(session, encoding, onTrouble);
  const first = [...session.trials.keys()].slice(session.next, session.next + clips.ahead);
  const bar = make('progress', { max: 1, value: 0, 'aria-label': texts.preload_heading });
  const words = make('p', { role: 'status' });
  const show = (share) => {
    bar.value = share;
    words.textContent = texts.preload_progress.replace('{percent}', Math.floor(100 * share));
  };
  show(0);
  sheet(stage, texts.preload_heading, bar, words);
  clips.want(session.next);
  for (const [i, index] of first.entries()) await clips.url(index, (share) => show((i + share) / first.length));
  return clips;
}

/** The exit button, which asks once. `onLeave` ends the study. */
export const exitButton = (texts, onLeave) =>
  askingButton(texts, 'exit', { button: 'exit', confirm: 'leave', cancel: 'stay', label: 'exit' }, onLeave);

/** The two optional texts. */
export function questions(stage, texts, onLeave) {
  return new Promise((resolve) => {
    const fields = ['common_details', 'thoughts'].map((key) => ({
      key, field: make('textarea', { id: key, maxlength: 5000 }),
    }));
    sheet(stage, texts.questions_heading,
      ...fields.flatMap(({ key, field }) => [
        make('label', { class: 'text', for: key }, texts[key], make('span', {}, ` (${texts.optional})`)), field]),
      make('div', { class: 'row' },
        make('button', {
          type: 'button', id: 'next',
          onclick: () => resolve(Object.fromEntries(fields.filter(({ field }) => field.value.trim())
            .map(({ key, field }) => [key, field.value.trim()]))),
        }, texts.next), exitButton(texts, onLeave)));
  });
}

const nextParticipant = (texts, onNext) => (onNext ? [make('div', { class: 'row' },
  make('button', { type: 'button', id: 'next-participant', onclick: onNext }, texts.next_participant))] : []);

// In one line, as JATOS exports results, so that it can be imported as one.
function offerDownload(content) {
  const url = URL.createObjectURL(new Blob([JSON.stringify(content), '\n'], { type: 'application/json' }));
  make('a', { href: url, download: 'answers.json' }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** Saves when the participant says so, and tries until it is confirmed. Resolves to { code, completion }. */
export function save(stage, texts, backend, freeText, onLeave) {
  return new Promise((resolve, reject) => {
    const status = make('div', { role: 'status' });
    const button = make('button', { type: 'button', id: 'save' }, texts.save);
    const exit = exitButton(texts, onLeave);
    let wait = 1000;  // ms
    let timer = 0;
    const trouble = () => make('div', {}, make('p', { class: 'wrong' }, texts.not_saved), make('div', { class: 'row' },
      make('button', { type: 'button', id: 'retry', onclick: attempt }, texts.retry),
      make('button', { type: 'button', id: 'download', class: 'quiet', onclick: () => offerDownload(backend.download(freeText)) },
        texts.download)));
    async function attempt() {
      clearTimeout(timer);
      button.disabled = true;
      exit.hidden = true;
      if (!status.firstChild) status.replaceChildren(make('p', {}, texts.saving));
      try {
        resolve(await backend.save(freeText));
      } catch (error) {
        if (error instanceof SessionGone || error instanceof Refused) return reject(error);
        if (!status.querySelector('#retry')) status.replaceChildren(trouble());
        timer = setTimeout(attempt, wait);
        wait = Math.min(2 * wait, 10000);
      }
    }
    button.addEventListener('click', attempt);
    sheet(stage, texts.save_heading, make('p', {}, texts.save_body), make('div', { class: 'row' }, button, exit), status);
  });
}

/** The end; `onNext`: what begins with another participant at this browser, or null. */
export function thanks(stage, texts, { code, completion }, site, onNext = null) {
  const copy = make('button', {
    type: 'button', class: 'quiet',
    onclick: () => navigator.clipboard.writeText(code).then(() => { copy.textContent = texts.copied; }, console.warn),
  }, texts.copy);
  copy.hidden = !navigator.clipboard;  // as on pages without TLS
  sheet(stage, texts.saved_heading, make('p', {}, completion?.url ? texts.recruiting_saved : texts.saved_body),
    ...(code ? [make('p', {}, texts.code_body), make('div', { class: 'row' }, make('span', { class: 'code', id: 'code' }, code), copy)] : []),
    ...site.completion(completion), ...nextParticipant(texts, onNext));
}

export function goodbye(stage, texts, site, onNext = null) {
  sheet(stage, texts.left_heading, make('p', {}, texts.left_body), ...site.back('declined'), ...nextParticipant(texts, onNext));
}
