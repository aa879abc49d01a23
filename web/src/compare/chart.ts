import type uPlot from 'uplot';
import { h } from '../panels/dom';
import { explain } from '../panels/explain';
import { History } from '../panels/history';
import type { Hub } from '../panels/hub';
import { mathematics } from '../panels/mathematics';
import { chart } from '../panels/traces';
import { charted } from '../panels/words';
import { say } from '../words/say';

/** Quantities that are drawn for both cells, as the package records them, and their charts. */
const DRAWN: [name: string, chart: 'order' | 'peak'][] = [['order', 'order'], ['peak_speed', 'peak']];

/** What one cell has recorded. */
export class Records {
  history: History;

  constructor(private readonly hub: Hub) {
    this.history = new History(hub.model.traces.length + 1);
    hub.on('cell', (cell) => {
      if (cell.fresh) this.history = new History(hub.modelOf(cell).traces.length + 1);
      else this.history.cut(cell.t); // what was undone has not happened
    });
    hub.on('frame', (frame) => this.history.push(frame.records));
  }

  /** Times, and one quantity. */
  of(name: string): [number[], number[]] {
    const { columns } = this.history;
    const k = this.hub.model.traces.findIndex((trace) => trace.name === name);
    return [columns[0]!, columns[k + 1] ?? []];
  }
}

/** Both curves in each of a few charts. */
export class BothCharts {
  readonly element = h('section', { id: 'both-charts', 'aria-label': say('compare.charts'), hidden: true });
  private readonly plots: [HTMLElement, uPlot, string][] = [];
  private waiting = false;

  constructor(private readonly first: Records, private readonly second: Records, hub: Hub) {
    const observer = new ResizeObserver((entries) => {
      for (const { target, contentRect: { width, height } } of entries) {
        if (width > 0) this.plots.find(([host]) => host === target)?.[1].setSize({ width, height: Math.max(70, height) });
      }
    });
    for (const [name, of] of DRAWN) {
      const title = say(`charts.${of}`);
      const host = h('div', { class: 'plot' });
      const words = explain(say('compare.of-both', { title }), () => [...charted(of), say('compare.lines')].map((sentence) => h('p', {}, sentence)));
      const keys = ['first', 'second'].map((which) => h('span', { class: 'key', 'data-of': which }));
      this.element.append(h('figure', { class: 'chart' }, h('figcaption', {}, h('strong', {}, title), words, ...keys), host));
      this.plots.push([host, chart(host, 't', () => '', [name, `${name} of the second`]), name]);
      observer.observe(host);
    }
    hub.on('look', () => this.plots.forEach(([, plot]) => plot.redraw(false, true)));
  }

  /** How the cells are called. */
  name(first: string, second: string): void {
    for (const [which, text] of [['first', first], ['second', second]] as const) {
      this.element.querySelectorAll(`[data-of=${which}]`).forEach((key) => {
        if (key.textContent !== text) key.replaceChildren(mathematics(text));
      });
    }
  }

  /** Ten times per second is enough. */
  redraw(): void {
    if (this.waiting || this.element.hidden) return;
    this.waiting = true;
    setTimeout(() => requestAnimationFrame(() => {
      this.waiting = false;
      for (const [, plot, name] of this.plots) plot.setData(joined(this.first.of(name), this.second.of(name)) as uPlot.AlignedData);
    }), 100);
  }
}

type Curve = [times: number[], values: number[]];

/** Two curves on the times of both; where one has no value, null. */
export function joined([t1, y1]: Curve, [t2, y2]: Curve): [number[], (number | null)[], (number | null)[]] {
  const out: [number[], (number | null)[], (number | null)[]] = [[], [], []];
  for (let i = 0, j = 0; i < t1.length || j < t2.length;) {
    const [a, b] = [t1[i] ?? Infinity, t2[j] ?? Infinity];
    out[0].push(Math.min(a, b));
    out[1].push(a <= b ? y1[i++]! : null);
    out[2].push(b <= a ? y2[j++]! : null);
  }
  return out;
}
