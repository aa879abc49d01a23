/**
 * Frames that came and were not yet said to be seen. The server sends only so many ahead, so each must be
 * answered once: also those that a newer one, or another cell, took the place of.
 */
export class Unseen {
  private waiting: number[] = [];

  constructor(private readonly say: (frame: number) => void) {}

  came(frame: number): void {
    this.waiting.push(frame);
  }

  /** All up to this one are done with. */
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
