import { describe, expect, it, vi } from 'vitest';
import { History } from '../src/panels/history';
import { borders, cellOf, mix, others } from '../src/panels/plane';
import { fromSlider, short, STEPS, toSlider } from '../src/panels/scales';
import { Unseen } from '../src/panels/seen';
import { SpeedMeter } from '../src/panels/speed';
import { debounce, throttle } from '../src/panels/throttle';

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
    expect([short(0), short(0.123456), short(-2), short(1e-5), short(NaN)]).toEqual(['0', '0.123', '−2', '1.00e−5', '–']);
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
