// The part of benchmarks/engine.py that runs in Node.js: prints microseconds of the processor as JSON.
import { initialState } from '../web/src/engine/initial';
import { Grid, resolvedModes, spectrumOf } from '../web/src/engine/grid';
import { Live } from '../web/src/engine/live';
import { protocolOf } from '../web/src/engine/protocol';
import { System } from '../web/src/engine/system';

declare const process: { argv: string[]; cpuUsage(): { user: number; system: number }; stdout: { write(text: string): void } };

const FIGURE_4 = {
  alpha_p: 1, alpha_u: 0.5, epsilon: 0.1, d_s: 0.025, d_r: 0.025, kappa: 0.5, mu: 0.05, repulsion_angle: 0, zero_theta_flux: false, force_exponent: 2,
};
const [what, nTheta, nZ, count] = process.argv.slice(2) as [string, string, string, string];
const grid = new Grid(Number(nTheta), Number(nZ), 5);
const spent = (): number => process.cpuUsage().user + process.cpuUsage().system;

function rightHandSides(repeats: number): number {
  const system = new System(grid, { first: FIGURE_4, last: FIGURE_4, ramps: {} });
  const spectrum = resolvedModes(grid, spectrumOf(grid, initialState({ filaments_per_square: 100 }, grid)));
  const out = new Float64Array(spectrum.length);
  const times: number[] = [];
  for (let round = 0; round < 9; round += 1) {
    const began = spent();
    for (let k = 0; k < repeats; k += 1) system.nonlinear(spectrum, 0, out);
    times.push((spent() - began) / repeats);
  }
  return times.slice(2).sort((a, b) => a - b)[3]!; // the first rounds are compiled
}

/** Time units per second of the processor, with frames every 0.1, from t = 0 on. */
function pace(until: number): number {
  const live = new Live(FIGURE_4, grid, initialState({}, grid), 0.1, protocolOf([], 0));
  const began = spent();
  while (live.t < until) live.forward();
  return until / ((spent() - began) / 1e6);
}

process.stdout.write(String(what === 'pace' ? pace(Number(count)) : rightHandSides(Number(count))));
