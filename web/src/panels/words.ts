// What a cell is doing, in words for a visitor; `numbers` gives the numbers behind them.

import type { Regime } from '../protocol';
import { isKey, say } from '../words/say';
import { short } from './scales';
import { Units } from './units';

/** Widths, as shares of the circumference, that differ by less look equal. */
const ALIKE = 0.03;
/** Share of the order in P_theta above which the text says so. */
const MOSTLY_AROUND = 0.5;

const PURE = new Units(null);

/** The charts of the page: one quantity, or several of one kind. */
export type Chart = 'order' | 'mean' | 'peak' | 'rotation' | 'power' | 'profile';

/** What a chart shows, in sentences; those over time end with the unit of time. */
export function charted(chart: string, straight = true, units = PURE): string[] {
  const keys = ['1', '2'].map((k) => [...(straight ? [] : [`charts.${chart}-closed.${k}`]), `charts.${chart}.${k}`].find(isKey));
  const words = keys.filter((key) => key !== undefined).map((key) => say(key));
  return chart === 'profile' ? words : [...words, unitOfTime(units)];
}

/** What a unit of time is, in general or for a cell whose radius and speed are known. */
export function unitOfTime({ scales, second }: Units): string {
  return scales ? say('charts.time-here', { radius: short(scales.radius_um), speed: short(scales.speed_um_s), second: short(second) }) : say('charts.time');
}

export function title(regime: Regime): string {
  const key = `regime.${regime.name}`;
  return isKey(key) ? say(key) : regime.name;
}

/** What the cell shows, in a sentence without jargon. `profile` is the axial mean of P_z over theta. */
export function seen(regime: Regime, profile: ArrayLike<number>, units = PURE): string {
  const [fewest, most] = regime.boundaries;
  const closed = regime.defects !== undefined;
  const end = regime.mean[1] > 0 ? 'up' : 'down';
  switch (regime.name) {
    case 'disordered':
    case 'circumferential':
    case 'swirl':
    case 'circulation':
      return say(`seen.${regime.name}`);
    case 'unidirectional':
    case 'source-to-sink':
      return say(`seen.${regime.name}-${end}`);
    case 'cyclosis':
      return closed ? say('seen.cyclosis-closed') : streams(regime, profile);
    case 'multistripe':
      return say('seen.multistripe', { Count: capital(counted(most)) });
    case 'travelling':
      return say('seen.travelling', { how: movement(regime.drift, units) });
  }
  if (closed && regime.name === 'undecided' && /rotation explains/.test(regime.reason)) return say('seen.no-axis');
  if (fewest !== most) return say(fewest === 0 ? 'seen.boundaries-up-to' : 'seen.boundaries', { Fewest: capital(counted(fewest)), most: counted(most) });
  return say(regime.around > MOSTLY_AROUND ? 'seen.around' : 'seen.parts');
}

/** Whether and how fast the cell settles; empty while it is too early to tell. */
export function pace({ name, pace: rate }: Regime, units = PURE): string {
  if (rate === null || rate === 0) return '';
  if (rate === 'steady') return say('pace.steady');
  const time = units.lasting(Math.LN2 / Math.abs(rate), 2);
  if (rate > 0) return say('pace.growing', { time });
  // What is not decided may well pick up again.
  return say(name === 'undecided' ? 'pace.slowing' : 'pace.settling', { time });
}

/** The numbers behind the sentences: name, value, meaning. */
export function numbers(regime: Regime): [string, string, string][] {
  const [fewest, most] = regime.boundaries;
  const { pace: rate, widths, drift, defects, circulation } = regime;
  const row = (name: Measured, value: string): [string, string, string] => [say(`number.${name}`), value, say(`number.${name}-meaning`)];
  const range = fewest === most ? String(most) : say('number.boundaries-range', { fewest, most });
  const rows = [
    row('regime', regime.name),
    row('order', short(regime.order)),
    row('around', `${Math.round(100 * regime.around)} %`),
    row('boundaries', range),
  ];
  if (widths.length) rows.push(row('widths', widths.map((width) => `${Math.round(100 * width)} %`).join(', ')));
  if (regime.name === 'travelling') rows.push(row('movement', `${short(drift[0])}, ${short(drift[1])}`));
  if (defects) {
    const count = (sign: number): number => defects.filter(([index]) => Math.sign(index) === sign).length;
    rows.push(row('defects', say('number.defects-count', { plus: count(1), minus: count(-1) })));
  }
  if (circulation) rows.push(row('circulation', circulation.map((part) => short(part)).join(', ')));
  if (typeof rate === 'number') rows.push(row('pace', `${short(rate)} U/R`));
  return rows;
}

type Measured = 'regime' | 'order' | 'around' | 'boundaries' | 'widths' | 'movement' | 'defects' | 'circulation' | 'pace';

function streams({ zones, widths }: Regime, profile: ArrayLike<number>): string {
  if (widths.length !== 2) return say('seen.cyclosis');
  if (Math.abs(widths[0]! - 0.5) < ALIKE) return say('seen.cyclosis-equal');
  const middle = zones[0]! + Math.PI * widths[0]!;
  const up = profile[Math.round((middle / (2 * Math.PI)) * profile.length) % profile.length]! > 0 ? widths[0]! : widths[1]!;
  return say('seen.cyclosis-share', { percent: Math.round(100 * up) });
}

function movement([around, along]: [number, number], units: Units): string {
  const turn = Math.abs(around) > 0 ? say('move.turn', { time: units.lasting((2 * Math.PI) / Math.abs(around), 2) }) : '';
  const slide = Math.abs(along) > 0.1 * Math.abs(around) ? say(along > 0 ? 'move.up' : 'move.down') : '';
  if (turn && slide) return say('move.both', { one: turn, other: slide });
  return turn || slide || say('move.whole');
}

const counted = (count: number): string => say('count.words').split('|')[count] ?? String(count);
const capital = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);
