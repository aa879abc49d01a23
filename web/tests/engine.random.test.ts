import { createHash } from 'node:crypto';
import { describe, expect, it } from 'vitest';
import { numbersOf } from '../src/engine/base64';
import { normals, seedWords } from '../src/engine/random';
import { golden } from './golden';

interface Noise {
  streams: { seed: number; key: number[]; words: number[]; first: string; sha256: string }[];
}

describe('random numbers are those of NumPy bit for bit', () => {
  for (const { seed, key, words, first, sha256 } of golden<Noise>('noise.json').streams) {
    it(`seed ${seed}${key.length ? `, spawn key ${key.join()}` : ''}`, () => {
      expect([...seedWords(seed, key, 4)]).toEqual(words);
      const drawn = normals(2 * 128 * 128, seed, key);
      expect([...drawn.slice(0, 32)]).toEqual([...numbersOf(first)]);
      expect(createHash('sha256').update(new Uint8Array(drawn.buffer)).digest('hex')).toBe(sha256);
    });
  }
});
