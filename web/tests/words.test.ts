import { readdirSync, readFileSync } from 'node:fs';
import { afterEach, describe, expect, it } from 'vitest';
import { short } from '../src/panels/scales';
import { chosen, heard, languages, said, say, speak } from '../src/words/say';
import english from '../src/words/en';

afterEach(() => speak('en'));

const others = Object.entries(languages).filter(([tag]) => tag !== 'en');
const names = (text: string): string[] => [...text.matchAll(/\{(\w+)\}/g)].map(([name]) => name).sort();
/** The numbers in a text, which are the same in every language but for their decimal mark. */
const numbers = (text: string, mark: string): string[] =>
  [...text.matchAll(/(?<![A-Za-z])\d+(?:[.,]\d+)?/g)].map(([found]) => found.replace(mark, '.')).sort();

describe.each(others)('the texts in %s', (_, { words, sentences }) => {
  const mark = words['number.decimal'];

  it('are those of English, with the same values to fill in and the same numbers', () => {
    expect(Object.keys(words).sort()).toEqual(Object.keys(english.words).sort());
    for (const [key, text] of Object.entries(english.words)) {
      const here = words[key as keyof typeof words];
      expect(names(here), key).toEqual(names(text));
      expect(numbers(here, mark), key).toEqual(numbers(text, '.'));
      expect(here.trim(), key).not.toBe('');
    }
    expect(words['count.words'].split('|').length).toBe(english.words['count.words'].split('|').length);
  });

  it('fill nothing into a sentence that the package does not say', () => {
    for (const [there, here] of Object.entries(sentences)) for (const name of names(here)) expect(names(there)).toContain(name);
  });
});

it('has no text that nobody uses', () => {
  const source = readdirSync(new URL('../src', import.meta.url), { recursive: true, encoding: 'utf8' })
    .filter((path) => path.endsWith('.ts') && !/words\/[a-z]{2}(-[a-z]+)?\.ts$/.test(path))
    .map((path) => readFileSync(new URL(`../src/${path}`, import.meta.url), 'utf8')).join('\n');
  const patterns = [...source.matchAll(/`([a-z]+\.(?:\$\{[^}]*\}|[^`\s$])*)`/g)].map(([, text]) =>
    new RegExp(`^${text!.split(/\$\{[^}]*\}/).map((piece) => piece.replaceAll('.', '\\.')).join('.+')}$`));
  const unused = Object.keys(english.words).filter((key) => !source.includes(`'${key}'`) && !patterns.some((pattern) => pattern.test(key)));
  expect(unused).toEqual([]);
});

it('takes the language of the address, then the one chosen before, then what the browser prefers', () => {
  expect(chosen('?lang=de', 'en', ['en'])).toBe('de');
  expect(chosen('?lang=xx', 'de', ['en'])).toBe('de');
  expect(chosen('', null, ['fr', 'de-AT', 'en'])).toBe('de');
  expect(chosen('?lang=constructor', 'toString', ['fr'])).toBe('en');
});

it('fills in values, and leaves what it does not know as it is', () => {
  expect(say('seen.travelling', { how: 'up' })).toBe('The pattern keeps its shape and moves up.');
  speak('de');
  expect(say('tour.count', { k: 1, all: 6 })).toBe('1 von 6');
  expect(short(-1.5)).toBe('−1,5');
  expect(said('preset.wound', 'A wound')).toBe('Eine Wunde');
  expect(said('preset.unknown', 'Unknown')).toBe('Unknown');
  expect(heard('drawing picture 3 of 14')).toBe('Bild 3 von 14 wird gezeichnet');
  expect(heard('Preparing a sphere of 32 x 64 points. The first of its kind takes about 9 s.')).toContain('32 x 64 Punkten');
  expect(heard('kappa = 9 cannot be used')).toBe('kappa = 9 cannot be used');
});
