// How each quantity is drawn over time. Purple and green, or their like, mean up and down, as on the cylinder.

export interface Line {
  /** The name of a colour of the page. */
  colour: '--ink' | '--flow';
  dash: number[];
  /** Whether its sign means up or down: the line, and the area to zero, have the colours of the cylinder. */
  upright: boolean;
}

const FILAMENTS: Line = { colour: '--ink', dash: [], upright: false };
const FLOW: Line = { colour: '--flow', dash: [], upright: false };

/** Components across the axis: around a cylinder, and in both directions across a closed cell; a second cell. */
const DASHES: [RegExp, number[]][] = [[/_(theta|x)$/, [4, 3]], [/_y$/, [1.5, 2.5]], [/ of the second$/, [6, 4]]];

/** Filaments in ink and flow in grey; components across the axis are dashed or dotted. */
export function lineOf(quantity: string): Line {
  const dash = DASHES.find(([part]) => part.test(quantity))?.[1] ?? [];
  if (/speed|power|dissipation|circulation|^u/.test(quantity)) return { ...FLOW, dash };
  return { ...FILAMENTS, dash, upright: /(P|vector)_z$/.test(quantity) };
}
