/**
 * Frames that have arrived and are not yet confirmed as seen. The server sends only so many ahead, so each must
 * be confirmed once, including those replaced by a newer one or by another cell.
 */
export class Unseen {
  private waiting: number[] = [];

  constructor(private readonly say: (frame: number) => void) {}

  came(frame: number): void {
    this.waiting.push(frame);
  }

  /** Confirm all up to this one. */
  drawn(frame: number): void {
    const place = this.waiting.lastIndexOf(frame);
    for (const done of this.waiting.splice(0, place + 1)) this.say(done);
  }

  dropped(): void {
    for (const done of this.waiting.splice(0)) this.say(done);
  }

  forget(): void {
    this.waiting = [];
  }
}
