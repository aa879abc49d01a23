// Choices that a browser remembers.

export function kept(name: string): string | null {
  try {
    return localStorage.getItem(`cyclosis-${name}`);
  } catch {
    return null;
  }
}

export function keep(name: string, value: string): void {
  try {
    localStorage.setItem(`cyclosis-${name}`, value);
  } catch {
    // A browser that stores nothing still shows the choice.
  }
}
