import { Connection, type Socket } from './connection';
import type { Hub } from './panels/hub';
import { lostBanner } from './panels/notices';
import { firstPreset } from './panels/story';
import type { Waits } from './panels/waits';
import type { Ask, Frame, Inside, Said } from './protocol';
import { decimals } from './panels/scales';
import { heard, say } from './words/say';

interface Parts {
  hub: Hub;
  waits: Waits;
  said(said: Said): void;
  frame(frame: Frame): void;
  inside(inside: Inside): void;
  /** Earlier pictures will not be confirmed any more. */
  lost(): void;
}

/** The page's end of a session: it shows when the connection is lost, and continues from the same state. */
export class Session {
  readonly banner: HTMLElement;
  private readonly connection: Connection;

  constructor(private readonly parts: Parts, make?: () => Socket) {
    const { waits } = parts;
    const banner = lostBanner(() => this.connection.open());
    this.banner = banner.element;
    const there = (): void => {
      banner.hide();
      waits.lose('');
    };
    this.connection = new Connection({
      begin: (again) => {
        there();
        this.begin(again);
      },
      resumed: (preparing) => {
        there();
        waits.prepare(preparing);
      },
      said: (said) => {
        if (said.type === 'preparing') waits.prepare(said);
        else if (said.type === 'prepared') waits.prepare(null);
        else if (said.type !== 'ended') parts.said(said);
      },
      frame: (frame) => parts.frame(frame),
      inside: (inside) => parts.inside(inside),
      lost: (sentence, over) => {
        parts.lost();
        waits.lose(over ? heard(sentence) : say('page.lost'));
        banner.show(heard(sentence), over);
      },
    }, make);
    document.addEventListener('visibilitychange', () => document.hidden || this.connection.check());
    for (const name of ['online', 'offline', 'pageshow']) addEventListener(name, () => this.connection.check());
    document.addEventListener('resume', () => this.connection.check()); // after the browser has frozen the page
    addEventListener('pagehide', ({ persisted }) => persisted || this.connection.leave());
  }

  open(): void {
    this.connection.open();
  }

  /** Send a request to the cell, or show why that is impossible. */
  ask(message: Ask): void {
    const why = this.parts.waits.refuses(message);
    if (why === '') this.connection.ask(message);
    else if (message.do !== 'seen' && message.do !== 'tell') this.parts.hub.toast(why);
  }

  /** Begin the cell that the page shows, or that of its address, or the first of the presets. */
  private begin(again: boolean): void {
    const { hub } = this.parts;
    const { cell, frame } = hub;
    const { scales } = hub;
    if (cell) {
      const t = Math.max(cell.t, frame?.t ?? 0);
      this.connection.ask({ do: 'begin', link: cell.link, t, playing: cell.playing });
      this.connection.ask({ do: 'speed', value: cell.speed });
      if (again) hub.toast(say('page.forgotten', { t: decimals(t, 1) }));
      return;
    }
    const link = location.hash.slice(1);
    const preset = firstPreset(hub.about.presets)?.name;
    this.connection.ask(link ? { do: 'begin', link, scales } : preset ? { do: 'begin', preset, scales } : { do: 'begin', setup: {}, scales });
  }
}
