import type { Ask, Preparing } from '../protocol';
import { h } from './dom';
import { heard, say } from '../words/say';

/** Requests that are allowed while a cell is being prepared. */
const ALWAYS = new Set<Ask['do']>(['seen', 'tell', 'begin', 'play', 'pause', 'speed', 'vacuole', 'units']);

/**
 * What the page is waiting for: a message over the stage and next to the controls of time. Controls are disabled
 * while they would act on another cell, or on none.
 */
export class Waits {
  /** Over the stage; hidden from screen readers, which read the other. */
  readonly over = h('p', { id: 'waits-over', class: 'waits', 'aria-hidden': 'true' });
  readonly beside = h('p', { id: 'waits', class: 'waits', role: 'status' });
  private lost = '';
  private preparing: Preparing | null = null;
  private empty = true;
  /** Whether there has been a cell at all. */
  private ever = false;
  private focused: HTMLElement | null = null;

  constructor(
    private readonly root: HTMLElement,
    /** The controls to disable. */
    private readonly controls: () => Iterable<HTMLElement>,
  ) {
    this.show();
  }

  /** Why a request is refused now, or ''. */
  refuses(message: Ask): string {
    if (this.lost) return this.lost;
    return this.preparing?.another && !ALWAYS.has(message.do) ? heard(this.preparing.sentence) : '';
  }

  prepare(preparing: Preparing | null): void {
    this.preparing = preparing;
    this.show();
  }

  lose(sentence: string): void {
    this.lost = sentence;
    if (sentence) this.preparing = null;
    this.show();
  }

  /** Whether there is no picture of the present cell yet. */
  blank(empty: boolean): void {
    if (empty === this.empty && this.ever) return;
    this.empty = empty;
    this.ever = true;
    this.show();
  }

  private get holds(): boolean {
    return this.lost !== '' || this.preparing?.another === true || !this.ever;
  }

  private show(): void {
    const words = this.lost || (this.preparing ? heard(this.preparing.sentence) : this.empty ? say('page.opening') : '');
    for (const element of [this.over, this.beside]) {
      if (element.textContent !== words) element.textContent = words;
      element.hidden = words === '';
    }
    // Dim the picture while it does not show the present cell or the connection is lost.
    this.root.classList.toggle('stale', this.holds);
    this.root.classList.toggle('holds', this.holds);
    this.root.classList.toggle('busy', words !== '' && !this.lost);
    const focused = document.activeElement;
    for (const element of this.controls()) element.inert = this.holds;
    if (!this.holds) {
      if (this.focused && document.activeElement === document.body) this.focused.focus({ preventScroll: true });
      this.focused = null;
    } else if (focused instanceof HTMLElement && focused !== document.body) this.focused ??= focused;
  }
}
