import type { Ask, Said } from '../protocol';
import type { Catalogue, Table } from './definitions';
import { measure } from './diagnostics';
import { InputError } from './errors';
import { resolvedModes, spectrumOf, stateOf, unpacked } from './grid';
import { Live } from './live';
import { picture } from './picture';
import { protocolOf, stepOf, type Step } from './protocol';
import { judged, type Found } from './regimes';
import { modulo } from './regions';
import { checkMemory, filled, linkOf, ready, scaled, type SetUp } from './setup';
import { Undo } from './undo';

/** Time over which the rate of relaxation is measured, and the rate below which a state counts as steady. */
const RELAXATION = 2;
const STILL = 1e-9;

type Words = Omit<Extract<Said, { type: 'cell' }>, 'type' | 'playing' | 'speed' | 'catching_up' | 'preset' | 'begun' | 'done' | 'fresh' | 'vacuole'>;

/** A live cell that can be watched, acted on and shared, as `explorer/session.py`. */
export class Cell {
  live: Live;
  /** Rows of records since the last picture. */
  fresh: number[][] = [];
  private rates: [number, number][] = [];
  /** Parameters that the visitor has changed, as they are now. */
  private own: Table = {};
  private readonly done = new Undo();

  constructor(private given: SetUp, private readonly about: Catalogue) {
    const { params, grid, state, every, protocol } = ready(given, about);
    this.live = new Live(params, grid, state, every, protocol);
    this.record();
  }

  get setUp(): SetUp {
    return this.given;
  }

  /** Show the cell in the units of these scales, or dimensionless. */
  measure(scales: Table | null): void {
    this.given = scaled(this.given, scales, this.about);
  }

  /** Try some steps; return whether the next frame is reached. */
  forward(steps: number): boolean {
    const { live, about } = this;
    if (live.frame >= about.mostFrames) {
      throw new InputError('t', live.t, `less than ${about.mostFrames} frames long`, 'begin a new cell');
    }
    if (live.forward(steps)) {
      this.record();
      return true;
    }
    if (live.failed) throw new InputError('this cell', 'diverged', 'one that the grid resolves', 'use more points, or begin again');
    return false;
  }

  /** Change parameters from now on, by hand or by a drug; several changes at one time are one step. */
  change(given: Table, drug = ''): void {
    const { t } = this.live;
    const steps = [...this.live.protocol.steps];
    const last = steps.findLastIndex((step) => step.at === t);
    const before = steps[last];
    let values = given;
    if (before && before.action === 'change' && !before.where && !before.over) {
      values = { ...before.values, ...given };
      steps.splice(last, 1);
    }
    this.act(stepOf({ at: t, action: 'change', ...values }, this.about), `change ${drug} ${Object.keys(given).join(' ')}`, steps);
    this.own = { ...this.own, ...given };
  }

  drug(name: string): void {
    const values = this.about.drugs[name];
    if (values) this.change(values, name);
    else {
      this.act(stepOf({ at: this.live.t, action: 'wash_out' }, this.about), 'wash_out');
      this.own = {};
    }
  }

  brush(stroke: Extract<Ask, { do: 'brush' }>): void {
    const rounded = (value: number): number => Math.round(1000 * value) / 1000;
    const { length } = this.live.grid;
    const discs = stroke.points.map(([theta, z]) => ({
      shape: 'disc', theta: rounded(modulo(theta, 6.283185)), z: rounded(modulo(z, length)), radius: rounded(stroke.radius),
    }));
    const where = discs.length === 1 ? discs[0] : { shape: 'union', parts: discs };
    const action = {
      wound: { action: 'depolymerise' },
      fragment: { action: 'fragment' },
      align: { action: 'align', angle: stroke.angle ?? Math.PI / 2 },
    }[stroke.tool];
    this.act(stepOf({ at: this.live.t, where, ...action }, this.about), `${stroke.tool} ${stroke.radius}`);
  }

  /** Whether the visitor has changed parameters. */
  get changed(): boolean {
    return Object.keys(this.own).length > 0;
  }

  /** Return to the state just before the visitor's last intervention. */
  undo(): void {
    const { live, own } = this.done.back();
    this.live = live;
    this.own = own;
    this.fresh = this.fresh.filter(([t]) => t! <= live.t);
    this.rates = [];
  }

  /** The set-up of the same cell at t = 0: its seed and first protocol, with the visitor's parameters. */
  again(): SetUp {
    const { tables, steps } = this.setUp;
    return { tables: { ...tables, parameters: { ...tables.parameters, ...this.own } }, steps, t: 0 };
  }

  /** The set-up that leads to exactly this state. */
  setUpNow(): SetUp {
    return { ...this.setUp, steps: this.live.protocol.steps.map((step) => step.table), t: this.live.t };
  }

  /** The description of the cell for the page; its link keeps a later target time. */
  words(end: number): Words {
    const { live } = this;
    const now = this.setUpNow();
    const params = Object.entries(live.paramsNow);
    const mean = (field: Float64Array): number => field.reduce((sum, value) => sum + value, 0) / field.length;
    const { ramps } = live.schedule.stages[live.schedule.done(live.t)]!;
    return {
      setup: filled(this.setUp, this.about) as Words['setup'],
      parameters: Object.fromEntries(params.map(([name, value]) => [name, value instanceof Float64Array ? mean(value) : value])) as Words['parameters'],
      special: {
        ...Object.fromEntries(params.filter(([, value]) => value instanceof Float64Array).map(([name]) => [name, 'field' as const])),
        ...Object.fromEntries(Object.keys(ramps).map((name) => [name, 'ramp' as const])),
      },
      protocol: live.protocol.steps.map(({ at, text }) => ({ at, text })),
      link: linkOf({ ...now, t: Math.max(now.t, end) }),
      outline: null,
      t: live.t,
      undo: this.done.count,
    };
  }

  /** The message of a picture of the cell now. */
  picture(): ArrayBuffer {
    const { live } = this;
    const { grid, system, state, t } = live;
    const spectrum = resolvedModes(grid, spectrumOf(grid, state));
    const change = stateOf(grid, system.rate(spectrum, t, new Float64Array(spectrum.length)));
    const found = judged(grid, stateOf(grid, spectrum), spectrum, change);
    system.at(live.reported, t);
    const u = unpacked(system.u);
    const peakSpeed = u[0].reduce((most, value, at) => Math.max(most, Math.hypot(value, u[1][at]!)), 0);
    const pace = this.pace();
    const { name, zones, widths, order, around, boundaries, drift, mean } = found;
    const regime = { name, reason: reasonOf(found, pace), zones, widths, order, around, boundaries, drift, mean, pace };
    const records = this.fresh;
    this.fresh = [];
    return picture(grid, state, u, records, { t, frame: live.frame, peakSpeed, regime });
  }

  /** The rate at which changes grow; null while it is unknown. */
  private pace(): number | 'steady' | null {
    const { t } = this.live;
    const old = this.rates.find(([time]) => time >= t - RELAXATION);
    if (!old || t - old[0] <= 0.5 * RELAXATION) return null;
    const now = this.rates.at(-1)![1];
    if (now < STILL) return 'steady';
    return old[1] > 0 ? Math.log(now / old[1]) / (t - old[0]) : null;
  }

  private record(): void {
    const { live } = this;
    const now = measure(live.system, live.reported, live.t);
    this.fresh.push([live.t, now.order, now.mean_P_theta, now.mean_P_z, now.peak_speed, now.power_input]);
    this.rates.push([live.t, now.rate_of_change]);
    this.rates = this.rates.filter(([time]) => time >= live.t - RELAXATION);
  }

  private act(step: Step, gesture: string, steps: Step[] = this.live.protocol.steps): void {
    const earlier = steps.filter((each) => each.at <= step.at);
    const later = steps.filter((each) => each.at > step.at);
    const protocol = protocolOf([...earlier, step, ...later], this.live.protocol.seed);
    checkMemory(protocol, this.live.grid, this.about);
    const before = { live: this.live.copy(), own: this.own };
    this.live.do(protocol);
    this.done.keep(before, gesture);
    this.rates = [];
  }
}

/** The reason for a regime with the stripes' widths and how fast the cell relaxes. */
function reasonOf({ reason, widths }: Found, pace: number | 'steady' | null): string {
  const shares = `${widths.length} zones, widths ${widths.map((width) => width.toFixed(2)).join(' : ')}`;
  const words = [widths.length > 0 && widths.length <= 4 ? shares : reason];
  if (pace === 'steady') words.push(pace);
  else if (pace !== null) words.push(pace < 0 ? `relaxing at ${pace.toFixed(3)}` : `changing faster, at ${pace.toFixed(3)}`);
  return words.join(', ');
}
