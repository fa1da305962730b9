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
  const confirmed = (method, path, body) => insist(() => request(method, path, body), onTrouble);
  return {
    study: () => confirmed('GET', 'api/study', null),

    /** The session that was begun before, with the same id of the site if there is one, or null. */
    async running(ids = {}) {
      recruited = ids;
      const { participant } = stored.read()?.recruited ?? {};
      if (!stored.read() || participant !== ids.participant) return null;
      try {
        return await confirmed('GET', 'api/session', null);
      } catch (error) {
        if (!(error instanceof SessionGone)) throw error;
        stored.write(null);
        return null;
      }
    },

    async start(language) {
      const link = new URLSearchParams(location.search).get('link') ?? '';
      const { token, ...session } = await request('POST', 'api/start', { consent: true, link, ...(language && { language }), ...withIds() });
      stored.write({ token, answers: [], ...withIds() });
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

    /** One attempt; what can be tried again is for the page to say. */
    async save(freeText) {
      const { code, completion = null } = await request('POST', 'api/save', { free_text: freeText });
      stored.write(null);
      return { code, completion };
    },

    /** What this browser knows, for a participant whose answers the server does not take. */
    download: (freeText) => ({ ...stored.read(), free_text: freeText }),

    async startAnew() {
      await this.leave();
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
