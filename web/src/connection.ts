import { isInside, readFrame, readInside, type Ask, type Frame, type Inside, type Preparing, type Said } from './protocol';
import { say } from './words/say';

export interface Listener {
  /** A session without a cell: begin one. `again` if the server has lost the previous session. */
  begin(again: boolean): void;
  /** The session continues as it was. */
  resumed(preparing: Preparing | null): void;
  said(said: Said): void;
  frame(frame: Frame): void;
  inside(inside: Inside): void;
  /** There is no connection, and why; `over` if the page does not reconnect by itself. */
  lost(sentence: string, over: boolean): void;
}

/**
 * The part of a WebSocket that is used. One to a worker of this page is `local`: it closes if it fails, and is silent
 * only while the machine is busy.
 */
export type Socket = Pick<
  WebSocket,
  'readyState' | 'binaryType' | 'onopen' | 'onclose' | 'onmessage' | 'send' | 'close'
> & { readonly local?: boolean };

/** Milliseconds: between checks; without a message of the server; to connect; to answer a ping. */
export const LOOK = 500;
export const SILENT = 3500;
export const CONNECTING = 5000;
export const ANSWERING = 2000;
/** A check that comes later than this was held up, like everything else in the page. */
const LATE = 2000;
/** Milliseconds before the first attempt to connect again, and the most between two. */
const SOON = 300;
const LONGEST = 15_000;
const OPEN = 1;
/** Questions: each is repeated over the next connection until the answer, a message of the same name, arrives. */
const QUESTIONS = new Set<string>(['hash', 'curves'] satisfies (Ask['do'] & Said['type'])[]);
/** Requests that the server does not count: questions, and those that need not be repeated. */
const UNCOUNTED = new Set<Ask['do']>(['seen', 'tell', 'hash', 'curves', 'alive', 'ping', 'leave', 'resume', 'reach']);

/** The address of the cell, next to that of this page. */
export function cellAddress(location: { href: string }): string {
  const address = new URL('cell', location.href);
  address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
  address.hash = '';
  address.search = '';
  return address.href;
}

/**
 * A session with the server over one WebSocket after another. Each side sends a message at least every 1.5 s,
 * since a dead connection looks open for minutes. A lost one is replaced, the session continues, and requests
 * that did not arrive are repeated.
 */
export class Connection {
  private socket: Socket | null = null;
  private token = '';
  /** Whether there is a session, so that requests are received. */
  private ready = false;
  private over = false;
  private attempts = 0;
  private deadline = 0;
  private next = Infinity;
  private looked: number;
  private asked = 0;
  private unsure: (Ask & { n: number })[] = [];
  private readonly unanswered = new Map<string, Ask>();
  /** Questions whose answers were lost with a connection. */
  private lost: Ask[] = [];
  /** Requests that wait until a cell that is recomputed is at the time at which they were made. */
  private late: Ask[] = [];
  private ended = '';
  private readonly looking: ReturnType<typeof setInterval>;

  constructor(
    private readonly listener: Listener,
    private make: () => Socket = () => new WebSocket(cellAddress(location)),
    private readonly now: () => number = Date.now, // keeps counting while a machine sleeps
  ) {
    this.looked = now();
    this.looking = setInterval(() => this.look(), LOOK);
  }

  get isOpen(): boolean {
    return this.ready;
  }

  open(): void {
    this.drop();
    this.over = false;
    this.ended = '';
    this.next = Infinity;
    const socket = this.make();
    this.deadline = socket.local ? Infinity : this.now() + CONNECTING;
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onopen = () => {
      this.heard();
      if (this.token) this.send({ do: 'resume', token: this.token });
      else this.begin(false);
    };
    socket.onclose = () => this.lose();
    socket.onmessage = ({ data }: MessageEvent<ArrayBuffer | string>) => {
      this.heard();
      if (typeof data !== 'string') {
        if (isInside(data)) this.listener.inside(readInside(data));
        else this.listener.frame(readFrame(data));
      } else this.hear(JSON.parse(data) as Said);
    };
  }

  /** Continue over other sockets, of another engine: the cell begins there anew, with the requests that did not arrive. */
  moveTo(make: () => Socket): void {
    this.make = make;
    this.token = '';
    this.open();
  }

  /** End the session, and do not come back. */
  end(): void {
    clearInterval(this.looking);
    this.leave();
    this.drop();
    this.over = true;
  }

  /** Send a request; without a session nothing is sent, and false is returned. */
  ask(message: Ask): boolean {
    if (!this.ready) return false;
    if (QUESTIONS.has(message.do)) this.unanswered.set(message.do, message);
    if (UNCOUNTED.has(message.do)) this.send(message);
    else {
      const counted = { ...message, n: (this.asked += 1) };
      this.unsure.push(counted);
      this.send(counted);
    }
    return true;
  }

  /** The page is visible again, or the network has changed: check at once whether the server is there. */
  check(): void {
    if (this.over) return;
    if (!this.socket) this.open();
    else if (this.socket.readyState > OPEN) this.lose();
    else if (this.socket.readyState === OPEN && !this.socket.local) {
      this.send({ do: 'ping' });
      const soon = this.now() + ANSWERING;
      this.deadline = this.deadline > this.now() ? Math.min(this.deadline, soon) : soon;
    }
  }

  /** The page will not come back: the server need not keep its session. */
  leave(): void {
    if (this.ready) this.send({ do: 'leave' });
    this.token = '';
  }

  private look(): void {
    const now = this.now();
    const late = now - this.looked > LATE;
    this.looked = now;
    if (!this.socket) {
      if (now >= this.next) this.open();
    } else if (now > this.deadline) {
      // If this page was held up itself, messages of the server may still be waiting.
      if (late && this.ready) this.check();
      else this.lose();
    }
  }

  private hear(said: Said): void {
    if (said.type === 'alive') this.send({ do: 'alive' });
    else if (said.type === 'welcome') {
      this.token = said.token;
      this.attempts = 0;
    } else if (said.type === 'resumed') {
      this.attempts = 0;
      this.ready = true;
      this.unsure = this.unsure.filter(({ n }) => n > said.received);
      this.listener.resumed(said.preparing);
      this.unsure.forEach((message) => this.send(message));
    } else if (said.type === 'forgotten') {
      this.token = '';
      this.begin(true);
    } else {
      if (said.type === 'ended') this.ended = said.sentence;
      if (said.type === 'cell') {
        this.unsure = this.unsure.filter(({ n }) => n > said.done);
        // A cell that is recomputed up to the time that was shown is not yet the one that was asked about.
        if (said.catching_up === null) {
          this.late.splice(0).forEach((message) => this.ask(message));
          this.lost.splice(0).forEach((question) => this.send(question));
        }
      }
      this.unanswered.delete(said.type);
      this.listener.said(said);
    }
  }

  /** Begin a cell in a new session, and repeat the requests that the previous one never processed. */
  private begin(again: boolean): void {
    this.ready = true;
    const left = [...this.late.splice(0), ...this.unsure.splice(0)];
    const last = left.findLastIndex((message) => message.do === 'begin');
    if (last < 0) {
      this.late = left;
      this.listener.begin(again);
    } else for (const message of left.slice(last)) this.ask(message);
  }

  private send(message: Ask): void {
    if (this.socket?.readyState === OPEN) this.socket.send(JSON.stringify(message));
  }

  private heard(): void {
    this.deadline = this.socket?.local ? Infinity : this.now() + SILENT;
  }

  private drop(): void {
    const { socket } = this;
    this.socket = null;
    this.ready = false;
    this.lost = [...this.unanswered.values()];
    if (!socket) return;
    socket.onopen = socket.onclose = socket.onmessage = null;
    socket.close();
  }

  private lose(): void {
    // Do not reconnect to a server that has ended the session; do if it had no room for it.
    this.over = this.ended !== '' && this.ready && this.token !== '';
    const sentence = this.ended || say('page.away');
    if (this.ended) this.token = '';
    this.drop();
    const wait = Math.min(LONGEST, SOON * 2 ** this.attempts) * (0.75 + 0.5 * Math.random());
    this.attempts += 1;
    this.next = this.over ? Infinity : this.now() + wait;
    this.listener.lost(sentence, this.over);
  }
}
