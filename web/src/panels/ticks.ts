// Room for the numbers next to a chart, however small these are.

import { short } from './scales';

/** Pixels of an axis that holds numbers of ordinary size, so that charts side by side are alike. */
export const USUAL = 40;
const GAP = 6;

/** Ticks as texts, with as many digits as the finest needs. */
export function tickTexts(ticks: number[]): string[] {
  return ticks.map((tick) => short(tick, 6));
}

/** Pixels that an axis with these texts needs; `width` measures one text. */
export function roomFor(texts: readonly string[], width: (text: string) => number): number {
  return Math.max(USUAL, ...texts.map((text) => Math.ceil(width(text)) + GAP));
}

/** Pixels to leave beyond the end of a horizontal axis, which may end in the middle of its last text. */
export function roomBeyond(texts: readonly string[], width: (text: string) => number): number {
  return Math.max(GAP, Math.ceil(width(texts.at(-1) ?? '') / 2) + 1);
}
