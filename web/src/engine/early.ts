import type { Socket } from '../connection';
import { isInside, readFrame, type Ask, type Frame } from '../protocol';
import { WorkerSocket } from './socket';

type Heard = MessageEvent<ArrayBuffer | string>;

/**
 * The engine with its first cell, begun before the page can listen: what it says is kept until the page asks for that
 * cell, and then said at once.
 */
export class EarlySocket implements Socket {
  readonly local = true;
  onopen: Socket['onopen'] = null;
  onclose: Socket['onclose'] = null;
  onmessage: Socket['onmessage'] = null;
  /** The first picture; null if there will be none. */
  readonly picture: Promise<Frame | null>;
  private asked = '';
  private kept: Heard[] = [];
  private joined = false;
  private listening = false;

  constructor(private readonly engine: WorkerSocket) {
    this.picture = new Promise((done) => {
      engine.onopen = () => {
        if (this.asked) engine.send(this.asked);
        if (this.joined) this.onopen?.call(this as never, new Event('open'));
      };
      engine.onclose = () => {
        done(null);
        if (this.joined) this.onclose?.call(this as never, new Event('close') as CloseEvent);
      };
      engine.onmessage = (event: Heard) => {
        if (this.listening) {
          this.say(event);
          return;
        }
        this.kept.push(event);
        if (typeof event.data !== 'string') done(isInside(event.data) ? null : readFrame(event.data));
        else if (event.data.startsWith('{"type":"refused"')) done(null);
      };
    });
  }

  get readyState(): number {
    return this.engine.readyState;
  }

  get binaryType(): BinaryType {
    return this.engine.binaryType;
  }

  set binaryType(type: BinaryType) {
    this.engine.binaryType = type;
  }

  /** Begin this cell: the request that the page will make first. */
  begin(ask: Ask): void {
    this.asked = JSON.stringify({ ...ask, n: 1 });
    this.engine.send(this.asked); // or once it is open
  }

  /** The socket for the page's connection, once; afterwards null. */
  join(): EarlySocket | null {
    if (this.joined) return null;
    this.joined = true;
    queueMicrotask(() => {
      if (this.engine.opened) this.onopen?.call(this as never, new Event('open'));
      else if (this.engine.ended) this.onclose?.call(this as never, new Event('close') as CloseEvent);
    });
    return this;
  }

  send(text: string): void {
    const same = text === this.asked;
    if (!this.listening) {
      this.listening = true;
      const kept = this.kept.splice(0);
      // After the request, as if the answers had just come.
      queueMicrotask(() => kept.filter((event) => same || isWelcome(event)).forEach((event) => this.say(event)));
      // Pictures of a cell that is not wanted any more count as seen.
      if (!same) for (const { data } of kept) if (typeof data !== 'string') this.engine.send(JSON.stringify({ do: 'seen', frame: 0 }));
      if (same) return;
    }
    this.engine.send(text);
  }

  close(): void {
    this.engine.close();
  }

  private say(event: Heard): void {
    this.onmessage?.call(this as never, event);
  }
}

function isWelcome({ data }: Heard): boolean {
  return typeof data === 'string' && data.startsWith('{"type":"welcome"');
}
