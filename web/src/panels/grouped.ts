import type { Trace } from '../protocol';
import type { Chart } from './words';

const SHARED: [RegExp, Chart][] = [
  [/^mean_(P|vector)/, 'mean'],
  [/^circulation/, 'rotation'],
  [/power|dissipation/, 'power'],
  [/^peak_speed/, 'peak'],
  [/^order/, 'order'],
];

/** Which columns share a chart: components of one vector, and all powers. */
export function grouped(traces: Trace[]): { chart: string; columns: number[] }[] {
  const groups = new Map<string, number[]>();
  traces.forEach(({ name }, k) => {
    const chart = SHARED.find(([pattern]) => pattern.test(name))?.[1] ?? name;
    groups.set(chart, [...(groups.get(chart) ?? []), k + 1]);
  });
  return [...groups].map(([chart, columns]) => ({ chart, columns }));
}
