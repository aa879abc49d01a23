import { check, type Catalogue, type Table } from './definitions';
import { beside, closest, general, InputError } from './errors';
import type { Grid } from './grid';

// Parts of the surface, as `model/regions/shapes.py` and `model/region_tables.py`.

/** A point no farther than this before an edge counts as on it. */
const ROUNDING = 1e-9;
const DEEPEST = 8;

export interface Region {
  table: Table;
  text: string;
  inside(theta: number, z: number, length: number): boolean;
  /** Throw `InputError` if the region is not on the cell. */
  check(length: number): void;
}

/** The region that a table describes. Throws `InputError` for any mistake in it. */
export function regionOf(table: unknown, shapes: Catalogue['shapes'], depth = 0): Region {
  if (typeof table !== 'object' || table === null || Array.isArray(table)) {
    throw new InputError('where', table, 'a table with a shape', 'write { shape = "disc", ... }');
  }
  if (depth > DEEPEST) throw new InputError('where', table, `nested at most ${DEEPEST} deep`, 'simplify it');
  const { shape, invert = false, ...given } = table as Table;
  if (typeof shape !== 'string' || !(shape in shapes)) {
    throw new InputError('shape', shape, `one of ${Object.keys(shapes).join(', ')}`, closest(shape, Object.keys(shapes)));
  }
  if (typeof invert !== 'boolean') throw new InputError('invert', invert, 'true or false', 'write one of the two');
  const region = plain(shape, given, shapes, depth);
  return invert ? complement(region) : region;
}

/** Which points of a grid lie in a region: 1 or 0. Throws `InputError` if none does. */
export function maskOf(region: Region, grid: Grid, action: string, at: number): Uint8Array {
  region.check(grid.length);
  const out = new Uint8Array(grid.size);
  for (let i = 0, k = 0; i < grid.nTheta; i += 1) {
    for (let j = 0; j < grid.nZ; j += 1, k += 1) out[k] = region.inside(grid.theta[i]!, grid.z[j]!, grid.length) ? 1 : 0;
  }
  if (!out.includes(1)) {
    const rule = `a region with at least one point of the grid of ${grid.nTheta} x ${grid.nZ}`;
    throw new InputError(`where of ${action} at t = ${general(at)}`, region.text, rule, 'enlarge it, or refine the grid');
  }
  return out;
}

function plain(shape: string, given: Table, shapes: Catalogue['shapes'], depth: number): Region {
  if (shape === 'union' || shape === 'intersection') {
    refuseUnknown(shape, given, ['parts']);
    const { parts } = given;
    if (!Array.isArray(parts) || !parts.length) {
      throw new InputError('parts', parts, 'a list of regions', 'write parts = [{ shape = "disc", ... }, ...]');
    }
    return combined(shape, parts.map((part) => regionOf(part, shapes, depth + 1)));
  }
  if (shape === 'image') {
    throw new InputError('shape', shape, 'another one in the browser', 'open this cell with cyclosis explore, which needs Python');
  }
  const items = shapes[shape]!;
  refuseUnknown(shape, given, items.map((item) => item.name));
  const values: Table = {};
  for (const item of items) {
    if (item.needed && (given[item.name] ?? null) === null) {
      throw new InputError(item.name, null, `given for shape = ${shape}`, `add ${item.name}`);
    }
    values[item.name] = check(item, given[item.name] ?? item.default);
  }
  const text = `${shape} (${Object.entries(values).map(([name, value]) => `${name} = ${typeof value === 'number' ? general(value) : String(value)}`).join(', ')})`;
  return { table: { shape, ...values }, text, ...MADE[shape]!(values) };
}

type Made = Pick<Region, 'inside' | 'check'>;

const MADE: Record<string, (values: Table) => Made> = {
  box: (values) => {
    const { theta0, theta1, z0, z1 } = values as Record<string, number>;
    refuseNothing('theta1', theta0!, theta1!);
    refuseNothing('z1', z0!, z1!);
    return {
      inside: (theta, z, length) => between(theta, theta0!, theta1!, 2 * Math.PI) && between(z, z0!, z1!, length),
      check: (length) => {
        onTheCell('z0', z0!, length);
        onTheCell('z1', z1!, length);
      },
    };
  },
  disc: (values) => {
    const own = values as { theta: number; z: number; radius: number };
    return {
      inside: (theta, z, length) =>
        Math.hypot(nearest(theta - own.theta, 2 * Math.PI), nearest(z - own.z, length)) <= own.radius + ROUNDING,
      check: (length) => onTheCell('z', own.z, length),
    };
  },
  band: (values) => {
    const { axis, start, stop } = values as { axis: string; start: number; stop: number };
    refuseNothing('stop', start, stop);
    const around = axis === 'theta';
    for (const [name, end] of [['start', start], ['stop', stop]] as const) {
      if (around && end > 6.3) {
        throw new InputError(name, end, 'an angle from -6.3 to 6.3 radians where axis is theta', 'give it in radians, or axis = z');
      }
    }
    return {
      inside: (theta, z, length) => (around ? between(theta, start, stop, 2 * Math.PI) : between(z, start, stop, length)),
      check: (length) => {
        if (around) return;
        onTheCell('start', start, length);
        onTheCell('stop', stop, length);
      },
    };
  },
  strips: (values) => {
    const own = values as { count: number; share: number; axis: string; offset: number };
    return {
      inside: (theta, z, length) => {
        const place = own.axis === 'theta' ? theta / (2 * Math.PI) : z / length;
        return modulo(place * own.count - own.offset + ROUNDING, 1) < own.share;
      },
      check: () => undefined,
    };
  },
};

function complement(region: Region): Region {
  return {
    table: { ...region.table, invert: true },
    text: `all but ${region.text}`,
    inside: (theta, z, length) => !region.inside(theta, z, length),
    check: (length) => region.check(length),
  };
}

function combined(shape: 'union' | 'intersection', parts: Region[]): Region {
  const word = shape === 'union' ? 'or' : 'and';
  return {
    table: { shape, parts: parts.map((part) => part.table) },
    text: `(${parts.map((part) => part.text).join(` ${word} `)})`,
    inside: (theta, z, length) =>
      shape === 'union' ? parts.some((part) => part.inside(theta, z, length)) : parts.every((part) => part.inside(theta, z, length)),
    check: (length) => parts.forEach((part) => part.check(length)),
  };
}

/** The remainder with the sign of the divisor, as in Python. */
export function modulo(value: number, divisor: number): number {
  const rest = value % divisor;
  return rest < 0 ? rest + divisor : rest;
}

function between(x: number, start: number, stop: number, period: number): boolean {
  const width = stop > start ? stop - start : stop - start + period;
  return modulo(x - start + ROUNDING, period) < width || width >= period;
}

function nearest(distance: number, period: number): number {
  return modulo(distance + 0.5 * period, period) - 0.5 * period;
}

function refuseNothing(name: string, start: number, stop: number): void {
  if (start === stop) throw new InputError(name, stop, 'different from the first end', 'leave some room between the two');
}

function onTheCell(name: string, z: number, length: number): void {
  if (z >= 0 && z <= length * (1 + ROUNDING)) return;
  throw new InputError(name, z, `on the cell, from 0 to its length ${beside(length, z)}`, 'move the region, or lengthen the cell');
}

function refuseUnknown(shape: string, given: Table, known: string[]): void {
  for (const name of Object.keys(given)) {
    if (!known.includes(name)) throw new InputError('where key', name, `a key of shape ${shape}: ${[...known, 'invert'].join(', ')}`, closest(name, known));
  }
}
