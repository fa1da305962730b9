// SPDX-License-Identifier: GPL-3.0-or-later
// The researcher's own questions on one page, in the form of jsPsych's survey-html-form. A field is { element, read, focus }: `read` returns the answer, undefined
// where there is none, or { wrong } with what to tell.

import { make } from './make.js';

const idOf = (question) => `question-${question.name}`;

// Radio buttons under a legend; `wrong` is where it says what is missing.
function radios(question, legend, wrong, entries, list) {
  const inputs = entries.map(({ value, name }) => make('input', {
    type: 'radio', name: idOf(question), value, id: `${idOf(question)}-${value}`, ...(name && { 'aria-label': name }),
  }));
  const options = entries.map(({ label }, i) => make('label', {}, inputs[i], make('span', {}, label)));
  return {
    element: make('fieldset', { id: idOf(question), 'aria-describedby': wrong.id }, make('legend', {}, ...legend), list(options), wrong),
    read: () => {
      const chosen = inputs.findIndex(({ checked }) => checked);
      return chosen < 0 ? undefined : entries[chosen].answer;
    },
    focus: () => inputs[0].focus(),
    invalid: (isWrong) => inputs.forEach((input) => input.setAttribute('aria-invalid', isWrong)),
  };
}

const choiceField = (question, legend, wrong) => radios(question, legend, wrong,
  question.choices.map((choice, i) => ({ value: i + 1, label: choice, answer: choice })),
  (options) => make('div', { class: 'choices-list' }, ...options));

function scaleField(question, legend, wrong) {
  const { points, low, high } = question;
  const named = (i) => (i === 1 ? `1, ${low}` : i === points ? `${points}, ${high}` : undefined);
  const entries = Array.from({ length: points }, (_, i) => ({ value: i + 1, label: String(i + 1), answer: i + 1, name: named(i + 1) }));
  const end = (words) => make('span', { class: 'scale-end', 'aria-hidden': 'true' }, words);
  return radios(question, legend, wrong, entries, (options) => make('div', { class: 'scale' }, end(low), ...options, end(high)));
}

function inputField(question, legend, wrong, input, read) {
  return {
    element: make('div', { class: 'question' }, make('label', { class: 'text', for: idOf(question) }, ...legend), input, wrong),
    read: () => (input.value.trim() === '' && !input.validity.badInput ? undefined : read(input)),
    focus: () => input.focus(),
    invalid: (isWrong) => input.setAttribute('aria-invalid', isWrong),
  };
}

function numberField(question, legend, wrong, texts) {
  const { min, max, whole } = question;
  const input = make('input', {
    type: 'number', id: idOf(question), min, max, step: whole ? 1 : 'any', 'aria-describedby': wrong.id, required: question.required,
  });
  const hint = (whole ? texts.questionnaire_whole : texts.questionnaire_number).replace('{min}', min).replace('{max}', max);
  return inputField(question, legend, wrong, input, ({ valueAsNumber: number }) =>
    (number >= min && number <= max && (!whole || Number.isInteger(number)) ? number : { wrong: hint }));
}

function textField(question, legend, wrong) {
  const area = make('textarea', { id: idOf(question), maxlength: question.longest, 'aria-describedby': wrong.id, required: question.required });
  return inputField(question, legend, wrong, area, ({ value }) => value.trim());
}

const fieldOf = { choice: choiceField, scale: scaleField, number: numberField, text: textField };

/** Puts the questions of a part into the page. Resolves to the answers by name, once they are as they have to be. */
export function questionnaire(show, texts, part, questions, exit) {
  return new Promise((resolve) => {
    const problem = make('p', { class: 'wrong', role: 'alert' });
    const fields = questions.map((question) => {
      const wrong = make('p', { class: 'wrong', id: `${idOf(question)}-wrong` });
      const legend = [question.text, ...(question.required ? [] : [make('span', { class: 'mark' }, ` (${texts.optional})`)])];
      return { question, wrong, ...fieldOf[question.kind](question, legend, wrong, texts) };
    });
    // Says what is wrong with an answer; returns it if nothing is.
    const check = (field) => {
      const answer = field.read();
      const isMissing = answer === undefined && field.question.required;
      field.wrong.textContent = isMissing ? texts.questionnaire_missing : answer?.wrong ?? '';
      field.isWrong = field.wrong.textContent !== '';
      field.invalid(field.isWrong);
      return answer;
    };
    // What was wrong is looked at again as soon as it changes; not when the field is left, as a
    // message that goes then moves "Next" away from under the pointer that is pressed on it.
    for (const field of fields) field.element.addEventListener('input', () => { if (field.isWrong) check(field); });
    const answers = {};
    const next = (event) => {
      let first = null;
      for (const field of fields) {
        const answer = check(field);
        if (field.isWrong) first ??= field;
        else if (answer === undefined) delete answers[field.question.name];  // it was taken back
        else answers[field.question.name] = answer;
      }
      problem.textContent = first ? texts.questionnaire_problem : '';
      if (!first) return;
      event.stopPropagation();  // and so past the plugin
      event.preventDefault();
      first.focus();
    };
    const display = make('div', {});
    display.addEventListener('submit', next, { capture: true });
    show(texts[`questionnaire_${part}_heading`], display);
    new jsPsychSurveyHtmlForm({ finishTrial: () => resolve(answers) }).trial(display, {
      html: '<div class="questions"></div>', preamble: null, button_label: texts.next, autofocus: '', dataAsArray: false, autocomplete: false,
    });
    const form = display.querySelector('form'), button = form.querySelector('[type=submit]');
    form.noValidate = true;  // what is wrong is said beside each answer
    form.querySelector('.questions').replaceChildren(...fields.map(({ element }) => element));
    button.id = 'next';
    form.append(problem, make('div', { class: 'row' }, button, exit));
  });
}
