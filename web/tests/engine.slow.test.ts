import { describe, expect, it } from 'vitest';
import { Grid, resolvedModes, spectrumOf, stateOf } from '../src/engine/grid';
import { initialState } from '../src/engine/initial';
import { Live } from '../src/engine/live';
import { protocolOf } from '../src/engine/protocol';
import { judged } from '../src/engine/regimes';
import { golden } from './golden';
import { FIGURE_4 } from './paper';

// `npm run test:slow`: half a minute.
const { SLOW } = (globalThis as unknown as { process: { env: Record<string, string | undefined> } }).process.env;

describe.skipIf(!SLOW)('cells from ten seeds are at t = 200 what they are in the library', () => {
  for (const { alpha_u, seed, name, zones } of golden<{ alpha_u: number; seed: number; name: string; zones: number[] }[]>('ends.json')) {
    it(`alpha_u = ${alpha_u}, seed ${seed}: ${name}`, { timeout: 120_000 }, () => {
      const grid = new Grid(32, 32, 5);
      const live = new Live({ ...FIGURE_4, alpha_u }, grid, initialState({ seed }, grid), 1, protocolOf([], seed));
      while (live.t < 200) live.forward();
      const spectrum = resolvedModes(grid, spectrumOf(grid, live.state));
      const change = stateOf(grid, live.system.rate(spectrum, live.t, new Float64Array(spectrum.length)));
      const found = judged(grid, stateOf(grid, spectrum), spectrum, change);
      expect(found.name).toBe(name);
      expect(found.zones.length).toBe(zones.length);
      zones.forEach((angle, k) => expect(Math.abs(found.zones[k]! - angle)).toBeLessThan(1e-6));
    });
  }
});
