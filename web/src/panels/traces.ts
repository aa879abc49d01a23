import uPlot from 'uplot';
import type { Trace } from '../protocol';
import type { Hub } from './hub';
import { h, mathematics } from './dom';
import { History } from './history';
import { short } from './scales';

const SHARED: [RegExp, string][] = [
  [/^mean_P/, 'mean P'],
  [/power|dissipation/, 'power'],
];
const COLOURS = ['--up', '--down', '--ink', '--quiet'];

/** Which columns share a chart: directions of one vector, and all that is power. */
export function grouped(traces: Trace[]): { title: string; columns: number[] }[] {
  const groups = new Map<string, number[]>();
  traces.forEach(({ name }, k) => {
    const title = SHARED.find(([pattern]) => pattern.test(name))?.[1] ?? name.replaceAll('_', ' ');
    groups.set(title, [...(groups.get(title) ?? []), k + 1]);
  });
  return [...groups].map(([title, columns]) => ({ title, columns }));
}

/** A symbol without the brackets of its mean, which the title says. */
const plain = (symbol: string): string => symbol.replace(/[<>⟨⟩]/g, '').replace('theta', 'θ');

/** The recorded numbers over time, and the mean along the axis against the angle. */
export function traces(hub: Hub): HTMLElement {
  const { traces: recorded } = hub.about;
  const history = new History(recorded.length + 1);
  const hosts: [HTMLElement, uPlot, () => uPlot.AlignedData][] = [];
  const add = (title: string, tip: string, x: string, lines: [string, string][], data: () => uPlot.AlignedData, range?: [number, number]): HTMLElement => {
    const host = h('div', { class: 'plot' });
    const keys = lines.map(([name, colour]) => h('span', { class: 'key', style: `--line: var(${colour})` }, name && mathematics(name)));
    const figure = h('figure', { class: 'chart', title: tip }, h('figcaption', {}, h('strong', {}, title), ' ', ...keys), host);
    hosts.push([host, chart(host, x, lines, range), data]);
    return figure;
  };
  const pick = (k: number): Trace => recorded[k - 1]!;
  const charts = grouped(recorded).map(({ title, columns }) =>
    add(title, columns.map((k) => pick(k).meaning).join('; '), 't',
      columns.map((k, i) => [columns.length > 1 ? plain(pick(k).symbol) : '', COLOURS[i % COLOURS.length]!]),
      () => [history.columns[0]!, ...columns.map((k) => history.columns[k]!)] as uPlot.AlignedData));

  let angles = new Float64Array();
  const profile = add('profile', 'means along the axis against the angle θ', 'θ', [['P_z', '--up'], ['u_z', '--down']], () => {
    const frame = hub.frame;
    if (!frame) return [[], [], []];
    if (angles.length !== frame.n_theta) angles = Float64Array.from({ length: frame.n_theta }, (_, i) => (2 * Math.PI * i) / frame.n_theta);
    return [angles, frame.profile_P, frame.profile_u] as unknown as uPlot.AlignedData;
  }, [-1, 1]);

  // Ten times a second is enough for curves, and leaves time for the cell itself.
  let waiting = false;
  const redraw = (): void => {
    if (waiting) return;
    waiting = true;
    setTimeout(() => requestAnimationFrame(() => {
      waiting = false;
      for (const [, plot, data] of hosts) plot.setData(data());
    }), 100);
  };
  hub.on('cell', ({ fresh }) => {
    if (!fresh) return;
    history.clear();
    redraw();
  });
  hub.on('frame', (frame) => {
    history.push(frame.records);
    redraw();
  });
  hub.on('look', () => hosts.forEach(([, plot]) => plot.redraw(false, true)));
  const observer = new ResizeObserver((entries) => {
    for (const { target, contentRect } of entries) {
      const found = hosts.find(([host]) => host === target);
      if (found && contentRect.width > 0) found[1].setSize({ width: contentRect.width, height: Math.max(70, contentRect.height) });
    }
  });
  hosts.forEach(([host]) => observer.observe(host));
  return h('section', { id: 'charts', 'aria-label': 'Traces over time' }, ...charts, profile);
}

function chart(host: HTMLElement, x: string, lines: [string, string][], range?: [number, number]): uPlot {
  const style = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const axis = (): uPlot.Axis => ({
    stroke: () => style('--soft'),
    grid: { stroke: () => style('--line'), width: 1 },
    ticks: { show: false },
    font: '11px system-ui, sans-serif',
    gap: 3,
  });
  return new uPlot({
    width: 200,
    height: 90,
    legend: { show: false },
    cursor: { show: false },
    padding: [6, 16, 0, 0],
    scales: { x: { time: false, ...(range ? { range: [0, 2 * Math.PI] } : {}) }, y: range ? { range: (_, low, high) => [Math.min(range[0], low ?? 0), Math.max(range[1], high ?? 0)] } : {} },
    axes: [
      range
        ? { ...axis(), size: 22, splits: () => [0, Math.PI, 2 * Math.PI], values: () => ['0', `${x} = π`, '2π'] }
        : { ...axis(), size: 22, space: 44, values: (_, ticks) => ticks.map((tick, i) => (i === ticks.length - 1 ? `${x} ${+tick.toPrecision(4)}` : String(+tick.toPrecision(4)))) },
      { ...axis(), size: 40, space: 22, values: (_, ticks) => ticks.map((tick) => short(+tick.toPrecision(6))) },
    ],
    series: [{}, ...lines.map(([, colour]) => ({ stroke: () => style(colour), width: 1.6, points: { show: false } }))],
  }, [[], ...lines.map(() => [])] as unknown as uPlot.AlignedData, host);
}
