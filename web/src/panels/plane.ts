import { colourAt } from '../scene/palette';

/** Borders of the cells around increasing values: halfway, the first no lower than zero. */
export function borders(values: number[]): number[] {
  if (values.length === 1) return [Math.max(0, values[0]! - 0.5), values[0]! + 0.5];
  const inner = values.slice(1).map((value, k) => (value + values[k]!) / 2);
  const first = Math.max(0, 2 * values[0]! - inner[0]!);
  return [first, ...inner, 2 * values.at(-1)! - inner.at(-1)!];
}

/** The index of the cell that contains a value; the nearest for values outside. */
export function cellOf(edges: number[], value: number): number {
  const k = edges.findIndex((edge) => value < edge);
  return k < 0 ? edges.length - 2 : Math.max(0, k - 1);
}

/** The colour a share of the way from one "#rrggbb" to another. */
export function mix(from: string, to: string, share: number): string {
  return `rgb(${colourAt([[0, from], [1, to]], share).join(' ')})`;
}

/** Names of the parameters, other than the two axes, that differ from those of the diagram. */
export function others(computed: Record<string, unknown>, now: Record<string, unknown>): string[] {
  return Object.keys(computed).filter((name) => name !== 'alpha_p' && name !== 'alpha_u' && now[name] !== undefined && now[name] !== computed[name]);
}
