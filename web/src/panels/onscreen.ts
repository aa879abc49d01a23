/** Follows which elements are in sight: what is not need not be drawn. `came` is called when one comes into sight. */
export class OnScreen {
  private readonly away = new Set<Element>();
  private readonly observer: IntersectionObserver;

  constructor(came: () => void) {
    this.observer = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        if (isIntersecting && this.away.delete(target)) came();
        else if (!isIntersecting) this.away.add(target);
      }
    }, { rootMargin: '50px' });
  }

  watch(element: Element): void {
    this.observer.observe(element);
  }

  leave(element: Element): void {
    this.observer.unobserve(element);
    this.away.delete(element);
  }

  /** Whether it is in sight, as far as is known. */
  has(element: Element): boolean {
    return !this.away.has(element);
  }
}
