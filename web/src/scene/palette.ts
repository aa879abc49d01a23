// Colours of P_z.

import type { Palette } from '../protocol';

export type Rgb = [number, number, number];

export function rgb(hex: string): Rgb {
  const value = parseInt(hex.slice(1, 7), 16);
  return [(value >> 16) & 255, (value >> 8) & 255, value & 255];
}

/** Colour of `value`, piecewise linear between the stops; beyond them the nearest. */
export function colourAt(stops: [number, string][], value: number): Rgb {
  let k = 0;
  while (k < stops.length && stops[k][0] < value) k++;
  if (k === 0) return rgb(stops[0][1]);
  if (k === stops.length) return rgb(stops[k - 1][1]);
  const [low, high] = [stops[k - 1], stops[k]];
  const a = (value - low[0]) / (high[0] - low[0] || 1);
  const [from, to] = [rgb(low[1]), rgb(high[1])];
  return [0, 1, 2].map((c) => Math.round(from[c] + a * (to[c] - from[c]))) as Rgb;
}

/** `count` colours from -1 to 1 as bytes r, g, b, 255. */
export function paletteTable(palette: Palette, count: number): Uint8Array<ArrayBuffer> {
  const table = new Uint8Array(4 * count);
  for (let k = 0; k < count; k++) {
    const colour = colourAt(palette.stops, -1 + (2 * k) / (count - 1));
    table.set(colour, 4 * k);
    table[4 * k + 3] = 255;
  }
  return table;
}
