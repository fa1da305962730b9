// SPDX-License-Identifier: GPL-3.0-or-later
// How large a pixel is, how far away the eyes are, and how often the screen is redrawn.

import { make } from './make.js';

const cardWidth = 85.6, cardHeight = 53.98;  // mm, ISO/IEC 7810 ID-1
const distance = { min: 20, max: 300 };  // cm
const wanted = 120, enough = 30;  // steps from one redrawing to the next

/**
 * Begins to measure, by the times at which the browser redraws the page. The function that it returns ends that, with
 * { refresh_rate_hz }, or {} where the page was hidden too much.
 */
function measureRefreshRate() {
  const steps = [];  // ms
  let last = null, isEnded = false;
  const onFrame = (now) => {
    if (last !== null && !document.hidden) steps.push(now - last);
    last = document.hidden ? null : now;
    if (!isEnded && steps.length < wanted) requestAnimationFrame(onFrame);
  };
  requestAnimationFrame(onFrame);
  return () => {
    isEnded = true;
    if (steps.length < enough) return {};
    const sorted = steps.sort((a, b) => a - b);
    return { refresh_rate_hz: Math.round(100000 / sorted[sorted.length >> 1]) / 100 };
  };
}

/** The page. Resolves to the answers of the part `screen` of api/questionnaire. */
export function measureScreen(show, texts, exit) {
  return new Promise((resolve) => {
    const refreshRate = measureRefreshRate();
    const card = make('div', { class: 'card', 'aria-hidden': 'true' });
    const size = make('input', { type: 'range', id: 'card-width', min: 150, max: 1000, step: 1, value: 324, 'aria-describedby': 'card-hint card-wrong' });
    const unset = make('p', { class: 'wrong', id: 'card-wrong', role: 'alert' });
    let isSet = false;  // a width that nobody touched is nobody's card
    const fit = () => {
      card.style.width = `${size.value}px`;
      card.style.height = `${size.value * cardHeight / cardWidth}px`;
    };
    const noCard = make('input', { type: 'checkbox', id: 'no-card', onchange() { size.disabled = noCard.checked; } });
    const far = make('input', { type: 'number', id: 'distance', ...distance, step: 'any', required: true, 'aria-describedby': 'distance-wrong' });
    const wrong = make('p', { class: 'wrong', id: 'distance-wrong', role: 'alert' });
    const next = () => {
      const isRight = far.valueAsNumber >= distance.min && far.valueAsNumber <= distance.max;
      far.setAttribute('aria-invalid', !isRight);
      wrong.textContent = isRight ? '' : texts.questionnaire_number.replace('{min}', distance.min).replace('{max}', distance.max);
      const isMissing = !isSet && !noCard.checked;
      unset.textContent = isMissing ? texts.questionnaire_missing : '';
      if (isMissing) return size.focus();
      if (!isRight) return far.focus();
      return resolve({
        viewing_distance_mm: 10 * far.valueAsNumber, ...refreshRate(),
        ...(!noCard.checked && { px_per_mm: Number(size.value) / cardWidth }),
      });
    };
    size.addEventListener('input', () => {
      isSet = true;
      fit();
    });
    show(texts.screen_heading, make('p', { id: 'card-hint' }, texts.screen_card), card,
      make('label', { class: 'text', for: 'card-width' }, texts.screen_size), size, unset,
      make('label', { class: 'tick' }, noCard, texts.screen_no_card),
      make('label', { class: 'text', for: 'distance' }, texts.screen_distance), far, wrong,
      make('div', { class: 'row' }, make('button', { type: 'button', id: 'next', onclick: next }, texts.next), exit));
    fit();
  });
}
