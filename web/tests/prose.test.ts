import { afterEach, describe, expect, it } from 'vitest';
import { explained, glossary, pieces, titleOf } from '../src/panels/prose';
import { languages, speak } from '../src/words/say';

afterEach(() => speak('en'));
const of = (text: string): string[] => pieces(text).filter(({ word }) => word).map(({ text, word }) => `${text}: ${word}`);
const symbols = (text: string): string[] => pieces(text).filter(({ symbol }) => symbol).map(({ text }) => text);

describe('sentences', () => {
  it('lose nothing in any language', () => {
    for (const [tag, { words, package: given }] of Object.entries(languages)) {
      speak(tag);
      for (const text of [...Object.values(words), ...Object.values(given)]) expect(pieces(text).map((piece) => piece.text).join('')).toBe(text);
    }
  });

  it('have their symbols typeset, and no names of settings', () => {
    expect(symbols('angle of the repulsive direction d from e_theta, in radians')).toEqual(['d', 'e_theta']);
    expect(symbols('exponent of the force law F = |P|^n P')).toEqual(['F = |P|^n P']);
    expect(symbols('Raise α_p above d_r: two streams (P_θ) by t = 20 in R/U, about √μ radii')).toEqual(['α_p', 'd_r', 'P_θ', 't', 'R/U', '√μ']);
    expect(symbols('zero_theta_flux, alpha_p, k_maximal, PNAS, Pole and Radius')).toEqual([]);
  });

  it('mark each word of the glossary once, the longest that fits, whole', () => {
    expect(of('Indifferent zones, zones and a seed of seeds')).toEqual(['Indifferent zones: zone', 'seed: seed']);
    expect(of('reordering bordered gridlines')).toEqual([]);
    speak('de');
    expect(of('Mit Startwert 0 ist die Zelle zu grob aufgelöst, nicht entfilamentet')).toEqual(['Startwert: seed', 'zu grob aufgelöst: underresolved']);
  });
});

describe.each(Object.keys(languages))('the glossary in %s', (tag) => {
  it('has an explanation for every entry, and no word twice', () => {
    speak(tag);
    const words = glossary().flatMap((name) => languages[tag]!.words[`glossary.${name}-words` as 'glossary.seed-words'].split('|'));
    expect(new Set(words.map((word) => word.toLowerCase())).size).toBe(words.length);
    for (const name of glossary()) expect(explained(name)).toMatch(/\.$/);
    const titles = glossary().map(titleOf);
    expect(titles).toEqual([...titles].sort((a, b) => a.localeCompare(b)));
  });
});
