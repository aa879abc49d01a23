// The texts of the page in the visitor's language.

import { keep, kept } from '../panels/kept';
import english, { type Key, type Language } from './en';

export type { Key, Language };

const found = import.meta.glob<Language>(['./??.ts', './??-*.ts'], { eager: true, import: 'default' });

/** Every language by its tag, as "de". */
export const languages: Record<string, Language> = Object.fromEntries(
  Object.entries(found).map(([path, language]) => [path.replace(/^\.\/|\.ts$/g, ''), language]),
);

/** The tag of a language that the page has: that of the address, else the one kept, else the first that the browser prefers. */
export function chosen(search: string, before: string | null, preferred: readonly string[]): string {
  const wanted = [new URLSearchParams(search).get('lang'), before, ...preferred];
  for (const tag of wanted) {
    const known = tag && [tag, tag.slice(0, 2)].map((each) => each.toLowerCase()).find((each) => Object.hasOwn(languages, each));
    if (known) return known;
  }
  return 'en';
}

const page = globalThis.window !== undefined;
let tag = page ? chosen(location.search, kept('language'), navigator.languages) : 'en';
let language = languages[tag]!;

/** The tag of the language in use. */
export function spoken(): string {
  return tag;
}

/** Use another language for what is said from now on. */
export function speak(wanted: string): void {
  tag = wanted;
  language = languages[tag] ?? english;
}

/** Remember another language, and open the page anew in it, at the same cell. */
export function change(wanted: string, link: string): void {
  keep('language', wanted);
  const address = new URL(location.href);
  address.searchParams.set('lang', wanted);
  address.hash = link;
  location.replace(address);
}

/** A text of the page, with values filled in. */
export function say(key: Key, values: Record<string, string | number> = {}): string {
  return filled(language.words[key], values);
}

/** Whether there is a text of a name that is known only while the page runs. */
export function isKey(name: string): name is Key {
  return Object.hasOwn(english.words, name);
}

/** A text of the package, given in English, in the language of the page. */
export function said(place: string, text: string): string {
  return language.package[place] ?? text;
}

/** A sentence that the package has made, in the language of the page where that has one for it. */
export function heard(sentence: string): string {
  for (const [template, here] of Object.entries(language.sentences)) {
    const pattern = template.replace(/[.*+?^$()|[\]\\]/g, '\\$&').replace(/\{(\w+)\}/g, '(?<$1>.+?)');
    const match = new RegExp(`^${pattern}$`).exec(sentence);
    if (match) return filled(here, match.groups ?? {});
  }
  return sentence;
}

function filled(text: string, values: Record<string, string | number>): string {
  return text.replace(/\{(\w+)\}/g, (whole, name: string) => (name in values ? String(values[name]) : whole));
}
