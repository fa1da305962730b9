// SPDX-License-Identifier: GPL-3.0-or-later
// A jsPsych plugin: two clips in one video, so that both are on the same frame always, and a forced
// choice that can be made once the first loop has ended.

import { askBesides, grade, inputOf } from './after_choice.js';
import { make } from './make.js';
import { decision, pressAll, unseen } from './simulation.js';

const { ParameterType } = jsPsychModule;

let lastSize = null;  // of a clip as it was shown, so that what stands under the next does not jump

export class PairTrial {
  static info = {
    name: 'pair-trial',
    version: '1.0.0',
    parameters: {
      clip: { type: ParameterType.FUNCTION },  // gets a listener of the share that has come; resolves to the address
      texts: { type: ParameterType.COMPLEX },
      remaining: { type: ParameterType.INT },  // trials that count, with this one
      practice: { type: ParameterType.BOOL, default: false },
      options: { type: ParameterType.OBJECT, default: {} },  // what is asked besides the choice
      exit: { type: ParameterType.FUNCTION },  // returns the exit button
      before: { type: ParameterType.FUNCTION },  // awaited before the clip plays
      after: { type: ParameterType.FUNCTION },  // gets the data; awaited before the trial ends
      failed: { type: ParameterType.FUNCTION },
    },
    data: {
      choice: { type: ParameterType.STRING },
      reaction_time_s: { type: ParameterType.FLOAT },
      loops_watched: { type: ParameterType.INT },
    },
  };

  constructor(jsPsych) {
    this.jsPsych = jsPsych;
  }

  trial(display, trial) {
    this.run(display, trial).then((data) => this.jsPsych.finishTrial(data), trial.failed);
  }

  /** jsPsych's simulation: `data` of the options is what the participant decides. */
  simulate(trial, mode, { data: given }, onLoad) {
    const display = this.jsPsych.getDisplayElement();
    const decided = decision(trial.options, given);
    onLoad();
    if (mode === 'visual') {
      this.trial(display, trial);
      pressAll(display, decided);
      return;
    }
    const data = { ...decided, ...unseen() };
    (async () => {
      await trial.before();
      await trial.after(data);
      this.jsPsych.finishTrial(data);
    })().catch(trial.failed);
  }

  async run(display, trial) {
    const view = build(display, trial);
    const url = await trial.clip((share) => view.tell(trial.texts.preload_progress.replace('{percent}', Math.floor(100 * share)), share));
    view.tell(trial.texts.watch_first, 0);
    await trial.before();
    const watch = new Watch(view.video, (share) => view.tell(trial.texts.watch_first, share));
    const unfit = keepFitting(view);
    view.video.src = url;
    play(view, trial.texts, watch);
    try {
      await watch.firstLoop;
    } catch (error) {
      watch.stop();
      unfit();
      throw error;
    }
    const { seconds, ...decision } = await choose(view, trial.texts, trial.options.preference === 'graded');
    const data = { ...decision, reaction_time_s: seconds, ...watch.stop(), ...sizes(view.video) };
    Object.assign(data, await askBesides(view, trial.texts, trial.options));
    unfit();
    await trial.after(data);
    view.video.removeAttribute('src');
    return data;
  }
}

function build(display, { texts, practice, remaining, exit }) {
  const heading = make('h1', { tabindex: -1 }, texts.question);
  const video = make('video', {
    loop: true, muted: true, playsinline: true, preload: 'auto', disablepictureinpicture: true, disableremoteplayback: true,
    'aria-label': texts.clips_label,
  });
  if (lastSize) Object.assign(video.style, lastSize);
  video.muted = true;  // the attribute alone does not count for elements that a script makes
  const words = make('span');
  const bar = make('progress', { max: 1, value: 0, 'aria-label': texts.watch_first });
  const choices = make('div', { class: 'choices' }, make('p', { class: 'wait' }, words, bar));
  if (!lastSize) choices.style.visibility = 'hidden';
  const tell = (text, share) => {
    if (words.textContent !== text) words.textContent = text;
    bar.value = share;
  };
  const spoken = make('p', { class: 'spoken', role: 'status' });
  // One line in every trial, so that all clips have the same size.
  const left = make('p', { id: 'remaining' }, practice ? texts.practice
    : remaining === 1 ? texts.remaining_last : texts.remaining.replace('{count}', remaining));
  // The style puts how many are left, the question and the exit above the clips; the order here is that of the Tab key.
  const top = [heading, left, exit()];
  display.replaceChildren(make('section', { class: 'trial' }, heading, make('div', { class: 'clips' }, video), choices, spoken, ...top.slice(1)));
  heading.focus();
  return { video, choices, spoken, top, tell };
}

// One pixel of the clip on one of the screen where the window allows it, smaller otherwise; but where words are so large
// that little room is left, the page scrolls.
function keepFitting({ video, choices, top }) {
  const notice = document.getElementById('notice');
  const fit = () => {
    if (!video.videoWidth) return;  // what stands under the clips would jump
    const width = video.videoWidth / devicePixelRatio, height = video.videoHeight / devicePixelRatio;  // CSS px
    const heightOf = (element) => element.getBoundingClientRect().height;
    const others = Math.max(...top.map(heightOf)) + heightOf(choices) + heightOf(notice);
    const widest = Math.min(1, document.documentElement.clientWidth / width);
    const scale = Math.min(widest, Math.max((innerHeight - others - 8) / height, widest / 2));
    lastSize = { width: `${width * scale}px`, height: `${height * scale}px` };
    Object.assign(video.style, lastSize);
    choices.style.visibility = 'visible';
    choices.style.width = `${width * scale}px`;  // so that each button is in the middle under its clip
  };
  video.addEventListener('loadedmetadata', fit);
  addEventListener('resize', fit);
  const onNotice = new ResizeObserver(fit);
  onNotice.observe(notice);
  return () => {
    removeEventListener('resize', fit);
    onNotice.disconnect();
  };
}

const mostFailures = 3;  // of a clip to play, before it is given up

// Autoplay without sound is allowed nearly everywhere; where it is not, a button starts the clip. One that cannot be played
// is loaded again; if that does not help, a reload of the page fetches it anew.
function play({ video, choices }, texts, watch) {
  const begin = () => video.play().catch((error) => {
    if (watch.isStopped) return;
    watch.note(`play: ${error.name}`);
    if (error.name !== 'NotAllowedError' || choices.querySelector('#play')) return;
    const wait = choices.firstChild;
    const button = make('button', { type: 'button', id: 'play', onclick() { button.replaceWith(wait); begin(); } }, texts.play);
    wait.replaceWith(button);
  });
  let failures = 0;
  video.addEventListener('error', () => {
    if (watch.isStopped) return;
    watch.note(`error: ${video.error?.code} ${video.error?.message ?? ''}`);
    if (++failures > mostFailures) return watch.giveUp(new Error('the clip cannot be played'));
    video.load();
    begin();
  });
  const isWanted = () => !watch.isStopped && !video.ended && video.currentSrc && !document.hidden;
  // Media keys and the like must not stop it; a hidden page does, since nobody sees it play.
  video.addEventListener('pause', () => {
    if (isWanted()) begin();
  });
  watch.onHidden = () => {
    if (document.hidden) video.pause();
    else if (isWanted()) begin();
  };
  begin();
}

// What happens while a clip plays. `loop` fires no event: the end of a loop shows in time going back. A loop counts if
// it was really shown: time between two frames that came too far apart (the page was hidden, the computer busy) is none.
class Watch {
  static longestStep = 0.5;  // s of the clip from one frame that was shown to the next; timeupdate comes four times a second
  static wholeLoop = 0.9;  // share of a loop that must have been shown

  constructor(video, onProgress) {
    this.video = video;
    this.onProgress = onProgress;  // of the first loop, 0 to 1
    this.onHidden = () => {};
    this.shown = 0;  // s of this loop
    this.loops = 0;
    this.focusLost = 0;
    this.errors = [];
    this.isStopped = false;
    this.isInterrupted = false;  // since the loop began
    this.last = null;  // frame that was seen: { time: s of the clip, at: ms of the clock }
    this.loopGaps = [];  // s
    this.isAway = false;
    this.firstLoop = new Promise((resolve, reject) => { Object.assign(this, { loopEnded: resolve, giveUp: reject }); });
    video.addEventListener('stalled', () => this.note('stalled'));
    this.onAway = () => {
      const isAway = document.hidden || !document.hasFocus();
      if (document.hidden) this.isInterrupted = true;  // a hidden page is given no frames
      this.onHidden();
      if (isAway && !this.isAway) ++this.focusLost;
      this.isAway = isAway;
    };
    this.isAway = document.hidden || !document.hasFocus();
    addEventListener('blur', this.onAway);
    addEventListener('focus', this.onAway);
    document.addEventListener('visibilitychange', this.onAway);
    if (video.requestVideoFrameCallback) {
      const onFrame = (now, { mediaTime, expectedDisplayTime }) => {
        this.saw(mediaTime, expectedDisplayTime);
        if (!this.isStopped) video.requestVideoFrameCallback(onFrame);
      };
      video.requestVideoFrameCallback(onFrame);
    } else {
      video.addEventListener('timeupdate', () => this.saw(video.currentTime, null));
    }
  }

  // A frame of the clip's second `time` is on the screen at `at` ms, or null where the browser does not tell.
  saw(time, at) {
    if (this.isStopped) return;
    const { duration } = this.video;
    const isLoopEnd = this.last && time < this.last.time;
    const step = this.last ? time - this.last.time + (isLoopEnd ? duration : 0) : 0;  // s of the clip
    if (step <= Watch.longestStep) this.shown += step;
    if (this.loops === 0) this.onProgress(Math.min(1, this.shown / duration));
    if (isLoopEnd) {
      if (this.shown >= Watch.wholeLoop * duration) {
        ++this.loops;
        this.loopEnded();
      }
      this.shown = 0;
      // How much longer it took than the clip's own time from the one frame to the other.
      const gap = (at - this.last.at) / 1000 - step;
      if (at !== null && !this.isInterrupted) this.loopGaps.push(gap);
      this.isInterrupted = false;
    }
    this.last = { time, at };
  }

  note(message) {
    if (this.errors.length < 50) this.errors.push(message.slice(0, 200));
  }

  stop() {
    this.isStopped = true;
    removeEventListener('blur', this.onAway);
    removeEventListener('focus', this.onAway);
    document.removeEventListener('visibilitychange', this.onAway);
    const { droppedVideoFrames = 0, totalVideoFrames = 0 } = this.video.getVideoPlaybackQuality?.() ?? {};
    const gaps = [...this.loopGaps].sort((a, b) => a - b);
    return {
      loops_watched: this.loops,
      focus_lost_count: this.focusLost,
      dropped_frames: droppedVideoFrames,
      frame_count: Math.max(totalVideoFrames, droppedVideoFrames),  // dropped ones among them, also where a browser miscounts
      ...(gaps.length > 0 && { loop_gap_median_s: median(gaps), loop_gap_max_s: gaps.at(-1) }),
      playback_errors: this.errors,
    };
  }
}

const median = (sorted) => (sorted[(sorted.length - 1) >> 1] + sorted[sorted.length >> 1]) / 2;

async function choose({ choices, spoken }, texts, isGraded) {
  const since = performance.now();  // ms
  spoken.textContent = texts.choose_now;
  const decision = await (isGraded ? grade(choices, texts) : side(choices, texts));
  return { ...decision, seconds: (performance.now() - since) / 1000 };
}

function side(choices, texts) {
  return new Promise((resolve) => {
    const decide = (choice, input) => {
      removeEventListener('keydown', onKey);
      buttons.forEach((button) => { button.disabled = true; });
      resolve({ choice, input });
    };
    const onKey = (event) => {
      const choice = { ArrowLeft: 'left', ArrowRight: 'right' }[event.key];
      const isOurs = choice && !event.repeat && !event.altKey && !event.ctrlKey && !event.metaKey && !event.shiftKey;
      if (!isOurs || document.querySelector('dialog[open]')) return;
      event.preventDefault();
      decide(choice, 'keyboard');
    };
    const buttons = ['left', 'right'].map((choice) => make('button', {
      type: 'button', id: choice, 'aria-label': `${texts[choice]}: ${texts[`${choice}_label`]}`, onclick: (event) => decide(choice, inputOf(event)),
    }, texts[choice]));
    choices.replaceChildren(buttons[0], make('p', { class: 'arrows hint' }, texts.arrow_hint), buttons[1]);
    addEventListener('keydown', onKey);
  });
}

function sizes(video) {
  const shown = video.getBoundingClientRect();
  return {
    window_width_px: innerWidth, window_height_px: innerHeight,
    clip_width_px: Math.round(shown.width), clip_height_px: Math.round(shown.height),
    screen_width_px: screen.width, screen_height_px: screen.height,
    device_pixel_ratio: devicePixelRatio,
  };
}
