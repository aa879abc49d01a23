// The surface of a cell: the periodic cylinder, or a closed surface of revolution. Places are (theta, s).

import type { Outline } from '../protocol';

export type Place = [number, number];
/** Writes the velocity at (theta, s). */
export type Velocity = (theta: number, s: number, out: Place) => void;

const TURN = 2 * Math.PI;
/** Where the radius is less, places are moved on the flat map around a pole. */
const FLAT = 0.7;

/** The nearest copy of `to` as seen from `from`, with period `period`. */
export function nearest(from: number, to: number, period: number): number {
  return to - period * Math.round((to - from) / period);
}

export function wrap(value: number, period: number): number {
  const wrapped = ((value % period) + period) % period;
  return wrapped < period ? wrapped : 0;
}

/**
 * What a picture needs of a surface. s runs along the axis of a cylinder, and from the south pole to the north along
 * a meridian of a closed surface. Lengths are in radii, `z` is the height above the middle.
 */
export interface Surface {
  readonly closed: boolean;
  /** Whether up and down along the meridian mean anything: not on a sphere. */
  readonly axial: boolean;
  /** The length of the cylinder or of a meridian. */
  readonly length: number;
  /** The period of s in charts: that of the cylinder. On a closed surface a meridian and the one behind it. */
  readonly period: number;
  /** Half the height, and the largest radius. */
  readonly half: number;
  readonly widest: number;
  /** Four numbers for each of the even steps of s: r, z, and the outward and upward parts of the normal. */
  readonly profile: Float32Array;
  /** The radius at a chart's s: negative behind a pole. */
  radius(s: number): number;
  /** The radius, the height, and the outward and upward parts of the normal at a place on the cell. */
  skin(s: number): { r: number; z: number; out: number; up: number };
  /** The nearest place on the cell, with theta and s within their ranges. */
  within(theta: number, s: number): Place;
  /** Write where a velocity (around, along), in radii, carries a place of a chart in a time: not within its ranges. */
  carry(theta: number, s: number, velocity: Velocity, time: number, out: Place): void;
  /** The distance of two places, straight through space on a closed surface, and what lies between. */
  apart(a: Place, b: Place): number;
  between(a: Place, b: Place, share: number): Place;
  /** The places at a distance from one: the edge of a brush. */
  edge(at: Place, distance: number, count: number): Place[];
  /** Where the line (right, up + forward sin, forward cos) at a tilt meets the surface, from the viewer or from behind. */
  pick(right: number, up: number, centre: number, tilt: number, behind: boolean): { angle: number; s: number } | null;
}

export class CylinderSurface implements Surface {
  readonly closed = false;
  readonly axial = true;
  readonly period: number;
  readonly half: number;
  readonly widest = 1;
  readonly profile: Float32Array;
  private readonly velocity: Place = [0, 0];

  constructor(readonly length: number) {
    this.period = length;
    this.half = length / 2;
    this.profile = new Float32Array([1, -length / 2, 1, 0, 1, length / 2, 1, 0]);
  }

  radius(): number {
    return 1;
  }

  skin(s: number): { r: number; z: number; out: number; up: number } {
    return { r: 1, z: s - this.half, out: 1, up: 0 };
  }

  within(theta: number, s: number): Place {
    return [wrap(theta, TURN), wrap(s, this.length)];
  }

  carry(theta: number, s: number, velocity: Velocity, time: number, out: Place): void {
    const v = this.velocity;
    velocity(theta, s, v);
    // Midpoint rule: circles stay circles.
    velocity(theta + 0.5 * time * v[0], s + 0.5 * time * v[1], v);
    out[0] = theta + time * v[0];
    out[1] = s + time * v[1];
  }

  apart(a: Place, b: Place): number {
    return Math.hypot(nearest(a[0], b[0], TURN) - a[0], nearest(a[1], b[1], this.length) - a[1]);
  }

  between(a: Place, b: Place, share: number): Place {
    const dx = nearest(a[0], b[0], TURN) - a[0];
    const dz = nearest(a[1], b[1], this.length) - a[1];
    return [wrap(a[0] + share * dx, TURN), wrap(a[1] + share * dz, this.length)];
  }

  edge(at: Place, distance: number, count: number): Place[] {
    return Array.from({ length: count }, (_, k): Place => {
      const angle = (TURN * k) / count;
      return [at[0] + distance * Math.cos(angle), at[1] + distance * Math.sin(angle)];
    });
  }

  pick(right: number, up: number, centre: number, tilt: number, behind: boolean): { angle: number; s: number } | null {
    if (Math.abs(right) >= 1) return null;
    const near = (behind ? -1 : 1) * Math.sqrt(1 - right * right);
    const [c, sin] = [Math.cos(tilt), Math.sin(tilt)];
    const s = centre + up * c + ((near + up * sin) / c) * sin + this.half;
    return s < 0 || s >= this.length ? null : { angle: Math.atan2(right, near), s };
  }
}

type Point = [number, number, number];

/** A closed surface, by its meridian at even steps of s. */
export class ClosedSurface implements Surface {
  readonly closed = true;
  readonly axial: boolean;
  readonly period: number;
  readonly half: number;
  readonly widest: number;
  readonly profile: Float32Array;
  private readonly last: number;
  private readonly velocity: Place = [0, 0];

  constructor(
    private readonly outline: Outline,
    readonly length: number,
  ) {
    const { r, z, out, up } = outline;
    this.axial = outline.axial;
    this.period = 2 * length;
    this.last = r.length - 1;
    this.half = z[this.last];
    this.widest = Math.max(...r);
    this.profile = Float32Array.from({ length: 4 * r.length }, (_, k) => [r, z, out, up][k % 4][k >> 2]);
  }

  radius(s: number): number {
    const folded = wrap(s, this.period);
    return folded > this.length ? -this.at('r', this.period - folded) : this.at('r', folded);
  }

  skin(s: number): { r: number; z: number; out: number; up: number } {
    return { r: this.at('r', s), z: this.at('z', s), out: this.at('out', s), up: this.at('up', s) };
  }

  within(theta: number, s: number): Place {
    const folded = wrap(s, this.period);
    if (folded > this.length) return [wrap(theta + Math.PI, TURN), this.period - folded];
    return [wrap(theta, TURN), folded];
  }

  carry(theta: number, s: number, velocity: Velocity, time: number, out: Place): void {
    const v = this.velocity;
    velocity(theta, s, v);
    const r = this.radius(s);
    if (Math.abs(r) > FLAT) {
      const [x, y] = [theta + (0.5 * time * v[0]) / r, s + 0.5 * time * v[1]];
      velocity(x, y, v);
      out[0] = theta + (time * v[0]) / this.radius(y);
      out[1] = s + time * v[1];
      return;
    }
    this.flat(theta, s, 0.5 * time * v[1], 0.5 * time * v[0] * this.widening(s), out);
    const turned = out[0] - theta;
    const wider = this.widening(out[1]);
    velocity(out[0], out[1], v);
    const [cos, sin] = [Math.cos(turned), Math.sin(turned)];
    const aside = v[0] * wider;
    this.flat(theta, s, time * (v[1] * cos - aside * sin), time * (v[1] * sin + aside * cos), out);
  }

  /** How much longer circles are on the flat map around a pole than on the surface; negative where s runs to the pole. */
  private widening(s: number): number {
    const turns = Math.round(s / this.length);
    const [rho, r] = [s - turns * this.length, this.radius(s)];
    return Math.abs(r) > 1e-9 ? rho / r : turns % 2 ? -1 : 1;
  }

  /**
   * Move on the flat map around the nearest pole, on which theta and the distance from it, negative on one side, are
   * polar coordinates: forward along the meridian and to its left.
   */
  private flat(theta: number, s: number, forward: number, left: number, out: Place): void {
    const pole = Math.round(s / this.length) * this.length;
    const ahead = s - pole + forward;
    // Of the two ways to write the same place, the one that is turned by less than a right angle.
    out[0] = theta + (ahead === 0 && left === 0 ? 0 : Math.atan(left / ahead));
    out[1] = pole + (ahead < 0 ? -1 : 1) * Math.hypot(ahead, left);
  }

  apart(a: Place, b: Place): number {
    const [p, q] = [this.point(a), this.point(b)];
    return Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
  }

  between(a: Place, b: Place, share: number): Place {
    const [p, q] = [this.point(a), this.point(b)];
    return this.onto([0, 1, 2].map((k) => p[k] + share * (q[k] - p[k])) as Point);
  }

  edge(at: Place, distance: number, count: number): Place[] {
    const centre = this.point(at);
    const step = distance / 8;
    return Array.from({ length: count }, (_, k) => {
      // A straight path on the surface, until it is as far from the centre.
      let here = centre;
      let way = this.tangent(at, (TURN * k) / count);
      let before = 0;
      for (let n = 0; n < 40; n++) {
        const ahead = this.point(this.onto([0, 1, 2].map((c) => here[c] + step * way[c]) as Point));
        const far = Math.hypot(ahead[0] - centre[0], ahead[1] - centre[1], ahead[2] - centre[2]);
        const moved = [0, 1, 2].map((c) => ahead[c] - here[c]) as Point;
        if (far >= distance) {
          const share = (distance - before) / (far - before);
          return this.onto([0, 1, 2].map((c) => here[c] + share * moved[c]) as Point);
        }
        if (far <= before) break; // the brush is larger than the cell
        const size = Math.hypot(...moved) || 1;
        way = moved.map((c) => c / size) as Point;
        here = ahead;
        before = far;
      }
      return this.onto(here);
    });
  }

  pick(right: number, up: number, centre: number, tilt: number, behind: boolean): { angle: number; s: number } | null {
    const [c, sin] = [Math.cos(tilt), Math.sin(tilt)];
    // From the viewer backwards: the first point inside, and where the line enters.
    const reach = Math.hypot(this.half, this.widest) + Math.abs(centre) + 0.1;
    const inside = (t: number): boolean => {
      const z = centre + up * c + t * sin;
      return Math.abs(z) < this.half && Math.hypot(right, t * c - up * sin) < this.at('r', this.arc(z));
    };
    const way = behind ? -1 : 1;
    const steps = 240;
    for (let k = 0; k <= steps; k++) {
      let low = way * reach * (1 - (2 * k) / steps);
      if (!inside(low)) continue;
      let high = low + (way * 2 * reach) / steps;
      for (let n = 0; n < 24; n++) {
        const middle = 0.5 * (low + high);
        if (inside(middle)) low = middle;
        else high = middle;
      }
      const forward = low * c - up * sin;
      const [, s] = this.onto([right, forward, centre + up * c + low * sin]);
      return { angle: Math.atan2(right, forward), s };
    }
    return null;
  }

  /** Where a place is in space: x, y and the height. */
  point([theta, s]: Place): Point {
    const r = this.radius(s);
    return [r * Math.cos(theta), r * Math.sin(theta), this.at('z', this.within(theta, s)[1])];
  }

  /** The place on the surface nearest to a point. */
  onto([x, y, z]: Point): Place {
    const { r: radii, z: heights } = this.outline;
    const r = Math.hypot(x, y);
    let [best, s] = [Infinity, 0];
    for (let k = 0; k < this.last; k++) {
      const [dr, dz] = [radii[k + 1] - radii[k], heights[k + 1] - heights[k]];
      const share = ((r - radii[k]) * dr + (z - heights[k]) * dz) / (dr * dr + dz * dz);
      const t = Math.min(1, Math.max(0, share));
      const far = (r - radii[k] - t * dr) ** 2 + (z - heights[k] - t * dz) ** 2;
      if (far < best) [best, s] = [far, ((k + t) / this.last) * this.length];
    }
    return [wrap(Math.atan2(y, x), TURN), s];
  }

  private tangent([theta, s]: Place, angle: number): Point {
    const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
    const [out, up] = [this.at('out', s), this.at('up', s)];
    const along = [-up * cos, -up * sin, out];
    const around = [-sin, cos, 0];
    return [0, 1, 2].map((k) => Math.cos(angle) * around[k] + Math.sin(angle) * along[k]) as Point;
  }

  private at(name: 'r' | 'z' | 'out' | 'up', s: number): number {
    const values = this.outline[name];
    const x = Math.min(1, Math.max(0, s / this.length)) * this.last;
    const k = Math.min(this.last - 1, Math.floor(x));
    return values[k] + (x - k) * (values[k + 1] - values[k]);
  }

  /** The s at a height, which grows from pole to pole. */
  private arc(z: number): number {
    const { z: heights } = this.outline;
    let [low, high] = [0, this.last];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (heights[middle] <= z) low = middle;
      else high = middle;
    }
    const share = (z - heights[low]) / (heights[high] - heights[low] || 1);
    return ((low + share) / this.last) * this.length;
  }
}

export function surfaceOf(outline: Outline | null, length: number): Surface {
  return outline ? new ClosedSurface(outline, length) : new CylinderSurface(length);
}
