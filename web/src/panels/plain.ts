// What each parameter does, for someone who has not read the equation. The package's definitions are shown too.

import { isKey, say } from '../words/say';

/** A sentence or two on a parameter; nothing for one that is not known here. */
export function plainly(name: string): string {
  const key = `plain.${name}`;
  return isKey(key) ? say(key) : '';
}
