// SPDX-License-Identifier: GPL-3.0-or-later
// Who is taking part. The token stands behind the # of the address, which no browser sends.

const state = document.getElementById('state');
const table = document.querySelector('table');

async function refresh() {
  const response = await fetch('api/overview', {
    headers: { Authorization: `Bearer ${location.hash.slice(1)}` }, cache: 'no-store',
  }).catch(() => null);
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
  table.tBodies[0].replaceChildren(...running.map((participant) => {
    const row = document.createElement('tr');
    const time = (utc) => utc.slice(11, 19);
    for (const text of [participant.participant, participant.number, `${participant.answered} of ${participant.trials}`,
      time(participant.started_utc), time(participant.last_seen_utc)]) {
      row.insertCell().textContent = text;
    }
    return row;
  }));
}

refresh();
setInterval(refresh, 2000);
