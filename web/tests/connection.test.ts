import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Connection, LOOK, SILENT, type Listener, type Socket } from '../src/connection';
import { made, STALLED, type Far } from '../src/panels/making';
import { place } from '../src/panels/place';
import type { Ask, Said } from '../src/protocol';

/** A socket whose server is this test. */
class Fake implements Socket {
  local = false;
  readyState = 0;
  binaryType: BinaryType = 'blob';
  onopen: Socket['onopen'] = null;
  onclose: Socket['onclose'] = null;
  onmessage: Socket['onmessage'] = null;
  readonly sent: (Ask & { n?: number; token?: string })[] = [];

  send(text: unknown): void {
    this.sent.push(JSON.parse(String(text)) as Ask);
  }

  close(): void {
    this.readyState = 3;
  }

  opens(): void {
    this.readyState = 1;
    this.onopen?.call(this as never, new Event('open'));
  }

  ends(): void {
    this.readyState = 3;
    this.onclose?.call(this as never, new Event('close') as CloseEvent);
  }

  says(said: object): void {
    this.onmessage?.call(this as never, { data: JSON.stringify(said) } as MessageEvent);
  }

  get asked(): string[] {
    return this.sent.map((message) => message.do);
  }
}

describe('a connection', () => {
  let sockets: Fake[];
  let told: string[];
  let connection: Connection;
  const last = (): Fake => sockets.at(-1)!;
  const welcome = { type: 'welcome', token: 'T', received: 0, preparing: null };

  beforeEach(() => {
    vi.useFakeTimers();
    vi.spyOn(Math, 'random').mockReturnValue(0.5);
    sockets = [];
    told = [];
    const listener: Listener = {
      begin: (again) => {
        told.push(again ? 'begin again' : 'begin');
        connection.ask({ do: 'begin', preset: 'figure4' });
      },
      resumed: () => told.push('resumed'),
      said: (said: Said) => told.push(said.type),
      frame: () => told.push('frame'),
      inside: () => told.push('inside'),
      lost: (sentence, over) => told.push(over ? `over: ${sentence}` : 'lost'),
    };
    connection = new Connection(listener, () => {
      sockets.push(new Fake());
      return last();
    });
    connection.open();
    last().opens();
    last().says(welcome);
    last().says({ type: 'cell', done: 1 });
    told = [];
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.restoreAllMocks();
  });

  it('repeats a question whose answer was lost, once the cell is at the time that was shown', () => {
    connection.ask({ do: 'hash' });
    connection.ask({ do: 'curves' });
    last().says({ type: 'curves', curves: [], applies: true });
    last().ends();
    vi.advanceTimersByTime(1000);
    last().opens();
    last().says({ ...welcome, type: 'resumed' });
    expect(last().asked).toEqual(['resume']);
    last().says({ type: 'cell', done: 1, catching_up: 7 });
    expect(last().asked).toEqual(['resume']);
    last().says({ type: 'cell', done: 1, catching_up: null });
    expect(last().asked).toEqual(['resume', 'hash']);
    last().says({ type: 'cell', done: 1, catching_up: null });
    expect(last().asked).toEqual(['resume', 'hash']);
    last().says({ type: 'hash', t: 7, sha256: 'f' });
    last().ends();
    vi.advanceTimersByTime(1000);
    last().opens();
    last().says({ ...welcome, type: 'resumed' });
    last().says({ type: 'cell', done: 1, catching_up: null });
    expect(last().asked).toEqual(['resume']);
  });

  it('answers each word of the server, and is not lost while there are any', () => {
    for (let k = 0; k < 20; k += 1) {
      vi.advanceTimersByTime(1500);
      last().says({ type: 'alive' });
    }
    expect(told).toEqual([]);
    expect(last().asked.filter((what) => what === 'alive')).toHaveLength(20);
  });

  it('is lost within 5 s of silence, and tries again, more and more seldom', () => {
    vi.advanceTimersByTime(SILENT + LOOK);
    expect(SILENT + LOOK).toBeLessThan(5000);
    expect(told).toEqual(['lost']);
    expect(sockets[0]!.readyState).toBe(3);
    const times: number[] = [];
    for (let k = 0; k < 400; k += 1) {
      const count = sockets.length;
      vi.advanceTimersByTime(LOOK);
      if (sockets.length > count) {
        times.push(k * LOOK);
        last().ends(); // refused at once
      }
    }
    const waits = times.slice(1).map((time, k) => time - times[k]!);
    expect(waits.slice(0, 5).every((wait, k) => k === 0 || wait >= waits[k - 1]!)).toBe(true);
    expect(Math.max(...waits)).toBeLessThanOrEqual(15_500);
    expect(times.length).toBeGreaterThan(10);
  });

  it('waits for a worker of the page as long as it takes, and begins again if that fails', () => {
    last().local = true;
    last().says({ type: 'alive' });
    vi.advanceTimersByTime(20 * SILENT);
    connection.check();
    vi.advanceTimersByTime(20 * SILENT);
    expect(told).toEqual([]);
    last().ends();
    expect(told).toEqual(['lost']);
    vi.advanceTimersByTime(20 * SILENT);
    expect(sockets.length).toBeGreaterThan(1);
  });

  it('goes on with its session, and asks again what did not arrive, once and in order', () => {
    connection.ask({ do: 'play' }); // n = 2, arrives
    connection.ask({ do: 'seen', frame: 3 });
    connection.ask({ do: 'pause' });
    connection.ask({ do: 'step' });
    last().ends();
    vi.advanceTimersByTime(2 * LOOK);
    expect(sockets).toHaveLength(2);
    last().opens();
    expect(last().sent).toEqual([{ do: 'resume', token: 'T' }]);
    expect(connection.ask({ do: 'play' })).toBe(false); // not before the session is there
    last().says({ type: 'resumed', token: 'T', received: 2, preparing: null });
    expect(told).toEqual(['lost', 'resumed']);
    expect(last().sent.slice(1)).toEqual([{ do: 'pause', n: 3 }, { do: 'step', n: 4 }]);
    last().says({ type: 'cell', done: 4 });
    last().ends();
    vi.advanceTimersByTime(2 * LOOK);
    last().opens();
    last().says({ type: 'resumed', token: 'T', received: 4, preparing: null });
    expect(last().asked).toEqual(['resume']);
  });

  it('begins again where the session is gone, and does what was not done', () => {
    connection.ask({ do: 'step' });
    last().ends();
    vi.advanceTimersByTime(2 * LOOK);
    last().opens();
    last().says({ type: 'forgotten' });
    expect(told).toEqual(['lost', 'begin again']);
    // The cell is recomputed first: what was asked is done at the time at which it was asked.
    last().says({ type: 'cell', done: 1, catching_up: 7 });
    expect(last().asked).toEqual(['resume', 'begin']);
    last().says({ type: 'cell', done: 1, catching_up: null });
    expect(last().asked).toEqual(['resume', 'begin', 'step']);
  });

  it('begins what was asked for last, where that never arrived', () => {
    connection.ask({ do: 'step' });
    connection.ask({ do: 'begin', preset: 'other' });
    connection.ask({ do: 'play' });
    last().ends();
    vi.advanceTimersByTime(2 * LOOK);
    last().opens();
    last().says({ type: 'forgotten' });
    expect(last().sent.slice(1).map((message) => [message.do, 'preset' in message && message.preset])).toEqual([['begin', 'other'], ['play', false]]);
  });

  it('asks at once when it is looked at again, and waits no longer than 2 s', () => {
    connection.check();
    expect(last().asked.at(-1)).toBe('ping');
    vi.advanceTimersByTime(1500);
    last().says({ type: 'alive' });
    vi.advanceTimersByTime(1500);
    expect(told).toEqual([]);
    connection.check();
    vi.advanceTimersByTime(2000 + LOOK);
    expect(told).toEqual(['lost']);
    connection.check(); // does not wait for its turn
    expect(sockets).toHaveLength(2);
  });

  it('asks before it gives up a connection after a sleep', () => {
    vi.setSystemTime(Date.now() + 3_600_000);
    vi.advanceTimersByTime(LOOK);
    expect(told).toEqual([]);
    expect(last().asked.at(-1)).toBe('ping');
    vi.advanceTimersByTime(2000 + 2 * LOOK);
    expect(told).toEqual(['lost']);
  });

  it('gives up an attempt that nobody answers', () => {
    last().ends();
    for (let k = 0; k < 60; k += 1) vi.advanceTimersByTime(LOOK);
    expect(sockets.length).toBeGreaterThan(3);
  });

  it('does not come back by itself to a session that was ended', () => {
    last().says({ type: 'ended', sentence: 'left alone' });
    last().ends();
    vi.advanceTimersByTime(100_000);
    expect(sockets).toHaveLength(1);
    expect(told).toEqual(['ended', 'over: left alone']);
    connection.open();
    last().opens();
    expect(last().asked).toEqual(['begin']);
  });

  it('comes back to a server that had no place', () => {
    last().ends();
    vi.advanceTimersByTime(2 * LOOK);
    last().opens();
    last().says({ type: 'forgotten' });
    last().says({ type: 'ended', sentence: 'all are taken' });
    last().ends();
    vi.advanceTimersByTime(20_000);
    expect(sockets.length).toBeGreaterThan(2);
    expect(told.filter((what) => what.startsWith('over'))).toEqual([]);
  });
});

describe('a file that is made', () => {
  const answer = (...pieces: string[]): Response =>
    new Response(new ReadableStream({
      start(control) {
        for (const piece of pieces) control.enqueue(new TextEncoder().encode(piece));
        control.close();
      },
    }));

  it('is told of line by line, however the lines are cut, and comes whole', async () => {
    const far: Far[] = [];
    const blob = await made(answer('{"share": null, "doi', 'ng": "waiting"}\n{"share": 0.5, "doing": "computing"}\n{"bytes": 7}\nab', 'cd\nef'), (each) => far.push(each));
    expect(far.slice(0, 2)).toEqual([{ share: null, doing: 'waiting' }, { share: 0.5, doing: 'computing' }]);
    expect(await blob.text()).toBe('abcd\nef');
  });

  it('fails with the reason', async () => {
    await expect(made(answer('{"share": 0.5, "doing": "x"}\n{"sentence": "The disk is full."}\n'), () => undefined)).rejects.toThrow('The disk is full.');
    await expect(made(answer('{"bytes": 9}\nab'), () => undefined)).rejects.toThrow('connection was lost');
    await expect(made(answer('{"share"'), () => undefined)).rejects.toThrow('connection was lost');
  });

  it('fails where nothing comes any more', async () => {
    vi.useFakeTimers();
    const silent = new Response(new ReadableStream({ start: () => undefined }));
    const failing = expect(made(silent, () => undefined)).rejects.toThrow('The server has stopped sending');
    await vi.advanceTimersByTimeAsync(STALLED + 1);
    await failing;
    vi.useRealTimers();
  });
});

describe('the tour’s card', () => {
  const covers = (mark: { top: number; bottom: number }, at: { end: string; scroll: number }, height: number, card: number): boolean => {
    const [low, high] = at.end === 'bottom' ? [height - card, height] : [0, card];
    return mark.bottom - at.scroll > low && mark.top - at.scroll < high;
  };

  it.each([
    [[{ top: 50, bottom: 438 }]],
    [[{ top: 600, bottom: 943 }, { top: 1900, bottom: 1960 }]],
    [[{ top: 50, bottom: 438 }, { top: 438, bottom: 560 }]],
    [[{ top: 2900, bottom: 3300 }]],
  ])('covers none of its marks: %j', (marks) => {
    const found = place(marks, 844, 300, 2600, 0);
    for (const mark of marks) expect(covers(mark, found, 844, 300)).toBe(false);
    expect(marks[0]!.top - found.scroll).toBeGreaterThanOrEqual(0);
    expect(marks[0]!.bottom - found.scroll).toBeLessThanOrEqual(844);
  });

  it('goes to the top where the page cannot be scrolled far enough', () => {
    expect(place([{ top: 900, bottom: 1040 }], 844, 300, 200, 0)).toEqual({ end: 'top', scroll: 200 });
  });
});
