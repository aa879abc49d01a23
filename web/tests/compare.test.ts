import { describe, expect, it } from 'vitest';
import { linkAt, otherLink, valueIn } from '../src/compare/address';
import { parted, suffix } from '../src/compare/parted';
import { joined } from '../src/compare/chart';
import { called, proposal } from '../src/compare/panel';
import { Pair } from '../src/compare/pair';
import { contentsOf, setUpOf, setUpOfLink, linkOf } from '../src/engine/setup';
import { Visit } from '../src/engine/visit';
import { readFrame, type Ask, type Definition, type Frame, type Said } from '../src/protocol';
import { CATALOGUE } from './catalogue';

const SMALL = { grid: { n_theta: 16, n_z: 16 }, initial: { kind: 'stripes' } };
const WOUND = { at: 0.2, action: 'depolymerise', where: { shape: 'disc', theta: 1, z: 2, radius: 0.5 } };

/** Two engines and a pair, on one clock that jumps to what is due. */
class Both {
  readonly frames: [Frame[], Frame[]] = [[], []];
  readonly said: [Said[], Said[]] = [[], []];
  readonly sent: [Ask[], Ask[]] = [[], []];
  now = 0;
  /** How many times slower the second engine is. */
  private due: { at: number; act: () => void }[] = [];
  private readonly ticks: [number | null, number | null] = [null, null];
  readonly visits: [Visit, Visit];
  readonly pair: Pair;

  constructor(private readonly deaf = new Set<number>()) {
    this.visits = [0, 1].map((k) => new Visit(CATALOGUE, {
      say: (said) => this.said[k]!.push(said),
      show: (data) => {
        const frame = readFrame(data);
        this.frames[k]!.push(frame);
        this.visits[k]!.hear({ do: 'seen', frame: frame.frame });
        this.pair.came(k as 0 | 1, frame.frame);
      },
      now: () => this.now,
      later: (wait) => (this.ticks[k] = this.now + wait),
    })) as [Visit, Visit];
    const send = (k: 0 | 1) => (ask: Ask): void => {
      this.sent[k].push(ask);
      if (!this.deaf.has(k)) this.visits[k].hear(ask);
    };
    this.pair = new Pair([send(0), send(1)], () => 0.1, {
      now: () => this.now,
      later: (act, wait) => void this.due.push({ at: this.now + wait, act }),
    });
    for (const k of [0, 1] as const) {
      const parameters = { alpha_u: k ? 0 : 0.5 };
      this.visits[k].hear({ do: 'begin', setup: { ...SMALL, parameters } });
    }
    this.pair.begin(0);
  }

  run(until: number): this {
    for (let k = 0; k < 20_000; k += 1) {
      const times = [...this.due.map(({ at }) => at), ...this.ticks.filter((at) => at !== null)];
      const next = Math.max(this.now, Math.min(...times));
      if (next > until) break;
      this.now = next + 0.01;
      this.ticks.forEach((at, which) => {
        if (at === null || at > this.now) return;
        this.ticks[which] = null;
        this.visits[which]!.tick();
      });
      const ready = this.due.filter(({ at }) => at <= this.now);
      this.due = this.due.filter(({ at }) => at > this.now);
      ready.forEach(({ act }) => act());
    }
    return this;
  }

  get times(): number[] {
    return this.frames.map((frames) => frames.at(-1)!.t);
  }
}

describe('two cells at one time', () => {
  it('run at the pace of one, and stand still at the same frame', () => {
    const both = new Both();
    both.pair.speed = 10;
    both.pair.play(true);
    both.run(1000);
    both.pair.play(false);
    both.run(1500);
    const [a, b] = both.times;
    expect(a).toBe(b);
    expect(a).toBeGreaterThan(8);
    expect(a).toBeLessThan(10.5);
    both.run(3000);
    expect(both.times).toEqual([a, b]);
  });

  it('have the same done to them at the same time, however it is timed', () => {
    const both = new Both();
    both.pair.speed = 10;
    both.pair.play(true);
    both.run(137);
    const ask: Ask = { do: 'brush', tool: 'wound', points: [[1, 2]], radius: 0.5 };
    both.pair.act(() => both.visits.forEach((visit) => visit.hear(ask)));
    both.run(500);
    both.visits.forEach((visit) => visit.hear({ do: 'tell' }));
    const protocols = both.said.map((said) => (said.findLast(({ type }) => type === 'cell') as Extract<Said, { type: 'cell' }>).protocol);
    expect(protocols[0]).toHaveLength(1);
    expect(protocols[0]).toEqual(protocols[1]);
  });

  it('take one step at a time', () => {
    const both = new Both();
    both.run(100);
    both.pair.step();
    both.run(200);
    both.pair.step();
    both.run(300);
    expect(both.times).toEqual([0.2, 0.2]);
  });

  it('ask again what was lost, and stand still when one cannot go on', () => {
    const deaf = new Set<number>();
    const both = new Both(deaf);
    both.run(100);
    deaf.add(1);
    both.pair.play(true);
    both.run(1000);
    expect(both.times[1]).toBe(0);
    deaf.delete(1);
    both.run(6000);
    expect(both.times[1]).toBeGreaterThan(5);
    deaf.add(1);
    both.run(6500);
    for (let k = 0; k < 3; k += 1) both.pair.refused();
    const { length } = both.sent[1];
    both.run(20_000);
    expect(both.pair.playing).toBe(false);
    expect(both.sent[1]).toHaveLength(length);
  });

  it('follow a cell that is further than was known', () => {
    const both = new Both();
    both.run(100);
    both.visits[0].hear({ do: 'step' });
    both.run(300);
    expect(both.times).toEqual([0.1, 0.1]);
  });
});

describe('an address of two cells', () => {
  const link = linkOf(setUpOf({ ...SMALL, parameters: { alpha_u: 0.5 } }, [
    { at: 0.1, action: 'change', alpha_u: 0.3 }, WOUND, { at: 0.3, action: 'change', alpha_u: 0 }, { at: 0.4, action: 'change', alpha_u: 0.2, over: 1 },
    { at: 2, action: 'change', alpha_p: 0.7 },
  ], 3, CATALOGUE));

  it('has both links and the name', () => {
    const hash = `#${link}${suffix('alpha_u', 'other')}`;
    expect(parted(hash)).toEqual({ link, other: { name: 'alpha_u', link: 'other' } });
    expect(parted(`#${link}`)).toEqual({ link, other: null });
    expect(parted('')).toEqual({ link: '', other: null });
  });

  it('keeps one parameter of the second cell, but for drugs, ramps and regions', () => {
    const other = setUpOfLink(otherLink(link, 'alpha_u', 0.1), CATALOGUE);
    expect(other.tables.parameters).toEqual({ alpha_u: 0.1 });
    expect(other.t).toBe(3);
    expect(other.steps).toEqual([
      { at: 0.1, action: 'change', alpha_u: 0.1 }, WOUND, { at: 0.3, action: 'change', alpha_u: 0 },
      { at: 0.4, action: 'change', alpha_u: 0.2, over: 1 }, { at: 2, action: 'change', alpha_p: 0.7 },
    ]);
    expect(valueIn(otherLink(link, 'zero_theta_flux', true), 'zero_theta_flux')).toBe(true);
    expect(valueIn(link, 'd_s')).toBe(null);
    expect(contentsOf(linkAt(link, 7))).toEqual({ ...contentsOf(link), t: 7 });
  });
});

describe('what a comparison shows', () => {
  const definition = (name: string): Definition =>
    ({ ...CATALOGUE.parameters.find((item) => item.name === name), symbol: name === 'alpha_u' ? 'α_u' : '-', usual: [0, 1] }) as unknown as Definition;

  it('proposes the absence of what the first cell has', () => {
    expect(proposal(definition('alpha_u'), 0.5)).toBe(0);
    expect(proposal(definition('alpha_u'), 0)).toBe(0.5);
    expect(proposal(definition('zero_theta_flux'), false)).toBe(true);
    expect(called(definition('alpha_u'), 0.25)).toBe('α_u = 0.25');
    expect(called(definition('zero_theta_flux'), true)).toBe('zero theta flux = yes');
  });

  it('puts two curves on the times of both', () => {
    expect(joined([[0, 1, 3], [5, 6, 7]], [[0, 2], [8, 9]])).toEqual([[0, 1, 2, 3], [5, 6, null, 7], [8, null, 9, null]]);
  });
});
