// SPDX-License-Identifier: GPL-3.0-or-later
// Who is taking part. The token stands behind the # of the address, which no browser sends.

const state = document.getElementById('state');
const table = document.querySelector('table');

const authorization = { Authorization: `Bearer ${location.hash.slice(1)}` };

// Ends a session of somebody who does not come back; the place goes to the next.
async function release({ participant, answered }) {
  if (!confirm(`End the session of ${participant}? ${answered} answers are removed, and the place goes to the next who comes.`)) return;
  const response = await fetch('api/release', {
    method: 'POST', headers: { ...authorization, 'Content-Type': 'application/json' }, body: JSON.stringify({ participant }),
  }).catch(() => null);
  if (!response?.ok && response?.status !== 404) alert('The place could not be released; the server says why where it runs.');
  await refresh();
}

async function refresh() {
  const response = await fetch('api/overview', { headers: authorization, cache: 'no-store' }).catch(() => null);
  if (!response?.ok) {
    state.textContent = response?.status === 401
      ? 'This needs the token: open the address that was printed when the server started.'
      : 'The server does not answer.';
    table.hidden = true;
    return;
  }
  const { running, finished, left } = await response.json();
  state.textContent = `${running.length} running, ${finished} finished, ${left} left since the server started.`;
  table.hidden = running.length === 0;
  const focused = document.activeElement.dataset.participant;
  table.tBodies[0].replaceChildren(...running.map((participant) => {
    const row = document.createElement('tr');
    const time = (utc) => utc.slice(11, 19);
    for (const text of [participant.participant, participant.number, `${participant.answered} of ${participant.trials}`,
      time(participant.started_utc), time(participant.last_seen_utc)]) {
      row.insertCell().textContent = text;
    }
    const button = document.createElement('button');
    button.type = 'button';
    button.className = 'quiet';
    button.textContent = 'Release';
    button.setAttribute('aria-label', `Release the place of ${participant.participant}`);
    button.dataset.participant = participant.participant;
    button.addEventListener('click', () => release(participant));
    row.insertCell().append(button);
    return row;
  }));
  if (focused) table.querySelector(`[data-participant="${focused}"]`)?.focus();
}

refresh();
setInterval(refresh, 2000);
