import { describe, expect, it, vi } from 'vitest';
import { Connection, type Listener } from '../src/connection';
import { EarlySocket } from '../src/engine/early';
import { WorkerSocket, type Engine } from '../src/engine/socket';
import { Visit } from '../src/engine/visit';
import { firstCell } from '../src/opening/begin';
import type { About, Ask, Frame, Said } from '../src/protocol';
import { Quality } from '../src/scene/quality';
import { CATALOGUE } from './catalogue';

const SMALL: Ask = { do: 'begin', setup: { grid: { n_theta: 16, n_z: 16 }, initial: { kind: 'stripes' } } };

/** An engine as its worker runs it, and all that it was asked. */
function engine(): { made: Engine; asked: string[]; ended: boolean } {
  const found = { made: null as unknown as Engine, asked: [] as string[], ended: false };
  const tell = (data: unknown): void => found.made.onmessage?.call(found.made as Worker, { data } as MessageEvent);
  let visit: Visit | null = null;
  found.made = {
    onmessage: null,
    onerror: null,
    postMessage: (data: unknown) => {
      if (typeof data === 'string') {
        found.asked.push(data);
        visit?.hear(JSON.parse(data) as Ask);
        return;
      }
      let due: ReturnType<typeof setTimeout> | undefined;
      const own = new Visit(data as typeof CATALOGUE, {
        say: (said) => tell(JSON.stringify(said)),
        show: (bytes) => tell(bytes),
        now: () => performance.now(),
        later: (wait) => {
          clearTimeout(due);
          due = setTimeout(() => own.tick(), wait);
        },
      });
      visit = own;
      tell(JSON.stringify({ type: 'welcome', token: 'browser', received: 0, preparing: null }));
    },
    terminate: () => (found.ended = true),
  };
  return found;
}

/** A connection that asks for one cell. */
function connected(early: EarlySocket, ask: Ask): { said: Said[]; frames: Frame[]; connection: Connection } {
  const [said, frames]: [Said[], Frame[]] = [[], []];
  const listener: Listener = {
    begin: () => connection.ask(ask),
    resumed: () => undefined,
    said: (each) => said.push(each),
    frame: (frame) => {
      frames.push(frame);
      connection.ask({ do: 'seen', frame: frame.frame });
    },
    inside: () => undefined,
    lost: () => undefined,
  };
  const connection = new Connection(listener, () => early.join()!);
  return { said, frames, connection };
}

describe('a cell that is begun before the page can listen', () => {
  it('is computed once, and the page hears of it all that there was to hear', async () => {
    const { made, asked } = engine();
    const early = new EarlySocket(new WorkerSocket(Promise.resolve(CATALOGUE), () => made));
    early.begin(SMALL);
    const first = await early.picture;
    expect(first).toMatchObject({ t: 0, n_theta: 16, length: 5 });
    const page = connected(early, SMALL);
    page.connection.open();
    await vi.waitFor(() => expect(page.frames).toHaveLength(1));
    expect(asked.filter((text) => text.includes('"begin"'))).toHaveLength(1);
    expect(page.said.map(({ type }) => type)).toEqual(['cell']);
    expect(page.frames.map(({ P_z }) => [...P_z])).toEqual([[...first!.P_z]]);
    page.connection.ask({ do: 'step' });
    await vi.waitFor(() => expect(page.frames.at(-1)!.frame).toBe(1));
    page.connection.end();
  });

  it('gives way to another cell that the page asks for', async () => {
    const { made } = engine();
    const early = new EarlySocket(new WorkerSocket(Promise.resolve(CATALOGUE), () => made));
    early.begin(SMALL);
    await early.picture;
    const page = connected(early, { do: 'begin', setup: { grid: { n_theta: 8, n_z: 32 } } });
    page.connection.open();
    await vi.waitFor(() => expect(page.frames.map(({ n_theta, n_z }) => [n_theta, n_z])).toEqual([[8, 32]]));
    // As many pictures as ever are sent ahead: the one that was dropped counts as seen.
    for (let k = 1; k <= 3; k++) {
      page.connection.ask({ do: 'step' });
      await vi.waitFor(() => expect(page.frames.at(-1)!.frame).toBe(k));
    }
    page.connection.end();
  });

  it('waits neither for a refused cell nor for an engine that failed', async () => {
    const refusing = new EarlySocket(new WorkerSocket(Promise.resolve(CATALOGUE), () => engine().made));
    refusing.begin({ do: 'begin', preset: 'no such' });
    expect(await refusing.picture).toBeNull();
    const failing = new EarlySocket(new WorkerSocket(Promise.reject(new Error('no network')), () => engine().made));
    expect(await failing.picture).toBeNull();
  });

  it('is that of the address, else the first preset', () => {
    const about = { presets: [{ name: 'other' }, { name: 'figure4' }], scales: null } as unknown as About;
    expect(firstCell(about, '#abc~alpha_u~def')).toEqual({ do: 'begin', link: 'abc' });
    expect(firstCell(about, '')).toEqual({ do: 'begin', preset: 'figure4' });
  });
});

describe('quality', () => {
  const run = (quality: Quality, rate: number, seconds: number): void => {
    for (let k = 0; k < rate * seconds; k++) quality.count((1000 * k) / rate, 1000 / rate);
  };

  it('stays where pictures are many, and falls to the cheapest where they are few', () => {
    const quality = new Quality();
    run(quality, 30, 20);
    expect(quality.level).toMatchObject({ nth: 1, flat: false });
    run(quality, 15, 3);
    expect(quality.level.flat).toBe(false);
    run(quality, 15, 9);
    expect(quality.level).toMatchObject({ flat: true });
    run(quality, 15, 9);
    expect(quality.level).toMatchObject({ flat: true });
  });

  it('falls sooner where they are very few', () => {
    const [slow, crawling] = [new Quality(), new Quality()];
    run(slow, 15, 2);
    run(crawling, 3, 2.4);
    expect(crawling.ratio).toBeLessThan(slow.ratio);
  });
});
