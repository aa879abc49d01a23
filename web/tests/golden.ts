import { readFileSync } from 'node:fs';
import { numbersOf } from '../src/engine/base64';
import type { State } from '../src/engine/grid';

/** One of the files that `golden/make.py` writes from the library. */
export function golden<T>(name: string): T {
  return JSON.parse(readFileSync(new URL(`golden/${name}`, import.meta.url), 'utf8')) as T;
}

export function stateOfText(text: string): State {
  const both = numbersOf(text);
  return [both.slice(0, both.length / 2), both.slice(both.length / 2)];
}

/** The largest difference of two states over the largest value of the second. */
export function apart(found: State, expected: State): number {
  let [difference, largest] = [0, 0];
  expected.forEach((part, k) => part.forEach((value, at) => {
    const distance = Math.abs(found[k]![at]! - value);
    difference = distance <= difference ? difference : distance; // NaN is kept
    largest = Math.max(largest, Math.abs(value));
  }));
  return difference / largest;
}
