import { unzlibSync, zlibSync } from 'fflate';
import { check, knownKey, type Catalogue, type Setting, type Table } from './definitions';
import { closest, InputError } from './errors';
import { Grid, type State } from './grid';
import { checkInitial, initialState } from './initial';
import { isRandom, protocolOfTables, type Protocol } from './protocol';
import type { Params } from './values';

// The set-up of a cell: tables, the steps of its protocol, and the time reached, as `explorer/setup.py`. A link is
// the same text as there, so that it opens in either engine.

const TABLES = ['model', 'parameters', 'grid', 'initial', 'run', 'scales'] as const;
const LONGEST_LINK = 40_000;
const LONGEST_TEXT = 200_000;
const LINK_RULE = 'the part of an address of the explorer after #';
const ELSEWHERE = 'use cyclosis run, which needs Python';

export type Tables = Record<(typeof TABLES)[number], Table>;

export interface SetUp {
  tables: Tables;
  steps: unknown[];
  t: number;
}

export interface Ready {
  params: Params;
  grid: Grid;
  state: State;
  every: number;
  protocol: Protocol;
}

/** The set-up that tables describe. Throws `InputError` for any mistake, and beyond the limits. */
export function setUpOf(given: unknown, steps: unknown, t: unknown, about: Catalogue): SetUp {
  if (!isTable(given)) throw new InputError('cell', given, 'a set of tables', 'give parameters, grid, initial or run');
  for (const name of Object.keys(given)) {
    if (!(TABLES as readonly string[]).includes(name)) {
      throw new InputError('table', name, `one of ${TABLES.map((each) => `[${each}]`).join(', ')}, [[protocol]]`, closest(name, TABLES));
    }
  }
  const known: Record<string, Setting[]> = {
    model: about.model, parameters: about.parameters, grid: about.grid, initial: about.initial, run: [about.interval], scales: about.scales,
  };
  const tables = Object.fromEntries(TABLES.map((name) => [name, checked(name, given[name] ?? {}, known[name]!)])) as Tables;
  tables.run.save_every ??= about.interval.default;
  refuseDear(tables, steps, about);
  const every = tables.run.save_every as number;
  if (typeof t !== 'number' || !(t >= 0 && t <= every * about.mostFrames)) {
    throw new InputError('t', t, `one number from 0 to ${every * about.mostFrames}`, 'begin again');
  }
  return { tables, steps: (steps ?? []) as unknown[], t };
}

/** A set-up with the scales in whose units it is shown; dimensionless without. */
export function scaled(setUp: SetUp, scales: Table | null, about: Catalogue): SetUp {
  return { ...setUp, tables: { ...setUp.tables, scales: checked('scales', scales ?? {}, about.scales) } };
}

/** The set-up of a link. Throws `InputError` for a text that is not a link, or not of a cell. */
export function setUpOfLink(link: string, about: Catalogue): SetUp {
  const { protocol = [], t = 0, ...tables } = contentsOf(link);
  return setUpOf(tables, protocol, t, about);
}

/** What is packed in a link, unchecked. Throws `InputError` for a text that is not a link. */
export function contentsOf(link: string): Table {
  try {
    if (link.length > LONGEST_LINK) throw new Error('too long');
    const letters = atob(link.replaceAll('-', '+').replaceAll('_', '/'));
    const bytes = unzlibSync(Uint8Array.from(letters, (letter) => letter.charCodeAt(0)), { out: new Uint8Array(LONGEST_TEXT) });
    const given: unknown = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(bytes));
    if (!isTable(given)) throw new Error('not a table');
    return given;
  } catch {
    throw new InputError('link', link, LINK_RULE, 'copy the whole address');
  }
}

/** The set-up as a short text for an address. */
export function linkOf(setUp: SetUp): string {
  const whole = Object.fromEntries(Object.entries(setUp.tables).filter(([, table]) => Object.keys(table).length));
  const text = JSON.stringify({ ...whole, protocol: setUp.steps, t: setUp.t });
  const packed = zlibSync(new TextEncoder().encode(text), { level: 9 });
  const letters = Array.from(packed, (byte) => String.fromCharCode(byte)).join('');
  return btoa(letters).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
}

/** What a run needs. Throws `InputError` for settings that are inconsistent. */
export function ready(setUp: SetUp, about: Catalogue): Ready {
  const { tables } = setUp;
  const all = filled(setUp, about);
  for (const [name, value] of Object.entries(tables.grid)) {
    if (!['n_theta', 'n_z', 'length'].includes(name) && value !== null) {
      throw new InputError(name, value, 'used only where [model] kind is closed', 'remove it, or choose that model');
    }
  }
  const { n_theta, n_z, length } = all.grid as { n_theta: number; n_z: number; length: number };
  const grid = new Grid(n_theta, n_z, length);
  let given = { ...tables.initial };
  const protocol = protocolOfTables(setUp.steps, (given.seed ?? 0) as number, about);
  checkMemory(protocol, grid, about);
  if (protocol.steps.some(isRandom) && !('filaments_per_square' in given) && kindOf(tables, about) !== 'disordered') {
    const { seed: _usedByTheProtocolAlone, ...rest } = given;
    given = rest;
  }
  checkInitial(given, about.uses, 'disordered');
  const state = initialState(given, grid);
  return { params: all.parameters as unknown as Params, grid, state, every: tables.run.save_every as number, protocol };
}

/** The tables with every default that has a value filled in. */
export function filled({ tables }: SetUp, about: Catalogue): Tables {
  const defaults = (items: Setting[]): Table => Object.fromEntries(items.map((item) => [item.name, item.default]));
  const kind = kindOf(tables, about);
  // In an ordered state, noise that is left out is zero, not its default.
  const noise = kind === 'disordered' ? [] : ['seed', 'filaments_per_square', 'noise_grid'];
  const used = new Set(['kind', ...about.uses[kind]!.filter((name) => !noise.includes(name))]);
  const initial = Object.fromEntries(Object.entries(defaults(about.initial)).filter(([name]) => used.has(name)));
  return {
    model: { kind: 'polar', ...tables.model },
    parameters: { ...defaults(about.parameters), ...tables.parameters },
    grid: { ...defaults(about.grid), ...tables.grid },
    initial: { ...initial, ...tables.initial },
    run: { ...tables.run },
    scales: { ...tables.scales },
  };
}

/** Throw `InputError` for a protocol that would take much memory. */
export function checkMemory(protocol: Protocol, grid: Grid, about: Catalogue): void {
  const placed = protocol.steps.some((step) => step.action === 'change' && step.where);
  const most = Math.floor(about.mostPlaced / grid.size);
  if (!placed || protocol.steps.length <= most) return;
  const rule = `at most ${most} on ${grid.nTheta} x ${grid.nZ} points where a step changes parameters in a region`;
  throw new InputError('steps', protocol.steps.length, rule, 'use fewer steps or points');
}

function kindOf(tables: Tables, about: Catalogue): string {
  return (tables.initial.kind ?? about.initial.find((item) => item.name === 'kind')!.default) as string;
}

function isTable(value: unknown): value is Table {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

function checked(name: string, table: unknown, items: Setting[]): Table {
  if (!isTable(table)) throw new InputError(name, table, 'a table', `write [${name}] on a line of its own`);
  return Object.fromEntries(Object.entries(table).map(([key, value]) => {
    knownKey(`${name} key`, key, items.map((item) => item.name), `a key of [${name}]`);
    const item = items.find((each) => each.name === key)!;
    if (item.field && Array.isArray(value)) throw new InputError('parameters', 'a field', 'numbers in the explorer', 'use a step with where');
    return [key, check(item, value)];
  }));
}

/** Refuse what the explorer does not offer, as its server does. */
function refuseDear(tables: Tables, steps: unknown, about: Catalogue): void {
  const { finest } = about;
  if (tables.model.kind === 'closed') {
    throw new InputError('model kind', 'closed', 'polar where the browser computes without a server', 'start `cyclosis explore` to see closed cells');
  }
  for (const name of ['n_theta', 'n_z']) {
    const points = (tables.grid[name] ?? 0) as number;
    if (points > finest) throw new InputError(name, points, `at most ${finest} in the explorer`, ELSEWHERE);
  }
  for (const [name, value] of Object.entries(tables.model)) {
    if (value !== about.model.find((item) => item.name === name)!.default) {
      const rule = "left out in the explorer, which shows the polar model by the paper's closure";
      throw new InputError(name, value, rule, ELSEWHERE);
    }
  }
  const kind = kindOf(tables, about);
  if (!about.kinds.includes(kind)) throw new InputError('kind', kind, `one of ${about.kinds.join(', ')} in the explorer`, 'choose another');
  const shape = (tables.initial.noise_grid ?? []) as number[];
  if (shape.some((points) => points > finest) || ((tables.initial.stripes ?? 2) as number) > finest) {
    throw new InputError('initial', tables.initial, `at most ${finest} points or stripes`, 'use fewer');
  }
  for (const step of Array.isArray(steps) ? (steps as unknown[]) : []) {
    const drawn = isTable(step) ? step.noise_grid : null;
    if (Array.isArray(drawn) && drawn.some((points) => (points as number) > finest)) {
      throw new InputError('noise_grid', drawn, `at most ${finest} x ${finest} in the explorer`, ELSEWHERE);
    }
  }
}
