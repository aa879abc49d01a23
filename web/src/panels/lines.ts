// How each quantity is drawn over time. Colour shows direction, as on the cylinder, and nothing else.

export interface Line {
  /** The name of a colour of the page. */
  colour: '--ink' | '--flow';
  dash: number[];
  /** Whether its sign means up or down: the area to zero has the colours of the cylinder. */
  upright: boolean;
}

const FILAMENTS: Line = { colour: '--ink', dash: [], upright: false };
const FLOW: Line = { colour: '--flow', dash: [], upright: false };

/** Filaments in ink and flow in grey; components around the cell are dashed. */
export function lineOf(quantity: string): Line {
  if (/speed|power|dissipation|^u/.test(quantity)) return FLOW;
  if (/P_theta$/.test(quantity)) return { ...FILAMENTS, dash: [4, 3] };
  return { ...FILAMENTS, upright: /P_z$/.test(quantity) };
}
