import type { Palette, Wheel } from '../protocol';
import type { Hub } from './hub';
import { directionOf, upAndDown } from '../scene/palette';
import { h, panel } from './dom';
import { keep, kept } from './kept';
import { change, languages, said, say, spoken } from '../words/say';

type Theme = 'auto' | 'light' | 'dark';

export interface LookTarget {
  setPalette(palette: Palette): void;
  setDark(dark: boolean): void;
}

const system = matchMedia('(prefers-color-scheme: dark)');

export function keptTheme(): Theme {
  const theme = kept('theme');
  return theme === 'light' || theme === 'dark' ? theme : 'auto';
}

export function isDark(theme: Theme = keptTheme()): boolean {
  return theme === 'dark' || (theme === 'auto' && system.matches);
}

export function keptPalette(palettes: Palette[]): Palette {
  return palettes.find((p) => p.name === kept('palette')) ?? palettes[0]!;
}

/** Theme and colours. */
export function look(hub: Hub, target: LookTarget): HTMLElement {
  const theme = h(
    'select', { id: 'theme', onchange: () => { keep('theme', theme.value); apply(); } },
    ...(['auto', 'light', 'dark'] as const).map((value) => h('option', { value }, say(`look.${value}`))),
  );
  const palette = h(
    'select', { id: 'palette', onchange: () => { keep('palette', palette.value); paint(); } },
    ...hub.about.palettes.map((p) => h('option', { value: p.name }, said(`palette.${p.name}`, p.title))),
  );
  const language = h(
    'select', { id: 'language', onchange: async () => { await hub.refresh(); change(language.value, hub.link); } },
    ...Object.entries(languages).map(([tag, { name }]) => h('option', { value: tag, lang: tag }, name)),
  );
  language.value = spoken();
  theme.value = keptTheme();
  palette.value = keptPalette(hub.about.palettes).name;
  const apply = (): void => {
    const dark = isDark(theme.value as Theme);
    document.documentElement.dataset.theme = dark ? 'dark' : 'light';
    target.setDark(dark);
    paint();
  };
  const paint = (): void => {
    const chosen = hub.about.palettes.find((p) => p.name === palette.value)!;
    const stops = chosen.stops.map(([value, colour]) => `${colour} ${(50 * (value + 1)).toFixed(1)}%`);
    const { style } = document.documentElement;
    style.setProperty('--polarity', `linear-gradient(to right, ${stops.join(', ')})`);
    const [up, down] = upAndDown(chosen, isDark(theme.value as Theme));
    style.setProperty('--up', up);
    style.setProperty('--down', down);
    style.setProperty('--wheel', chosen.wheel ? conic(chosen.wheel) : 'none');
    document.documentElement.classList.toggle('wheeled', chosen.wheel !== null);
    target.setPalette(chosen);
    hub.emit('look', null);
  };
  system.addEventListener('change', apply);
  apply();
  return panel(
    'look', say('look.title'), false,
    h('div', { class: 'setting' }, h('label', { for: 'palette' }, say('look.colours')), palette),
    h('div', { class: 'setting' }, h('label', { for: 'theme' }, say('look.theme')), theme),
    h('div', { class: 'setting' }, h('label', { for: 'language' }, say('look.language')), language),
  );
}

/** The colours of all directions around a disc, up at its top. */
function conic(wheel: Wheel): string {
  const colours = Array.from({ length: 33 }, (_, k) => {
    const angle = 0.5 * Math.PI - (2 * Math.PI * k) / 32; // clockwise from the top
    return `rgb(${directionOf(wheel, Math.cos(angle), Math.sin(angle)).map((part) => Math.round(255 * part)).join(' ')})`;
  });
  return `radial-gradient(#000, transparent 70%), conic-gradient(${colours.join(', ')})`;
}
