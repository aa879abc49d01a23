import type { Ask, Said } from '../protocol';
import { Cell } from './cell';
import type { Catalogue, Table } from './definitions';
import { InputError } from './errors';
import { instant } from './instants';
import { scaled, setUpOf, setUpOfLink, type SetUp } from './setup';

/** Pictures that may be in transit before the page confirms one as drawn; one more after an action. */
const UNSEEN = 2;
/** Milliseconds for which a cell keeps running while the page draws nothing, as in a hidden tab. */
const PATIENCE = 5000;
const BETWEEN_PICTURES = 1000 / 30;
/** About how many milliseconds are computed before requests are heard again, and steps between two looks at the clock. */
const SLICE = 30;
const STEPS = 4;
const NO_VACUOLE = 'The flow inside the cell is computed by the server: it needs cyclosis explore, and so Python.';

export interface Surroundings {
  say(said: Said): void;
  /** Send a picture. */
  show(data: ArrayBuffer): void;
  /** Milliseconds. */
  now(): number;
  /** Call `tick` after some milliseconds, once, and instead of an earlier call that was asked for. */
  later(wait: number): void;
}

/** A cell and its pace, as `explorer/visit.py`: requests come in, the cell runs, pictures go out. */
export class Visit {
  private cell: Cell | null = null;
  private preset: string | null = null;
  private playing = false;
  private speed = 5;
  private catchingUp: number | null = null;
  /** The frame to compute up to, as fast as possible. */
  private goal: number | null = null;
  private begun = 0;
  private done = 0;
  private unseen = 0;
  private seenAt = 0;
  private sentAt = -Infinity;
  private due = 0;
  private stale = false;
  private acted = false;
  private inside = false;

  constructor(private readonly about: Catalogue, private readonly around: Surroundings) {}

  /** Answer a request of the page. */
  hear(ask: Ask & { n?: number }): void {
    if (ask.n !== undefined) this.done = ask.n;
    try {
      this.do(ask);
    } catch (error) {
      if (!(error instanceof InputError)) throw error;
      this.around.say({ type: 'refused', sentence: error.message });
    }
    this.around.later(0);
  }

  /** Compute for a moment if it is time, and send a picture if one is due. */
  tick(): void {
    if (!this.cell) return;
    const { around } = this;
    if (this.moving() && around.now() >= this.due) this.onward(this.cell);
    const next = this.sentAt + BETWEEN_PICTURES;
    if (this.toShow() && around.now() >= next) this.show(this.cell);
    const waits = [...(this.moving() ? [this.due] : []), ...(this.toShow() ? [next] : [])];
    if (waits.length) around.later(Math.max(0, Math.min(...waits) - around.now()));
  }

  private onward(cell: Cell): void {
    const { around } = this;
    const end = around.now() + SLICE;
    try {
      let arrived = cell.forward(STEPS);
      while (!arrived && around.now() < end) arrived = cell.forward(STEPS);
      if (arrived) this.arrived(cell);
    } catch (error) {
      if (!(error instanceof InputError)) throw error;
      this.playing = false;
      this.catchingUp = this.goal = null;
      around.say({ type: 'refused', sentence: error.message });
      this.tell(cell);
    }
  }

  private arrived(cell: Cell): void {
    const { around } = this;
    this.stale = true;
    if (this.catchingUp !== null && cell.live.t >= instant(this.catchingUp)) {
      this.catchingUp = null;
      this.tell(cell);
    }
    const pause = this.catchingUp === null && this.goal === null ? (1000 * cell.live.every) / this.speed : 0;
    if (this.goal !== null && cell.live.frame >= this.goal) this.goal = null;
    // Time that was lost is not made up for.
    this.due = Math.max(this.due + pause, around.now() - pause);
  }

  private moving(): boolean {
    if (!this.cell) return false;
    if (this.catchingUp !== null || this.goal !== null) return true;
    return this.playing && (this.unseen < UNSEEN || this.around.now() - this.seenAt < PATIENCE);
  }

  private toShow(): boolean {
    return this.stale && this.unseen < UNSEEN + (this.acted ? 1 : 0);
  }

  private do(ask: Ask): void {
    if (ask.do === 'seen') {
      this.unseen = Math.max(0, this.unseen - 1);
      this.seenAt = this.around.now();
      return;
    }
    if (ask.do === 'begin') {
      this.begin(ask);
      return;
    }
    const { cell } = this;
    if (!cell) throw new InputError('cell', null, 'begun', 'begin one');
    switch (ask.do) {
      case 'play':
      case 'pause':
        this.playing = ask.do === 'play';
        this.goal = null;
        this.due = this.around.now();
        if (!this.playing) {
          toFrame(cell);
          this.stale = true; // the picture is of the time that is told
        }
        break;
      case 'reach':
        this.playing = false;
        this.goal = ask.frame > cell.live.frame ? ask.frame : null;
        this.due = this.around.now();
        this.stale ||= this.goal === null;
        return;
      case 'step':
        this.playing = false;
        this.goal = null;
        while (!cell.forward(Infinity));
        this.stale = true;
        break;
      case 'new_seed': {
        const { initial } = cell.setUp.tables;
        const tables = { ...cell.setUp.tables, initial: { ...initial, seed: ((initial.seed ?? 0) as number) + 1 } };
        this.open(setUpOf(tables, cell.setUp.steps, 0, this.about), this.playing);
        return;
      }
      case 'again':
        this.open(cell.again(), this.playing, cell.changed ? null : this.preset);
        return;
      case 'undo':
        cell.undo();
        this.stale = this.acted = true;
        this.sentAt = -Infinity;
        this.due = this.around.now();
        break;
      case 'units':
        cell.measure(ask.scales && { ...ask.scales });
        break;
      case 'hash':
        void this.digest(cell);
        return;
      case 'curves':
        this.around.say({ type: 'curves', ...this.curves(cell) });
        return;
      case 'speed':
        this.speed = Math.min(100, Math.max(0.1, ask.value));
        break;
      case 'vacuole':
        if (ask.on && !this.inside) this.around.say({ type: 'refused', sentence: NO_VACUOLE });
        this.inside = ask.on;
        break;
      case 'change':
        this.act(cell, () => cell.change(ask.values));
        break;
      case 'drug':
        this.act(cell, () => cell.drug(ask.name));
        break;
      case 'brush':
        this.act(cell, () => cell.brush(ask));
        break;
      case 'tell':
        break;
      default:
        return; // signs of life
    }
    this.tell(cell);
  }

  private begin(ask: Extract<Ask, { do: 'begin' }>): void {
    const { about } = this;
    /** With the scales of the page, unless it has its own. */
    const shown = (setUp: SetUp): SetUp => (ask.scales && !Object.keys(setUp.tables.scales).length ? scaled(setUp, { ...ask.scales }, about) : setUp);
    if (ask.link !== undefined) {
      const setUp = setUpOfLink(ask.link, about);
      const later = ask.t === undefined ? setUp : setUpOf(setUp.tables, setUp.steps, Math.max(setUp.t, ask.t), about);
      this.open(shown(later), ask.playing ?? false);
    } else if (ask.preset !== undefined) {
      const chosen = about.presets.find(({ name }) => name === ask.preset);
      if (!chosen) throw new InputError('preset', ask.preset, `one of ${about.presets.map(({ name }) => name).join(', ')}`, 'choose another');
      this.open(shown(setUpOf(chosen.tables, chosen.protocol, 0, about)), this.playing, chosen.name);
    } else this.open(shown(setUpOf(ask.setup ?? {}, [], 0, about)), this.playing);
  }

  private open(setUp: SetUp, playing: boolean, preset: string | null = null): void {
    const cell = new Cell(setUp, this.about);
    this.cell = cell;
    this.preset = preset;
    this.playing = playing;
    this.due = this.around.now();
    this.catchingUp = setUp.t > 0 ? setUp.t : null;
    this.goal = null;
    this.begun += 1;
    this.stale = true;
    this.tell(cell, true);
  }

  private act(cell: Cell, what: () => void): void {
    toFrame(cell);
    what();
    this.stale = this.acted = true;
    this.sentAt = -Infinity;
  }

  private show(cell: Cell): void {
    this.unseen += 1;
    this.sentAt = this.around.now();
    this.stale = this.acted = false;
    this.around.show(cell.picture());
  }

  private tell(cell: Cell, fresh = false): void {
    const { playing, speed, catchingUp, preset, begun, done } = this;
    this.around.say({
      type: 'cell', ...cell.words(catchingUp ?? 0), playing, speed, catching_up: catchingUp, preset, begun, done, fresh,
      ...(this.inside ? { vacuole: 0 } : {}),
    });
  }

  /** The curves of theory where they are stored: for the parameters of the presets. Others need Python. */
  private curves(cell: Cell): { curves: Catalogue['curves'][number]['curves']; applies: boolean; elsewhere: boolean } {
    const now = cell.live.paramsNow as unknown as Table;
    const applies = Object.values(now).every((value) => typeof value !== 'object');
    const found = this.about.curves.find(({ parameters }) => Object.entries(parameters).every(([name, value]) => now[name] === value));
    return { curves: (applies && found?.curves) || [], applies, elsewhere: applies && !found };
  }

  private async digest(cell: Cell): Promise<void> {
    const { t, state } = cell.live;
    const bytes = new Uint8Array(16 * state[0].length);
    state.forEach((part, k) => bytes.set(new Uint8Array(part.buffer, part.byteOffset, part.byteLength), k * part.byteLength));
    if (!globalThis.crypto?.subtle) {
      this.around.say({ type: 'refused', sentence: 'This browser computes fingerprints only on pages with an encrypted address (https).' });
      return;
    }
    const digest = new Uint8Array(await crypto.subtle.digest('SHA-256', bytes));
    const sha256 = Array.from(digest, (byte) => byte.toString(16).padStart(2, '0')).join('');
    this.around.say({ type: 'hash', t, sha256 });
  }
}

/** Compute up to the next frame if the cell is between two. */
function toFrame(cell: Cell): void {
  while (!cell.live.atFrame) cell.forward(Infinity);
}
