import { instant } from '../engine/instants';
import { chosenEngine } from '../engine/socket';
import { h } from '../panels/dom';
import type { Cell, Hub } from '../panels/hub';
import { mathematics } from '../panels/mathematics';
import type { Ask, Frame, Said } from '../protocol';
import type { Scene, Tool } from '../scene/scene';
import { heard, say } from '../words/say';
import { linkAt, otherLink, valueIn, type Value } from './address';
import { suffix, type Address } from './parted';
import { BothCharts, Records } from './chart';
import { Pair } from './pair';
import { called, comparePanel, type ComparePanel } from './panel';
import { Second } from './second';

export interface Parts {
  hub: Hub;
  scene: Scene;
  app: HTMLElement;
  stage: HTMLElement;
  charts: HTMLElement;
  /** Send a request to the first cell. */
  ask(ask: Ask): void;
  /** Show the cell from outside. */
  close(): void;
}

interface On {
  name: string;
  value: Value;
  pair: Pair;
}

/** Two cells side by side, of the same seed and at the same time, in which one parameter differs. */
export class Comparison {
  readonly panel: ComparePanel;
  private on: On | null = null;
  private second: Second | null = null;
  private charts: BothCharts | null = null;
  private readonly records: Records;
  private readonly labels = [h('p', { id: 'label-first', class: 'label' }), h('p', { id: 'label-second', class: 'label', role: 'status' })] as const;
  /** The second cell as the address has it, until the first one has begun. */
  private coming: Address['other'];
  private tool: [Tool, number] = ['turn', 0.4];
  /** The first cell has been asked to stand still, for a comparison to begin. */
  private resting: { link?: string } | null = null;
  /** How many interventions could be undone before the first cell was asked to undo one: the second begins anew then. */
  private undoing: number | null = null;

  constructor(private readonly parts: Parts, opened: Address) {
    const { hub } = parts;
    this.coming = opened.other;
    this.records = new Records(hub);
    this.panel = comparePanel(hub, {
      begin: (name, value) => this.begin(name, value),
      change: (value) => this.on && this.begin(this.on.name, value),
      end: () => this.end(),
    });
    hub.on('look', () => this.second?.repaint());
  }

  /** Another address: the second cell in it, if there is one, is begun once the first one has begun. */
  open(other: Address['other']): void {
    this.end();
    this.coming = other;
  }

  /** Whether a request of the page is dealt with here. */
  asks(ask: Ask): boolean {
    const { on, second } = this;
    if (!on || !second) return false;
    const { pair } = on;
    const both = (other: Ask = ask): void => pair.act(() => {
      this.parts.ask(ask);
      second.ask(other);
    });
    switch (ask.do) {
      case 'play':
      case 'pause':
        pair.play(ask.do === 'play');
        pair.act(() => this.parts.ask({ do: 'tell' }));
        break;
      case 'step':
        pair.step();
        pair.act(() => this.parts.ask({ do: 'tell' }));
        break;
      case 'speed':
        pair.speed = ask.value;
        break;
      case 'change':
        both(on.name in ask.values ? { ...ask, values: { ...ask.values, [on.name]: on.value } } : ask);
        return true;
      case 'drug':
      case 'brush':
      case 'units':
        both();
        return true;
      case 'undo':
        pair.act(() => {
          this.undoing = this.parts.hub.cell?.undo ?? null;
          this.parts.ask(ask);
        });
        return true;
      default:
        return false;
    }
    this.retell();
    return true;
  }

  /** What the first cell says, with the pace of both. */
  hears(said: Said): Said {
    const { on } = this;
    if (said.type === 'refused') {
      on?.pair.refused();
      if (this.resting) queueMicrotask(() => this.end()); // a cell that cannot go on
    }
    if (said.type !== 'cell') return said;
    if (said.fresh && this.coming) {
      const { name, link } = this.coming;
      this.coming = null;
      const value = this.parts.hub.about.parameters.some((each) => each.name === name) ? valueIn(link, name) : null;
      if (value !== null) queueMicrotask(() => this.begin(name, value, link)); // once the page knows of the first cell
    } else if (on && (said.fresh || (this.resting && !said.playing) || (this.undoing !== null && said.undo < this.undoing))) {
      const { link } = this.resting ?? {};
      this.resting = this.undoing = null;
      queueMicrotask(() => this.follow(undefined, link));
    }
    return on ? ({ ...said, playing: on.pair.playing, speed: on.pair.speed } satisfies Cell) : said;
  }

  /** A picture of the first cell was shown. */
  came(frame: Frame): void {
    this.on?.pair.came(0, frame.frame);
    this.charts?.redraw();
  }

  setTool(tool: Tool, radius: number): void {
    this.tool = [tool, radius];
    this.second?.setTool(tool, radius);
  }

  /** The first cell has been taken to the browser: the second one as well. */
  moved(): void {
    this.second?.moveToBrowser();
  }

  /** The pictures of the cells that are shown, drawn now. */
  canvases(everything: boolean): HTMLCanvasElement[][] {
    const scenes = this.on && this.second ? [this.parts.scene, this.second.scene] : [this.parts.scene];
    return scenes.flatMap((scene) => scene.canvases(everything));
  }

  get active(): boolean {
    return this.on !== null;
  }

  /** The second cell for the page's statistics. */
  get other(): { t: number; link: string } | null {
    const cell = this.on && this.second?.hub.cell;
    return cell ? { t: this.second?.hub.frame?.t ?? cell.t, link: cell.link } : null;
  }

  private begin(name: string, value: Value, link?: string): void {
    const { hub, scene, ask } = this.parts;
    const { cell } = hub;
    if (!cell) return;
    if (this.on) {
      Object.assign(this.on, { name, value });
      this.follow(this.on.pair.target);
      return;
    }
    const second = (this.second ??= this.made());
    this.parts.close();
    const pair = new Pair([ask, (each) => second.hub.cell && second.ask(each)], () => this.every);
    pair.speed = cell.speed;
    pair.playing = cell.playing;
    this.on = { name, value, pair };
    this.dress();
    // On a telephone the pictures are at the top of the page.
    if (document.documentElement.scrollHeight > innerHeight) scrollTo({ top: 0 });
    second.setTool(...this.tool);
    second.scene.stance = scene.stance;
    this.resting = { link };
    ask({ do: 'pause' });
  }

  /** Begin the second cell anew, up to the frame at which the first one will stand still. */
  private follow(frame?: number, link?: string): void {
    const { on, second } = this;
    const { cell } = this.parts.hub;
    if (!on || !second || !cell) return;
    const target = frame ?? Math.round((cell.catching_up ?? cell.t) / this.every);
    on.pair.begin(target);
    this.parts.ask({ do: 'reach', frame: target });
    second.begin(linkAt(link ?? otherLink(cell.link, on.name, on.value), instant(target * this.every)), chosenEngine());
    this.dress();
  }

  private end(): void {
    const { on, parts } = this;
    if (!on) return;
    on.pair.end();
    this.on = this.resting = null;
    this.second?.end();
    parts.ask({ do: 'speed', value: on.pair.speed });
    parts.ask({ do: on.pair.playing ? 'play' : 'tell' });
    this.dress();
    this.retell();
  }

  private made(): Second {
    const { hub, scene, app, stage, charts } = this.parts;
    stage.append(...this.labels);
    const second = new Second(stage, hub.about, {
      cell: () => this.retell(),
      frame: (frame) => {
        this.on?.pair.came(1, frame.frame);
        this.charts?.redraw();
        this.label();
      },
      refused: (sentence) => {
        this.on?.pair.refused();
        hub.toast(`${say('compare.second')}: ${heard(sentence)}`);
      },
      lost: (sentence) => hub.toast(`${say('compare.second')}: ${heard(sentence)}`),
    }, hub.toast);
    this.charts = new BothCharts(this.records, new Records(second.hub), hub);
    charts.after(this.charts.element);
    // Turning one cell turns both.
    scene.onView = () => this.on && (second.scene.stance = scene.stance);
    second.scene.onView = () => this.on && (scene.stance = second.scene.stance);
    second.scene.onStroke = (points) => scene.onStroke?.(points);
    app.classList.add('compares');
    return second;
  }

  private get every(): number {
    return Number(this.parts.hub.cell?.setup.run.save_every) || 0.1;
  }

  /** The page as it is with two cells, or with one. */
  private dress(): void {
    const { on, parts, charts } = this;
    parts.app.classList.toggle('comparing', on !== null);
    if (charts) charts.element.hidden = on === null;
    this.panel.show(on?.name ?? null, on?.value ?? 0);
    if (!on) parts.hub.suffix = '';
    this.label();
  }

  private label(): void {
    const { on, second } = this;
    const { hub } = this.parts;
    const definition = hub.about.parameters.find(({ name }) => name === on?.name);
    if (!on || !second || !definition) return;
    const own = (hub.parameters[on.name] ?? definition.default) as Value;
    const names = [called(definition, own), called(definition, on.value)] as const;
    const { cell, frame } = second.hub;
    const end = cell?.catching_up ?? null;
    const behind = end === null || end === 0 ? '' : say('compare.behind', { percent: Math.floor(100 * Math.min(1, (frame?.t ?? 0) / end)) });
    this.labels.forEach((label, k) => {
      const text = `${names[k]}${k === 1 && behind ? ` · ${behind}` : ''}`;
      if (label.dataset.text === text) return;
      label.dataset.text = text;
      label.replaceChildren(h('span', { class: 'hidden' }, `${say(k ? 'compare.second' : 'compare.first')}: `), mathematics(names[k]!), ...(k === 1 && behind ? [h('small', { 'aria-hidden': 'true' }, ` ${behind}`)] : []));
    });
    this.charts?.name(...names);
  }

  /** Show the pace of both, and the address of both. */
  private retell(): void {
    const { on, second } = this;
    const { hub } = this.parts;
    if (!hub.cell) return;
    if (on && second?.hub.cell) hub.suffix = suffix(on.name, second.hub.cell.link);
    if (second) second.scene.playing = on?.pair.playing ?? false;
    hub.emit('cell', { ...hub.cell, ...(on ? { playing: on.pair.playing, speed: on.pair.speed } : {}), fresh: false });
    this.parts.scene.playing = hub.cell.playing;
    this.label();
  }
}
