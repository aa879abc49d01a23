/**
 * A bounded number of rows over time: once full, every second row is dropped, and from then on only every
 * second row is added. The newest row is always kept.
 */
export class History {
  readonly columns: number[][];
  /** Changes whenever rows do. */
  version = 0;
  private stride = 1;
  private seen = 0;
  /** Whether the last row is kept only because it is the newest. */
  private loose = false;

  constructor(
    readonly width: number,
    readonly bound = 4000,
  ) {
    this.columns = Array.from({ length: width }, () => []);
  }

  get length(): number {
    return this.columns[0]!.length;
  }

  /** Add consecutive rows; rows that are not later than the last are left out. */
  push(rows: ArrayLike<number>): void {
    for (let start = 0; start + this.width <= rows.length; start += this.width) {
      const times = this.columns[0]!;
      if (times.length > 0 && !(rows[start]! > times.at(-1)!)) continue;
      if (this.loose) for (const column of this.columns) column.pop();
      this.columns.forEach((column, k) => column.push(rows[start + k]!));
      this.loose = this.seen % this.stride !== 0;
      this.seen += 1;
      if (this.length > this.bound) this.thin();
    }
    this.version += 1;
  }

  /** Drop the rows after a time. */
  cut(t: number): void {
    const times = this.columns[0]!;
    if (!(times.at(-1)! > t)) return;
    const left = times.findIndex((time) => time > t);
    for (const column of this.columns) column.length = left;
    this.loose = false;
    this.seen = 1 + (left - 1) * this.stride;
    this.version += 1;
  }

  clear(): void {
    for (const column of this.columns) column.length = 0;
    this.stride = 1;
    this.seen = 0;
    this.loose = false;
    this.version += 1;
  }

  private thin(): void {
    const last = this.length - 1;
    this.columns.forEach((column, k) => {
      this.columns[k] = column.filter((_, i) => i % 2 === 0 || i === last);
    });
    if (last % 2 === 1) this.loose = true;
    this.stride *= 2;
  }
}
