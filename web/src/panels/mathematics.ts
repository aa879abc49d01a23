import { h } from './dom';

const RAISED: Record<string, string> = {
  '⁽': '(', '⁾': ')', 'ʳ': 'r', 'ˢ': 's', 'ⁿ': 'n', '⁻': '−', '⁰': '0', '¹': '1', '²': '2', '³': '3', '⁴': '4', '⁵': '5', '⁶': '6', '⁷': '7', '⁸': '8', '⁹': '9',
};
const TOKEN = /([⁽⁾ʳˢⁿ⁻⁰¹²³⁴-⁹]+)|\^(½|\w)|(max|theta|\p{L})(?:_(theta|max|[\p{L}0-9]))?|(.)/gsu;
/** Letters that are vectors, or tensors, unless they have a component or an index. */
const VECTORS = 'PuFdI';
/** Indices that are variables; others are names. */
const VARIABLES = 'xyzθn';

/** Mathematics as in the texts of the package, typeset: variables italic, vectors bold, indices and powers in their places. */
export function mathematics(text: string): HTMLElement {
  const out = h('span', { class: 'math' });
  for (const match of text.matchAll(TOKEN)) {
    const [, raised, power, letter, index, other] = match;
    const next = text[match.index + match[0].length] ?? '';
    if (raised) out.append(h('sup', {}, variables([...raised].map((sign) => RAISED[sign] ?? sign).join(''))));
    else if (power) out.append(h('sup', {}, variables(power)));
    else if (letter === 'max') out.append('max');
    else if (letter) {
      const sign = letter === 'theta' ? 'θ' : letter;
      const vector = sign === 'e' || (VECTORS.includes(sign) && !index && next !== '⁽');
      out.append(h(vector ? 'b' : 'i', {}, sign));
      if (index) out.append(h('sub', {}, variables(index === 'theta' ? 'θ' : index)));
    } else out.append(other === '-' ? '−' : other!);
  }
  return out;
}

/** An index or a power: italic if it is a variable. */
function variables(text: string): Node | string {
  return VARIABLES.includes(text) ? h('i', {}, text) : text;
}
