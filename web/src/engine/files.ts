import { contentsOf } from './setup';
import { inBrowser } from './socket';

const NEEDS: Record<string, string> = {
  nc: 'Data files are made by the server, and need cyclosis explore, and so Python: the settings (TOML) with cyclosis run give the same data.',
  movie: 'Movies of the whole run are made by the server, and need cyclosis explore, and so Python: “Record the screen” makes one of what you see.',
};

/** A file made without a server, or null where there is one. Throws an error that says what needs a server. */
export function madeHere(kind: string, link: string): Blob | null {
  if (!inBrowser()) return null;
  if (kind !== 'toml') throw new Error(NEEDS[kind]);
  return new Blob([tomlOf(link)], { type: 'application/toml' });
}

/** The set-up of a link as a configuration for `cyclosis run`. */
export function tomlOf(link: string): string {
  const { protocol = [], t = 0, run, ...tables } = contentsOf(link);
  const whole = { ...tables, run: { ...(run as object), t_end: t } };
  const parts = Object.entries(whole).map(([name, table]) => section(`[${name}]`, table as object));
  const steps = (protocol as object[]).map((step) => section('[[protocol]]', step));
  return [...parts, ...steps].join('\n');
}

function section(title: string, table: object): string {
  return `${title}\n${given(table).map(([key, value]) => `${key} = ${written(value)}\n`).join('')}`;
}

/** The entries that have a value. */
function given(table: object): [string, unknown][] {
  return Object.entries(table).filter(([, value]) => value !== null);
}

function written(value: unknown): string {
  if (Array.isArray(value)) return `[${value.map(written).join(', ')}]`;
  if (typeof value === 'object') return `{ ${given(value as object).map(([key, each]) => `${key} = ${written(each)}`).join(', ')} }`;
  return JSON.stringify(value); // texts, numbers and flags are written alike
}
