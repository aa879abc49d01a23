// What the page and the server say to each other, and how a frame is read.

/** One setting, from the package's one definition of it. */
export interface Definition {
  name: string;
  symbol: string;
  meaning: string;
  default: number | boolean | string | null;
  kind: 'number' | 'whole' | 'flag' | 'choice';
  minimum: number;
  maximum: number;
  /** The range of a slider; a number field takes all of minimum to maximum. */
  usual: [number, number] | null;
  allowed: string[];
}

export interface Term {
  name: string;
  formula: string;
  caption: string;
}

/** A number recorded at every frame, in the order in which it stands in `Frame.records` after the time. */
export interface Trace {
  name: string;
  symbol: string;
  meaning: string;
}

export interface Preset {
  name: string;
  group: 'figures' | 'regimes' | 'experiments';
  title: string;
  text: string;
}

export interface Palette {
  name: string;
  title: string;
  /** Colours of P_z, from -1 to 1: [value, "#rrggbb"], increasing. */
  stops: [number, string][];
  zone: string;
}

/** The computed phase diagram: the share (%) of cyclosis, share[i][j] at alpha_p[i], alpha_u[j]. */
export interface Diagram {
  alpha_p: number[];
  alpha_u: number[];
  share: number[][];
  /** The parameters it was computed with. */
  parameters: Record<string, number | boolean>;
  caption: string;
}

/** GET api/about: all that the page is built from. */
export interface About {
  version: string;
  limits: {
    points: number;
    stroke: number;
    fastest: number;
  };
  parameters: Definition[];
  grid: Definition[];
  initial: Definition[];
  /** Which of `initial` each kind of initial state takes; others would be refused. */
  uses: Record<string, string[]>;
  /** Time between frames of a cell, dimensionless. */
  interval: Definition;
  terms: Term[];
  traces: Trace[];
  presets: Preset[];
  palettes: Palette[];
  diagram: Diagram;
}

export type Values = Record<string, number | boolean | string>;

/** Text from the server. */
export type Said =
  | {
      type: 'cell';
      /** The set-up as its tables, every default filled in. */
      setup: { parameters: Values; grid: Values; initial: Values; run: Values };
      /** Parameters in force now. */
      parameters: Values;
      /** Whether each is on a ramp, or differs from place to place, now. */
      special: Record<string, 'ramp' | 'field'>;
      /** What was done and will be done, in order. */
      protocol: { at: number; text: string }[];
      /** The whole set-up up to now, for the address after "#". */
      link: string;
      t: number;
      playing: boolean;
      speed: number;
      /** The end that a link asked for: until then the cell is catching up, and does not wait. */
      catching_up: number | null;
      preset: string | null;
      /** True when this is another cell than before: traces begin anew. */
      fresh: boolean;
    }
  | { type: 'refused'; sentence: string }
  | { type: 'hash'; t: number; sha256: string }
  | { type: 'curves'; curves: { name: string; alpha_p: number[]; alpha_u: number[] }[]; applies: boolean }
  | { type: 'ended'; sentence: string };

/** What the page may ask, as JSON text. */
export type Ask =
  | {
      do: 'begin';
      preset?: string;
      link?: string;
      setup?: { parameters?: Values; grid?: Values; initial?: Values; run?: Values };
    }
  | { do: 'play' | 'pause' | 'step' | 'tell' | 'hash' | 'new_seed' | 'curves' }
  | { do: 'speed'; value: number }
  | { do: 'change'; values: Values }
  | { do: 'drug'; name: 'cytochalasin' | 'wash_out' | 'inhibit_myosin' }
  | {
      do: 'brush';
      tool: 'wound' | 'fragment' | 'align';
      /** [theta, z] in radians and radii. */
      points: [number, number][];
      radius: number;
      /** Direction of alignment from e_theta, radians: π/2 is up. */
      angle?: number;
    }
  | { do: 'seen'; frame: number };

export interface Regime {
  name: string;
  reason: string;
  zones: number[];
  widths: number[];
}

/** One picture of the cell. Fields are theta-major: value at i * n_z + j. */
export interface Frame {
  t: number;
  frame: number;
  n_theta: number;
  n_z: number;
  length: number;
  peak_speed: number;
  regime: Regime | null;
  P_theta: Float32Array;
  P_z: Float32Array;
  u_theta: Float32Array;
  u_z: Float32Array;
  /** Axial means over theta (n_theta). */
  profile_P: Float32Array;
  profile_u: Float32Array;
  /** Rows since the frame before: time, then one value for each trace. */
  records: Float64Array;
}

/** Read a binary message: uint32 length of a JSON header, the header padded to 8 bytes, records, fields. */
export function readFrame(data: ArrayBuffer): Frame {
  const length = new DataView(data).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 8, length)));
  let place = 8 + Math.ceil(length / 8) * 8;
  const records = new Float64Array(data, place, header.records);
  place += records.byteLength;
  const take = (count: number): Float32Array => {
    const values = new Float32Array(data, place, count);
    place += values.byteLength;
    return values;
  };
  const points = header.n_theta * header.n_z;
  return {
    ...header,
    records,
    P_theta: take(points),
    P_z: take(points),
    u_theta: take(points),
    u_z: take(points),
    profile_P: take(header.n_theta),
    profile_u: take(header.n_theta),
  };
}
