// The theme and the colours of the page, as they are kept.

import type { Palette, Wheel } from '../protocol';
import { directionOf, upAndDown } from '../scene/palette';
import { kept } from './kept';

export type Theme = 'auto' | 'light' | 'dark';

export const system = matchMedia('(prefers-color-scheme: dark)');

export function keptTheme(): Theme {
  const theme = kept('theme');
  return theme === 'light' || theme === 'dark' ? theme : 'auto';
}

export function isDark(theme: Theme = keptTheme()): boolean {
  return theme === 'dark' || (theme === 'auto' && system.matches);
}

export function keptPalette(palettes: Palette[]): Palette {
  return palettes.find((p) => p.name === kept('palette')) ?? palettes[0]!;
}

/** Give the page the colours of a palette. */
export function dress(palette: Palette, dark: boolean): void {
  const stops = palette.stops.map(([value, colour]) => `${colour} ${(50 * (value + 1)).toFixed(1)}%`);
  const { style } = document.documentElement;
  style.setProperty('--polarity', `linear-gradient(to right, ${stops.join(', ')})`);
  const [up, down] = upAndDown(palette, dark);
  style.setProperty('--up', up);
  style.setProperty('--down', down);
  style.setProperty('--wheel', palette.wheel ? conic(palette.wheel) : 'none');
  document.documentElement.classList.toggle('wheeled', palette.wheel !== null);
}

/** The colours of all directions around a disc, up at its top. */
function conic(wheel: Wheel): string {
  const colours = Array.from({ length: 33 }, (_, k) => {
    const angle = 0.5 * Math.PI - (2 * Math.PI * k) / 32; // clockwise from the top
    return `rgb(${directionOf(wheel, Math.cos(angle), Math.sin(angle)).map((part) => Math.round(255 * part)).join(' ')})`;
  });
  return `radial-gradient(#000, transparent 70%), conic-gradient(${colours.join(', ')})`;
}
