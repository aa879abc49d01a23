import { contentsOf, linkOf, type SetUp } from '../engine/setup';

export type Value = number | boolean;

type Table = Record<string, unknown>;

/**
 * The link of the same cell, of the same seed, that has always had another value of one parameter. Changes of that
 * parameter by hand, which are those of the first cell, keep it; drugs, ramps and regions act in both.
 */
export function otherLink(link: string, name: string, value: Value, drugs: Table[] = DRUGS): string {
  const { protocol = [], t = 0, ...tables } = contentsOf(link);
  const given = Object.fromEntries(Object.entries(tables).map(([key, table]) => [key, { ...(table as object) }])) as SetUp['tables'];
  given.parameters = { ...given.parameters, [name]: value };
  const steps = (protocol as Table[]).map((step) => {
    const byHand = step.action === 'change' && name in step && !step.over && !step.where;
    return byHand && !drugs.some((drug) => name in drug && drug[name] === step[name]) ? { ...step, [name]: value } : step;
  });
  return linkOf({ tables: given, steps, t: t as number });
}

/** The link of the same cell at another time. */
export function linkAt(link: string, t: number): string {
  const { protocol = [], t: _other, ...tables } = contentsOf(link);
  return linkOf({ tables: tables as SetUp['tables'], steps: protocol as Table[], t });
}

/** The value of a parameter with which a cell began, if its link gives one. */
export function valueIn(link: string, name: string): Value | null {
  const { parameters = {} } = contentsOf(link) as { parameters?: Table };
  const value = parameters[name];
  return typeof value === 'number' || typeof value === 'boolean' ? value : null;
}

/** What drugs do, as `explorer/session.py`. */
const DRUGS: Table[] = [{ alpha_p: 0 }, { alpha_u: 0 }];
