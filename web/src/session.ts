import { Connection, type Socket } from './connection';
import { Reserve } from './engine/reserve';
import { inBrowser } from './engine/socket';
import type { Hub } from './panels/hub';
import { lostBanner } from './panels/notices';
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
  /** Earlier pictures will not be confirmed any more; why there is no connection. */
  lost(sentence: string): void;
  /** The request that begins the first cell. */
  first(): Ask;
  /** The cell is from now on computed in the browser. */
  moved?(): void;
}

/** The page's end of a session: it shows when the connection is lost, and continues from the same state. */
export class Session {
  readonly banner: HTMLElement;
  private readonly connection: Connection;
  private readonly reserve = new Reserve();
  private readonly listening = new AbortController();
  /** Whether the cell has just been taken from the server to the browser. */
  private moving = false;

  constructor(private readonly parts: Parts, make?: () => Socket) {
    const { waits } = parts;
    const banner = lostBanner(() => this.connection.open(), () => this.moveToBrowser());
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
      frame: (frame) => {
        if (!inBrowser()) this.reserve.prepare();
        parts.frame(frame);
      },
      inside: (inside) => parts.inside(inside),
      lost: (sentence, over) => {
        parts.lost(heard(sentence));
        waits.lose(over ? heard(sentence) : say('page.lost'));
        banner.show(heard(sentence), over, this.movable);
      },
    }, make);
    const { signal } = this.listening;
    document.addEventListener('visibilitychange', () => document.hidden || this.connection.check(), { signal });
    for (const name of ['online', 'offline', 'pageshow']) addEventListener(name, () => this.connection.check(), { signal });
    document.addEventListener('resume', () => this.connection.check(), { signal }); // after the browser has frozen the page
    addEventListener('pagehide', ({ persisted }) => persisted || this.connection.leave(), { signal });
  }

  /** Whether requests are received. */
  get isOpen(): boolean {
    return this.connection.isOpen;
  }

  /** Whether the cell can go on in the browser instead: closed cells need the server. */
  private get movable(): boolean {
    return !inBrowser() && this.reserve.ready && this.parts.hub.cell !== null && this.parts.hub.model.straight;
  }

  /** Compute the cell in the browser from now on, from the state that the page shows; its address says so. */
  moveToBrowser(): void {
    if (!this.movable) return;
    const { reserve } = this;
    this.moving = true;
    this.parts.moved?.();
    this.connection.moveTo(() => reserve.socket());
  }

  end(): void {
    this.listening.abort();
    this.connection.end();
    this.reserve.end();
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

  /** Begin the cell that the page shows, or the first one. */
  private begin(again: boolean): void {
    const { hub } = this.parts;
    const { cell, frame } = hub;
    const { scales } = hub;
    const moved = this.moving;
    this.moving = false;
    if (!cell) {
      this.connection.ask({ scales, ...this.parts.first() } as Ask);
      return;
    }
    const t = Math.max(cell.t, frame?.t ?? 0);
    this.connection.ask({ do: 'begin', link: cell.link, t, playing: cell.playing });
    this.connection.ask({ do: 'speed', value: cell.speed });
    if (again) hub.toast(say('page.forgotten', { t: decimals(t, 1) }));
    if (moved) hub.toast(say('page.moved', { t: decimals(t, 1) }));
  }
}
