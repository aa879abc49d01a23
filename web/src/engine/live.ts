import { act } from './actions';
import { Advance, FIRST_RUNG, NEVER, start, type Control, type Progress } from './advance';
import { beside, InputError } from './errors';
import { resolvedModes, spectrumOf, stateOf, type Grid, type State } from './grid';
import { instant } from './instants';
import type { Protocol } from './protocol';
import { Schedule } from './schedule';
import { System } from './system';
import type { Params } from './values';

/** The |P| beyond which a run has diverged, and the same once a step has acted on the state. */
const BOUND = 1.01;
const SHARP_BOUND = 1.25;

/** A running cell whose protocol is still being written, as `dynamics/live.py`: frames are `every` apart. */
export class Live {
  frame = 0;
  failed = false;
  schedule: Schedule;
  system!: System;
  private done = 0;
  private advance!: Advance;
  private now: Progress;
  /** The state as a step at this time left it, bit for bit. */
  private left: { t: number; state: State } | null = null;
  /** The run before the events of this time. */
  private before: { now: Progress; done: number } | null = null;

  constructor(readonly params: Params, readonly grid: Grid, state: State, readonly every: number, protocol: Protocol) {
    this.schedule = new Schedule(params, grid, protocol);
    this.setDone(0);
    this.now = start(this.system, resolvedModes(grid, spectrumOf(grid, state)), 0);
    this.intervene();
  }

  get t(): number {
    return this.now.t;
  }

  get progress(): Progress {
    return this.now;
  }

  /** Whether steps of the protocol are accepted now. */
  get atFrame(): boolean {
    return this.t === this.timeOf(this.frame);
  }

  get protocol(): Protocol {
    return this.schedule.protocol;
  }

  get paramsNow(): Params {
    return this.schedule.paramsAt(this.t);
  }

  get state(): State {
    return this.left && this.left.t === this.t ? this.left.state : stateOf(this.grid, this.now.spectrum);
  }

  /** The spectrum as it is reported: without Nyquist modes. */
  get reported(): Float64Array {
    return resolvedModes(this.grid, this.now.spectrum);
  }

  /** Try at most `most` steps towards the next frame; return whether it is reached. */
  forward(most = Infinity): boolean {
    if (this.failed) return false;
    const frame = this.timeOf(this.frame + 1);
    const target = Math.min(frame, this.schedule.times[this.done] ?? Infinity);
    const began = this.t;
    this.now = this.advance.to(this.control(), this.now, target, most);
    if (this.t !== began) this.before = null;
    this.failed = this.now.failed;
    if (!this.failed && this.t === target) this.intervene();
    if (this.t !== frame || this.failed) return false;
    this.frame += 1;
    return true;
  }

  /** A run that starts where this one is. Only one of the two may continue: they share their working memory. */
  copy(): Live {
    return Object.assign(Object.create(Live.prototype) as Live, this);
  }

  /** Continue under a protocol with further steps, at the time reached or later. */
  do(protocol: Protocol): void {
    const { t } = this;
    const known = new Set(this.protocol.steps.map((step) => JSON.stringify(step.table)));
    const late = protocol.steps.find((step) => step.at < t && !known.has(JSON.stringify(step.table)));
    if (late) throw new InputError('at', late.at, `at least ${beside(t, late.at)}, the time reached`, 'move it there');
    if (!this.atFrame) throw new InputError('at', t, 'the time of a frame', 'go forward to the next frame first');
    this.schedule = new Schedule(this.params, this.grid, protocol);
    // What was done at this time is done again, together with the new steps.
    if (this.before) this.now = this.before.now;
    this.setDone(this.schedule.times.filter((time) => time < t).length);
    this.left = null;
    this.intervene();
    this.failed = false;
  }

  private control(): Control {
    const sharp = this.schedule.times.slice(0, this.done).some((_, event) => this.schedule.disturbing(event).length > 0);
    return { rtol: 1e-4, atol: 1e-10, dt: 0.1, steadyRate: NEVER, bound: sharp ? SHARP_BOUND : BOUND };
  }

  private setDone(done: number): void {
    this.done = done;
    this.system = new System(this.grid, this.schedule.stages[done]!);
    this.advance = new Advance(this.system);
  }

  /** Do what the protocol does at the time reached. */
  private intervene(): void {
    const { now, done } = this;
    if (done === this.schedule.times.length || this.schedule.times[done]! > this.t) return;
    const steps = this.schedule.disturbing(done);
    let { spectrum } = now;
    if (steps.length) {
      const { seed } = this.protocol;
      const state = steps.reduce((old, [step, mask]) => act(step, old, this.grid, seed, mask), this.state);
      // Nyquist modes are kept here: without them the whole surface would change. They diffuse away.
      spectrum = spectrumOf(this.grid, state);
      this.left = { t: now.t, state };
    } else this.left = null;
    this.setDone(done + 1);
    // The right-hand side is new: step control restarts, from the length of a first step or shorter.
    const fresh = start(this.system, spectrum, now.t);
    this.now = {
      ...now, spectrum, nonlinear: fresh.nonlinear, rate: fresh.rate, calmSince: Infinity, leastRate: Infinity,
      peak: steps.length ? fresh.peak : now.peak, rung: Math.min(now.rung, FIRST_RUNG), left: 0, evaluations: now.evaluations + 1,
    };
    this.before ??= { now, done };
  }

  private timeOf(frame: number): number {
    return instant(this.every * frame);
  }
}
