// Two cells in one address: the link of the first, the parameter that differs, and the link of the second.

const BETWEEN = '~';

export interface Address {
  link: string;
  /** The parameter that differs, and the second cell. */
  other: { name: string; link: string } | null;
}

/** What the part of an address after "#" says. */
export function parted(hash: string): Address {
  const [link = '', name, other] = hash.replace(/^#/, '').split(BETWEEN);
  return { link, other: name && other ? { name, link: other } : null };
}

/** What follows the link of the first cell in an address of two. */
export function suffix(name: string, link: string): string {
  return `${BETWEEN}${name}${BETWEEN}${link}`;
}
