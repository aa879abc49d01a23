// The stage of a transform for the radix 8, as the others in `radices.ts`.

const HALF = Math.SQRT1_2;

/** Eight at once: fewer passes through memory than `four` and `two`. */
export function eight(x: Float64Array, y: Float64Array, n: number, s: number, lines: number, w: Float64Array, step: number, sign: number): void {
  const m = n / 8;
  const a = 2 * s * m;
  const o = 2 * s;
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n * s) {
    for (let p = 0; p < m; p += 1) {
      const k = 2 * p * step;
      const w1r = w[k]!, w1i = w[k + 1]!, w2r = w[2 * k]!, w2i = w[2 * k + 1]!, w3r = w[3 * k]!, w3i = w[3 * k + 1]!, w4r = w[4 * k]!, w4i = w[4 * k + 1]!;
      const w5r = w[5 * k]!, w5i = w[5 * k + 1]!, w6r = w[6 * k]!, w6i = w[6 * k + 1]!, w7r = w[7 * k]!, w7i = w[7 * k + 1]!;
      let i0 = base + 2 * s * p;
      let j = base + 16 * s * p;
      for (const end = i0 + 2 * s; i0 < end; i0 += 2, j += 2) {
        const i1 = i0 + a, i2 = i1 + a, i3 = i2 + a, i4 = i3 + a, i5 = i4 + a, i6 = i5 + a, i7 = i6 + a;
        const ar = x[i0]! + x[i4]!, ai = x[i0 + 1]! + x[i4 + 1]!, Ar = x[i0]! - x[i4]!, Ai = x[i0 + 1]! - x[i4 + 1]!;
        const br = x[i2]! + x[i6]!, bi = x[i2 + 1]! + x[i6 + 1]!, Br = x[i2]! - x[i6]!, Bi = x[i2 + 1]! - x[i6 + 1]!;
        const cr = x[i1]! + x[i5]!, ci = x[i1 + 1]! + x[i5 + 1]!, Cr = x[i1]! - x[i5]!, Ci = x[i1 + 1]! - x[i5 + 1]!;
        const dr = x[i3]! + x[i7]!, di = x[i3 + 1]! + x[i7 + 1]!, Dr = x[i3]! - x[i7]!, Di = x[i3 + 1]! - x[i7 + 1]!;
        // Even waves from the sums, as in `four`.
        const er = ar + br, ei = ai + bi, fr = ar - br, fi = ai - bi;
        const gr = cr + dr, gi = ci + di, hr = sign * (ci - di), hi = sign * (dr - cr);
        // Odd waves from the differences: those of the second half are turned by one and by three eighths.
        const kr = Ar + sign * Bi, ki = Ai - sign * Br, lr = Ar - sign * Bi, li = Ai + sign * Br;
        const mr = Cr + sign * Di, mi = Ci - sign * Dr, nr = Cr - sign * Di, ni = Ci + sign * Dr;
        const or = HALF * (mr + sign * mi), oi = HALF * (mi - sign * mr), qr = HALF * (sign * ni - nr), qi = -HALF * (ni + sign * nr);
        const t1r = kr + or, t1i = ki + oi;
        const t2r = fr + hr, t2i = fi + hi;
        const t3r = lr + qr, t3i = li + qi;
        const t4r = er - gr, t4i = ei - gi;
        const t5r = kr - or, t5i = ki - oi;
        const t6r = fr - hr, t6i = fi - hi;
        const t7r = lr - qr, t7i = li - qi;
        y[j] = er + gr;
        y[j + 1] = ei + gi;
        y[j + o] = t1r * w1r - t1i * w1i;
        y[j + o + 1] = t1r * w1i + t1i * w1r;
        y[j + 2 * o] = t2r * w2r - t2i * w2i;
        y[j + 2 * o + 1] = t2r * w2i + t2i * w2r;
        y[j + 3 * o] = t3r * w3r - t3i * w3i;
        y[j + 3 * o + 1] = t3r * w3i + t3i * w3r;
        y[j + 4 * o] = t4r * w4r - t4i * w4i;
        y[j + 4 * o + 1] = t4r * w4i + t4i * w4r;
        y[j + 5 * o] = t5r * w5r - t5i * w5i;
        y[j + 5 * o + 1] = t5r * w5i + t5i * w5r;
        y[j + 6 * o] = t6r * w6r - t6i * w6i;
        y[j + 6 * o + 1] = t6r * w6i + t6i * w6r;
        y[j + 7 * o] = t7r * w7r - t7i * w7i;
        y[j + 7 * o + 1] = t7r * w7i + t7i * w7r;
      }
    }
  }
}

/** `eight` where the length left is eight, and so all roots are 1. */
export function lastEight(x: Float64Array, y: Float64Array, s: number, lines: number, sign: number): void {
  const a = 2 * s;
  for (let line = 0, base = 0; line < lines; line += 1, base += 16 * s) {
    for (let i0 = base, end = base + a; i0 < end; i0 += 2) {
      const i1 = i0 + a, i2 = i1 + a, i3 = i2 + a, i4 = i3 + a, i5 = i4 + a, i6 = i5 + a, i7 = i6 + a;
      const ar = x[i0]! + x[i4]!, ai = x[i0 + 1]! + x[i4 + 1]!, Ar = x[i0]! - x[i4]!, Ai = x[i0 + 1]! - x[i4 + 1]!;
      const br = x[i2]! + x[i6]!, bi = x[i2 + 1]! + x[i6 + 1]!, Br = x[i2]! - x[i6]!, Bi = x[i2 + 1]! - x[i6 + 1]!;
      const cr = x[i1]! + x[i5]!, ci = x[i1 + 1]! + x[i5 + 1]!, Cr = x[i1]! - x[i5]!, Ci = x[i1 + 1]! - x[i5 + 1]!;
      const dr = x[i3]! + x[i7]!, di = x[i3 + 1]! + x[i7 + 1]!, Dr = x[i3]! - x[i7]!, Di = x[i3 + 1]! - x[i7 + 1]!;
      // Even waves from the sums, as in `four`.
      const er = ar + br, ei = ai + bi, fr = ar - br, fi = ai - bi;
      const gr = cr + dr, gi = ci + di, hr = sign * (ci - di), hi = sign * (dr - cr);
      // Odd waves from the differences: those of the second half are turned by one and by three eighths.
      const kr = Ar + sign * Bi, ki = Ai - sign * Br, lr = Ar - sign * Bi, li = Ai + sign * Br;
      const mr = Cr + sign * Di, mi = Ci - sign * Dr, nr = Cr - sign * Di, ni = Ci + sign * Dr;
      const or = HALF * (mr + sign * mi), oi = HALF * (mi - sign * mr), qr = HALF * (sign * ni - nr), qi = -HALF * (ni + sign * nr);
      y[i0] = er + gr;
      y[i0 + 1] = ei + gi;
      y[i1] = kr + or;
      y[i1 + 1] = ki + oi;
      y[i2] = fr + hr;
      y[i2 + 1] = fi + hi;
      y[i3] = lr + qr;
      y[i3 + 1] = li + qi;
      y[i4] = er - gr;
      y[i4 + 1] = ei - gi;
      y[i5] = kr - or;
      y[i5 + 1] = ki - oi;
      y[i6] = fr - hr;
      y[i6 + 1] = fi - hi;
      y[i7] = lr - qr;
      y[i7 + 1] = li - qi;
    }
  }
}
