// SPDX-License-Identifier: GPL-3.0-or-later
// A JATOS server in the place of our own, by its jatos.js (https://www.jatos.org/jatos.js-Reference). Who takes part is
// kept in the session of the study run, so that a reload goes on; which plans are taken, in the session of the batch,
// which all participants share. JATOS gives both nobody else, and drops the first when the run ends.

import { Refused, insist, pause } from './errors.js';

/* global jatos */

const longestPause = 24 * 3600 * 1000;  // ms; who has not finished by then gives the plan to another
const alphabet = '0123456789ABCDEFGHJKMNPQRSTVWXYZ';  // Crockford's base 32

const random = (length) => [...crypto.getRandomValues(new Uint8Array(length))];
const hex = (length) => random(length).map((byte) => byte.toString(16).padStart(2, '0')).join('');
const code = () => random(12).map((byte) => alphabet[byte % 32]).join('').replace(/(.{4})(?!$)/g, '$1-');
const now = () => new Date().toISOString();

const loaded = new Promise((resolve) => { jatos.onLoad(resolve); });
const input = () => jatos.componentJsonInput ?? jatos.componentInput;

// Changes what all participants see. JATOS refuses a change that another came before; then it is tried anew.
async function changeTaken(change) {
  for (let attempt = 0; ; ++attempt) {
    const taken = { ...jatos.batchSession.get('taken') };
    const result = change(taken);
    try {
      await jatos.batchSession.set('taken', taken);
      return result;
    } catch (error) {
      if (attempt === 30) throw new Error(`the batch session: ${error}`);
      await pause(100 + 400 * Math.random());
    }
  }
}

// The smallest number that nobody has.
const takeNumber = (participant) => changeTaken((taken) => {
  const isFree = (claim) => !claim || (!claim.done && Date.now() - claim.since > longestPause);
  let number = 0;
  while (!isFree(taken[number])) ++number;
  if (number >= input().participants) throw new Refused(409);
  taken[number] = { participant, since: Date.now(), done: false };
  return number;
});

const giveBack = ({ participant, number }) => changeTaken((taken) => {
  if (taken[number]?.participant === participant) delete taken[number];
});

export function connect(onTrouble) {
  let session = null;
  const keep = () => insist(() => jatos.setStudySessionData({ study: session }), onTrouble);

  // Only the plan of this participant is fetched.
  async function progress() {
    const plan = await insist(async () => {
      const response = await fetch(`plans/${session.number}.json`, { cache: 'no-store' });
      if (!response.ok) throw new Error(`status ${response.status}`);
      return response.json();
    }, onTrouble);
    const open = Object.keys(input().questionnaires ?? {}).filter((part) => !session.questionnaires?.[part]);
    return { trials: plan, next: session.answers.length, questionnaires: open, language: session.language };
  }

  const result = (freeText) => {
    const { shown_utc: unused, ...rest } = session;
    return { format: 'study-answers 1', study: input().study, ...rest, saved_utc: now(), free_text: freeText };
  };

  return {
    async study() {
      await loaded;
      jatos.httpTimeout = 15000;  // ms
      jatos.httpRetry = 1;  // then the page says so, and tries again by itself
      return { language: input().language, texts: input().texts, translations: input().translations, questionnaires: input().questionnaires, trial_options: input().trial_options };
    },

    async running() {
      session = jatos.studySessionData?.study ?? null;
      return session && progress();
    },

    async start(language = input().language) {
      const participant = hex(8);
      session = {
        participant, number: await takeNumber(participant), language, user_agent: navigator.userAgent.slice(0, 1000),
        started_utc: now(), resumed_count: 0, withdrawal_code: code(), answers: [], shown_utc: '',
      };
      await keep();
      return progress();
    },

    async resume() {
      ++session.resumed_count;
      await keep();
      return progress();
    },

    async show() {
      session.shown_utc = now();
      await keep();
    },

    async questionnaire(part, answers) {
      session.questionnaires = { ...session.questionnaires, [part]: answers };
      await keep();
    },

    async answer({ index, ...answer }) {
      session.answers[index] = { shown_utc: session.shown_utc, ...answer };
      await keep();
    },

    /** One attempt; what can be tried again is for the page to say. */
    async save(freeText) {
      await jatos.submitResultData(result(freeText));
      // The answers are safe; the rest is tidying, which must not make it look as if they were not.
      try {
        await changeTaken((taken) => { taken[session.number] = { participant: session.participant, done: true }; });
        await (jatos.endStudyWithoutRedirect ?? jatos.endStudyAjax)(true);  // the latter in old versions
      } catch (error) {
        console.warn(error);
      }
      return { code: session.withdrawal_code };
    },

    download: result,

    async startAnew() {
      await giveBack(session).catch(console.warn);
      session = null;
      await keep();
    },

    /** JATOS then removes everything of this run. */
    async leave() {
      await giveBack(session).catch(console.warn);
      await Promise.resolve((jatos.abortStudyWithoutRedirect ?? jatos.abortStudyAjax)()).catch(console.warn);
    },
  };
}
