import type { Preset } from '../protocol';
import type { Hub } from './hub';
import { h, panel } from './dom';
import { prose } from './prose';
import { said, say } from '../words/say';

const GROUPS: Preset['group'][] = ['figures', 'regimes', 'experiments'];

/** Ready-made cells worth seeing. */
export function presets(hub: Hub): HTMLElement {
  const text = h('p', { id: 'preset-text', class: 'note', 'aria-live': 'polite' });
  let shown = '';
  const own = h('option', { value: '' }, say('presets.own'));
  const select = h(
    'select', { id: 'preset', onchange: () => select.value && hub.ask({ do: 'begin', preset: select.value }) },
    own,
    ...GROUPS.map((group) =>
      h('optgroup', { label: say(`presets.${group}`) }, ...hub.about.presets.filter((p) => p.group === group).map((p) => h('option', { value: p.name }, capital(said(`preset.${p.name}`, p.title))))),
    ),
  );
  hub.on('cell', (cell) => {
    const found = hub.about.presets.find((p) => p.name === cell.preset);
    select.value = found?.name ?? '';
    own.hidden = found !== undefined;
    const words = found ? said(`preset.${found.name}.text`, found.text) : say('presets.own-text');
    if (words === shown) return;
    shown = words;
    text.replaceChildren(...prose(words));
  });
  return panel('presets', say('presets.title'), true, h('label', { for: 'preset', class: 'hidden' }, say('presets.label')), select, text);
}

const capital = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);
