// SPDX-License-Identifier: GPL-3.0-or-later
// A site that sends participants with ids in the address, and wants them back.

import { make } from './make.js';

/** What the study knows of its site; `recruiting` of api/study, or null where there is none. */
export class Site {
  constructor(recruiting, texts) {
    this.recruiting = recruiting;
    this.texts = texts;
    this.ids = {};  // participant and, if they are there, study and session
    const address = new URLSearchParams(location.search);
    for (const [name, parameter] of Object.entries(recruiting?.parameters ?? {})) {
      const id = address.get(parameter);
      if (id) this.ids[name] = id;
    }
  }

  /** Did the participant come without the id that is needed? */
  get isMissing() {
    return this.recruiting !== null && !/^[\w.~-]{1,128}$/.test(this.ids.participant ?? '');
  }

  #link(template, id, text) {
    const href = template.replace(/\{(\w+)\}/g, (slot, name) => encodeURIComponent(this.ids[name] ?? ''));
    return make('a', { href, id, class: 'button' }, text.replace('{site}', new URL(href).host));
  }

  /** The link back for `declined`, `screen_out` or `full`: a list of one, or of none. */
  back(why, text = this.texts.recruiting_back) {
    const template = this.recruiting?.[`${why}_url`];
    return template ? [this.#link(template, `back-${why}`, text)] : [];
  }

  /** What the last page shows of `completion`, which the server tells once the answers are saved. */
  completion(completion) {
    const parts = [];
    if (completion?.code) {
      parts.push(make('p', {}, this.texts.recruiting_code), make('p', { class: 'code', id: 'completion-code' }, completion.code));
    }
    if (completion?.url) {
      parts.push(make('p', {}, this.texts.recruiting_completion),
        make('div', { class: 'row' }, this.#link(completion.url, 'back-completed', this.texts.recruiting_back)));
    }
    return parts;
  }
}
