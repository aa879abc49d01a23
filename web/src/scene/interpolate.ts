// Values between the points of the periodic grid.

/** Write the flow at (theta, z), bilinear, to `out`. `flow` holds u_theta, u_z for each point, theta-major. */
export function flowAt(
  flow: Float32Array,
  n_theta: number,
  n_z: number,
  length: number,
  theta: number,
  z: number,
  out: [number, number] | Float64Array,
): void {
  const x = (theta / (2 * Math.PI)) * n_theta;
  const y = (z / length) * n_z;
  const fx = Math.floor(x);
  const fy = Math.floor(y);
  const a = x - fx;
  const b = y - fy;
  const i = ((fx % n_theta) + n_theta) % n_theta;
  const j = ((fy % n_z) + n_z) % n_z;
  const right = i + 1 < n_theta ? i + 1 : 0;
  const up = j + 1 < n_z ? j + 1 : 0;
  const p = 2 * (i * n_z + j);
  const q = 2 * (right * n_z + j);
  const r = 2 * (i * n_z + up);
  const s = 2 * (right * n_z + up);
  const wp = (1 - a) * (1 - b);
  const wq = a * (1 - b);
  const wr = (1 - a) * b;
  const ws = a * b;
  out[0] = wp * flow[p] + wq * flow[q] + wr * flow[r] + ws * flow[s];
  out[1] = wp * flow[p + 1] + wq * flow[q + 1] + wr * flow[r + 1] + ws * flow[s + 1];
}

/**
 * Four neighbours and their cubic (Catmull-Rom) weights for each of `count` pixel centres over `n` periodic points, or
 * over the first `share` of them.
 */
function stencil(n: number, count: number, reversed: boolean, share = 1): { index: Int32Array; weight: Float32Array } {
  const index = new Int32Array(4 * count);
  const weight = new Float32Array(4 * count);
  for (let k = 0; k < count; k++) {
    const pixel = reversed ? count - 1 - k : k;
    const x = ((pixel + 0.5) / count) * n * share;
    const i = Math.floor(x);
    const t = x - i;
    for (let m = 0; m < 4; m++) index[4 * k + m] = (i + m - 1 + 2 * n) % n;
    weight[4 * k] = 0.5 * t * (-1 + t * (2 - t));
    weight[4 * k + 1] = 0.5 * (2 + t * t * (3 * t - 5));
    weight[4 * k + 2] = 0.5 * t * (1 + t * (4 - 3 * t));
    weight[4 * k + 3] = 0.5 * t * t * (t - 1);
  }
  return { index, weight };
}

/** Bicubic enlargement of a periodic theta-major field to an image: rows from the top, z up. */
export class Enlarger {
  private readonly across: ReturnType<typeof stencil>;
  private readonly along: ReturnType<typeof stencil>;
  private readonly columns: Float32Array;
  private readonly line: Float32Array;

  constructor(
    readonly n_theta: number,
    readonly n_z: number,
    readonly width: number,
    readonly height: number,
    /** The share of the rows of the field that the image shows. */
    readonly share = 1,
  ) {
    this.across = stencil(n_theta, width, false);
    this.along = stencil(n_z, height, true, share);
    this.columns = new Float32Array(n_theta * height);
    this.line = new Float32Array(n_z);
  }

  /** Point p has its value before at `values[4 * p + offset]` and the present one two further. */
  enlarge(values: Float32Array, offset: number, mixing: number, out: Float32Array): void {
    const { n_theta, n_z, width, height, columns, line } = this;
    let { index, weight } = this.along;
    for (let i = 0; i < n_theta; i++) {
      for (let j = 0, p = 4 * i * n_z + offset; j < n_z; j++, p += 4) {
        line[j] = values[p] + mixing * (values[p + 2] - values[p]);
      }
      for (let row = 0, m = 0; row < height; row++, m += 4) {
        columns[row * n_theta + i] =
          weight[m] * line[index[m]] +
          weight[m + 1] * line[index[m + 1]] +
          weight[m + 2] * line[index[m + 2]] +
          weight[m + 3] * line[index[m + 3]];
      }
    }
    ({ index, weight } = this.across);
    for (let row = 0, q = 0; row < height; row++) {
      const base = row * n_theta;
      for (let k = 0, m = 0; k < width; k++, m += 4, q++) {
        out[q] =
          weight[m] * columns[base + index[m]] +
          weight[m + 1] * columns[base + index[m + 1]] +
          weight[m + 2] * columns[base + index[m + 2]] +
          weight[m + 3] * columns[base + index[m + 3]];
      }
    }
  }
}
