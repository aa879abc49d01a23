/** Call `act` at most once per `wait` milliseconds, at once when idle, and always with the last value. */
export function throttle<T>(act: (value: T) => void, wait: number): ((value: T) => void) & { flush(): void } {
  let last = -Infinity;
  let timer: ReturnType<typeof setTimeout> | null = null;
  let pending: { value: T } | null = null;
  const fire = (): void => {
    if (timer !== null) clearTimeout(timer);
    timer = null;
    if (pending === null) return;
    const { value } = pending;
    pending = null;
    last = Date.now();
    act(value);
  };
  const call = (value: T): void => {
    pending = { value };
    const left = last + wait - Date.now();
    if (left <= 0) fire();
    else timer ??= setTimeout(fire, left);
  };
  return Object.assign(call, { flush: fire });
}

/** Call `act` once there have been no calls for `wait` milliseconds. */
export function debounce(act: () => void, wait: number): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(act, wait);
  };
}
