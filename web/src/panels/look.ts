import type { Palette } from '../protocol';
import type { Hub } from './hub';
import { dress, isDark, keptPalette, keptTheme, system, type Theme } from './dress';
import { h, panel } from './dom';
import { keep } from './kept';
import { change, languages, said, say, spoken } from '../words/say';

export interface LookTarget {
  setPalette(palette: Palette): void;
  setDark(dark: boolean): void;
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
    dress(chosen, isDark(theme.value as Theme));
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
