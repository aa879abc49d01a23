// Numbers as they are shown: dimensionless, or in the units of a cell whose radius and speed are known.

import type { Scales } from '../protocol';
import { decimals, short } from './scales';

/** A unit: `factor` takes a dimensionless number to a number of units. */
export interface Unit {
  factor: number;
  name: string;
}

const SECONDS: [limit: number, seconds: number, name: string][] = [[120, 1, 's'], [7200, 60, 'min'], [172_800, 3600, 'h'], [Infinity, 86_400, 'd']];

/** The units of a cell, as `cyclosis.model.units` has them. */
export class Units {
  constructor(readonly scales: Scales | null) {}

  /** Seconds in a unit of time, R/U. */
  get second(): number {
    return this.scales ? this.scales.radius_um / this.scales.speed_um_s : 1;
  }

  /** The unit of times up to `last`. */
  time(last: number): Unit {
    if (!this.scales) return { factor: 1, name: 'R/U' };
    const longest = this.second * Math.abs(last);
    const [, seconds, name] = SECONDS.find(([limit]) => longest < limit)!;
    return { factor: this.second / seconds, name };
  }

  /** The unit of lengths up to `longest`. */
  length(longest = 0): Unit {
    if (!this.scales) return { factor: 1, name: 'R' };
    const { radius_um } = this.scales;
    return radius_um * longest >= 1000 ? { factor: radius_um / 1000, name: 'mm' } : { factor: radius_um, name: 'µm' };
  }

  get speed(): Unit {
    return this.scales ? { factor: this.scales.speed_um_s, name: 'µm/s' } : { factor: 1, name: 'U' };
  }

  /** A span of time in words, to some digits. */
  lasting(t: number, digits = 3): string {
    const { factor, name } = this.time(t);
    return `${short(factor * t, digits)} ${name}`;
  }

  /** The time that a clock shows. */
  clock(t: number): string {
    const { factor, name } = this.time(t);
    return this.scales ? `${decimals(factor * t, 1)} ${name}` : `t = ${decimals(t, 1)}`;
  }

  /** A length in words. */
  reaching(length: number, digits = 3): string {
    const { factor, name } = this.length(length);
    return `${short(factor * length, digits)} ${name}`;
  }

  /** A round length (1, 2 or 5 times a power of ten) of at most `about` radii: in radii, and its name; null without units. */
  bar(about: number): { length: number; name: string } | null {
    if (!this.scales || !(about > 0)) return null;
    const { radius_um } = this.scales;
    const most = radius_um * about;
    const power = 10 ** Math.floor(Math.log10(most));
    const best = power * [5, 2, 1].find((factor) => factor * power <= most * (1 + 1e-9))!;
    return { length: best / radius_um, name: best >= 1000 ? `${short(best / 1000)} mm` : `${short(best)} µm` };
  }

  /** The value of a parameter of the equation in units, as `cyclosis.Scales.to_physical`; '' where it has none. */
  parameter(name: string, value: number): string {
    if (!this.scales) return '';
    const { radius_um, speed_um_s } = this.scales;
    const physical: Record<string, [factor: number, unit: string]> = {
      alpha_p: [speed_um_s / radius_um, '/s'],
      alpha_u: [1 / radius_um, '/µm'],
      d_s: [speed_um_s * radius_um, 'µm²/s'],
      d_r: [speed_um_s / radius_um, '/s'],
      kappa: [speed_um_s / radius_um, '/s'],
    };
    const found = physical[name];
    return found ? `${short(found[0] * value)} ${found[1]}` : '';
  }
}

/** The scales in a set-up, or null where it has none. */
export function scalesIn(table: Partial<Scales> | undefined): Scales | null {
  const { radius_um, speed_um_s } = table ?? {};
  return typeof radius_um === 'number' && typeof speed_um_s === 'number' ? { radius_um, speed_um_s } : null;
}
