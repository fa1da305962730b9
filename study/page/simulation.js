// SPDX-License-Identifier: GPL-3.0-or-later
// Participants who are not there, by jsPsych's simulation mode. A program that drives the browser sets, before the page
// loads, window.simulation = { mode: 'data-only' or 'visual', answers: [{ choice: 'left', ... }, ...] }: for each trial what
// of its data it decides; the rest is drawn. Only a pilot's server lets it, and its answers are marked as a pilot's.

const die = (sides) => 1 + Math.floor(sides * Math.random());
const drawn = () => (Math.random() < 0.5 ? 'left' : 'right');

/** The simulation that the page is to run, or null. */
export const simulationOf = (isPilot) => (isPilot && window.simulation) || null;

/** What the participant decides in one trial: what `given` says, and the rest by dice. */
export function decision({ preference, confidence }, given = {}) {
  const { choice = drawn(), ...rest } = given;
  const grade = { left: -die(3), right: die(3), tie: 0 }[choice];
  return {
    choice, input: 'keyboard', reaction_time_s: 0.3 + Math.random(),
    ...(preference === 'graded' && { preference: grade }), ...(confidence > 0 && { confidence: die(confidence) }), ...rest,
  };
}

/** A trial of which nothing was shown. */
export const unseen = () => ({
  loops_watched: 0, focus_lost_count: 0, frame_count: 0, dropped_frames: 0, playback_errors: [],
  window_width_px: innerWidth, window_height_px: innerHeight, clip_width_px: 0, clip_height_px: 0,
  screen_width_px: screen.width, screen_height_px: screen.height, device_pixel_ratio: devicePixelRatio,
});

/** Presses what the trial in `display` asks for, as it comes, until nothing of it is left. */
export function pressAll(display, { choice, preference, confidence, reaction_time_s: seconds }) {
  const wanted = [preference === undefined ? `#${choice}` : `#grade-${preference + 4}`, `#confidence-${confidence}`, '#where-none', '#reason-next'];
  const trial = display.firstChild;
  const press = () => {
    if (display.firstChild !== trial) return observer.disconnect();
    const button = wanted.map((selector) => trial.querySelector(selector)).find((found) => found && !found.disabled && !found.dataset.pressed);
    if (!button) return undefined;
    button.dataset.pressed = 'yes';
    return setTimeout(() => button.click(), 1000 * seconds);
  };
  const observer = new MutationObserver(press);
  observer.observe(display, { childList: true, subtree: true });
}
