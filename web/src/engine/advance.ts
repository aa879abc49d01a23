import { sizeOf, type System } from './system';
import { Stepper, tableau, type Tableau } from './steppers';

// Many steps: the choice of their length, exact landing, and the reasons to stop, as `dynamics/advance.py`. Steps
// wanted are on the ladder 2^(j/2); the interval to a target is cut into equal steps no longer than the rung.

export const FIRST_RUNG = -8;
const LOWEST_RUNG = -46;
const HIGHEST_RUNG = 40;
const SAFETY = 0.9;
const MAX_RISE = 2;
const MAX_FALL = 8;
const ORDER = 4;
const EVALUATIONS = 4;
/** A rate of change that no state falls below. */
export const NEVER = -1;
/** Time for which the rate must have stayed low and not grown for a steady run, and by how much it then has grown. */
const CALM = 10;
const RISE = 1.1;
const ROUNDING = 100 * 2 ** -52;
const SOLVING = 10;

export type Method = 'adaptive' | 'etdrk4' | 'rk4';

/** All that is needed to continue a run, as `StepperState`. Spectra are never changed in place. */
export interface Progress {
  t: number;
  spectrum: Float64Array;
  nonlinear: Float64Array;
  rung: number;
  h: number;
  left: number;
  evaluations: number;
  accepted: number;
  rejected: number;
  peak: number;
  rate: number;
  failed: boolean;
  calmSince: number;
  leastRate: number;
}

export interface Control {
  rtol: number;
  atol: number;
  dt: number;
  steadyRate: number;
  /** The |P| beyond which the run has diverged. */
  bound: number;
}

/** A run that begins at time t. */
export function start(system: System, spectrum: Float64Array, t: number): Progress {
  const nonlinear = system.nonlinear(spectrum, t, new Float64Array(spectrum.length));
  return {
    t, spectrum, nonlinear, rung: FIRST_RUNG, h: 0, left: 0, evaluations: 1, accepted: 0, rejected: 0,
    peak: Math.sqrt(system.peak()), rate: relativeRate(system, spectrum, nonlinear), failed: false,
    calmSince: Infinity, leastRate: Infinity,
  };
}

export function isSteady(now: Progress): boolean {
  return now.t - now.calmSince >= CALM;
}

/** Makes steps of one system; coefficients are kept while the length of a step stays the same. */
export class Advance {
  private readonly stepper: Stepper;
  private tabulated = -1;
  private coefficients: Tableau | null = null;

  constructor(readonly system: System, readonly method: Method = 'adaptive') {
    this.stepper = new Stepper(system.grid.size);
  }

  /** Make steps until the target is reached, the state is steady, a step fails, or `most` are tried. */
  to(control: Control, progress: Progress, target: number, most = Infinity): Progress {
    let now = progress;
    for (let tried = 0; now.t < target && !now.failed && !isSteady(now) && tried < most; tried += 1) {
      now = this.aim(now, control, target);
      if (now.h !== this.tabulated || !this.coefficients) {
        this.coefficients = tableau(this.system.linear, now.h);
        this.tabulated = now.h;
      }
      now = this.once(control, now, target, this.coefficients);
    }
    return now;
  }

  /** Cut the interval to the target into equal steps, unless some of an earlier cut are left. */
  private aim(now: Progress, control: Control, target: number): Progress {
    if (now.left !== 0) return now;
    const wanted = this.method === 'adaptive' ? 2 ** (0.5 * now.rung) : control.dt;
    const left = Math.max(Math.ceil((target - now.t) / wanted - 1e-9), 1);
    const h = (target - now.t) / left;
    // A length that differs only by rounding is kept, so that its coefficients are reused.
    return { ...now, left, h: Math.abs(h - now.h) < 1e-12 * h ? now.h : h };
  }

  /** Try a step, and choose the rung of the next. */
  private once(control: Control, now: Progress, target: number, c: Tableau): Progress {
    const { stepper, system } = this;
    const peak = stepper.step(system, c, now.t, now.h, now.spectrum, now.nonlinear);
    const size = sizeOf(stepper.spectrum);
    const rate = relativeRate(system, stepper.spectrum, stepper.nonlinear);
    const bounded = peak <= control.bound ** 2 && Number.isFinite(rate); // false for NaN as well
    let good = bounded;
    let rung = now.rung;
    let failed = !bounded;
    let noise = ROUNDING;
    if (this.method === 'adaptive') {
      const error = sizeOf(stepper.error) / tolerance(control, now, size);
      good = bounded && error <= 1;
      rung = nextRung(now, error, bounded, good);
      failed = rung < LOWEST_RUNG;
      noise += (SOLVING * control.atol) / Math.max(size, 1e-300);
    }
    const left = good ? now.left - 1 : now.left;
    const again = rung !== now.rung || !good; // zero steps left request a new cut of the interval
    const next = { ...now, rung, left: again ? 0 : left, evaluations: now.evaluations + EVALUATIONS };
    if (!good) return { ...next, rejected: now.rejected + 1, failed };
    const t = now.left <= 1 ? target : now.t + now.h;
    return {
      ...next, t, spectrum: stepper.spectrum.slice(), nonlinear: stepper.nonlinear.slice(), accepted: now.accepted + 1,
      peak: Math.max(Math.sqrt(peak), now.peak), rate, failed: false, ...calm(control, now, t, rate, noise),
    };
  }
}

/** The rung after a step whose error, in units of the tolerance, is given. */
function nextRung(now: Progress, error: number, bounded: boolean, good: boolean): number {
  const factor = bounded ? SAFETY * Math.max(error, 1e-12) ** (-1 / ORDER) : 0;
  const fitting = Math.floor(2 * Math.log2(Math.max(factor * now.h, 1e-30)) + 1e-9);
  // A step cut short by the target may be shorter than its rung: that alone does not lower the rung.
  const kept = factor >= 1 ? Math.max(fitting, now.rung) : fitting;
  // A rejected step is followed by one at least a rung below the length that was tried.
  const tried = Math.floor(2 * Math.log2(now.h) + 1e-9);
  const rung = good ? clip(kept, now.rung - MAX_FALL, now.rung + MAX_RISE) : clip(fitting, tried - MAX_FALL, tried - 1);
  return Math.min(rung, HIGHEST_RUNG);
}

function clip(value: number, least: number, most: number): number {
  return Math.min(Math.max(value, least), most);
}

/** Since when the rate of change has stayed low without growing, and the least rate since then. */
function calm(control: Control, now: Progress, t: number, rate: number, noise: number): Pick<Progress, 'calmSince' | 'leastRate'> {
  const low = rate <= control.steadyRate;
  if (!low) return { calmSince: Infinity, leastRate: Infinity };
  const grown = rate > RISE * now.leastRate + noise;
  if (grown || !Number.isFinite(now.calmSince)) return { calmSince: t, leastRate: rate };
  return { calmSince: now.calmSince, leastRate: Math.min(now.leastRate, rate) };
}

/** The error allowed in a step; for a run that is to stop when steady also a tenth of the change in it. */
function tolerance(control: Control, now: Progress, size: number): number {
  const allowed = control.atol + control.rtol * size;
  if (control.steadyRate <= 0) return allowed;
  const change = now.h * Math.max(now.rate, ROUNDING) * size;
  return Math.min(allowed, control.atol + 0.1 * change);
}

function relativeRate(system: System, spectrum: Float64Array, nonlinear: Float64Array): number {
  const { linear } = system;
  let sum = 0;
  for (let at = 0; at < spectrum.length; at += 1) {
    const rate = linear[at >> 1]! * spectrum[at]! + nonlinear[at]!;
    sum += rate * rate;
  }
  return Math.sqrt(sum) / Math.max(sizeOf(spectrum), 1e-300);
}
