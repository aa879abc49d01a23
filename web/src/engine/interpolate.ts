import { Transform } from './transform';

/** The highest mode that grids of n and m points both resolve. */
function highest(n: number, m: number): number {
  return Math.floor((Math.min(n, m) - 1) / 2);
}

/** A periodic real field [from0][from1] on another grid, by trigonometric interpolation, as `model.grid.interpolate`. */
export function interpolate(field: Float64Array, from: [number, number], to: [number, number]): Float64Array {
  if (from[0] === to[0] && from[1] === to[1]) return field.slice();
  const packed = new Float64Array(2 * field.length);
  field.forEach((value, at) => (packed[2 * at] = value));
  const source = new Transform(...from).forward(packed, new Float64Array(packed.length));
  const target = new Float64Array(2 * to[0] * to[1]);
  const [rows, columns] = [highest(from[0], to[0]), highest(from[1], to[1])];
  const scale = 1 / field.length;
  for (let m = -rows; m <= rows; m += 1) {
    for (let q = -columns; q <= columns; q += 1) {
      const a = 2 * (((m + from[0]) % from[0]) * from[1] + ((q + from[1]) % from[1]));
      const b = 2 * (((m + to[0]) % to[0]) * to[1] + ((q + to[1]) % to[1]));
      target[b] = scale * source[a]!;
      target[b + 1] = scale * source[a + 1]!;
    }
  }
  const out = new Transform(...to).inverse(target, new Float64Array(target.length));
  return Float64Array.from({ length: out.length / 2 }, (_, at) => out[2 * at]!);
}
