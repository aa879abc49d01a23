// Colours of P_z, or of the direction of P.

import type { Palette, Wheel } from '../protocol';

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

/** Colours of a wheel as light, each from 0 to 1. */
export function lightOf(wheel: Wheel): Rgb[] {
  return wheel.colours.map((colour) => rgb(colour).map((part) => (part / 255) ** wheel.gamma) as Rgb);
}

/** The colour of an order vector, each part from 0 to 1: its direction as hue, its length as brightness. */
export function directionOf(wheel: Wheel, around: number, along: number, light = lightOf(wheel)): Rgb {
  const place = ((Math.atan2(along, around) / (0.5 * Math.PI)) % 4 + 4) % 4;
  const below = Math.floor(place) % 4;
  const share = place - Math.floor(place);
  const size = wheel.darkest + (1 - wheel.darkest) * Math.min(1, Math.hypot(around, along));
  return light[below]!.map((part, c) => (((1 - share) * part + share * light[(below + 1) % 4]![c]!) * size) ** (1 / wheel.gamma)) as Rgb;
}

const TURNS = 256;
const SIZES = 128;

/** Colours of order vectors in a table, as pixels: fast, and within a step of 255 of `directionOf`. */
export class DirectionTable {
  private readonly pixels = new Uint32Array(TURNS * SIZES);

  constructor(wheel: Wheel) {
    const light = lightOf(wheel);
    const bytes = new Uint8Array(this.pixels.buffer);
    for (let k = 0, q = 0; k < TURNS; k++) {
      for (let m = 0; m < SIZES; m++, q += 4) {
        const [angle, size] = [(2 * Math.PI * k) / TURNS, (m / (SIZES - 1)) ** 2];
        bytes.set(directionOf(wheel, size * Math.cos(angle), size * Math.sin(angle), light).map((part) => Math.round(255 * part)), q);
        bytes[q + 3] = 255;
      }
    }
  }

  /** The pixel of an order vector. */
  of(around: number, along: number): number {
    const k = ((Math.atan2(along, around) * TURNS) / (2 * Math.PI) + TURNS + 0.5) | 0;
    // Closer near zero, where colours change fastest.
    const m = (Math.sqrt(Math.min(1, Math.hypot(around, along))) * (SIZES - 1) + 0.5) | 0;
    return this.pixels[(k % TURNS) * SIZES + m]!;
  }
}

/** The colours of up and down for lines of charts: deep ones on white, bright ones on black. */
export function upAndDown({ stops }: Palette, dark: boolean): [up: string, down: string] {
  const strength = dark ? 1 : 0.33;
  const nearest = (value: number): string => stops.reduce((best, stop) => (Math.abs(stop[0] - value) < Math.abs(best[0] - value) ? stop : best))[1];
  return [nearest(strength), nearest(-strength)];
}

/** Colours of the solid besides those of its skin: its outline, its ends, and these where they turn away. */
export function solidColours(dark: boolean): { ink: string; paper: string; shade: string } {
  return dark ? { ink: '#09070b', paper: '#3a3442', shade: '#211d27' } : { ink: '#1b1720', paper: '#f6f4f8', shade: '#d8d3df' };
}
