import { describe, expect, it, vi } from 'vitest';
import { Connection, type Listener } from '../src/connection';
import { instant } from '../src/engine/instants';
import { tomlOf } from '../src/engine/files';
import { linkOf, setUpOfLink } from '../src/engine/setup';
import { inBrowser, WorkerSocket, type Engine } from '../src/engine/socket';
import { Visit } from '../src/engine/visit';
import { readFrame, type Ask, type Frame, type Said } from '../src/protocol';
import { CATALOGUE } from './catalogue';
import { golden } from './golden';

type Told<T extends Said['type']> = Extract<Said, { type: T }>;

/** A visit whose clock is this test: it jumps to when the visit wants to be called. */
class Page {
  readonly said: Said[] = [];
  readonly frames: Frame[] = [];
  now = 0;
  drawing = true;
  private due: number | null = null;
  readonly visit: Visit;

  constructor() {
    this.visit = new Visit(CATALOGUE, {
      say: (said) => this.said.push(said),
      show: (data) => this.frames.push(readFrame(data)),
      now: () => this.now,
      later: (wait) => (this.due = this.now + wait),
    });
  }

  ask(...asks: Ask[]): this {
    asks.forEach((ask) => this.visit.hear(ask));
    return this.until(() => this.due === null || this.due > this.now);
  }

  until(enough: () => boolean, most = 5000): this {
    for (let k = 0; k < most && this.due !== null && !enough(); k += 1) {
      this.now = Math.max(this.now, this.due) + 0.01;
      this.due = null;
      const before = this.frames.length;
      this.visit.tick();
      if (this.drawing) this.frames.slice(before).forEach(({ frame }) => this.visit.hear({ do: 'seen', frame }));
    }
    return this;
  }

  last<T extends Said['type']>(type: T): Told<T> {
    return this.said.findLast((said) => said.type === type) as Told<T>;
  }

  get frame(): Frame {
    return this.frames.at(-1)!;
  }
}

const SMALL = { grid: { n_theta: 16, n_z: 16 }, initial: { kind: 'stripes' } };
const small = (): Page => new Page().ask({ do: 'begin', setup: SMALL });

describe('a visit to a cell in the browser', () => {
  it('shows a cell and plays it at its pace', () => {
    const page = small();
    expect(page.last('cell')).toMatchObject({ t: 0, playing: false, begun: 1, fresh: true, catching_up: null, special: {} });
    expect(page.frame).toMatchObject({ t: 0, n_theta: 16, n_z: 16, length: 5, regime: { name: 'cyclosis', boundaries: [2, 2] } });
    expect([...page.frame.records].slice(0, 1)).toEqual([0]);
    page.ask({ do: 'speed', value: 10 }, { do: 'play' }).until(() => page.frame.t >= 2);
    expect(page.frame.t).toBeLessThan(2.5); // pictures are at most 30 a second
    expect(page.now).toBeGreaterThan(190);
    expect(page.now).toBeLessThan(270);
    page.ask({ do: 'pause' });
    const { t } = page.last('cell');
    page.until(() => false, 50);
    expect(page.last('cell').t).toBe(t);
  });

  it('records every frame once', () => {
    const page = small().ask({ do: 'play' });
    page.until(() => page.frame.t >= 1);
    const times = page.frames.flatMap(({ records }) => [...records].filter((_, k) => k % 6 === 0));
    expect(times).toEqual(times.map((_, k) => instant(0.1 * k)));
    expect(times.at(-1)).toBe(page.frame.t);
  });

  it('stops when the page draws nothing, and goes on when it does', () => {
    const page = small().ask({ do: 'play' });
    page.until(() => page.frame.t >= 1);
    page.drawing = false;
    page.until(() => false, 500);
    const { t } = page.frame;
    page.drawing = true;
    page.ask({ do: 'seen', frame: 0 }, { do: 'seen', frame: 0 }).until(() => page.frame.t > t + 1);
    expect(page.frame.t).toBeGreaterThan(t + 1);
  });

  it('undoes what was done last: state, link and records are those before', () => {
    const page = small().ask({ do: 'step' }, { do: 'change', values: { alpha_p: 0.5 } }, { do: 'step' });
    page.until(() => page.frame.t === page.last('cell').t);
    const { t, link, undo } = page.last('cell');
    expect(undo).toBe(1);
    const state = page.frame.P_z.slice();
    page.ask({ do: 'brush', tool: 'wound', points: [[1, 2]], radius: 0.7 }, { do: 'step' }, { do: 'step' });
    expect(page.last('cell').undo).toBe(2);
    page.ask({ do: 'undo' });
    expect(page.last('cell')).toMatchObject({ t, link, undo: 1, fresh: false });
    expect(page.frame).toMatchObject({ t, P_z: state });
    page.ask({ do: 'step' });
    const on = page.last('cell');
    page.until(() => page.frame.t === on.t);
    const other = new Page().ask({ do: 'begin', link: on.link }).until(() => false, 200);
    expect(other.frame).toMatchObject({ t: on.t, P_z: page.frame.P_z });
    page.ask({ do: 'undo' }, { do: 'undo' });
    expect(page.said.filter((said) => said.type === 'refused').length).toBe(1);
    expect(page.last('cell').protocol).toEqual([]);
  });

  it('begins again with the same seed and what the visitor has set', () => {
    const page = small().ask({ do: 'step' }, { do: 'change', values: { alpha_p: 0.25 } }, { do: 'drug', name: 'inhibit_myosin' }, { do: 'step' }, { do: 'again' });
    expect(page.last('cell')).toMatchObject({ t: 0, undo: 0, fresh: true, protocol: [], parameters: { alpha_p: 0.25, alpha_u: 0, kappa: 0.5 } });
    expect(page.last('cell').setup.initial).toEqual(small().last('cell').setup.initial);
  });

  it('keeps units in its set-up, its link and its files, and hands them on to cells without', () => {
    const scales = { radius_um: 500, speed_um_s: 75 };
    const page = small().ask({ do: 'step' }, { do: 'units', scales });
    const { setup, link, t } = page.last('cell');
    expect(setup.scales).toEqual(scales);
    expect(t).toBe(0.1);
    expect(tomlOf(link)).toContain('[scales]\nradius_um = 500\nspeed_um_s = 75\n');
    page.ask({ do: 'begin', link, scales: { radius_um: 1, speed_um_s: 1 } });
    expect(page.last('cell').setup.scales).toEqual(scales);
    page.ask({ do: 'begin', setup: SMALL, scales });
    expect(page.last('cell').setup.scales).toEqual(scales);
    page.ask({ do: 'units', scales: { radius_um: -1, speed_um_s: 1 } });
    expect(page.last('refused').sentence).toContain('radius_um');
    page.ask({ do: 'units', scales: null });
    expect(page.last('cell').setup.scales).toEqual({});
  });

  it('acts on the cell, and its link leads to the same state', () => {
    const page = small().ask(
      { do: 'step' },
      { do: 'change', values: { alpha_p: 0.5 } },
      { do: 'change', values: { kappa: 0.2 } },
      { do: 'brush', tool: 'fragment', points: [[1, 2], [1.2, 2]], radius: 0.7 },
      { do: 'step' },
      { do: 'brush', tool: 'align', points: [[-0.5, 5.5]], radius: 0.8 },
      { do: 'brush', tool: 'wound', points: [[3, 1]], radius: 0.5 },
      { do: 'drug', name: 'inhibit_myosin' },
      { do: 'step' },
      { do: 'drug', name: 'wash_out' },
      { do: 'step' },
    );
    expect(page.said.filter((said) => said.type === 'refused')).toEqual([]);
    const cell = page.last('cell');
    expect(cell.protocol.map(({ text }) => text)).toEqual([
      't = 0.1: alpha_p = 0.5, kappa = 0.2',
      't = 0.1: fragment to 1000 filaments per square, in (disc (theta = 1, z = 2, radius = 0.7) or disc (theta = 1.2, z = 2, radius = 0.7))',
      't = 0.2: align to 0.9 at angle 1.5708, in disc (theta = 5.783, z = 0.5, radius = 0.8)',
      't = 0.2: depolymerise to 0 of P, in disc (theta = 3, z = 1, radius = 0.5)',
      't = 0.2: alpha_u = 0',
      't = 0.3: wash out',
    ]);
    const other = new Page().ask({ do: 'begin', link: cell.link });
    other.until(() => other.last('cell').catching_up === null && other.frame.t === cell.t);
    expect(other.last('cell')).toMatchObject({ t: cell.t, protocol: cell.protocol, link: cell.link });
    for (const field of ['P_theta', 'P_z', 'u_theta', 'u_z'] as const) expect(other.frame[field]).toEqual(page.frame[field]);
  });

  it('opens every preset of a cylinder, and says where the others are', () => {
    for (const { name, tables } of CATALOGUE.presets) {
      const page = new Page().ask({ do: 'begin', preset: name });
      if (tables.model?.kind === 'closed') {
        expect(page.last('refused').sentence, name).toContain('start `cyclosis explore` to see closed cells');
        continue;
      }
      expect(page.last('refused'), name).toBeUndefined();
      expect(page.last('cell').preset).toBe(name);
      expect(page.frame.P_z.every(Number.isFinite), name).toBe(true);
    }
  });

  it('says in a sentence what cannot be', () => {
    const page = small();
    const refused = (ask: Ask): string => {
      page.ask(ask);
      return page.last('refused').sentence;
    };
    expect(refused({ do: 'change', values: { alpha_p: -1 } })).toBe('alpha_p = -1 cannot be used: it must be one number from 0 to 1000; the default is 1.');
    expect(refused({ do: 'begin', link: 'nonsense' })).toContain('copy the whole address');
    expect(refused({ do: 'begin', setup: { grid: { n_theta: 512 } } })).toContain('at most 128 in the explorer');
    expect(refused({ do: 'begin', setup: { parameters: { alpha_q: 1 } } })).toContain('did you mean alpha_p');
    expect(refused({ do: 'begin', setup: { initial: { kind: 'stripes', stripes: 3 } } })).toContain('an even number');
    expect(refused({ do: 'begin', setup: { initial: { kind: 'stripes', seed: 3 } } })).toContain('add it, for noise');
    expect(refused({ do: 'brush', tool: 'wound', points: [[0.2, 0.15]], radius: 0.02 })).toContain('at least one point of the grid');
    expect(refused({ do: 'vacuole', on: true })).toContain('Python');
    expect(page.last('cell').t).toBe(0);
  });

  it('says when a cell diverges, and stops', () => {
    const page = new Page().ask({ do: 'begin', setup: { grid: { n_theta: 16, n_z: 16 }, parameters: { epsilon: 10, alpha_u: 100, d_s: 0 } } }, { do: 'play' });
    page.until(() => page.last('refused') !== undefined);
    expect(page.last('refused').sentence).toContain('diverged');
    expect(page.last('cell').playing).toBe(false);
  });

  it('gives the fingerprint of the state', async () => {
    const page = small().ask({ do: 'hash' });
    await vi.waitFor(() => expect(page.last('hash')?.sha256).toMatch(/^[0-9a-f]{64}$/));
  });

  it('draws another cell with the next seed', () => {
    const page = new Page().ask({ do: 'begin', setup: { grid: SMALL.grid } }, { do: 'new_seed' });
    expect(page.last('cell')).toMatchObject({ begun: 2, setup: { initial: { kind: 'disordered', seed: 1 } } });
  });
});

describe('links', () => {
  for (const { link, tables, steps, t } of golden<{ link: string; tables: Record<string, object>; steps: unknown[]; t: number }[]>('links.json')) {
    it(`of the library open in the browser, and back: t = ${t}`, () => {
      const found = setUpOfLink(link, CATALOGUE);
      expect(found).toEqual({ tables, steps, t });
      expect(setUpOfLink(linkOf(found), CATALOGUE)).toEqual(found);
    });
  }
});

describe('settings', () => {
  it('are written as a configuration for cyclosis run', () => {
    const [{ link }] = golden<[{ link: string }]>('links.json');
    const text = tomlOf(link);
    expect(text).toContain('[parameters]\nalpha_p = 0.25\n');
    expect(text).toContain('[run]\nsave_every = 0.1\nt_end = 3.3\n');
    expect(text).toContain('[[protocol]]\nat = 1\naction = "fragment"\nwhere = { shape = "disc", theta = 0.1, z = 4.9, radius = 0.6 }\n');
    expect(text).toContain('noise_grid = [8, 8]\n');
    expect(text.split('[[protocol]]').length - 1).toBe(8);
  });
});

describe('which engine computes', () => {
  it('is said by the address, or else by the page', () => {
    const page = (content?: string): Document => ({ querySelector: () => (content ? { content } : null) }) as unknown as Document;
    expect(inBrowser('http://a/b/', page())).toBe(false);
    expect(inBrowser('http://a/b/?engine=browser#x', page())).toBe(true);
    expect(inBrowser('http://a/b/', page('browser'))).toBe(true);
    expect(inBrowser('http://a/b/?engine=server', page('browser'))).toBe(false);
  });
});

describe('the socket of a worker', () => {
  it('connects, carries messages, and lets the page begin again when the worker fails', async () => {
    vi.useFakeTimers();
    const engines: (Engine & { sent: unknown[] })[] = [];
    const make = (): Engine => {
      const engine = { sent: [] as unknown[], onmessage: null, onerror: null, postMessage: (data: unknown) => engine.sent.push(data), terminate: vi.fn() };
      engines.push(engine as never);
      return engine as never;
    };
    const told: string[] = [];
    const listener: Listener = {
      begin: (again) => {
        told.push(again ? 'begin again' : 'begin');
        connection.ask({ do: 'play' });
      },
      resumed: () => told.push('resumed'),
      said: (said) => told.push(said.type),
      frame: () => told.push('frame'),
      inside: () => told.push('inside'),
      lost: () => told.push('lost'),
    };
    const connection: Connection = new Connection(listener, () => new WorkerSocket(Promise.resolve(CATALOGUE), make));
    connection.open();
    await vi.advanceTimersByTimeAsync(1);
    const says = (said: object): void => engines.at(-1)!.onmessage!.call(null as never, { data: JSON.stringify(said) } as MessageEvent);
    expect(engines[0]!.sent).toEqual([CATALOGUE, JSON.stringify({ do: 'play', n: 1 })]);
    says({ type: 'welcome', token: 'browser', received: 0, preparing: null });
    says({ type: 'refused', sentence: '' });
    engines[0]!.onerror!.call(null as never, {} as ErrorEvent);
    expect(engines[0]!.terminate).toHaveBeenCalled();
    await vi.advanceTimersByTimeAsync(2000);
    expect(engines.length).toBe(2);
    expect(engines[1]!.sent[1]).toBe(JSON.stringify({ do: 'resume', token: 'browser' }));
    says({ type: 'forgotten' });
    expect(told).toEqual(['begin', 'refused', 'lost', 'begin again']);
    vi.useRealTimers();
  });
});
