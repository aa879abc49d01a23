import { readFileSync } from 'node:fs';
import { describe, expect, it, vi } from 'vitest';
import { History } from '../src/panels/history';
import { lineOf } from '../src/panels/lines';
import { upAndDown } from '../src/scene/palette';
import { golden } from './golden';
import { borders, cellOf, mix, others } from '../src/panels/plane';
import { fromSlider, short, STEPS, toSlider } from '../src/panels/scales';
import { Unseen } from '../src/panels/seen';
import { SpeedMeter } from '../src/panels/speed';
import { debounce, throttle } from '../src/panels/throttle';
import { roomBeyond, roomFor, tickTexts, USUAL } from '../src/panels/ticks';
import { charted, numbers, pace, seen, title } from '../src/panels/words';
import type { Palette, Regime } from '../src/protocol';

describe('history', () => {
  it('stays bounded, in order, evenly spread, and keeps both ends', () => {
    const history = new History(2, 100);
    for (let i = 0; i < 5000; i += 1) {
      history.push([i, 10 * i]);
      expect(history.length).toBeLessThanOrEqual(101);
      expect(history.columns[0]!.at(-1)).toBe(i);
    }
    const [t, value] = history.columns as [number[], number[]];
    expect(t[0]).toBe(0);
    expect(t.every((at, k) => value[k] === 10 * at)).toBe(true);
    const gaps = t.slice(1, -1).map((at, k) => at - t[k]!);
    expect(new Set(gaps).size).toBe(1);
  });

  it('leaves out rows that do not come later, and begins anew', () => {
    const history = new History(1);
    history.push([0, 1, 1, 0.5, 2]);
    expect(history.columns[0]).toEqual([0, 1, 2]);
    history.clear();
    history.push([0]);
    expect(history.columns[0]).toEqual([0]);
  });
});

describe('a history that is cut', () => {
  it('has the rows up to then, and goes on from there', () => {
    for (const count of [50, 333]) {
      const history = new History(1, 100);
      for (let i = 0; i < count; i += 1) history.push([i]);
      history.cut(40);
      expect(history.columns[0]!.every((t) => t <= 40)).toBe(true);
      const kept = [...history.columns[0]!];
      for (let i = kept.at(-1)! + 1; i < 400; i += 1) history.push([i]);
      const times = history.columns[0]!;
      expect(times[0]).toBe(0);
      expect(times.at(-1)).toBe(399);
      expect(times.length).toBeLessThanOrEqual(101);
      expect(times.every((t, k) => k === 0 || t > times[k - 1]!)).toBe(true);
      history.cut(1000);
      expect(history.columns[0]).toEqual(times);
    }
  });
});

describe('sliders', () => {
  it.each([[[0, 1]], [[0.5, 200]], [[-1.6, 1.6]], [[0.001, 1000]]] as [[number, number]][])('go there and back over %j', (range) => {
    for (let place = 0; place <= STEPS; place += 50) expect(Math.abs(toSlider(fromSlider(place, range), range) - place)).toBeLessThanOrEqual(5);
    expect(fromSlider(0, range)).toBe(range[0]);
    expect(fromSlider(STEPS, range)).toBe(range[1]);
  });

  it('hold values outside at an end', () => {
    expect(toSlider(50, [0, 1])).toBe(STEPS);
    expect(toSlider(-5, [0, 1])).toBe(0);
    expect(toSlider(0, [0.5, 200])).toBe(0);
  });

  it('reads short', () => {
    expect([short(0), short(0.123456), short(-2), short(1e-5), short(NaN)]).toEqual(['0', '0.123', '−2', '1·10⁻⁵', '–']);
  });
});

describe('throttle', () => {
  it('acts at once, then seldom, and always with the last value', () => {
    vi.useFakeTimers();
    const seen: number[] = [];
    const act = throttle((value: number) => seen.push(value), 80);
    for (let i = 0; i < 100; i += 1) {
      act(i);
      vi.advanceTimersByTime(10);
    }
    vi.advanceTimersByTime(200);
    expect(seen[0]).toBe(0);
    expect(seen.at(-1)).toBe(99);
    expect(seen.length).toBeLessThanOrEqual(1 + Math.ceil(1000 / 80) + 1);
    vi.useRealTimers();
  });

  it('waits for quiet', () => {
    vi.useFakeTimers();
    const act = vi.fn();
    const call = debounce(act, 400);
    call();
    vi.advanceTimersByTime(300);
    call();
    vi.advanceTimersByTime(399);
    expect(act).not.toHaveBeenCalled();
    vi.advanceTimersByTime(1);
    expect(act).toHaveBeenCalledOnce();
    vi.useRealTimers();
  });
});

it('answers each frame once, whatever became of it', () => {
  const said: number[] = [];
  const unseen = new Unseen((frame) => said.push(frame));
  [1, 2, 3].forEach((frame) => unseen.came(frame));
  unseen.drawn(2);
  unseen.drawn(2);
  expect(said).toEqual([1, 2]);
  unseen.dropped();
  unseen.dropped();
  expect(said).toEqual([1, 2, 3]);
});

it('measures the speed that is shown', () => {
  const meter = new SpeedMeter(2000);
  for (let i = 0; i <= 100; i += 1) meter.add(i * 50, i * 0.5);
  expect(meter.measured(5000)).toBeCloseTo(10);
  expect(meter.measured(9000)).toBe(0);
});

describe('plane', () => {
  it('borders cells halfway and finds them again', () => {
    const values = [0.025, 0.075, 0.125];
    const edges = borders(values);
    expect(edges.map((edge) => +edge.toFixed(6))).toEqual([0, 0.05, 0.1, 0.15]);
    expect(values.map((value) => cellOf(edges, value))).toEqual([0, 1, 2]);
    expect([cellOf(edges, -1), cellOf(edges, 9)]).toEqual([0, 2]);
  });

  it('mixes colours and names what differs', () => {
    expect(mix('#000000', '#ffffff', 0.5)).toBe('rgb(128 128 128)');
    expect(others({ alpha_p: 1, kappa: 0.5, mu: 0.05 }, { alpha_p: 0, kappa: 0.1, mu: 0.05 })).toEqual(['kappa']);
  });
});

describe('numbers beside a chart', () => {
  // Every letter as wide as a wide one.
  const width = (text: string): number => 7 * text.length;

  it('have as much room as the longest needs, and the usual where they are short', () => {
    for (const ticks of [[0, 2.5e-4, 5e-4], [-1.2e-5, 0, 1.2e-5], [0, 1e-10, 2e-10], [0, 2.5e6], [0, 0.5, 1]]) {
      const texts = tickTexts(ticks);
      const room = roomFor(texts, width);
      for (const text of texts) expect(width(text)).toBeLessThan(room);
    }
    expect(roomFor(tickTexts([0, 0.5, 1]), width)).toBe(USUAL);
    expect(roomFor([], width)).toBe(USUAL);
  });

  it('say small and large numbers in full', () => {
    expect(tickTexts([-2.5e-5, 0, 1.2e-10, 0.05, 250000])).toEqual(['−2.5·10⁻⁵', '0', '1.2·10⁻¹⁰', '0.05', '2.5·10⁵']);
  });

  it('leave half of the last below the axis', () => {
    expect(roomBeyond(['0', 't 100000'], width)).toBeGreaterThanOrEqual(28);
    expect(roomBeyond([], width)).toBeGreaterThan(0);
  });
});

describe('lines of charts', () => {
  const about = ['order', 'mean_P_theta', 'mean_P_z', 'peak_speed', 'power_input', 'P_z', 'u_z'];

  it('have the colours of up and down where their sign is up or down, and others elsewhere', () => {
    for (const name of about) expect(['--ink', '--flow']).toContain(lineOf(name).colour);
    expect(about.filter((name) => lineOf(name).upright)).toEqual(['mean_P_z', 'P_z']);
  });

  it('look the same for one quantity wherever it is drawn, and differ within one chart', () => {
    expect(lineOf('mean_P_z')).toEqual(lineOf('P_z'));
    for (const [a, b] of [['mean_P_theta', 'mean_P_z'], ['P_z', 'u_z']] as const) {
      const [one, other] = [lineOf(a), lineOf(b)];
      expect(one.colour !== other.colour || one.dash.length !== other.dash.length).toBe(true);
    }
  });
});

describe('colours of charts', () => {
  const css = readFileSync(new URL('../src/style.css', import.meta.url), 'utf8');
  const [light, dark] = css.split(":root[data-theme='dark']") as [string, string];
  const luminance = (theme: string, name: string): number => {
    const hex = new RegExp(`--${name}: #([0-9a-f]{6})`).exec(theme)![1]!;
    const [r, g, b] = [0, 2, 4].map((at) => (parseInt(hex.slice(at, at + 2), 16) / 255) ** 2.2) as [number, number, number];
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const contrast = (a: number, b: number): number => (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);

  it('differ in lightness from the page and from each other, for every colour vision', () => {
    for (const theme of [light, dark]) {
      const [paper, ink, flow] = ['paper', 'ink', 'flow'].map((name) => luminance(theme, name)) as [number, number, number];
      expect(contrast(paper, ink)).toBeGreaterThan(10);
      expect(contrast(paper, flow)).toBeGreaterThan(3);
      expect(contrast(ink, flow)).toBeGreaterThan(2.5);
    }
  });

  it('of up and down are seen on the page in every palette, and nothing else of it has them', () => {
    for (const palette of golden<{ palettes: Palette[] }>('colours.json').palettes) {
      for (const [theme, isDark] of [[light, false], [dark, true]] as const) {
        for (const colour of upAndDown(palette, isDark)) {
          expect(contrast(luminance(theme, 'paper'), luminance(`--x: ${colour}`, 'x')), `${palette.name} ${colour}`).toBeGreaterThan(3);
          const others = theme.replace(/--(up|down): #\w+/g, '');
          expect(others).not.toContain(colour);
        }
      }
    }
  });
});

describe('words', () => {
  const regime = (more: Partial<Regime>): Regime => ({
    ...{ name: 'cyclosis', reason: '', zones: [1, 1 + Math.PI], widths: [0.5, 0.5], order: 0.9, around: 0 },
    ...{ boundaries: [2, 2] as [number, number], drift: [0, 0] as [number, number], mean: [0, 0] as [number, number], pace: null },
    ...more,
  });
  const profile = Float32Array.from({ length: 64 }, (_, i) => Math.sin((2 * Math.PI * i) / 64 - 1));

  it('name every state and say what is seen', () => {
    const names = ['disordered', 'unidirectional', 'cyclosis', 'multistripe', 'circumferential', 'travelling', 'undecided'];
    expect(new Set(names.map((name) => title(regime({ name })))).size).toBe(names.length);
    for (const name of names) expect(seen(regime({ name, drift: [0.01, 0] }), profile)).toMatch(/^[A-Z].*\.$/);
    expect(seen(regime({ name: 'undecided', boundaries: [2, 8] }), profile)).toBe('Two to eight boundaries between streams, depending on the height.');
    expect(seen(regime({ name: 'undecided', boundaries: [0, 4] }), profile)).toMatch(/^Up to four/);
    expect(seen(regime({ name: 'unidirectional', mean: [0, -0.9] }), profile)).toMatch(/ down\./);
  });

  it('tell the share of the upward stream', () => {
    expect(seen(regime({}), profile)).toMatch(/equally wide/);
    const narrow = regime({ zones: [1, 2.2566], widths: [0.2, 0.8] });
    expect(seen(narrow, profile.map((_, i) => (i > 10 && i < 23 ? 1 : -1)))).toMatch(/upward one takes 20 %/);
    expect(seen(narrow, profile.map((_, i) => (i > 10 && i < 23 ? -1 : 1)))).toMatch(/upward one takes 80 %/);
  });

  it('say how long changes take, and nothing too early', () => {
    expect(pace(regime({ pace: -0.084 }))).toBe('Settling: changes halve in about 8.3 R/U.');
    expect(pace(regime({ name: 'undecided', pace: -0.084 }))).toBe('Slowing for now: changes halve in about 8.3 R/U.');
    expect(pace(regime({ pace: 0.5 }))).toBe('Under way: changes double in about 1.4 R/U.');
    expect(pace(regime({ pace: 'steady' }))).toMatch(/^Steady/);
    expect(pace(regime({}))).toBe('');
  });

  it('keep rates and counts for those who ask, each with its meaning', () => {
    const told = numbers(regime({ pace: -0.084 }));
    expect(told.map(([name]) => name)).toEqual(['regime', 'order', 'around', 'boundaries', 'widths', 'pace']);
    for (const [, value, meaning] of told) expect(value && meaning).toBeTruthy();
    expect(told.find(([name]) => name === 'pace')![1]).toBe('−0.084 U/R');
  });

  it('explain every chart', () => {
    for (const chart of ['order', 'mean', 'peak', 'power', 'profile']) expect(charted(chart).length).toBeGreaterThan(1);
  });
});

describe('words about closed cells', () => {
  const regime = (name: string, more: Partial<Regime> = {}): Regime => ({
    ...{ name, reason: '', zones: [], widths: [], order: 0.9, around: 0.2, boundaries: [2, 2], drift: [0, 0], mean: [0, 0.5], pace: null },
    ...{ defects: [[1, 0, 0], [1, 3, 8]], circulation: [0, 1, 0] },
    ...more,
  });

  it('say what happens at the ends, in words of their own', () => {
    expect(seen(regime('cyclosis'), [])).toContain('turn over at the ends');
    expect(seen(regime('source-to-sink'), [])).toContain('up from one end');
    expect(seen(regime('source-to-sink', { mean: [0, -0.5] }), [])).toContain('down from one end');
    expect(seen(regime('swirl'), [])).toContain('around the axis');
    expect(seen(regime('circulation'), [])).toContain('one axis');
    for (const name of ['source-to-sink', 'swirl', 'circulation']) expect(title(regime(name))).not.toBe('');
    expect(seen(regime('undecided', { reason: 'a rotation explains 40 % of the flow' }), [])).toContain('droplet');
  });

  it('count the defects and give the circulation', () => {
    const rows = Object.fromEntries(numbers(regime('cyclosis', { defects: [[1, 0, 0], [1, 0, 1], [1, 0, 2], [-1, 0, 3]] })).map(([name, value]) => [name, value]));
    expect(rows.defects).toBe('3 of +, 1 of −');
    expect(rows.circulation).toBe('0, 1, 0');
    expect(numbers(regime('cyclosis', { defects: undefined, circulation: undefined })).map(([name]) => name)).not.toContain('defects');
  });

  it('explain charts that mean something else there', () => {
    expect(charted('mean', false)).not.toEqual(charted('mean'));
    expect(charted('rotation', false).length).toBeGreaterThan(1);
    expect(charted('order', false)).toEqual(charted('order'));
    expect(new Set(['x', 'y', 'z'].map((axis) => lineOf(`mean_vector_${axis}`).dash.join())).size).toBe(3);
    expect(lineOf('mean_vector_z').upright).toBe(true);
    expect(lineOf('circulation_z').upright).toBe(false);
  });
});
