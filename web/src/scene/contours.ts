// Zero lines of a periodic field, by marching squares.

/** Line pieces, five numbers each: x0, y0, x1, y1 in points, and the strength there. */
export class Pieces {
  data = new Float32Array(5 * 1024);
  count = 0;

  add(x0: number, y0: number, x1: number, y1: number, strength: number): void {
    if (5 * (this.count + 1) > this.data.length) {
      const larger = new Float32Array(2 * this.data.length);
      larger.set(this.data);
      this.data = larger;
    }
    const d = this.data;
    let k = 5 * this.count++;
    d[k++] = x0;
    d[k++] = y0;
    d[k++] = x1;
    d[k++] = y1;
    d[k] = strength;
  }
}

/**
 * Find where `values` (value at y * width + x, periodic in both, or in x alone) pass through zero. `strength` is read at the
 * same points; pieces below `least` are left out, so that disorder is not full of lines.
 */
export function zeroLines(
  values: Float32Array,
  width: number,
  height: number,
  strength: Float32Array,
  least: number,
  out: Pieces,
  alone = false,
): void {
  out.count = 0;
  for (let y = 0; y < (alone ? height - 1 : height); y++) {
    const row = y * width;
    const next = y + 1 < height ? row + width : 0;
    for (let x = 0; x < width; x++) {
      const right = x + 1 < width ? x + 1 : 0;
      const a = values[row + x];
      const b = values[row + right];
      const c = values[next + right];
      const d = values[next + x];
      let kind = (a > 0 ? 1 : 0) | (b > 0 ? 2 : 0) | (c > 0 ? 4 : 0) | (d > 0 ? 8 : 0);
      if (kind === 0 || kind === 15) continue;
      const s = 0.25 * (strength[row + x] + strength[row + right] + strength[next + right] + strength[next + x]);
      if (s < least) continue;
      if (kind > 7) kind = 15 - kind; // the complement has the same lines
      const low = x + a / (a - b); // crossings of the four sides
      const high = x + d / (d - c);
      const left = y + a / (a - d);
      const far = y + b / (b - c);
      switch (kind) {
        case 1:
          out.add(low, y, x, left, s);
          break;
        case 2:
          out.add(low, y, x + 1, far, s);
          break;
        case 3:
          out.add(x, left, x + 1, far, s);
          break;
        case 4:
          out.add(high, y + 1, x + 1, far, s);
          break;
        case 6:
          out.add(low, y, high, y + 1, s);
          break;
        case 7:
          out.add(x, left, high, y + 1, s);
          break;
        case 5: {
          // Saddle: the middle decides which corners are joined.
          const joined = a + b + c + d > 0 === a > 0;
          out.add(low, y, joined ? x + 1 : x, joined ? far : left, s);
          out.add(high, y + 1, joined ? x : x + 1, joined ? left : far, s);
        }
      }
    }
  }
}
