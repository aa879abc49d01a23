import { numbersOf } from './base64';
import tables from './ziggurat.json';

// The random numbers of `numpy.random.default_rng(seed).normal()`, bit for bit: SeedSequence, PCG64 and the ziggurat
// of NumPy (BSD-3-Clause; the tables are those of its `ziggurat_constants.h`). One number in 4000 is drawn from the
// tail, by log1p, whose last bit may depend on the platform; it did not in the 295 000 numbers of the tests.

const POOL = 4;
const MASK128 = (1n << 128n) - 1n;
const MASK64 = (1n << 64n) - 1n;
const MULTIPLIER = 0x2360ed051fc65da44385df649fccf645n;

/** Whole numbers from 0 as 32-bit words, the lowest first. */
function words(value: number): number[] {
  const out = [value % 2 ** 32];
  for (let left = Math.floor(value / 2 ** 32); left > 0; left = Math.floor(left / 2 ** 32)) out.push(left % 2 ** 32);
  return out;
}

/** `numpy.random.SeedSequence(seed, spawn_key=key).generate_state(count)`: 32-bit words. */
export function seedWords(seed: number, key: readonly number[], count: number): Uint32Array {
  const entropy = words(seed);
  // With a spawn key, the seed is padded to the size of the pool, so that the two cannot be confused.
  if (key.length) while (entropy.length < POOL) entropy.push(0);
  for (const part of key) entropy.push(...words(part));
  const pool = new Uint32Array(POOL);
  let constant = 0x43b0d7e5;
  const hashed = (value: number): number => {
    const mixed = value ^ constant;
    constant = Math.imul(constant, 0x931e8875);
    const out = Math.imul(mixed, constant);
    return (out ^ (out >>> 16)) >>> 0;
  };
  const mix = (x: number, y: number): number => {
    const out = (Math.imul(0xca01f9dd, x) - Math.imul(0x4973f715, y)) | 0;
    return (out ^ (out >>> 16)) >>> 0;
  };
  for (let i = 0; i < POOL; i += 1) pool[i] = hashed(entropy[i] ?? 0);
  for (let from = 0; from < POOL; from += 1) {
    for (let to = 0; to < POOL; to += 1) if (from !== to) pool[to] = mix(pool[to]!, hashed(pool[from]!));
  }
  for (let from = POOL; from < entropy.length; from += 1) {
    for (let to = 0; to < POOL; to += 1) pool[to] = mix(pool[to]!, hashed(entropy[from]!));
  }
  let other = 0x8b51f9dd;
  return Uint32Array.from({ length: count }, (_, i) => {
    const mixed = pool[i % POOL]! ^ other;
    other = Math.imul(other, 0x58f38ded);
    const out = Math.imul(mixed, other);
    return (out ^ (out >>> 16)) >>> 0;
  });
}

/** A stream of 64-bit words: PCG64 (XSL-RR 128/64), seeded as by NumPy. */
export class Stream {
  private state: bigint;
  private readonly increment: bigint;

  constructor(seed: number, key: readonly number[] = []) {
    const w = seedWords(seed, key, 8);
    const word = (k: number): bigint => BigInt(w[2 * k]!) | (BigInt(w[2 * k + 1]!) << 32n);
    const [first, second] = [(word(0) << 64n) | word(1), (word(2) << 64n) | word(3)];
    this.increment = ((second << 1n) | 1n) & MASK128;
    this.state = ((this.increment + first) * MULTIPLIER + this.increment) & MASK128;
  }

  next(): bigint {
    this.state = (this.state * MULTIPLIER + this.increment) & MASK128;
    const folded = (this.state >> 64n) ^ (this.state & MASK64);
    const turn = this.state >> 122n;
    return ((folded >> turn) | (folded << (64n - turn))) & MASK64;
  }

  /** A number in [0, 1) with 53 random bits. */
  uniform(): number {
    return Number(this.next() >> 11n) / 2 ** 53;
  }
}

const KI = numbersOf(tables.ki);
const WI = numbersOf(tables.wi);
const FI = numbersOf(tables.fi);
const RIGHT = 3.6541528853610087963519472518;
const INVERSE_RIGHT = 0.27366123732975827203338247596;

/** The next standard normal number of a stream. */
export function normal(stream: Stream): number {
  for (;;) {
    const bits = stream.next();
    const box = Number(bits & 0xffn);
    const negative = (bits >> 8n) & 1n;
    const magnitude = Number((bits >> 9n) & 0xfffffffffffffn);
    const x = magnitude * WI[box]! * (negative ? -1 : 1);
    if (magnitude < KI[box]!) return x;
    if (box === 0) {
      for (;;) {
        const beyond = -INVERSE_RIGHT * Math.log1p(-stream.uniform());
        const height = -Math.log1p(-stream.uniform());
        if (height + height > beyond * beyond) return (Math.floor(magnitude / 256) % 2 ? -1 : 1) * (RIGHT + beyond);
      }
    }
    if ((FI[box - 1]! - FI[box]!) * stream.uniform() + FI[box]! < Math.exp(-0.5 * x * x)) return x;
  }
}

/** `count` standard normal numbers. */
export function normals(count: number, seed: number, key: readonly number[] = []): Float64Array {
  const stream = new Stream(seed, key);
  return Float64Array.from({ length: count }, () => normal(stream) + 0);
}
