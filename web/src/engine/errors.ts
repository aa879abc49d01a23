/** Input that cannot be used: the sentence of `cyclosis.InputError`. */
export class InputError extends Error {
  constructor(readonly field: string, readonly value: unknown, readonly rule: string, readonly remedy: string) {
    super(`${field} = ${shown(value)} cannot be used: it must be ${rule}; ${remedy}.`);
    this.name = 'InputError';
  }
}

/** A value as a short text of one line. */
export function shown(value: unknown, width = 60): string {
  const text = typeof value === 'string' ? `'${value}'` : value === undefined || value === null ? 'None' : JSON.stringify(value);
  const line = text.split(/\s+/).join(' ');
  return line.length <= width ? line : `${line.slice(0, width - 3)}...`;
}

/** Numbers as Python's format "g" prints them. */
export function general(value: number, digits = 6): string {
  if (value === 0 || !Number.isFinite(value)) return String(value).replace('Infinity', 'inf').toLowerCase();
  const [mantissa, exponent] = value.toExponential(digits - 1).split('e') as [string, string];
  const power = Number(exponent);
  const trimmed = (text: string): string => (text.includes('.') ? text.replace(/\.?0+$/, '') : text);
  if (power < -4 || power >= digits) {
    const size = String(Math.abs(power)).padStart(2, '0');
    return `${trimmed(mantissa)}e${power < 0 ? '-' : '+'}${size}`;
  }
  return trimmed(value.toFixed(Math.max(0, digits - 1 - power)));
}

/** A number as a text that compares with another, exactly printed, as the two numbers do: `model.wording.beside`. */
export function beside(value: number, other: number, digits = 6): string {
  for (let count = digits; count < 17; count += 1) {
    const text = general(value, count);
    const printed = Number(text);
    if (printed < other === value < other && printed > other === value > other) return text;
  }
  return String(value);
}

/** The one of some names that is most like another, as a remedy. */
export function closest(name: unknown, known: Iterable<string>): string {
  const near = [...known].map((each) => [distance(String(name).toLowerCase(), each.toLowerCase()), each] as const);
  near.sort(([a], [b]) => a - b);
  const [first] = near;
  return first && first[0] <= Math.max(1, 0.4 * first[1].length) ? `did you mean ${first[1]}` : 'check the spelling';
}

/** How many letters must be changed, added or removed to get from one word to another. */
function distance(one: string, other: string): number {
  let row = Array.from({ length: other.length + 1 }, (_, k) => k);
  for (let i = 1; i <= one.length; i += 1) {
    const next = [i];
    for (let j = 1; j <= other.length; j += 1) {
      next.push(Math.min(row[j]! + 1, next[j - 1]! + 1, row[j - 1]! + (one[i - 1] === other[j - 1] ? 0 : 1)));
    }
    row = next;
  }
  return row[other.length]!;
}
