// SPDX-License-Identifier: GPL-3.0-or-later
// The study from beginning to end, as a jsPsych timeline.

import { NotKept } from './errors.js';
import { PagePlugin, askResume, exitButton, failed, goodbye, information, preload, questions, save, sheet, thanks } from './pages.js';
import { PairTrial } from './pair_trial.js';
import { questionnaire } from './questionnaire.js';
import { Site } from './recruiting.js';
import { measureScreen } from './screen.js';
import { simulationOf } from './simulation.js';

const stage = document.getElementById('stage');
const notice = document.getElementById('notice');
const { connect } = await import(document.documentElement.dataset.backend);

let texts = null;
const tell = (trouble) => {
  // Before the texts have come, the page itself brings the one that is needed.
  const text = trouble instanceof NotKept ? texts.not_kept : trouble ? notice.dataset.lost : '';
  if (notice.textContent !== text) notice.textContent = text;
};
const backend = connect(tell);
let isShared = false, needsLink = false;  // one computer for many participants; a link for each
let recruiting = null, questionnaires = {}, options = {}, isPilot = false, firstLanguage = '', translations = {};
({ language: firstLanguage, texts, translations = {}, recruiting = null, questionnaires = {}, trial_options: options = {},
  shared_computer: isShared = false, needs_link: needsLink = false, pilot: isPilot = false } = await backend.study());
const simulation = simulationOf(isPilot);
const site = new Site(recruiting, texts);
const languages = { [firstLanguage]: texts, ...translations };

function speak(language) {
  texts = languages[language] ?? texts;
  site.texts = texts;
  document.documentElement.lang = language;
  document.title = texts.title;
  notice.dataset.lost = texts.connection_lost;
}

// What the browser asks for, of the study's languages; what the participant then chooses.
function preferred() {
  const known = Object.keys(languages);
  for (const wanted of navigator.languages) {
    const found = known.find((one) => one === wanted) ?? known.find((one) => one.split('-')[0] === wanted.split('-')[0]);
    if (found) return found;
  }
  return firstLanguage;
}

async function inform() {
  if (Object.keys(translations).length === 0) return information(stage, texts, backend, site);
  for (let language = preferred(); ;) {
    speak(language);
    const others = Object.entries(languages).filter(([other]) => other !== language).map(([other, own]) => [other, own.language_name]);
    const session = await information(stage, texts, backend, site, language, others);
    if (!session.wanted) return session;
    language = session.wanted;
  }
}

function next() {
  backend.forget();
  location.reload();
}
const nextIfShared = isShared ? next : null;

// The last page again, after a reload, so that nobody takes part twice by it. A button lets somebody else begin, where ids or
// links do not say who is who.
function stay(saved) {
  thanks(stage, texts, saved, site, isShared || !(recruiting || needsLink) ? next : null);
  return new Promise(() => {});
}

// The session to go on with: the one that was begun, if the participant says so, or a new one.
async function begin() {
  const running = await backend.running(site.ids);
  if (!running) return inform();
  if (running.language) speak(running.language);
  if (running.saved) return stay(running.saved);
  if (await askResume(stage, texts)) return backend.resume();
  const saved = await backend.startAnew() ?? {};
  return saved.code ? stay(saved) : inform();  // saved already, in another window
}

function page(show) {
  const shown = (display) => show(display);
  shown.texts = texts;
  return { type: PagePlugin, page: shown };
}

// The researcher's own questions, once: a part that was answered is not in `session.questionnaires` any more.
async function ask(display, session, part, leave) {
  if (!session.questionnaires?.includes(part)) return;
  const show = (...content) => sheet(display, ...content);
  const exit = exitButton(texts, leave);
  const asked = part === 'screen' ? measureScreen(show, texts, exit) : questionnaire(show, texts, part, questionnaires[part], exit);
  await backend.questionnaire(part, await asked);
}

try {
  const session = await begin();
  let jsPsych = null;
  const leave = async () => {
    const saved = await backend.leave() ?? {};
    jsPsych?.abortExperiment();
    if (document.fullscreenElement) document.exitFullscreen();
    if (saved.code) thanks(stage, texts, saved, site, nextIfShared);  // saved already, in another window
    else goodbye(stage, texts, site, nextIfShared);
  };

  await ask(stage, session, 'screen', leave);
  await ask(stage, session, 'before', leave);
  const clips = await preload(stage, texts, session, site, (isLost) => tell(isLost ? new Error('lost') : null));
  stage.replaceChildren();
  jsPsych = jsPsychModule.initJsPsych({ display_element: stage });

  const countedFrom = (index) => session.trials.slice(index).filter(({ practice }) => !practice).length;

  const trial = (index) => ({
    type: PairTrial,
    texts,
    remaining: countedFrom(index),
    practice: session.trials[index].practice,
    options,
    exit: () => exitButton(texts, leave),
    clip(onShare) {
      clips.want(index);
      return clips.url(index, onShare);
    },
    before: () => backend.show(index),
    after: (data) => backend.answer({ index, encoding: clips.encoding, ...data }),
    failed: (error) => failed(stage, texts, error),
    simulation_options: { data: simulation?.answers?.[index] ?? {} },
    on_finish: () => clips.release(index),
  });

  let freeText = {};
  let saved = {};
  const timeline = session.trials.map((_, index) => index).filter((index) => index >= session.next).map(trial);
  timeline.push(page(async (display) => {
    if (questionnaires.after) await ask(display, session, 'after', leave);
    else freeText = await questions(display, texts, leave);
  }));
  timeline.push(page(async (display) => { saved = await save(display, texts, backend, freeText, leave); }));
  timeline.push(page(async (display) => {
    if (document.fullscreenElement) document.exitFullscreen();
    thanks(display, texts, saved, site, nextIfShared);
    return new Promise(() => {});  // the end: stays
  }));
  await (simulation ? jsPsych.simulate(timeline, simulation.mode) : jsPsych.run(timeline));
} catch (error) {
  failed(stage, texts, error);
}
