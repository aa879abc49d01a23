// Sentences with their symbols typeset, and with words that open an explanation.

import { isKey, say, spoken, type Key } from '../words/say';
import { h } from './dom';
import { beside } from './explain';
import { mathematics } from './mathematics';

const SYMBOL = /(?<![\p{L}_/])(?:F = \|P\|\^n P|\|P\||(?:[αdPukne])_(?:theta|max|[pusrzθ])(?![\p{L}_])|√μ|[αεκμθφ](?![\p{L}_])|R\/U|U\/R|[PRU](?![\p{L}_/^])|[tn](?= = )|u(?= (?:the|die) )|d(?= (?:from|gegen) ))/gu;

/** A part of a sentence: plain text, a symbol, or a word of the glossary. */
export type Piece = { text: string; symbol?: true; word?: string };

/** The names of what the glossary explains, in alphabetical order of their words. */
export function glossary(): string[] {
  return NAMES.toSorted((a, b) => titleOf(a).localeCompare(titleOf(b)));
}

const NAMES = [
  'cyclosis', 'filament', 'motor', 'order', 'bundling', 'alignment', 'shear', 'repulsion', 'zone', 'stripe', 'regime', 'steady', 'seed',
  'frame', 'grid', 'underresolved', 'unit', 'vacuole', 'defect', 'cytochalasin', 'fingerprint', 'diffusion',
] as const;

/** The word that heads an entry. */
export function titleOf(name: string): string {
  return wordsOf(name)[0]!;
}

function wordsOf(name: string): string[] {
  return say(`glossary.${name}-words` as Key).split('|');
}

/** A sentence in pieces. Each entry of the glossary is marked once, and not those that are left out. */
export function pieces(text: string, without: string[] = []): Piece[] {
  const out: Piece[] = [];
  const used = new Set(without);
  let place = 0;
  for (const match of text.matchAll(SYMBOL)) {
    out.push(...marked(text.slice(place, match.index), used), { text: match[0], symbol: true });
    place = match.index + match[0].length;
  }
  out.push(...marked(text.slice(place), used));
  return out.filter((piece) => piece.text !== '');
}

/** The words of the glossary in the language spoken, with the names of their entries, and a pattern that finds the longest. */
function words(): { known: Map<string, string>; pattern: RegExp } {
  if (vocabulary?.tag === spoken()) return vocabulary;
  const known = new Map(NAMES.flatMap((name) => wordsOf(name).map((word): [string, string] => [word.toLowerCase(), name])));
  const longest = [...known.keys()].sort((a, b) => b.length - a.length);
  vocabulary = { tag: spoken(), known, pattern: new RegExp(`(?<!\\p{L})(?:${longest.join('|')})(?!\\p{L})`, 'giu') };
  return vocabulary;
}
let vocabulary: { tag: string; known: Map<string, string>; pattern: RegExp } | null = null;

function marked(text: string, used: Set<string>): Piece[] {
  const { known, pattern } = words();
  const out: Piece[] = [];
  let place = 0;
  for (const match of text.matchAll(pattern)) {
    const word = known.get(match[0].toLowerCase())!;
    if (used.has(word)) continue;
    used.add(word);
    out.push({ text: text.slice(place, match.index) }, { text: match[0], word });
    place = match.index + match[0].length;
  }
  out.push({ text: text.slice(place) });
  return out;
}

/** A sentence as it is shown. */
export function prose(text: string, without: string[] = []): (Node | string)[] {
  return pieces(text, without).map((piece) => (piece.symbol ? mathematics(piece.text) : piece.word ? term(piece.text, piece.word) : piece.text));
}

/** A sentence with its symbols typeset only: in a label, which a word would not let through. */
export function symbols(text: string): (Node | string)[] {
  return prose(text, [...NAMES]);
}

let box: HTMLElement | null = null;

/** A word that opens its explanation, by touch, mouse or key. */
function term(text: string, name: string): HTMLElement {
  const button = h('button', { class: 'word', type: 'button', popovertarget: 'glossary-box', 'aria-haspopup': 'dialog', onclick: () => fill(name, button) }, text);
  if (typeof button.showPopover !== 'function') button.title = explained(name);
  else if (!box) {
    box = h('div', { id: 'glossary-box', class: 'explained', popover: 'auto', role: 'note' });
    document.body.append(box);
  }
  return button;
}

function fill(name: string, button: HTMLElement): void {
  if (!box) return;
  box.replaceChildren(h('p', {}, h('strong', {}, titleOf(name))), h('p', {}, ...prose(explained(name), [name])));
  box.ontoggle = (event) => {
    if ((event as ToggleEvent).newState === 'open') beside(box!, button);
  };
}

/** What a word means. */
export function explained(name: string): string {
  const key = `glossary.${name}`;
  return isKey(key) ? say(key) : '';
}
