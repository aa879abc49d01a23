import type { Regime } from '../protocol';
import type { Grid, State } from './grid';
import { axialMean } from './zones';

export interface Header {
  t: number;
  frame: number;
  peakSpeed: number;
  regime: Regime;
}

/** The message of a picture as the server sends it, see `readFrame`: header, records, fields. */
export function picture(grid: Grid, P: State, u: State, records: number[][], { t, frame, peakSpeed, regime }: Header): ArrayBuffer {
  const header = {
    t, frame, n_theta: grid.nTheta, n_z: grid.nZ, length: grid.length, peak_speed: peakSpeed,
    records: records.reduce((sum, row) => sum + row.length, 0), regime,
  };
  const text = new TextEncoder().encode(JSON.stringify(header));
  const start = 8 + Math.ceil(text.length / 8) * 8;
  const out = new ArrayBuffer(start + 8 * header.records + 4 * (4 * grid.size + 2 * grid.nTheta));
  const bytes = new Uint8Array(out);
  bytes.fill(32, 8, start);
  bytes.set(text, 8);
  new DataView(out).setUint32(0, text.length, true);
  new Float64Array(out, start, header.records).set(records.flat());
  const fields = new Float32Array(out, start + 8 * header.records);
  let place = 0;
  for (const field of [...P, ...u, axialMean(grid, P[1]), axialMean(grid, u[1])]) {
    fields.set(field, place);
    place += field.length;
  }
  return out;
}
