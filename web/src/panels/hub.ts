import type { About, Ask, Frame, Model, Said, Scales, Values } from '../protocol';
import { scalesIn, Units } from './units';

export type Cell = Extract<Said, { type: 'cell' }>;
export type Curves = Extract<Said, { type: 'curves' }>;

interface Events {
  cell: Cell;
  frame: Frame;
  curves: Curves;
  hash: Extract<Said, { type: 'hash' }>;
  look: null;
  /** The cell is shown in other units than before; comes before `cell`. */
  units: Units;
}

/** Shared by all panels: the definitions, the newest cell and frame, and a way to send requests. */
export class Hub {
  cell: Cell | null = null;
  frame: Frame | null = null;
  units = new Units(null);
  /** What follows the link of the cell in the address of the page: a second cell. */
  suffix = '';
  private readonly listeners: { [K in keyof Events]?: ((value: Events[K]) => void)[] } = {};

  private readonly waiting: (() => void)[] = [];

  constructor(
    readonly about: About,
    readonly ask: (message: Ask) => void,
    readonly toast: (sentence: string) => void,
  ) {}

  /** The scales that another cell is given. */
  get scales(): Scales | undefined {
    return (this.cell ? this.units.scales : this.about.scales) ?? undefined;
  }

  /** Update the cell, for its address: a running cell is described only on request. */
  async refresh(): Promise<void> {
    if (!this.cell?.playing) return;
    const updated = new Promise<void>((done) => {
      this.waiting.push(done);
      setTimeout(done, 1000);
    });
    this.ask({ do: 'tell' });
    await updated;
  }

  on<K extends keyof Events>(name: K, act: (value: Events[K]) => void): void {
    const list = (this.listeners[name] ??= []) as ((value: Events[K]) => void)[];
    list.push(act);
  }

  emit<K extends keyof Events>(name: K, value: Events[K]): void {
    if (name === 'cell') {
      this.cell = value as Cell;
      for (const done of this.waiting.splice(0)) done();
      const scales = scalesIn(this.cell.setup.scales);
      if (JSON.stringify(scales) !== JSON.stringify(this.units.scales)) this.emit('units', (this.units = new Units(scales)));
    }
    if (name === 'frame') this.frame = value as Frame;
    for (const act of this.listeners[name] ?? []) act(value);
  }

  /** The address of the present cell for the exports. */
  get link(): string {
    return this.cell?.link ?? '';
  }

  /** What holds for the model of the present cell. */
  get model(): Model {
    return this.modelOf(this.cell);
  }

  modelOf(cell: Cell | null): Model {
    const { models } = this.about;
    return models[String(cell?.setup.model.kind)] ?? Object.values(models)[0]!;
  }

  get parameters(): Values {
    return this.cell?.parameters ?? {};
  }
}
