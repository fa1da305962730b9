// SPDX-License-Identifier: GPL-3.0-or-later
// The researcher's desk. The token stands behind the # of the address, which no browser sends.

import { make } from './make.js';

const authorization = { Authorization: `Bearer ${location.hash.slice(1)}` };
const html = document.documentElement;
const languages = ['en', 'sv'];
let texts = {};
let isRevealed = false;
let view = null;  // the elements that change

const fill = (text, values) => text.replace(/\{(\w+)\}/g, (_, key) => values[key]);
const time = (utc) => utc.slice(11, 19);
const percent = (share) => `${Math.round(100 * share)} %`;

async function ask(path, body) {
  return fetch(path, body === undefined ? { headers: authorization, cache: 'no-store' } : {
    method: 'POST', headers: { ...authorization, 'Content-Type': 'application/json' }, body: JSON.stringify(body),
  }).catch(() => null);
}

function tell(text) {
  if (view.state.textContent !== text) view.state.textContent = text;
}

// Ends a session of somebody who does not come back; the place goes to the next.
async function release({ participant, answered }) {
  if (!confirm(fill(texts.release_ask, { participant, answered }))) return;
  const response = await ask('api/release', { participant });
  if (!response?.ok && response?.status !== 404) alert(texts.release_failed);
  await refresh();
}

function runningRow(participant) {
  const button = make('button', {
    type: 'button', class: 'quiet', 'data-participant': participant.participant,
    'aria-label': fill(texts.release_label, participant), onclick: () => release(participant),
  }, texts.release);
  return make('tr', {}, ...[participant.participant, participant.number, fill(texts.of, participant), time(participant.started_utc),
    time(participant.last_seen_utc), button].map((content) => make('td', {}, content)));
}

const counts = (chosen) => Object.entries(chosen).map(([what, count]) => `${what} ${count}`).join(', ');

function chosenIn({ chosen, levels }) {
  if (chosen) return counts(chosen);
  return Object.entries(levels ?? {}).sort(([a], [b]) => a - b)
    .map(([level, answers]) => fill(texts.level, { level, counts: counts(answers) })).join('; ');
}

function showResults({ finished, demonstrations, sides, warnings, pilot }) {
  view.pilot.hidden = !pilot;
  view.results.hidden = finished === 0;
  view.noAnswers.hidden = finished > 0;
  view.revealedHead.hidden = !isRevealed;
  view.results.tBodies[0].replaceChildren(...demonstrations.map((row) => make('tr', {},
    make('td', {}, row.name), make('td', {}, row.answers), make('td', {}, percent(row.left / row.answers)),
    ...(isRevealed ? [make('td', {}, chosenIn(row))] : []))));
  view.sides.textContent = finished > 0 ? fill(texts.sides, sides) : '';
  view.blind.textContent = isRevealed ? '' : texts.blind;
  view.reveal.textContent = isRevealed ? texts.hide : texts.reveal;
  const shares = ['dropped_frames', 'one_side'];
  view.warnings.replaceChildren(...(warnings.length === 0 ? [make('li', {}, texts.no_warnings)] : warnings.map(({ code, participant, value }) =>
    make('li', {}, fill(texts[code], { participant, value: shares.includes(code) ? percent(value) : [].concat(value).join(', ') })))));
}

async function refresh() {
  const [overview, results] = await Promise.all([ask('api/overview'), ask('api/results', { reveal: isRevealed })]);
  const isThere = overview?.ok && results?.ok;
  view.body.hidden = !isThere;
  if (!isThere) return tell(overview?.status === 401 ? texts.needs_token : texts.lost);
  const { running, finished, left } = await overview.json();
  tell(fill(texts.state, { running: running.length, finished, left }));
  view.running.hidden = running.length === 0;
  view.nobody.hidden = running.length > 0;
  const focused = document.activeElement.dataset.participant;
  view.running.tBodies[0].replaceChildren(...running.map(runningRow));
  if (focused) view.running.querySelector(`[data-participant="${focused}"]`)?.focus();
  showResults(await results.json());
}

async function withdraw(code) {
  if (!code || !confirm(fill(texts.withdraw_ask, { code }))) return;
  const response = await ask('api/withdraw', { code });
  view.withdrawn.textContent = response?.ok ? fill(texts.withdrawn, await response.json())
    : response?.status === 422 ? texts.no_code : response?.status === 404 ? texts.unknown_code : texts.lost;
  await refresh();
}

async function download(name) {
  const response = await ask(`api/download/${name}`);
  if (!response?.ok) return alert(texts.download_failed);
  const url = URL.createObjectURL(await response.blob());
  make('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

async function preview(number, index = 0) {
  const response = await ask('api/preview', { number });
  if (!response?.ok) return tell(texts.lost);
  const { trials } = await response.json();
  const show = (at) => {
    const { mp4, practice } = trials[at];
    const step = (by, text) => make('button', { type: 'button', class: 'quiet', disabled: !trials[at + by], onclick: () => show(at + by) }, text);
    const video = make('video', { src: mp4, loop: true, muted: true, playsinline: true, 'aria-label': texts.preview_label });
    video.muted = true;
    view.preview.replaceChildren(make('p', { role: 'status' },
      fill(texts.preview_trial, { index: at + 1, count: trials.length }) + (practice ? ` (${texts.preview_practice})` : '')),
    video, make('div', { class: 'row' }, step(-1, texts.preview_before), step(1, texts.preview_next)));
    video.play().catch(console.warn);
  };
  show(index);
}

const table = (...heads) => make('table', { hidden: true },
  make('thead', {}, make('tr', {}, ...heads.map((head) => (head instanceof Element ? head : make('th', { scope: 'col' }, head))))), make('tbody'));

function field(label, id, attributes, button, onsubmit) {
  const input = make('input', { id, ...attributes });
  return make('form', { class: 'row', onsubmit(event) { event.preventDefault(); onsubmit(input.value.trim()); } },
    make('label', { for: id }, label), input, make('button', { type: 'submit', class: 'quiet' }, button));
}

function build() {
  html.lang = languages.find((language) => texts === all[language]);
  document.title = texts.title;
  const head = (text) => make('th', { scope: 'col' }, text);
  view = {
    state: make('p', { role: 'status' }, texts.loading), pilot: make('p', { class: 'wrong', hidden: true }, texts.pilot),
    running: table(texts.participant, texts.number, texts.answered, texts.started, texts.seen, texts.place),
    nobody: make('p', { hidden: true }, texts.nobody),
    revealedHead: head(texts.chosen), noAnswers: make('p', { hidden: true }, texts.no_answers), sides: make('p'), blind: make('p', { class: 'hint' }),
    warnings: make('ul'), preview: make('div', { class: 'preview' }), withdrawn: make('p', { role: 'status' }),
    reveal: make('button', {
      type: 'button', class: 'quiet', id: 'reveal',
      onclick() {
        if (!isRevealed && !confirm(texts.reveal_ask)) return;
        isRevealed = !isRevealed;
        refresh();
      },
    }, texts.reveal),
  };
  view.results = table(texts.demonstration, texts.count, texts.left_share, view.revealedHead);
  const downloads = [['answers.zip', texts.download_zip], ['answers.csv', texts.download_csv], ['psych-ds.zip', texts.download_psych]]
    .map(([name, text]) => make('button', { type: 'button', class: 'quiet', onclick: () => download(name) }, text));
  const section = (heading, ...children) => make('section', {}, make('h2', {}, heading), ...children);
  view.body = make('div', { hidden: true }, view.pilot, section(texts.running, view.running, view.nobody),
    section(texts.answers, view.noAnswers, view.results, view.sides, view.blind, make('div', { class: 'row' }, view.reveal)),
    section(texts.warnings, view.warnings),
    section(texts.download, make('div', { class: 'row' }, ...downloads)),
    section(texts.withdraw, field(texts.withdraw_code, 'code', { autocomplete: 'off', required: true }, texts.withdraw_button, withdraw), view.withdrawn),
    section(texts.preview, field(texts.preview_number, 'number', { type: 'number', min: 0, value: 0, required: true }, texts.preview_show,
      (number) => preview(Number(number))), view.preview));
  const other = languages.find((language) => all[language] !== texts);
  document.querySelector('main').replaceChildren(
    make('div', { class: 'row top' }, make('h1', {}, texts.title), make('a', { href: './' }, texts.participants_page),
      make('button', { type: 'button', class: 'quiet', lang: other, onclick() { texts = all[other]; build(); refresh(); } }, texts.language)),
    view.state, view.body);
}

const all = Object.fromEntries(await Promise.all(languages.map(async (language) =>
  [language, await (await fetch(`texts/researcher.${language}.json`)).json()])));
texts = all[html.lang.slice(0, 2)] ?? all.en;
build();
refresh();
setInterval(refresh, 2000);
