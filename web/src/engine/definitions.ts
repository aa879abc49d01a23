import { closest, general, InputError } from './errors';

/** One setting, as `cyclosis.model.setting.Definition`: how its values are checked. */
export interface Setting {
  name: string;
  kind: 'number' | 'whole' | 'flag' | 'choice' | 'text' | 'shape' | 'names' | 'numbers';
  default: unknown;
  minimum: number;
  maximum: number;
  allowed: string[];
  optional: boolean;
  needed: boolean;
  field: boolean;
  also: number | null;
}

export type Table = Record<string, unknown>;

/** What the engine needs to know of the package besides the equation: `api/engine`. */
export interface Catalogue {
  parameters: Setting[];
  grid: Setting[];
  initial: Setting[];
  model: Setting[];
  scales: Setting[];
  interval: Setting;
  /** Which keys of [initial] each kind of initial state uses. */
  uses: Record<string, string[]>;
  kinds: string[];
  at: Setting;
  actions: Record<string, { keys: Setting[]; regional: boolean }>;
  shapes: Record<string, Setting[]>;
  presets: { name: string; tables: Record<string, Table>; protocol: Table[] }[];
  finest: number;
  mostFrames: number;
  mostPlaced: number;
  drugs: Record<string, Table>;
  /** The curves of theory for some sets of parameters besides alpha_p and alpha_u. */
  curves: { parameters: Table; curves: { name: string; alpha_p: number[]; alpha_u: number[] }[] }[];
}

function remedy(item: Setting): string {
  if (item.needed) return 'give one: there is no default';
  if (item.default === null) return 'leave it out for the default';
  return `the default is ${String(item.default)}`;
}

function span(item: Setting): string {
  const exactly = (value: number): string => (Number(general(value)) === value ? general(value) : String(value));
  return `from ${exactly(item.minimum)} to ${exactly(item.maximum)}`;
}

export function ruleOf(item: Setting): string {
  if (item.kind === 'choice') return `one of ${item.allowed.join(', ')}`;
  if (item.kind === 'flag') return 'true or false';
  if (item.kind === 'text') return 'a text';
  if (item.kind === 'shape') return 'two whole numbers [n_theta, n_z]';
  return item.also === null ? span(item) : `${span(item)}, or ${item.also}`;
}

/** The value if it is allowed. Throws `InputError` otherwise. */
export function check(item: Setting, value: unknown): unknown {
  if ((value === null || value === undefined) && item.optional) return null;
  if (item.kind === 'number') {
    const fits = typeof value === 'number' && Number.isFinite(value) && value >= item.minimum && value <= item.maximum;
    if (!fits) throw new InputError(item.name, value, `one number ${span(item)}`, remedy(item));
    return value;
  }
  if (item.kind === 'whole') return whole(item, value);
  if (item.kind === 'flag') {
    if (typeof value !== 'boolean') throw new InputError(item.name, value, 'true or false', 'write one of the two');
    return value;
  }
  if (item.kind === 'choice') {
    if (typeof value === 'string' && item.allowed.includes(value)) return value;
    throw new InputError(item.name, value, ruleOf(item), closest(value, item.allowed));
  }
  if (item.kind === 'shape') {
    if (Array.isArray(value) && value.length === 2) return value.map((part) => whole(item, part));
    throw new InputError(item.name, value, ruleOf(item), remedy(item));
  }
  if (typeof value !== 'string' || !value) throw new InputError(item.name, value, ruleOf(item), remedy(item));
  return value;
}

function whole(item: Setting, value: unknown): number {
  // Larger ones are not exact in JSON as browsers read it.
  const most = Math.min(item.maximum, Number.MAX_SAFE_INTEGER);
  const fits = typeof value === 'number' && Number.isSafeInteger(value);
  if (fits && ((value >= item.minimum && value <= most) || value === item.also)) return value;
  const range = `a whole number ${span({ ...item, maximum: most })}`;
  throw new InputError(item.name, value, item.also === null ? range : `${range}, or ${item.also}`, remedy(item));
}

/** The settings by name. */
export function byName(items: Setting[]): Record<string, Setting> {
  return Object.fromEntries(items.map((item) => [item.name, item]));
}

/** Throw `InputError` for a key that is not one of those known. */
export function knownKey(field: string, name: string, known: string[], rule: string): void {
  if (!known.includes(name)) throw new InputError(field, name, `${rule}: ${known.join(', ')}`, closest(name, known));
}
