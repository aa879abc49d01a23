import { check, knownKey, type Catalogue, type Table } from './definitions';
import { beside, closest, general, InputError } from './errors';
import { instant } from './instants';
import { regionOf, type Region } from './regions';

// What is done to a running cell, and when, as `dynamics/steps.py` and `dynamics/protocol.py`.

const MOST_STEPS = 1000;
const LONGEST = 50_000;
const SHORTEST_RAMP = 1e-6;

export interface Step {
  action: 'change' | 'fragment' | 'depolymerise' | 'align' | 'noise' | 'wash_out';
  at: number;
  /** The time at which the step has ended. */
  until: number;
  over: number;
  where: Region | null;
  /** The settings of the action, checked; for a change the new values of parameters. */
  values: Table;
  /** The step as a table, as in a file. */
  table: Table;
  text: string;
}

export interface Protocol {
  steps: Step[];
  seed: number;
}

const RANDOM = new Set<string>(['fragment', 'noise']);
const ON_STATE = new Set<string>(['fragment', 'depolymerise', 'align', 'noise']);

export function isRandom(step: Step): boolean {
  return RANDOM.has(step.action);
}

export function actsOnState(step: Step): boolean {
  return ON_STATE.has(step.action);
}

/** The step that a table describes. Throws `InputError` for any mistake in it. */
export function stepOf(table: unknown, about: Catalogue): Step {
  if (typeof table !== 'object' || table === null || Array.isArray(table)) {
    throw new InputError('step', table, 'a table', 'write at = ..., action = ...');
  }
  const { action, where, ...given } = table as Table;
  const actions = Object.keys(about.actions);
  if (typeof action !== 'string' || !actions.includes(action)) {
    throw new InputError('action', action, `one of ${actions.join(', ')}`, closest(action, actions));
  }
  const { keys, regional } = about.actions[action]!;
  const items = [about.at, ...keys];
  const known = [...items.map((item) => item.name), ...(regional ? ['where'] : [])];
  for (const name of Object.keys(given)) knownKey('key', name, known, `a key of action ${action}`);
  if (where !== undefined) knownKey('key', 'where', known, `a key of action ${action}`);
  const values: Table = {};
  for (const item of items) {
    const value = given[item.name] ?? null;
    if (item.needed && value === null) throw new InputError(item.name, null, `given for action ${action}`, `add ${item.name}`);
    // A change has only the values that are given.
    if (action === 'change' && value === null && item.name !== 'over') continue;
    values[item.name] = check(item, value ?? item.default);
  }
  const { at: began, over = 0, ...rest } = values as Table & { at: number; over?: number };
  const at = instant(began);
  const region = where === undefined ? null : regionOf(where, about.shapes);
  const step = { action, at, until: instant(at + over), over, where: region, values: rest } as Step;
  refuseImpossible(step, about);
  return finished(step);
}

/** The protocol of steps in any order: sorted by time, with seeds for the random ones. */
export function protocolOf(steps: Step[], seed: number): Protocol {
  if (steps.length > MOST_STEPS) {
    throw new InputError('protocol', `${steps.length} steps`, `at most ${MOST_STEPS} steps`, 'leave out some');
  }
  const ordered = [...steps].sort((a, b) => a.at - b.at);
  const taken = new Set(ordered.map((step) => step.values.seed));
  let next = 1;
  const seeded = ordered.map((step) => {
    if (!isRandom(step) || (step.values.seed ?? null) !== null) return step;
    while (taken.has(next)) next += 1;
    const own = finished({ ...step, values: { ...step.values, seed: next } });
    next += 1;
    return own;
  });
  refuseOverlaps(seeded);
  const size = JSON.stringify(seeded.map((step) => step.table)).length;
  if (size > LONGEST) {
    const rule = `at most ${LONGEST} characters long when stored`;
    throw new InputError('protocol', `${size} characters`, rule, 'use fewer or simpler images and regions');
  }
  return { steps: seeded, seed };
}

/** The protocol that a list of tables describes. */
export function protocolOfTables(tables: unknown, seed: number, about: Catalogue): Protocol {
  if (!Array.isArray(tables)) throw new InputError('protocol', tables, 'a list of tables', 'write [[protocol]] above each step');
  const steps = tables.map((table, k) => {
    try {
      return stepOf(table, about);
    } catch (error) {
      if (!(error instanceof InputError)) throw error;
      throw new InputError(`${error.field} in step ${k + 1} of the protocol`, error.value, error.rule, error.remedy);
    }
  });
  return protocolOf(steps, seed);
}

/** The step with its table and its text. */
function finished(step: Step): Step {
  const { action, at, over, until, where, values } = step;
  const table: Table = { at, action };
  for (const [name, value] of Object.entries(values)) if (value !== null) table[name] = value;
  if (over) table.over = over;
  if (where) table.where = where.table;
  const span = over ? `t = ${general(at)} to ${general(until)}` : `t = ${general(at)}`;
  const text = `${span}: ${what(step)}${where ? `, in ${where.text}` : ''}`;
  return { ...step, table, text };
}

function what({ action, values }: Step): string {
  const value = (name: string): string => general(values[name] as number);
  switch (action) {
    case 'change':
      return Object.entries(values).map(([name, to]) => `${name} = ${typeof to === 'number' ? general(to) : String(to)}`).join(', ');
    case 'fragment':
      return `fragment to ${value('filaments_per_square')} filaments per square`;
    case 'depolymerise':
      return `depolymerise to ${value('keep')} of P`;
    case 'align':
      return `align to ${value('magnitude')} at angle ${value('angle')}`;
    case 'noise':
      return `add noise of size ${value('size')}`;
    case 'wash_out':
      return 'wash out';
  }
}

function refuseImpossible(step: Step, about: Catalogue): void {
  const { action, at, over, until, where, values } = step;
  if (over > 0 && over < SHORTEST_RAMP) {
    throw new InputError('over', over, `0 or at least ${SHORTEST_RAMP}`, 'leave it out for a jump');
  }
  if (over && until === at) {
    const rule = `long enough to differ from 0 in the 12 digits of a time near ${at}`;
    throw new InputError('over', over, rule, 'lengthen the ramp, or leave it out for a jump');
  }
  if (action !== 'change') return;
  if (!Object.keys(values).length) throw new InputError('change', {}, 'given at least one parameter', 'add alpha_p = 0, for example');
  for (const item of about.parameters) {
    if (!(item.name in values)) continue;
    if (where && !item.field) {
      const able = about.parameters.filter((each) => each.field).map((each) => each.name).join(', ');
      throw new InputError(item.name, values[item.name], `changed on the whole surface; only ${able} may differ from place to place`, 'leave out where');
    }
    if (over && item.kind === 'flag') {
      throw new InputError(item.name, values[item.name], 'changed at once, because it is true or false', 'leave out over');
    }
  }
}

function refuseOverlaps(steps: Step[]): void {
  const changed = new Set<string>();
  const ends = new Map<string, [number, number]>();
  for (const step of steps) {
    const own = step.action === 'change' ? Object.keys(step.values) : [];
    own.forEach((name) => changed.add(name));
    for (const name of step.action === 'wash_out' ? changed : own) {
      const [begin, end] = ends.get(name) ?? [0, 0];
      if (step.at < end) {
        const rule = `at least ${beside(end, step.at)}, the end of the ramp of ${name} that begins at ${general(begin)}`;
        throw new InputError(`at of ${step.action}`, step.at, rule, 'let one change end before the next');
      }
      const until = name === 'zero_theta_flux' ? step.at : step.until; // a flag changes at once
      if (until > end) ends.set(name, [step.at, until]);
    }
  }
}
