// SPDX-License-Identifier: GPL-3.0-or-later
// The study's own server. What it has confirmed is on its disk; what it has not is sent again.

import { NotKept, Refused, SessionGone, insist } from './errors.js';

const storageKey = 'study';
const longestWait = 15000;  // ms, for one reply

// Where storage is forbidden, the session lasts as long as the page.
const stored = {
  value: null,
  read() {
    try {
      return JSON.parse(localStorage.getItem(storageKey)) ?? this.value;
    } catch {
      return this.value;
    }
  },
  write(value) {
    this.value = value;
    try {
      if (value === null) localStorage.removeItem(storageKey);
      else localStorage.setItem(storageKey, JSON.stringify(value));
    } catch { /* kept in this.value */ }
  },
};

async function request(method, path, body) {
  const headers = {};
  const token = stored.read()?.token;
  if (token) headers.Authorization = `Bearer ${token}`;
  if (body) headers['Content-Type'] = 'application/json';
  const response = await fetch(path, {
    method, headers, body: body && JSON.stringify(body), cache: 'no-store', signal: AbortSignal.timeout(longestWait),
  });
  if (response.status === 401) throw new SessionGone();
  if (response.status >= 400 && response.status < 500 && response.status !== 429) throw new Refused(response.status);
  if (response.status === 507) throw new NotKept();
  if (!response.ok) throw new Error(`status ${response.status}`);
  return response.json();
}

export function connect(onTrouble) {
  let recruited = {};  // ids of the site that sent the participant
  const withIds = () => (recruited.participant ? { recruited } : {});
  const link = new URLSearchParams(location.search).get('link') ?? '';
  const confirmed = (method, path, body) => insist(() => request(method, path, body), onTrouble);
  return {
    study: () => confirmed('GET', 'api/study', null),

    /**
     * The session that was begun before, with the same id of the site or the same link if there is one; { saved }, what
     * save() resolved to, if its answers are saved; or null.
     */
    async running(ids = {}) {
      recruited = ids;
      const kept = stored.read();
      const isOther = kept?.recruited?.participant !== ids.participant || (link && kept?.link && link !== kept.link);
      if (!kept || isOther) return null;
      const orGone = (error) => {
        if (!(error instanceof SessionGone)) throw error;
        return null;
      };
      const session = kept.saved ? null : await confirmed('GET', 'api/session', null).catch(orGone);
      if (session) return session;
      const saved = await insist(() => this.save({}), onTrouble).catch(orGone);
      if (saved) return { saved, language: kept.language };
      stored.write(null);
      return null;
    },

    async start(language) {
      const { token, ...session } = await request('POST', 'api/start', { consent: true, link, ...(language && { language }), ...withIds() });
      stored.write({ token, language: session.language, answers: [], ...(link && { link }), ...withIds() });
      return session;
    },

    resume: () => confirmed('POST', 'api/resume', {}),
    show: (index) => confirmed('POST', 'api/show', { index }),

    async answer(sent) {
      const { answers, ...kept } = stored.read();
      stored.write({ ...kept, answers: [...answers.filter(({ index }) => index !== sent.index), sent] });
      await confirmed('POST', 'api/answer', sent);
    },

    /** The answers of one part of the questionnaires. */
    async questionnaire(part, answers) {
      const kept = stored.read();
      stored.write({ ...kept, questionnaires: { ...kept.questionnaires, [part]: answers } });
      await confirmed('POST', 'api/questionnaire', { part, answers });
    },

    /** One attempt; what can be tried again is for the page to say. Then only what gives the same reply again is kept. */
    async save(freeText) {
      const { token } = stored.read() ?? {};
      const { code, completion = null } = await request('POST', 'api/save', { free_text: freeText });
      const kept = stored.read();  // of somebody else, if that began in another window meanwhile
      if (kept?.token === token) stored.write({ ...kept, answers: [], questionnaires: {}, saved: true });
      return { code, completion };
    },

    /** For the next participant at this browser. */
    forget: () => stored.write(null),

    /**
     * What this browser knows, for a participant whose answers the server does not take; but for the secret and the link, by
     * which whoever is sent it could go on in the participant's place.
     */
    download(freeText) {
      const { token, link: unused, ...rest } = stored.read();
      return { participant: token.split('.')[0], ...rest, free_text: freeText };
    },

    startAnew() {
      return this.leave();
    },

    /** Keeps nothing; what was saved before is kept, and then it resolves to what save() does. */
    async leave() {
      try {
        await request('POST', 'api/leave', {});
      } catch (error) {
        if (error instanceof Refused && error.status === 409) return this.save({});
        // What is not saved is no answer, and is dropped when it is not seen for a while.
      }
      stored.write(null);
      return {};
    },
  };
}
