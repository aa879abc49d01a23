// One stage of a transform for each radix r: from x, in which the r values to combine are n/r apart, into y, in which
// they lie side by side. `s` is how many numbers each value is, and `w` the roots of 1 of the whole length, `step`
// apart for this one; `sign` is -1 for the inverse.

export function two(x: Float64Array, y: Float64Array, n: number, s: number, lines: number, w: Float64Array, step: number): void {
  const m = n / 2;
  const a = 2 * s * m;
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n * s) {
    for (let p = 0; p < m; p += 1) {
      const wr = w[2 * p * step]!;
      const wi = w[2 * p * step + 1]!;
      let i = base + 2 * s * p;
      let j = base + 4 * s * p;
      for (const end = i + 2 * s; i < end; i += 2, j += 2) {
        const ar = x[i]!, ai = x[i + 1]!, br = x[i + a]!, bi = x[i + a + 1]!;
        const dr = ar - br, di = ai - bi;
        y[j] = ar + br;
        y[j + 1] = ai + bi;
        y[j + 2 * s] = dr * wr - di * wi;
        y[j + 2 * s + 1] = dr * wi + di * wr;
      }
    }
  }
}

export function three(x: Float64Array, y: Float64Array, n: number, s: number, lines: number, w: Float64Array, step: number, sign: number): void {
  const m = n / 3;
  const a = 2 * s * m;
  const o = 2 * s;
  const sine = sign * Math.sqrt(0.75);
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n * s) {
    for (let p = 0; p < m; p += 1) {
      const k = 2 * p * step;
      const w1r = w[k]!, w1i = w[k + 1]!, w2r = w[2 * k]!, w2i = w[2 * k + 1]!;
      let i = base + 2 * s * p;
      let j = base + 6 * s * p;
      for (const end = i + 2 * s; i < end; i += 2, j += 2) {
        const ar = x[i]!, ai = x[i + 1]!, br = x[i + a]!, bi = x[i + a + 1]!, cr = x[i + 2 * a]!, ci = x[i + 2 * a + 1]!;
        const pr = br + cr, pi = bi + ci, nr = sine * (bi - ci), ni = sine * (cr - br);
        const hr = ar - 0.5 * pr, hi = ai - 0.5 * pi;
        const t1r = hr + nr, t1i = hi + ni, t2r = hr - nr, t2i = hi - ni;
        y[j] = ar + pr;
        y[j + 1] = ai + pi;
        y[j + o] = t1r * w1r - t1i * w1i;
        y[j + o + 1] = t1r * w1i + t1i * w1r;
        y[j + 2 * o] = t2r * w2r - t2i * w2i;
        y[j + 2 * o + 1] = t2r * w2i + t2i * w2r;
      }
    }
  }
}

export function four(x: Float64Array, y: Float64Array, n: number, s: number, lines: number, w: Float64Array, step: number, sign: number): void {
  const m = n / 4;
  const a = 2 * s * m;
  const o = 2 * s;
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n * s) {
    for (let p = 0; p < m; p += 1) {
      const k = 2 * p * step;
      const w1r = w[k]!, w1i = w[k + 1]!, w2r = w[2 * k]!, w2i = w[2 * k + 1]!, w3r = w[3 * k]!, w3i = w[3 * k + 1]!;
      let i0 = base + 2 * s * p;
      let j0 = base + 8 * s * p;
      for (const end = i0 + 2 * s; i0 < end; i0 += 2, j0 += 2) {
        const i1 = i0 + a, i2 = i1 + a, i3 = i2 + a;
        const ar = x[i0]!, ai = x[i0 + 1]!, br = x[i1]!, bi = x[i1 + 1]!;
        const cr = x[i2]!, ci = x[i2 + 1]!, dr = x[i3]!, di = x[i3 + 1]!;
        const pr = ar + cr, pi = ai + ci, mr = ar - cr, mi = ai - ci;
        const qr = br + dr, qi = bi + di, nr = sign * (bi - di), ni = sign * (dr - br);
        const t1r = mr + nr, t1i = mi + ni, t2r = pr - qr, t2i = pi - qi, t3r = mr - nr, t3i = mi - ni;
        const j1 = j0 + o, j2 = j1 + o, j3 = j2 + o;
        y[j0] = pr + qr;
        y[j0 + 1] = pi + qi;
        y[j1] = t1r * w1r - t1i * w1i;
        y[j1 + 1] = t1r * w1i + t1i * w1r;
        y[j2] = t2r * w2r - t2i * w2i;
        y[j2 + 1] = t2r * w2i + t2i * w2r;
        y[j3] = t3r * w3r - t3i * w3i;
        y[j3 + 1] = t3r * w3i + t3i * w3r;
      }
    }
  }
}

/** `four` where the length left is four, and so all roots are 1. */
export function lastFour(x: Float64Array, y: Float64Array, s: number, lines: number, sign: number): void {
  const a = 2 * s;
  for (let line = 0, base = 0; line < lines; line += 1, base += 8 * s) {
    for (let i0 = base, end = base + a; i0 < end; i0 += 2) {
      const i1 = i0 + a, i2 = i1 + a, i3 = i2 + a;
      const ar = x[i0]!, ai = x[i0 + 1]!, br = x[i1]!, bi = x[i1 + 1]!;
      const cr = x[i2]!, ci = x[i2 + 1]!, dr = x[i3]!, di = x[i3 + 1]!;
      const pr = ar + cr, pi = ai + ci, mr = ar - cr, mi = ai - ci;
      const qr = br + dr, qi = bi + di, nr = sign * (bi - di), ni = sign * (dr - br);
      y[i0] = pr + qr;
      y[i0 + 1] = pi + qi;
      y[i1] = mr + nr;
      y[i1 + 1] = mi + ni;
      y[i2] = pr - qr;
      y[i2 + 1] = pi - qi;
      y[i3] = mr - nr;
      y[i3 + 1] = mi - ni;
    }
  }
}

export function five(x: Float64Array, y: Float64Array, n: number, s: number, lines: number, w: Float64Array, step: number, sign: number): void {
  const m = n / 5;
  const a = 2 * s * m;
  const o = 2 * s;
  const [c1, c2] = [Math.cos(0.4 * Math.PI), Math.cos(0.8 * Math.PI)];
  const [s1, s2] = [sign * Math.sin(0.4 * Math.PI), sign * Math.sin(0.8 * Math.PI)];
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n * s) {
    for (let p = 0; p < m; p += 1) {
      const k = 2 * p * step;
      const w1r = w[k]!, w1i = w[k + 1]!, w2r = w[2 * k]!, w2i = w[2 * k + 1]!;
      const w3r = w[3 * k]!, w3i = w[3 * k + 1]!, w4r = w[4 * k]!, w4i = w[4 * k + 1]!;
      let i = base + 2 * s * p;
      let j = base + 10 * s * p;
      for (const end = i + 2 * s; i < end; i += 2, j += 2) {
        const xr = x[i]!, xi = x[i + 1]!, ar = x[i + a]!, ai = x[i + a + 1]!, br = x[i + 2 * a]!, bi = x[i + 2 * a + 1]!;
        const cr = x[i + 3 * a]!, ci = x[i + 3 * a + 1]!, dr = x[i + 4 * a]!, di = x[i + 4 * a + 1]!;
        const pr = ar + dr, pi = ai + di, qr = br + cr, qi = bi + ci;
        const mr = ai - di, mi = dr - ar, nr = bi - ci, ni = cr - br; // -i (a - d) and -i (b - c)
        const er = xr + c1 * pr + c2 * qr, ei = xi + c1 * pi + c2 * qi, fr = xr + c2 * pr + c1 * qr, fi = xi + c2 * pi + c1 * qi;
        const gr = s1 * mr + s2 * nr, gi = s1 * mi + s2 * ni, hr = s2 * mr - s1 * nr, hi = s2 * mi - s1 * ni;
        const t1r = er + gr, t1i = ei + gi, t2r = fr + hr, t2i = fi + hi, t3r = fr - hr, t3i = fi - hi, t4r = er - gr, t4i = ei - gi;
        y[j] = xr + pr + qr;
        y[j + 1] = xi + pi + qi;
        y[j + o] = t1r * w1r - t1i * w1i;
        y[j + o + 1] = t1r * w1i + t1i * w1r;
        y[j + 2 * o] = t2r * w2r - t2i * w2i;
        y[j + 2 * o + 1] = t2r * w2i + t2i * w2r;
        y[j + 3 * o] = t3r * w3r - t3i * w3i;
        y[j + 3 * o + 1] = t3r * w3i + t3i * w3r;
        y[j + 4 * o] = t4r * w4r - t4i * w4i;
        y[j + 4 * o + 1] = t4r * w4i + t4i * w4r;
      }
    }
  }
}

/** `four` where it is the first stage, so that values of a line lie side by side (s = 1). */
export function firstFour(x: Float64Array, y: Float64Array, n: number, lines: number, w: Float64Array, sign: number): void {
  const a = n / 2;
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n) {
    for (let k = 0, i0 = base, j = base; k < a; k += 2, i0 += 2, j += 8) {
      const i1 = i0 + a, i2 = i1 + a, i3 = i2 + a;
      const ar = x[i0]!, ai = x[i0 + 1]!, br = x[i1]!, bi = x[i1 + 1]!;
      const cr = x[i2]!, ci = x[i2 + 1]!, dr = x[i3]!, di = x[i3 + 1]!;
      const pr = ar + cr, pi = ai + ci, mr = ar - cr, mi = ai - ci;
      const qr = br + dr, qi = bi + di, nr = sign * (bi - di), ni = sign * (dr - br);
      const t1r = mr + nr, t1i = mi + ni, t2r = pr - qr, t2i = pi - qi, t3r = mr - nr, t3i = mi - ni;
      const w1r = w[k]!, w1i = w[k + 1]!, w2r = w[2 * k]!, w2i = w[2 * k + 1]!, w3r = w[3 * k]!, w3i = w[3 * k + 1]!;
      y[j] = pr + qr;
      y[j + 1] = pi + qi;
      y[j + 2] = t1r * w1r - t1i * w1i;
      y[j + 3] = t1r * w1i + t1i * w1r;
      y[j + 4] = t2r * w2r - t2i * w2i;
      y[j + 5] = t2r * w2i + t2i * w2r;
      y[j + 6] = t3r * w3r - t3i * w3i;
      y[j + 7] = t3r * w3i + t3i * w3r;
    }
  }
}

/** The defining sum, for the radices that are rare: r² operations for r values. */
export function prime(x: Float64Array, y: Float64Array, r: number, n: number, s: number, lines: number, w: Float64Array, step: number, whole: number): void {
  const m = n / r;
  const a = 2 * s * m;
  const turn = whole / r;
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n * s) {
    for (let p = 0; p < m; p += 1) {
      for (let f = 0; f < r; f += 1) {
        const wr = w[2 * p * step * f]!, wi = w[2 * p * step * f + 1]!;
        let i = base + 2 * s * p;
        let j = base + 2 * s * (r * p + f);
        for (const end = i + 2 * s; i < end; i += 2, j += 2) {
          let tr = 0, ti = 0;
          for (let k = 0, at = 0, c = i; k < r; k += 1, c += a) {
            const er = w[2 * at]!, ei = w[2 * at + 1]!, xr = x[c]!, xi = x[c + 1]!;
            tr += xr * er - xi * ei;
            ti += xr * ei + xi * er;
            at += f * turn;
            if (at >= whole) at -= whole;
          }
          y[j] = tr * wr - ti * wi;
          y[j + 1] = tr * wi + ti * wr;
        }
      }
    }
  }
}
