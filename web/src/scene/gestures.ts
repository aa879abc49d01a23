// Pointers on a canvas, one or two, as drags, hovering and pinches.

export interface Hand {
  /** A drag begins at (x, y) in CSS pixels of the canvas; `second` with the other button or a modifier key. */
  start(x: number, y: number, second: boolean): void;
  move(x: number, y: number, dx: number, dy: number): void;
  end(): void;
  /** A mouse or pen over the canvas without a drag; null when it left. */
  hover(at: [number, number] | null): void;
  /** Two fingers move apart by a factor, around a height, and upwards by `dy`. */
  pinch(factor: number, y: number, dy: number): void;
}

/** A finger may become one of two: its drag begins once it has moved as many pixels, or after as many milliseconds. */
const STILL = 6;
const HELD = 120;

/** Report to `hand` what pointers do on a canvas. */
export function listen(canvas: HTMLElement, hand: Hand): void {
  const pointers = new Map<number, [number, number]>();
  let dragging = false;
  let held: { begin(): void; from: [number, number]; timer: ReturnType<typeof setTimeout> } | null = null;
  /** Begin the drag that is held back, or forget it. */
  const release = (begins: boolean): void => {
    if (!held) return;
    const { begin, timer } = held;
    clearTimeout(timer);
    held = null;
    if (begins) begin();
  };
  const at = (event: PointerEvent): [number, number] => {
    const bounds = canvas.getBoundingClientRect();
    return [event.clientX - bounds.left, event.clientY - bounds.top];
  };
  const span = (): [number, number] => {
    const [a, b] = [...pointers.values()];
    return [Math.hypot(a[0] - b[0], a[1] - b[1]) || 1, (a[1] + b[1]) / 2];
  };
  const end = (event: PointerEvent): void => {
    if (!pointers.delete(event.pointerId)) return;
    release(event.type === 'pointerup'); // a tap
    if (dragging) hand.end();
    dragging = false;
    if (event.pointerType === 'touch') hand.hover(null);
  };
  const on = (name: string, heard: (event: PointerEvent) => void): void =>
    canvas.addEventListener(name, heard as EventListener);

  on('pointerdown', (event) => {
    const place = at(event);
    pointers.set(event.pointerId, place);
    canvas.setPointerCapture(event.pointerId);
    if (pointers.size === 1) {
      const begin = (): void => {
        dragging = true;
        hand.start(...place, event.button !== 0 || event.shiftKey);
      };
      if (event.pointerType === 'touch') held = { begin, from: place, timer: setTimeout(() => release(true), HELD) };
      else begin();
      return;
    }
    release(false);
    if (dragging) {
      hand.end(); // two fingers are a pinch
      dragging = false;
    }
  });
  on('pointermove', (event) => {
    const place = at(event);
    const before = pointers.get(event.pointerId);
    if (!before) {
      hand.hover(place);
      return;
    }
    if (pointers.size === 2) {
      const [was, before] = span();
      pointers.set(event.pointerId, place);
      const [is, y] = span();
      hand.pinch(is / was, y, y - before);
      return;
    }
    if (held && Math.hypot(place[0] - held.from[0], place[1] - held.from[1]) > STILL) release(true);
    if (held) return;
    pointers.set(event.pointerId, place);
    if (dragging) hand.move(...place, place[0] - before[0], place[1] - before[1]);
  });
  on('pointerup', end);
  on('pointercancel', end);
  on('pointerleave', () => hand.hover(null));
  on('contextmenu', (event) => event.preventDefault());
}
