import uPlot from 'uplot';
import type { Trace } from '../protocol';
import type { Hub } from './hub';
import { h } from './dom';
import { mathematics } from './mathematics';
import { explain } from './explain';
import { grouped } from './grouped';
import { History } from './history';
import { lineOf } from './lines';
import { OnScreen } from './onscreen';
import { prose } from './prose';
import { short } from './scales';
import { roomBeyond, roomFor, tickTexts } from './ticks';
import { charted } from './words';
import { isKey, said, say } from '../words/say';

const FONT = '11px system-ui, sans-serif';
/** Opacity of the area between a curve and zero, as the last two digits of a colour. */
const WASH = '40';

/** A symbol without the brackets of its mean, which the title mentions. */
const plain = (symbol: string): string => symbol.replace(/[<>⟨⟩]/g, '').replace('theta', 'θ');

/** A curve: the quantity, and its symbol where several share a chart. */
type Curve = [quantity: string, symbol: string];

/** The recorded numbers over time, and on a cylinder the mean along the axis against the angle. */
export function traces(hub: Hub): HTMLElement {
  let { model } = hub;
  let history = new History(model.traces.length + 1);
  let hosts: [HTMLElement, uPlot, () => uPlot.AlignedData][] = [];
  const add = (name: string, meanings: string[], x: string, curves: Curve[], data: () => uPlot.AlignedData, range?: [number, number]): HTMLElement => {
    const host = h('div', { class: 'plot' });
    const key = `charts.${name}`;
    const title = isKey(key) ? say(key) : name.replaceAll('_', ' ');
    const keys = curves.filter(([, symbol]) => symbol).map(([quantity, symbol]) => {
      const { colour, dash, upright } = lineOf(quantity);
      const style = dash.length === 0 ? 'solid' : dash[0]! < 3 ? 'dotted' : 'dashed';
      return h('span', { class: upright ? 'key upright' : 'key', style: `--line: var(${colour}); --dash: ${style}` }, mathematics(symbol));
    });
    const words = explain(title, () => [
      ...charted(name, hub.model.straight, hub.units).map((sentence) => h('p', {}, ...prose(sentence))),
      h('p', { class: 'note' }, say('charts.recorded', { meanings: meanings.join('; ') })),
    ]);
    const figure = h('figure', { class: 'chart' }, h('figcaption', {}, h('strong', {}, title), name === 'peak' && unit, words, ...keys, name === 'profile' && whole), host);
    hosts.push([host, chart(host, x, () => (hub.units.scales ? hub.units.time(history.columns[0]!.at(-1) ?? 0).name : ''), curves.map(([quantity]) => quantity), range), data]);
    return figure;
  };
  const unit = h('span', { class: 'unit' });
  /** What the flow of the profile is counted in. */
  const whole = h('span', { class: 'unit' });
  const inUnits = (speeds: number[]): number[] => (hub.units.scales ? speeds.map((speed) => hub.units.speed.factor * speed) : speeds);
  const named = (): void => {
    unit.textContent = hub.units.scales ? ` (${hub.units.speed.name})` : '';
    whole.textContent = hub.units.scales ? ` / ${short(hub.units.speed.factor)} ${hub.units.speed.name}` : '';
  };
  hub.on('units', () => {
    named();
    redraw();
  });
  let angles = new Float64Array();
  const profile = (): HTMLElement => add('profile', [say('charts.profile-meaning')], 'θ', [['P_z', 'P_z'], ['u_z', 'u_z']], () => {
    const frame = hub.frame;
    if (!frame) return [[], [], []];
    if (angles.length !== frame.n_theta) angles = Float64Array.from({ length: frame.n_theta }, (_, i) => (2 * Math.PI * i) / frame.n_theta);
    return [angles, frame.profile_P, frame.profile_u] as unknown as uPlot.AlignedData;
  }, [-1, 1]);

  /** Times in the unit that suits the last of them. */
  const times = (): number[] => {
    const [all] = history.columns as [number[]];
    const { factor } = hub.units.time(all.at(-1) ?? 0);
    return factor === 1 ? all : all.map((t) => factor * t);
  };
  const section = h('section', { id: 'charts', 'aria-label': say('charts.label') });
  const build = (): void => {
    for (const [host, plot] of hosts) {
      observer.unobserve(host);
      sight.leave(host);
      plot.destroy();
    }
    hosts = [];
    const recorded = model.traces;
    const rows = (history = new History(recorded.length + 1));
    const pick = (k: number): Trace => recorded[k - 1]!;
    const charts = grouped(recorded).map(({ chart, columns }) =>
      add(chart, columns.map((k) => said(`trace.${pick(k).name}`, pick(k).meaning)), 't',
        columns.map((k) => [pick(k).name, columns.length > 1 ? plain(pick(k).symbol) : '']),
        () => [times(), ...columns.map((k) => (chart === 'peak' ? inUnits(rows.columns[k]!) : rows.columns[k]!))] as uPlot.AlignedData));
    section.replaceChildren(...charts, ...(model.straight ? [profile()] : []));
    hosts.forEach(([host]) => {
      observer.observe(host);
      sight.watch(host);
    });
  };
  const observer = new ResizeObserver((entries) => {
    for (const { target, contentRect } of entries) {
      const found = hosts.find(([host]) => host === target);
      if (found && contentRect.width > 0) found[1].setSize({ width: contentRect.width, height: Math.max(70, contentRect.height) });
    }
  });

  const sight = new OnScreen(() => redraw());
  // Ten times per second is enough for curves, and leaves time for the cell itself.
  let waiting = false;
  const redraw = (): void => {
    if (waiting) return;
    waiting = true;
    setTimeout(() => requestAnimationFrame(() => {
      waiting = false;
      for (const [host, plot, data] of hosts) if (sight.has(host)) plot.setData(data());
    }), 100);
  };
  hub.on('cell', (cell) => {
    if (!cell.fresh) {
      // What was undone has not happened.
      history.cut(cell.t);
      return redraw();
    }
    const now = hub.modelOf(cell);
    if (now !== model) {
      model = now;
      build();
    }
    history.clear();
    redraw();
  });
  hub.on('frame', (frame) => {
    history.push(frame.records);
    redraw();
  });
  hub.on('look', () => hosts.forEach(([, plot]) => plot.redraw(false, true)));
  named();
  build();
  return section;
}

const style = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** The width of a text in the font of the charts, in CSS pixels. */
const measured = ((): ((text: string) => number) => {
  let pen: CanvasRenderingContext2D | null = null;
  return (text) => {
    pen ??= document.createElement('canvas').getContext('2d');
    if (!pen) return 7 * text.length;
    pen.font = FONT;
    return pen.measureText(text).width;
  };
})();

/** `x` names the axis; where `unit` is not empty, it follows the last number instead. */
export function chart(host: HTMLElement, x: string, unit: () => string, quantities: string[], range?: [number, number]): uPlot {
  const axis = (): uPlot.Axis => ({
    stroke: () => style('--soft'),
    grid: { stroke: () => style('--line'), width: 1 },
    ticks: { show: false },
    font: FONT,
    gap: 3,
  });
  const below = (ticks: number[]): string[] =>
    range ? ['0', `${x} = π`, '2π'] : ticks.map((tick, i) => (i < ticks.length - 1 ? short(tick, 4) : unit() ? `${short(tick, 4)} ${unit()}` : `${x} ${short(tick, 4)}`));
  let last: string[] = [];
  return new uPlot({
    width: 200,
    height: 90,
    legend: { show: false },
    cursor: { show: false },
    padding: [6, () => roomBeyond(last, measured), 0, 0],
    scales: { x: { time: false, ...(range ? { range: [0, 2 * Math.PI] } : {}) }, y: range ? { range: (_, low, high) => [Math.min(range[0], low ?? 0), Math.max(range[1], high ?? 0)] } : {} },
    axes: [
      {
        ...axis(), size: 22, values: (_, ticks) => (last = below(ticks)),
        ...(range ? { splits: () => [0, Math.PI, 2 * Math.PI] } : { space: 44 }),
      },
      { ...axis(), size: (_, texts) => roomFor(texts ?? [], measured), space: 22, values: (_, ticks) => tickTexts(ticks) },
    ],
    series: [{}, ...quantities.map((quantity) => {
      const { colour, dash, upright } = lineOf(quantity);
      return {
        stroke: upright ? (plot: uPlot) => directions(plot, '') : () => style(colour), width: 1.6, dash, points: { show: false }, spanGaps: true,
        ...(upright ? { fill: (plot: uPlot) => directions(plot, WASH), fillTo: 0 } : {}),
      };
    })],
  }, [[], ...quantities.map(() => [])] as unknown as uPlot.AlignedData, host);
}

/** The colours of up above zero and of down below it, with a sharp border, at some opacity. */
function directions(plot: uPlot, opacity: string): CanvasGradient | string {
  const { top, height } = plot.bbox;
  if (!(height > 0)) return style('--ink');
  const wash = plot.ctx.createLinearGradient(0, top, 0, top + height);
  const zero = (plot.valToPos(0, 'y', true) - top) / height;
  const border = Number.isFinite(zero) ? Math.min(1, Math.max(0, zero)) : 0.5;
  for (const [at, name] of [[0, '--up'], [border, '--up'], [border, '--down'], [1, '--down']] as const) {
    wash.addColorStop(at, style(name) + opacity);
  }
  return wash;
}
