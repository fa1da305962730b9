// SPDX-License-Identifier: GPL-3.0-or-later
// What a trial can ask besides the choice, in the row under the clips while they go on.

import { make } from './make.js';

const isFree = () => !document.querySelector('dialog[open]');

// A click without a pointer came from Enter or the space bar.
export const inputOf = (event) => (event.pointerType === 'touch' ? 'touch' : event.detail === 0 ? 'keyboard' : 'mouse');

// The row under the clips with a question, which takes the focus so that a screen reader says it.
function row(choices, words, ...content) {
  const label = make('p', { id: 'asked', tabindex: -1 }, words);
  choices.classList.add('asking');
  choices.replaceChildren(make('div', { role: 'group', 'aria-labelledby': 'asked', class: 'asked' }, label, ...content));
  label.focus();
}

/** One of several buttons, or the digit of its place. `entries`: { id, text, label }. Resolves to { place, input }, from 1. */
export function pick(choices, words, entries, ends = []) {
  return new Promise((resolve) => {
    const decide = (place, input) => {
      removeEventListener('keydown', onKey);
      buttons.forEach((button) => { button.disabled = true; });
      resolve({ place, input });
    };
    const onKey = (event) => {
      const place = Number(event.key);
      const isOurs = place >= 1 && place <= entries.length && !event.repeat && !event.altKey && !event.ctrlKey && !event.metaKey;
      if (!isOurs || !isFree()) return;
      event.preventDefault();
      decide(place, 'keyboard');
    };
    const buttons = entries.map(({ id, text, label }, i) => make('button', {
      type: 'button', id, 'aria-keyshortcuts': i + 1, ...(label && { 'aria-label': label }), onclick: (event) => decide(i + 1, inputOf(event)),
    }, text));
    const [low, high] = ends.map((end) => make('span', { class: 'hint', 'aria-hidden': 'true' }, end));
    row(choices, words, ...(low ? [low] : []), ...buttons, ...(high ? [high] : []));
    addEventListener('keydown', onKey);
  });
}

/** The choice in seven grades. Resolves to { choice, preference, input }. */
export async function grade(choices, texts) {
  const { place, input } = await pick(choices, texts.graded_hint, Array.from({ length: 7 }, (_, i) => (
    { id: `grade-${i + 1}`, text: texts[`graded_${i + 1}`] })));
  const preference = place - 4;
  return { choice: preference < 0 ? 'left' : preference > 0 ? 'right' : 'tie', preference, input };
}

async function confidence(choices, texts, points) {
  const { place } = await pick(choices, texts.confidence_question, Array.from({ length: points }, (_, i) => ({
    id: `confidence-${i + 1}`, text: String(i + 1),
    label: i === 0 ? `1, ${texts.confidence_low}` : i === points - 1 ? `${points}, ${texts.confidence_high}` : false,
  })), [texts.confidence_low, texts.confidence_high]);
  return { confidence: place };
}

// A click in the clips; or a cross, moved by the arrow keys and set by Enter. Nothing is an answer too.
function where({ video, choices }, texts) {
  return new Promise((resolve) => {
    const at = { x: 0.25, y: 0.5 };  // of both clips together
    const step = 0.02;
    const cross = make('span', { class: 'cross', 'aria-hidden': 'true' });
    const area = make('button', { type: 'button', id: 'where', class: 'where', 'aria-label': texts.click_label, 'aria-describedby': 'asked' }, cross);
    const move = (x, y) => {
      at.x = Math.min(1, Math.max(0, x));
      at.y = Math.min(1, Math.max(0, y));
      cross.style.left = `${100 * at.x}%`;
      cross.style.top = `${100 * at.y}%`;
    };
    const end = (result) => {
      area.remove();
      resolve(result);
    };
    area.addEventListener('keydown', (event) => {
      if (event.repeat && event.key === 'Enter') event.preventDefault();  // held since the question before
      const [x, y] = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] }[event.key] ?? [];
      if (x === undefined) return;
      event.preventDefault();
      move(at.x + x, at.y + y);
    });
    area.addEventListener('click', (event) => {
      const box = area.getBoundingClientRect();
      if (inputOf(event) !== 'keyboard') move((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height);
      const side = at.x < 0.5 ? 'left' : 'right';
      end({ where_side: side, where_x: 2 * at.x - (side === 'left' ? 0 : 1), where_y: at.y, where_time_s: video.currentTime });
    });
    row(choices, texts.click_question, make('button', { type: 'button', id: 'where-none', class: 'quiet', onclick: () => end({}) }, texts.click_none));
    move(at.x, at.y);
    video.parentElement.append(area);
    area.focus();
  });
}

function reason(choices, texts, longest) {
  return new Promise((resolve) => {
    const end = () => {
      const text = field.value.trim();
      resolve(text ? { reason: text } : {});
    };
    const field = make('input', {
      type: 'text', id: 'reason', maxlength: longest, 'aria-labelledby': 'asked', autocomplete: 'off',
      onkeydown: (event) => { if (event.key === 'Enter' && !event.isComposing) end(); },
    });
    row(choices, texts.reason_question, field, make('button', { type: 'button', id: 'reason-next', onclick: end }, texts.next));
    field.focus();
  });
}

/** Asks what `options` (of api/study) say, one after the other. Resolves to what is added to the answer. */
export async function askBesides(view, texts, options) {
  const given = {};
  if (options.confidence) Object.assign(given, await confidence(view.choices, texts, options.confidence));
  if (options.click_where) Object.assign(given, await where(view, texts));
  if (options.reason) Object.assign(given, await reason(view.choices, texts, options.reason));
  return given;
}
