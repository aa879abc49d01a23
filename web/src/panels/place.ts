// Where the tour's card goes, so that it does not cover what it describes.

/** A stretch from top to bottom of the page, in pixels. */
export interface Stretch {
  top: number;
  bottom: number;
}

export type End = 'bottom' | 'top';

const GAP = 10;

/**
 * Where to scroll, and at which end of the window a card of some height leaves most of its marks visible: the
 * first before the others, and none under the card. `furthest` is how far the page can scroll.
 */
export function place(marks: Stretch[], window: number, card: number, furthest: number, now: number): { end: End; scroll: number } {
  const [first] = marks;
  if (!first) return { end: 'bottom', scroll: now };
  const all = { top: Math.min(...marks.map((m) => m.top)), bottom: Math.max(...marks.map((m) => m.bottom)) };
  let best = { end: 'bottom' as End, scroll: now, cost: Infinity };
  for (const end of ['bottom', 'top'] as End[]) {
    const [from, to] = end === 'bottom' ? [GAP, window - card - GAP] : [card + GAP, window - GAP];
    const places = [now, ...[all, ...marks].flatMap((m) => [m.top - from, m.bottom - to])];
    for (const wanted of places) {
      const scroll = Math.round(Math.min(furthest, Math.max(0, wanted)));
      const covered = end === 'bottom' ? [window - card, window] : [0, card];
      const share = (m: Stretch, low: number, high: number): number =>
        Math.max(0, Math.min(m.bottom - scroll, high) - Math.max(m.top - scroll, low)) / Math.max(1, m.bottom - m.top);
      const cost = marks.reduce(
        (sum, m, k) => sum + (k === 0 ? 8 : 1) * (1 - share(m, from, to)) + 10 * share(m, covered[0]!, covered[1]!),
        (end === 'top' ? 0.2 : 0) + 1e-4 * Math.abs(scroll - now) / Math.max(1, window),
      );
      if (cost < best.cost) best = { end, scroll, cost };
    }
  }
  return { end: best.end, scroll: best.scroll };
}
