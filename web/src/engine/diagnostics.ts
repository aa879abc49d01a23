import { sizeOf, type System } from './system';

/** Numbers of a state, as `analysis/diagnostics.py`; dimensionless. */
export interface Measured {
  mean_P_theta: number;
  mean_P_z: number;
  order: number;
  max_P: number;
  peak_speed: number;
  rms_speed: number;
  net_flux: number;
  pressure_gradient: number;
  power_input: number;
  viscous_dissipation: number;
  friction_dissipation: number;
  rate_of_change: number;
  spectral_tail: number;
}

const TAIL_FRACTION = 2 / 3;
/** The spectral tail above which a cell is marked underresolved. */
export const UNDERRESOLVED_TAIL = 1e-2;

/** The numbers of a packed spectrum without its Nyquist modes. */
export function measure(system: System, spectrum: Float64Array, t: number): Measured {
  const { grid } = system;
  const change = system.rate(spectrum, t, new Float64Array(spectrum.length));
  system.at(spectrum, t); // the right-hand side has used some of the fields for other things
  const { p, u, force, flow } = system;
  let [maxP, maxU, power, pressure, flux, viscous] = [0, 0, 0, 0, 0, 0];
  for (let re = 0, im = 1; re < p.length; re += 2, im += 2) {
    maxP = Math.max(maxP, p[re]! ** 2 + p[im]! ** 2);
    maxU = Math.max(maxU, u[re]! ** 2 + u[im]! ** 2);
    power += force[re]! * u[re]! + force[im]! * u[im]!;
    pressure += force[im]!;
    flux += u[im]!;
    viscous += grid.k2[re >> 1]! * (flow[re]! ** 2 + flow[im]! ** 2);
  }
  return {
    mean_P_theta: spectrum[0]!,
    mean_P_z: spectrum[1]!,
    order: sizeOf(spectrum),
    max_P: Math.sqrt(maxP),
    peak_speed: Math.sqrt(maxU),
    rms_speed: sizeOf(flow),
    net_flux: flux / grid.size,
    pressure_gradient: pressure / grid.size,
    power_input: power / grid.size,
    viscous_dissipation: system.mu * viscous,
    friction_dissipation: sizeOf(flow) ** 2,
    rate_of_change: sizeOf(change),
    spectral_tail: tail(system, spectrum),
  };
}

/** The amplitude beyond two thirds of the resolved wavenumbers over that of all. */
export function tail({ grid }: System, spectrum: Float64Array): number {
  const [most, furthest] = [Math.max(...grid.m), Math.max(...grid.q, 2 ** -1022)];
  let [beyond, all] = [0, 2 ** -1022];
  for (let at = 0; at < grid.size; at += 1) {
    const energy = spectrum[2 * at]! ** 2 + spectrum[2 * at + 1]! ** 2;
    const m = Math.abs(grid.m[Math.floor(at / grid.nZ)]!) / most;
    const q = Math.abs(grid.q[at % grid.nZ]!) / furthest;
    all += energy;
    if (Math.max(m, q) > TAIL_FRACTION) beyond += energy;
  }
  return Math.sqrt(beyond / all);
}
