// How many pictures per second are drawn, and how many pixels they may have.

const RATIOS = [2, 1, 0.75];
const SLOW = 20;

export class Quality {
  frames = 0;
  /** Most device pixels per CSS pixel. */
  limit = RATIOS[0];

  private readonly times: number[] = [];
  private busy = 0;
  private drawn = 0;
  private slow = 0;

  /** Count a picture drawn at `now` (ms), `since` the previous one; true if the limit was lowered. */
  count(now: number, since: number): boolean {
    this.frames++;
    this.times.push(now);
    while (this.times.length && this.times[0] <= now - 1000) this.times.shift();
    if (since > 600) return false; // hidden, or nothing to draw
    this.busy += since;
    this.drawn++;
    if (this.busy < 1000) return false;
    this.slow = (1000 * this.drawn) / this.busy < SLOW ? this.slow + 1 : 0;
    this.busy = 0;
    this.drawn = 0;
    // A slow second or two may be due to loading the page.
    if (this.slow < 3) return false;
    this.slow = 0;
    const lower = RATIOS.find((ratio) => ratio < Math.min(this.limit, window.devicePixelRatio || 1));
    if (lower === undefined) return false;
    this.limit = lower;
    return true;
  }

  fps(now: number): number {
    let k = 0;
    while (k < this.times.length && this.times[k] <= now - 1000) k++;
    return this.times.length - k;
  }

  get ratio(): number {
    return Math.min(window.devicePixelRatio || 1, this.limit);
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
