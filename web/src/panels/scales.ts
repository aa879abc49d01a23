import { say } from '../words/say';

/** Steps of a slider over a range of values. */
export const STEPS = 1000;

/** Whether a range is wide enough that equal steps should be equal ratios. */
export function isLogarithmic([low, high]: [number, number]): boolean {
  return low > 0 && high / low >= 100;
}

/** The position (0 to STEPS) of a value on a slider over `range`; values outside are at an end. */
export function toSlider(value: number, range: [number, number], logarithmic = isLogarithmic(range)): number {
  const [low, high] = range;
  if (high <= low) return 0;
  const share = logarithmic
    ? Math.log(Math.max(value, low) / low) / Math.log(high / low)
    : (value - low) / (high - low);
  return Math.round(STEPS * Math.min(1, Math.max(0, share)));
}

/** The value at a position of a slider, rounded to the resolution of the slider. */
export function fromSlider(place: number, range: [number, number], logarithmic = isLogarithmic(range)): number {
  const [low, high] = range;
  const share = Math.min(1, Math.max(0, place / STEPS));
  if (share === 0) return low;
  if (share === 1) return high;
  const value = logarithmic ? low * (high / low) ** share : low + share * (high - low);
  return Number(value.toPrecision(3));
}

const RAISED = '⁰¹²³⁴⁵⁶⁷⁸⁹';

/** A number in few characters, for reading. */
export function short(value: number, digits = 3): string {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return written(String(Number(value.toPrecision(digits))));
  const [factor, power] = value.toExponential(Math.max(0, digits - 1)).split('e') as [string, string];
  const raised = [...String(Math.abs(Number(power)))].map((digit) => RAISED[Number(digit)]).join('');
  return `${written(String(Number(factor)))}·10${Number(power) < 0 ? '⁻' : ''}${raised}`;
}

/** A number with so many decimals, for reading. */
export function decimals(value: number, count: number): string {
  return written(value.toFixed(count));
}

/** A printed number with a true minus and the decimal mark of the language. */
function written(text: string): string {
  return text.replace('-', '−').replace('.', say('number.decimal'));
}
