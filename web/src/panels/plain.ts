// What each parameter does, for someone who has not read the equation. The package's definitions are shown too.

const PLAIN: Record<string, string> = {
  alpha_p: 'How fast filaments that lie side by side turn to point the same way. Cytochalasin sets it to 0.',
  alpha_u: 'How fast filaments turn to point the way the fluid flows. Inhibiting myosin sets it to 0.',
  epsilon: 'How freely the fluid moves and turns filaments, like anything that floats in it: 0 if they are held fast, 1 if they float.',
  d_s: 'How fast order spreads from place to place. The larger it is, the wider the zones between streams.',
  d_r: 'How fast random turning destroys order. Order lasts if bundling and alignment by flow are faster.',
  kappa: 'How strongly filaments avoid one direction. Unless its angle is changed, this is the direction around the cell, so that they lie along the cell.',
  mu: 'How far fluid drags along the fluid next to it, against the friction of the wall: about √μ radii. The larger it is, the smoother the flow.',
  repulsion_angle: 'The direction that filaments avoid, as an angle from the direction around the cell. Away from 0 the preferred direction winds like a screw.',
  zero_theta_flux: 'Whether flow around the cell must cancel out over the whole cell, as flow along it must.',
  force_exponent: 'How the force of the motors grows with order: in proportion to it for 0, with its cube for 2.',
};

/** A sentence or two on a parameter; nothing for one that is not known here. */
export function plainly(name: string): string {
  return PLAIN[name] ?? '';
}
