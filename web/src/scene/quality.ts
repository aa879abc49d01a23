// How many pictures per second are drawn, and what is left out where they are few.

/** From the best to what the weakest devices can draw: see `Level`. */
export interface Level {
  /** Most device pixels per CSS pixel. */
  ratio: number;
  /** Every so many of the particles are drawn. */
  nth: number;
  /** Whether the processor paints the cylinder instead of WebGL. */
  flat: boolean;
}

const LEVELS: Level[] = [
  { ratio: 2, nth: 1, flat: false },
  { ratio: 1, nth: 1, flat: false },
  { ratio: 0.75, nth: 2, flat: false },
  { ratio: 0.75, nth: 3, flat: true },
];
/** Fewer pictures a second are slow; as few are very slow. */
const SLOW = 20;
const CRAWL = 7;
/** Seconds of slowness in a row, and very slow ones, after which less is drawn: one or two may be due to loading the page. */
const PATIENCE = 3;
const HASTE = 2;

export class Quality {
  frames = 0;

  private place = 0;
  private readonly times: number[] = [];
  private busy = 0;
  private drawn = 0;
  private slow = 0;
  private crawled = 0;

  /** Count a picture drawn at `now` (ms), `since` the previous one; true if less is drawn from now on. */
  count(now: number, since: number): boolean {
    this.frames++;
    this.times.push(now);
    while (this.times.length && this.times[0] <= now - 1000) this.times.shift();
    if (since > 2000) return false; // hidden, or nothing to draw
    this.busy += since;
    this.drawn++;
    if (this.busy < 1000) return false;
    const rate = (1000 * this.drawn) / this.busy;
    const seconds = this.busy / 1000;
    this.slow = rate < SLOW ? this.slow + seconds : 0;
    this.crawled = rate < CRAWL ? this.crawled + seconds : 0;
    this.busy = 0;
    this.drawn = 0;
    if (this.slow < PATIENCE && this.crawled < HASTE) return false;
    this.slow = this.crawled = 0;
    return this.lower();
  }

  /** Draw less; false if that is not possible. */
  lower(): boolean {
    const { ratio, level } = this;
    // A level with as many pixels and all else the same would change nothing.
    const next = LEVELS.findIndex((each, k) => k > this.place && (each.ratio < ratio || each.nth > level.nth || each.flat));
    if (next < 0) return false;
    this.place = next;
    return true;
  }

  get level(): Level {
    return LEVELS[this.place]!;
  }

  fps(now: number): number {
    let k = 0;
    while (k < this.times.length && this.times[k] <= now - 1000) k++;
    return this.times.length - k;
  }

  get ratio(): number {
    return Math.min(globalThis.devicePixelRatio || 1, this.level.ratio);
  }
}

/** Whether WebGL runs on the processor: multisampling and many particles then cost more than they are worth. */
export function inSoftware(): boolean {
  const context = document.createElement('canvas').getContext('webgl2', { failIfMajorPerformanceCaveat: true });
  if (context === null) return true;
  // Not every browser counts it as a caveat; the renderer's name is reliable.
  const names = context.getExtension('WEBGL_debug_renderer_info');
  const renderer = String(context.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer);
}
