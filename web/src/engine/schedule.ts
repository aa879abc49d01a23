import { actsOnState, type Protocol, type Step } from './protocol';
import { InputError } from './errors';
import type { Grid } from './grid';
import { maskOf } from './regions';
import type { Stage } from './system';
import { paramsAt, valueAt, type Coupling, type Name, type Params } from './values';

type Mask = Uint8Array | null;
type Value = Coupling | boolean;

/**
 * What a protocol means for one cell, as `dynamics/schedule.py`. `times` are those of the steps and of the ends of
 * ramps; stage k is active once k events are done. Parameters that a step has made differ from place to place stay
 * fields.
 */
export class Schedule {
  readonly times: number[];
  readonly stages: Stage[];
  readonly steps: [Step, Mask][];

  constructor(private readonly params: Params, private readonly grid: Grid, readonly protocol: Protocol) {
    this.steps = protocol.steps.map((step) => [step, step.where && maskOf(step.where, grid, step.action, step.at)]);
    this.times = [...new Set(protocol.steps.flatMap((step) => [step.at, step.until]))].sort((a, b) => a - b);
    this.stages = this.made();
  }

  /** The number of events up to and at a time. */
  done(t: number): number {
    const later = this.times.findIndex((time) => time > t);
    return later < 0 ? this.times.length : later;
  }

  paramsAt(t: number): Params {
    const { first, last, ramps } = this.stages[this.done(t)]!;
    return paramsAt(first, last, ramps, t);
  }

  /** The steps at an event that act on the state. */
  disturbing(event: number): [Step, Mask][] {
    return this.due(this.times[event]!).filter(([step]) => actsOnState(step));
  }

  private due(time: number): [Step, Mask][] {
    return this.steps.filter(([step]) => step.at === time);
  }

  private made(): Stage[] {
    const current: Record<string, Value> = { ...this.params };
    const ramps = new Map<string, { begin: number; end: number; first: Value; last: Value }>();
    const changed = new Set<string>();
    const out: Stage[] = [{ first: this.params, last: this.params, ramps: {} }];
    for (const time of this.times) {
      for (const [name, ramp] of [...ramps]) {
        if (ramp.end <= time) {
          current[name] = ramp.last;
          ramps.delete(name);
        }
      }
      for (const [step, mask] of this.due(time)) {
        if (step.action === 'change') Object.keys(step.values).forEach((name) => changed.add(name));
        for (const [name, target] of Object.entries(this.targets(step, mask, current, changed))) {
          if (step.over && name !== 'zero_theta_flux') {
            ramps.set(name, { begin: step.at, end: step.until, first: current[name]!, last: target });
          } else current[name] = target;
        }
      }
      const first = { ...current } as unknown as Params;
      const last = { ...current } as unknown as Params;
      const spans: Stage['ramps'] = {};
      for (const [name, ramp] of ramps) {
        Object.assign(first, { [name]: ramp.first });
        Object.assign(last, { [name]: ramp.last });
        spans[name as Name] = [ramp.begin, ramp.end];
      }
      out.push({ first, last, ramps: spans });
    }
    return out;
  }

  /** The values to which a step takes parameters. */
  private targets(step: Step, mask: Mask, current: Record<string, Value>, changed: Set<string>): Record<string, Value> {
    if (step.action === 'wash_out') {
      return Object.fromEntries([...changed].sort().map((name) => [name, this.params[name as Name]]));
    }
    if (step.action !== 'change') return {};
    const values = step.values as Record<string, Value>;
    if (!mask) return values;
    return Object.fromEntries(Object.entries(values).map(([name, value]) => {
      if (typeof value === 'boolean') throw new InputError(name, value, 'changed on the whole surface', 'leave out where');
      const [inside, outside] = [valueAt(value), valueAt(current[name] as Coupling)];
      return [name, Float64Array.from({ length: this.grid.size }, (_, at) => (mask[at] ? inside(at) : outside(at)))];
    }));
  }
}
