// The messages between the page and the server, and how a frame is read.

/** One setting, from its definition in the package. */
export interface Definition {
  name: string;
  symbol: string;
  meaning: string;
  default: number | boolean | string | null;
  kind: 'number' | 'whole' | 'flag' | 'choice';
  minimum: number;
  maximum: number;
  /** The range of a slider; a number field accepts everything from minimum to maximum. */
  usual: [number, number] | null;
  allowed: (string | number)[];
}

/** A shape of cells: the model of its cells, and the settings of its grid. */
export interface Shape {
  name: string;
  model: string;
  settings: Definition[];
}

/** What the cells of a model record, and what has no meaning in them. */
export interface Model {
  traces: Trace[];
  /** Parameters without a meaning. */
  unused: string[];
  /** Which of `initial` each kind of initial state accepts; others are refused. */
  uses: Record<string, string[]>;
  /** Whether it is the periodic cylinder, with a vacuole and a phase diagram. */
  straight: boolean;
}

/** The meridian of a closed cell at even steps of s: radius, height, and the normal outwards and upwards. */
export interface Outline {
  r: number[];
  z: number[];
  out: number[];
  up: number[];
  /** Whether up and down mean anything: not on a sphere. */
  axial: boolean;
}

export interface Term {
  name: string;
  formula: string;
  caption: string;
}

/** A number recorded at every frame, in the order of `Frame.records` after the time. */
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
  /** Colours of the direction of P, where the cell shows that: see `directionOf`. */
  wheel: Wheel | null;
}

/** Colours where P points to e_theta, e_z, -e_theta and -e_z, which are mixed as light. */
export interface Wheel {
  colours: string[];
  gamma: number;
  darkest: number;
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

/** GET api/about: everything that the page is built from. */
export interface About {
  version: string;
  limits: {
    points: number;
    stroke: number;
    fastest: number;
  };
  parameters: Definition[];
  shapes: Shape[];
  models: Record<string, Model>;
  initial: Definition[];
  /** Time between frames of a cell, dimensionless. */
  interval: Definition;
  terms: Term[];
  presets: Preset[];
  palettes: Palette[];
  diagram: Diagram;
  worksheet: Question[];
  /** The scales in whose units cells are shown at first. */
  scales: Scales | null;
}

/** A question for a class: what to try, the answer, and the link of its cell. */
export interface Question {
  question: string;
  attempt: string;
  answer: string;
  link: string;
}

/** Radius (µm) and speed (µm/s) of a cell, by which it is shown in units. */
export interface Scales {
  radius_um: number;
  speed_um_s: number;
}

export type Values = Record<string, number | boolean | string>;

/** Text from the server. */
export type Said =
  | {
      type: 'cell';
      /** The set-up as its tables, every default filled in. */
      setup: { model: Values; parameters: Values; grid: Values; initial: Values; run: Values; scales: Partial<Scales> };
      /** The meridian of a closed cell. */
      outline: Outline | null;
      /** Parameters that are active now. */
      parameters: Values;
      /** Whether each is on a ramp, or varies in space, now. */
      special: Record<string, 'ramp' | 'field'>;
      /** Past and future actions, in order. */
      protocol: { at: number; text: string }[];
      /** The whole set-up up to now, for the address after "#". */
      link: string;
      t: number;
      /** How many interventions can be undone. After one `t` is earlier than before. */
      undo: number;
      playing: boolean;
      speed: number;
      /** The time requested by a link: until then the cell is catching up, at full speed. */
      catching_up: number | null;
      preset: string | null;
      /** Counts the cells of this session. */
      begun: number;
      /** The number `n` of the last request that has been processed. */
      done: number;
      /** True if this is another cell than before: traces start again. */
      fresh: boolean;
      /** The number of tracers inside, if the page asked for them. */
      vacuole?: number;
    }
  | { type: 'refused'; sentence: string }
  | { type: 'hash'; t: number; sha256: string }
  | { type: 'curves'; curves: { name: string; alpha_p: number[]; alpha_u: number[] }[]; applies: boolean; /** Whether only the server could compute them. */ elsewhere?: boolean }
  | { type: 'ended'; sentence: string }
  /** A new session, or the one with the given token; requests up to `received` have arrived. */
  | { type: 'welcome' | 'resumed'; token: string; received: number; preparing: Preparing | null }
  /** No session has the given token: begin a cell. */
  | { type: 'forgotten' }
  /** Sent every 1.5 s and answered likewise; otherwise the connection is dead. */
  | { type: 'alive' }
  /** Work that takes seconds before the cell continues: another cell, or more of this one. */
  | ({ type: 'preparing' } & Preparing)
  | { type: 'prepared' };

export interface Preparing {
  sentence: string;
  another: boolean;
}

/** The requests of the page, as JSON text. */
export type Ask =
  | {
      do: 'begin';
      preset?: string;
      link?: string;
      setup?: { model?: Values; parameters?: Values; grid?: Values; initial?: Values; run?: Values };
      /** With a link: the later time that was shown, and whether the cell was playing. */
      t?: number;
      playing?: boolean;
      /** Those of a cell that has none of its own. */
      scales?: Scales;
    }
  /** Show the cell in units, or dimensionless. */
  | { do: 'units'; scales: Scales | null }
  | { do: 'resume'; token: string }
  | { do: 'alive' | 'ping' | 'leave' }
  | { do: 'play' | 'pause' | 'step' | 'tell' | 'hash' | 'new_seed' | 'curves' | 'undo' | 'again' }
  | { do: 'speed'; value: number }
  /** Compute up to a frame as fast as possible, and stand still there. */
  | { do: 'reach'; frame: number }
  | { do: 'change'; values: Values }
  | { do: 'drug'; name: 'cytochalasin' | 'wash_out' | 'inhibit_myosin' }
  | {
      do: 'brush';
      tool: 'wound' | 'fragment' | 'align';
      /** [theta, z] in radians and radii; on a closed cell z is s, the arc length from the south pole. */
      points: [number, number][];
      radius: number;
      /** Direction of alignment from e_theta, radians: π/2 is up. */
      angle?: number;
    }
  /** The flow inside: tracers that move `pace` radii a second at the peak of the flow. */
  | { do: 'vacuole'; on: boolean; tracers?: number; pace?: number }
  | { do: 'seen'; frame: number };

/** A point where P vanishes: its index, theta and s. */
export type Defect = [index: number, theta: number, s: number];

export interface Regime {
  name: string;
  reason: string;
  /** Angles of the boundaries of the axial mean, and the stripes after each as shares of the circumference. */
  zones: number[];
  widths: number[];
  /** <|P|²>^½, and the share of <|P|²> around the axis. */
  order: number;
  around: number;
  /** The fewest and the most boundaries that a circle around the cell crosses. */
  boundaries: [number, number];
  /** Velocity (around, along) with which the pattern moves as a whole, where it does. */
  drift: [number, number];
  /** Mean of P: around, along. */
  mean: [number, number];
  /** The rate at which changes grow; null while it is unknown. */
  pace: number | 'steady' | null;
  /** On a closed cell: defects of P as [index, theta, s], and the circulation of the flow, a vector. */
  defects?: Defect[];
  circulation?: [number, number, number];
}

/**
 * One picture of the cell. Fields are theta-major: value at i * n_z + j. On a closed cell the points are those of an
 * even chart: z is s, from the south pole to the north, both included; components are those along the meridian.
 */
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
  /** Rows since the previous frame: time, then one value for each trace. */
  records: Float64Array;
}

/** The flow inside a cell at the time of a picture, for a page that asked for it. */
export interface Inside {
  t: number;
  /** The cell that it belongs to; see `Said`. */
  begun: number;
  length: number;
  /** The speed that counts as full: the peak on the wall, unless the flow is dying. */
  reference: number;
  tracers: number;
  rings: number;
  sectors: number;
  /** All x, all y, all z, in radii. */
  xyz: Float32Array;
  /** The axial velocity at each tracer, and on the section in the middle: ring after ring, from the axis to the wall. */
  axial: Float32Array;
  section: Float32Array;
}

/** Whether a binary message is about the inside: its second number is 1, that of a picture 0. */
export function isInside(data: ArrayBuffer): boolean {
  return new DataView(data).getUint32(4, true) === 1;
}

/** Read a binary message about the inside: a header as that of a picture, places, velocities. */
export function readInside(data: ArrayBuffer): Inside {
  const { header, place } = headerOf(data);
  const { tracers, rings, sectors } = header;
  return {
    ...header,
    xyz: new Float32Array(data, place, 3 * tracers),
    axial: new Float32Array(data, place + 12 * tracers, tracers),
    section: new Float32Array(data, place + 16 * tracers, rings * sectors),
  };
}

function headerOf(data: ArrayBuffer) {
  const length = new DataView(data).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 8, length)));
  return { header, place: 8 + Math.ceil(length / 8) * 8 };
}

/** Read a binary message: uint32 length of a JSON header, the header padded to 8 bytes, records, fields. */
export function readFrame(data: ArrayBuffer): Frame {
  const { header, place: start } = headerOf(data);
  let place = start;
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
