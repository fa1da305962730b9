// SPDX-License-Identifier: GPL-3.0-or-later
// What can go wrong with whatever keeps the answers.

/** The session ended, here or in another window. */
export class SessionGone extends Error {}

/** That will not be done, and would not be the next time; `status` is HTTP's. */
export class Refused extends Error {
  constructor(status) {
    super(`refused (${status})`);
    this.status = status;
  }
}

export const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

/** What was sent has reached the server, which could not keep it. */
export class NotKept extends Error {}

/**
 * Calls `attempt` until it succeeds or it is clear that it never will. `onTrouble` gets the error while it has not, and
 * null afterwards.
 */
export async function insist(attempt, onTrouble) {
  for (let wait = 500; ; wait = Math.min(2 * wait, 5000)) {  // ms
    try {
      const result = await attempt();
      onTrouble(null);
      return result;
    } catch (error) {
      if (error instanceof SessionGone || error instanceof Refused) {
        onTrouble(null);
        throw error;
      }
      onTrouble(error);
      await pause(wait);
    }
  }
}
