/** Time units per second, as shown over the last `span` milliseconds. */
export class SpeedMeter {
  private seen: [wall: number, t: number][] = [];

  constructor(private readonly span = 2000) {}

  add(wall: number, t: number): void {
    if (this.seen.length > 0 && t < this.seen.at(-1)![1]) this.seen = [];
    this.seen.push([wall, t]);
    while (this.seen.length > 2 && this.seen[0]![0] < wall - this.span) this.seen.shift();
  }

  measured(wall: number): number {
    const kept = this.seen.filter(([at]) => at >= wall - this.span);
    const [first, last] = [kept[0], kept.at(-1)];
    return first && last && last[0] > first[0] ? (1000 * (last[1] - first[1])) / (last[0] - first[0]) : 0;
  }
}
