// SPDX-License-Identifier: GPL-3.0-or-later
// As much of a JATOS server and of its jatos.js as the study uses, by what https://www.jatos.org/jatos.js-Reference
// says of them: sessions of the run and of the batch, result data, the two ends of a run.

import { createServer } from 'node:http';

// In the browser. `jatos.js` calls what onLoad was given once it knows the state of the run.
function jatosJs() {
  const call = async (what, body) => {
    const response = await fetch(`fake/${what}`, { method: 'POST', body: JSON.stringify(body ?? null) });
    if (!response.ok) throw new Error(`${what}: ${response.status}`);
    return response.json();
  };
  let batch = null;
  window.jatos = {
    studySessionData: {},
    onLoad(callback) {
      call('state').then((state) => {
        batch = state.batch;
        this.studySessionData = state.session;
        this.componentJsonInput = state.input;
        callback();
      });
    },
    setStudySessionData(data) {
      this.studySessionData = data;
      return call('session', data);
    },
    batchSession: {
      get: (name) => (batch.data[name] === undefined ? undefined : structuredClone(batch.data[name])),
      async set(name, value) {
        const { isDone, now } = await call('batch', { version: batch.version, name, value });
        batch = now;
        if (!isDone) throw new Error('another change came before');
      },
    },
    submitResultData: (data) => call('result', data),
    endStudyWithoutRedirect: () => call('end'),
    abortStudyWithoutRedirect: () => call('abort'),
  };
}

/** Serves the assets of an archive to runs: `address(run)` is where a participant goes. */
export async function fakeJatos({ assets, input }) {
  const runs = new Map();
  const jatos = { runs, batch: { version: 1, data: {} }, failures: 0, intrusions: 0, requests: [] };
  const types = { html: 'text/html', js: 'text/javascript', css: 'text/css', svg: 'image/svg+xml', json: 'application/json', mp4: 'video/mp4' };

  const calls = {
    state: (run) => ({ session: run.session, batch: jatos.batch, input }),
    session(run, data) { run.session = data; },
    batch(run, { version, name, value }) {
      if (jatos.intrusions > 0) {  // another participant is faster
        --jatos.intrusions;
        jatos.batch = { ...jatos.batch, version: jatos.batch.version + 1 };
      }
      const isDone = version === jatos.batch.version;
      if (isDone) jatos.batch = { version: version + 1, data: { ...jatos.batch.data, [name]: value } };
      return { isDone, now: jatos.batch };
    },
    result(run, data) {
      if (jatos.failures-- > 0) throw new Error('the database is full');
      run.result = data;
    },
    end(run) { run.state = 'finished'; },
    abort(run) { Object.assign(run, { state: 'aborted', result: null, session: {} }); },
  };

  const server = createServer((request, response) => {
    const [, , name, , ...rest] = new URL(request.url, 'http://x').pathname.split('/');
    const path = rest.join('/');
    if (!runs.has(name)) runs.set(name, { state: 'started', session: {}, result: null });
    const run = runs.get(name);
    jatos.requests.push({ run: name, path });
    const chunks = [];
    request.on('data', (chunk) => chunks.push(chunk));
    request.on('end', () => {
      if (path.startsWith('fake/')) {
        try {
          const reply = calls[path.slice(5)](run, JSON.parse(Buffer.concat(chunks).toString()));
          response.writeHead(200, { 'Content-Type': 'application/json' }).end(JSON.stringify(reply ?? null));
        } catch (error) {
          response.writeHead(500).end(String(error));
        }
        return;
      }
      const file = path === 'start' ? 'index.html' : path;
      const bytes = file === 'jatos.js' ? Buffer.from(`(${jatosJs})();`) : assets.get(file);
      if (!bytes) return void response.writeHead(404).end();
      response.writeHead(200, { 'Content-Type': types[file.split('.').pop()], 'Content-Length': bytes.length }).end(bytes);
    });
  });
  await new Promise((listening) => { server.listen(0, '127.0.0.1', listening); });
  jatos.address = (run) => `http://127.0.0.1:${server.address().port}/publix/${run}/component/start`;
  jatos.close = () => { server.closeAllConnections(); server.close(); };
  return jatos;
}
