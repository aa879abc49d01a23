import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Connection, type Listener, type Socket } from '../src/connection';
import type { Catalogue } from '../src/engine/definitions';
import { Reserve } from '../src/engine/reserve';
import { browserAddress, type Engine } from '../src/engine/socket';
import { isEmbedded, wholeAddress } from '../src/panels/embed';
import type { Cell, Hub } from '../src/panels/hub';
import { recordable } from '../src/panels/record';
import { restsWhileHidden } from '../src/panels/rest';
import type { Ask } from '../src/protocol';
import { listen, type Hand } from '../src/scene/gestures';
import { CATALOGUE } from './catalogue';

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe('fingers', () => {
  const told: string[] = [];
  const hand: Hand = {
    start: (x, y) => told.push(`start ${x} ${y}`),
    move: (x, y) => told.push(`move ${x} ${y}`),
    end: () => told.push('end'),
    hover: (at) => at && told.push('hover'),
    pinch: (factor, y, dy) => told.push(`pinch ${factor} ${y} ${dy}`),
  };
  let canvas: EventTarget;
  const does = (type: string, pointerId: number, x: number, y: number, pointerType = 'touch'): void => {
    canvas.dispatchEvent(Object.assign(new Event(type), { pointerId, pointerType, clientX: x, clientY: y, button: 0, shiftKey: false }));
  };

  beforeEach(() => {
    told.length = 0;
    canvas = Object.assign(new EventTarget(), { setPointerCapture: () => undefined, getBoundingClientRect: () => ({ left: 0, top: 0 }) });
    listen(canvas as HTMLElement, hand);
  });

  it('paint nothing when they are two', () => {
    does('pointerdown', 1, 50, 100);
    does('pointermove', 1, 52, 101);
    does('pointerdown', 2, 50, 200);
    does('pointermove', 2, 50, 300);
    vi.advanceTimersByTime(1000);
    does('pointerup', 1, 52, 101);
    does('pointerup', 2, 50, 300);
    expect(told).toEqual([`pinch 2 200 50`]);
  });

  it('begin a drag where they were put down, once it is one', () => {
    does('pointerdown', 1, 50, 100);
    expect(told).toEqual([]);
    does('pointermove', 1, 60, 100);
    does('pointerup', 1, 60, 100);
    expect(told).toEqual(['start 50 100', 'move 60 100', 'end']);
  });

  it('tap, and press without moving', () => {
    does('pointerdown', 1, 5, 5);
    does('pointerup', 1, 5, 5);
    expect(told.splice(0)).toEqual(['start 5 5', 'end']);
    does('pointerdown', 1, 5, 5);
    vi.advanceTimersByTime(200);
    expect(told).toEqual(['start 5 5']);
  });

  it('do nothing if the page scrolls under them', () => {
    does('pointerdown', 1, 5, 5);
    does('pointercancel', 1, 5, 5);
    vi.advanceTimersByTime(1000);
    expect(told).toEqual([]);
  });

  it('are waited for, a mouse is not', () => {
    does('pointerdown', 1, 5, 5, 'mouse');
    expect(told).toEqual(['start 5 5']);
  });
});

class Silent implements Engine {
  onmessage: Engine['onmessage'] = null;
  onerror: Engine['onerror'] = null;
  readonly posted: unknown[] = [];
  ended = false;

  postMessage(message: unknown): void {
    this.posted.push(message);
  }

  terminate(): void {
    this.ended = true;
  }
}

class Deaf implements Socket {
  readyState = 1;
  binaryType: BinaryType = 'blob';
  onopen: Socket['onopen'] = null;
  onclose: Socket['onclose'] = null;
  onmessage: Socket['onmessage'] = null;
  readonly sent: string[] = [];

  send(text: unknown): void {
    this.sent.push(String(text));
  }

  close(): void {
    this.readyState = 3;
  }
}

describe('a cell that goes on in the browser', () => {
  it('has an engine that was loaded before, and the requests that nobody heard', async () => {
    const made: Silent[] = [];
    const reserve = new Reserve(() => Promise.resolve(CATALOGUE), () => (made.push(new Silent()), made.at(-1)!));
    reserve.prepare();
    reserve.prepare();
    expect(made).toHaveLength(1);
    await vi.advanceTimersByTimeAsync(0);
    expect(reserve.ready).toBe(true);

    const lost: string[] = [];
    const socket = new Deaf();
    const listener: Listener = {
      begin: () => connection.ask({ do: 'begin', link: 'L', t: 7, playing: true }),
      resumed: () => undefined, said: () => undefined, frame: () => undefined, inside: () => undefined,
      lost: (sentence) => lost.push(sentence),
    };
    const connection: Connection = new Connection(listener, () => socket);
    connection.open();
    socket.onopen?.call(socket as never, new Event('open'));
    const says = (said: object): void => socket.onmessage?.call(socket as never, { data: JSON.stringify(said) } as MessageEvent);
    says({ type: 'welcome', token: 'T', received: 0, preparing: null });
    says({ type: 'cell', done: 1 });
    connection.ask({ do: 'drug', name: 'cytochalasin' });
    vi.advanceTimersByTime(5000);
    expect(lost).toHaveLength(1);

    connection.moveTo(() => reserve.socket());
    await vi.advanceTimersByTimeAsync(0);
    const [engine] = made;
    expect(engine!.posted[0]).toBe(CATALOGUE);
    const asked = engine!.posted.slice(1).map((text) => JSON.parse(String(text)) as Ask);
    expect(asked.map((ask) => ask.do)).toEqual(['begin']);
    // What nobody heard is done at the time at which it was asked for, which the cell must reach first.
    const answers = (said: object): void => engine!.onmessage?.call(engine as never, { data: JSON.stringify(said) } as MessageEvent);
    answers({ type: 'cell', done: 2, catching_up: 7 });
    expect(engine!.posted).toHaveLength(2);
    answers({ type: 'cell', done: 2, catching_up: null });
    expect(JSON.parse(String(engine!.posted[2]))).toMatchObject({ do: 'drug', name: 'cytochalasin' });
    answers({ type: 'cell', done: 3, catching_up: null });
    expect(engine!.posted).toHaveLength(3);
    expect(asked[0]).toMatchObject({ link: 'L', t: 7, playing: true });
    reserve.socket();
    expect(made).toHaveLength(2);
    connection.end();
    expect(engine!.ended).toBe(true);
    vi.advanceTimersByTime(60_000);
    expect(made).toHaveLength(2);
  });

  it('is not offered when the engine could not be loaded', async () => {
    let tries = 0;
    const engines: Silent[] = [];
    const reserve = new Reserve(() => ((tries += 1) > 1 ? Promise.resolve({} as Catalogue) : Promise.reject(new Error('away'))), () => {
      engines.push(new Silent());
      return engines.at(-1)!;
    });
    reserve.prepare();
    await vi.advanceTimersByTimeAsync(0);
    expect(reserve.ready).toBe(false);
    expect(engines[0]!.ended).toBe(true);
    reserve.prepare();
    await vi.advanceTimersByTimeAsync(0);
    expect(reserve.ready).toBe(true);
  });

  it('has an address that says so', () => {
    expect(browserAddress('https://a.org/b/?x=1#L')).toBe('https://a.org/b/?x=1&engine=browser#L');
  });
});

describe('a page that is not seen', () => {
  it('pauses its cell, and lets it go on once it is seen and connected', () => {
    const page = Object.assign(new EventTarget(), { hidden: false });
    vi.stubGlobal('document', page);
    const asked: string[] = [];
    let tell: (cell: Cell) => void = () => undefined;
    const hub = { cell: { playing: true }, ask: (ask: Ask) => asked.push(ask.do), on: (_: string, act: typeof tell) => (tell = act) };
    let open = true;
    restsWhileHidden(hub as unknown as Hub, () => open);
    const turn = (hidden: boolean): void => {
      page.hidden = hidden;
      page.dispatchEvent(new Event('visibilitychange'));
    };
    turn(true);
    expect(asked).toEqual(['pause']);
    open = false;
    turn(false);
    expect(asked).toEqual(['pause']);
    open = true;
    tell({} as Cell);
    tell({} as Cell);
    expect(asked).toEqual(['pause', 'play']);
    hub.cell.playing = false;
    turn(true);
    turn(false);
    expect(asked).toEqual(['pause', 'play']);
  });
});

describe('a small part of another page', () => {
  it('leads to all of it', () => {
    expect(isEmbedded('https://a.org/?embed#L')).toBe(true);
    expect(isEmbedded('https://a.org/#embed')).toBe(false);
    expect(wholeAddress('M', 'https://a.org/b/?embed&engine=browser#L')).toBe('https://a.org/b/?engine=browser#M');
  });
});

it('a movie is of the first kind that the browser can record', () => {
  expect(recordable((type) => type.startsWith('video/webm'))?.[1]).toBe('webm');
  expect(recordable(() => true)?.[1]).toBe('mp4');
  expect(recordable(() => false)).toBe(undefined);
});
