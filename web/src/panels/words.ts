// What a cell is doing, in words for a visitor; `numbers` gives the numbers behind them.

import type { Regime } from '../protocol';
import { short } from './scales';

const TITLES: Record<string, string> = {
  disordered: 'disorder',
  unidirectional: 'one direction',
  cyclosis: 'cyclosis',
  multistripe: 'several streams',
  circumferential: 'around the axis',
  travelling: 'moving streams',
  undecided: 'not yet decided',
  'source-to-sink': 'from pole to pole',
  swirl: 'around the axis',
  circulation: 'circulation',
};
const COUNTS = ['no', 'one', 'two', 'three', 'four', 'five', 'six', 'seven', 'eight', 'nine', 'ten', 'eleven', 'twelve'];
/** Widths, as shares of the circumference, that differ by less look equal. */
const ALIKE = 0.03;
/** Share of the order in P_theta above which the text says so. */
const MOSTLY_AROUND = 0.5;

export const TIME = 'Time is counted in R/U, the radius of the cell over the speed that its motors give the fluid. '
  + 'In Chara (R = 0.5 mm, streaming at 50 to 100 µm/s) one such unit is about 5 to 10 seconds.';

const CHARTS: Record<string, string[]> = {
  order: ['How much filaments agree, over the whole cell: 0 if they point in all directions, 1 if all neighbours point the same way.'],
  'mean P': [
    'Which way filaments point on average. Along the cell (P_z, solid) up is above zero and down below it, in the colours of the cylinder; around the cell (P_θ) is dashed.',
    'Two equal streams cancel: then P_z is near zero, however strong they are.',
  ],
  'peak speed': ['The fastest flow anywhere in the cell, in units of U, the speed that fully aligned motors give the fluid.'],
  power: ['The work that the motors do on the fluid per unit of time. All of it ends up as heat, by friction.'],
  profile: [
    'Around the cell from θ = 0 to 2π, averaged along its length. Solid: which way filaments point (P_z), up above zero and down below it, in the colours of the cylinder. Grey: the flow (u_z).',
    'The flow is smoother than the filaments that drive it. An indifferent zone is where both pass through zero.',
  ],
};

/** Those that mean something else on a closed cell. */
const ON_CLOSED: Record<string, string[]> = {
  'mean P': ['The mean of all filaments as an arrow in space. Solid is its part along the axis, up above zero and down below it; dashed and dotted are those across the cell.',
    'Two equal streams cancel: then it is near zero, however strong they are.'],
  rotation: ['About which axis, and how fast, the fluid goes around as a whole: the angular velocity if a droplet turns like a solid ball. Solid is the part about the axis of the cell.'],
};

/** What a chart shows, in sentences; those over time end with the unit of time. */
export function charted(chart: string, straight = true): string[] {
  const words = (straight ? undefined : ON_CLOSED[chart]) ?? CHARTS[chart] ?? [];
  return chart === 'profile' ? words : [...words, TIME];
}

export function title(regime: Regime): string {
  return TITLES[regime.name] ?? regime.name;
}

/** What the cell shows, in a sentence without jargon. `profile` is the axial mean of P_z over theta. */
export function seen(regime: Regime, profile: ArrayLike<number>): string {
  const [fewest, most] = regime.boundaries;
  const closed = regime.defects !== undefined;
  switch (regime.name) {
    case 'disordered':
      return 'Filaments point every way, and next to nothing streams.';
    case 'unidirectional':
      return `All filaments point ${regime.mean[1] > 0 ? 'up' : 'down'}. No fluid passes the ends, so it cannot stream.`;
    case 'circumferential':
      return 'Filaments run around the cell, not along it.';
    case 'source-to-sink':
      return `Filaments run ${regime.mean[1] > 0 ? 'up' : 'down'} from one end of the cell to the other. No fluid can follow them, so hardly any streams.`;
    case 'swirl':
      return 'Filaments run around the axis of the cell, and so does the fluid.';
    case 'circulation':
      return 'The fluid goes around one axis between two vortices, and all of the droplet turns the same way.';
    case 'cyclosis':
      if (closed) return 'Two streams, one up and one down, that turn over at the ends of the cell.';
      return `Two streams, one up and one down, along the whole cell${shares(regime, profile)}.`;
    case 'multistripe':
      return `${capital(counted(most))} streams along the whole cell, up and down in turn.`;
    case 'travelling':
      return `The pattern keeps its shape and moves ${movement(regime.drift)}.`;
  }
  if (closed && regime.name === 'undecided' && /rotation explains/.test(regime.reason)) return 'The droplet has filaments in order, but no single axis that the fluid goes around.';
  if (fewest !== most) return `${fewest === 0 ? 'Up' : capital(counted(fewest))} to ${counted(most)} boundaries between streams, depending on the height.`;
  if (regime.around > MOSTLY_AROUND) return 'Most filaments run around the cell, not along it.';
  return 'Filaments point up in one part of the length and down in another.';
}

/** Whether and how fast the cell settles; empty while it is too early to tell. */
export function pace({ name, pace: rate }: Regime): string {
  if (rate === null || rate === 0) return '';
  if (rate === 'steady') return 'Steady: no change can be seen.';
  const time = rounded(Math.LN2 / Math.abs(rate));
  if (rate > 0) return `Under way: changes double in about ${time} R/U.`;
  // What is not decided may well pick up again.
  return `${name === 'undecided' ? 'Slowing for now' : 'Settling'}: changes halve in about ${time} R/U.`;
}

/** The numbers behind the sentences: name, value, meaning. */
export function numbers(regime: Regime): [string, string, string][] {
  const [fewest, most] = regime.boundaries;
  const { pace: rate, widths, drift, defects, circulation } = regime;
  const rows: [string, string, string][] = [
    ['regime', regime.name, 'the name that the package gives this state'],
    ['order', short(regime.order), 'how much neighbouring filaments agree, over the whole cell: 0 is disorder (below 0.05), 1 is full agreement'],
    ['around', `${Math.round(100 * regime.around)} %`, 'how much of the order runs around the axis; the rest runs along it'],
    ['boundaries', fewest === most ? String(most) : `${fewest} to ${most}`, 'lines between up and down (the indifferent zones) that a circle around the cell crosses'],
  ];
  if (widths.length) rows.push(['widths', widths.map((width) => `${Math.round(100 * width)} %`).join(', '), 'shares of the circumference that the streams take']);
  if (regime.name === 'travelling') rows.push(['movement', `${short(drift[0])}, ${short(drift[1])}`, 'around (radians) and along (radii) in one R/U']);
  if (defects) {
    const count = (sign: number): number => defects.filter(([index]) => Math.sign(index) === sign).length;
    rows.push(['defects', `${count(1)} of +, ${count(-1)} of −`, 'points where filaments have no direction, marked in the pictures; around + they turn once with the way, around − once against it. On any closed cell two more are + than −, if each turns once']);
  }
  if (circulation) rows.push(['circulation', circulation.map((part) => short(part)).join(', '), 'the angular velocity (x, y, z) of the fluid as a whole, in U/R; z is the axis']);
  if (typeof rate === 'number') rows.push(['pace', `${short(rate)} U/R`, 'changes grow as exp(pace × time); they die away where it is negative. Measured over the last 2 R/U']);
  return rows;
}

function shares({ zones, widths }: Regime, profile: ArrayLike<number>): string {
  if (widths.length !== 2) return '';
  if (Math.abs(widths[0]! - 0.5) < ALIKE) return ', equally wide';
  const middle = zones[0]! + Math.PI * widths[0]!;
  const up = profile[Math.round((middle / (2 * Math.PI)) * profile.length) % profile.length]! > 0 ? widths[0]! : widths[1]!;
  return `; the upward one takes ${Math.round(100 * up)} % of the way around`;
}

function movement([around, along]: [number, number]): string {
  const turn = Math.abs(around) > 0 ? `about the axis, once in ${rounded((2 * Math.PI) / Math.abs(around))} R/U` : '';
  const slide = Math.abs(along) > 0.1 * Math.abs(around) ? `${along > 0 ? 'up' : 'down'} the cell` : '';
  return [turn, slide].filter(Boolean).join(' and ') || 'as a whole';
}

const counted = (count: number): string => COUNTS[count] ?? String(count);
const capital = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);
/** Two digits are enough for a quantity that is measured while it changes. */
const rounded = (value: number): string => short(value, 2);
