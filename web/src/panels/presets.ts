import type { Preset } from '../protocol';
import type { Hub } from './hub';
import { h, panel } from './dom';

const GROUPS: [Preset['group'], string][] = [
  ['figures', 'Figures of the paper'],
  ['regimes', 'Regimes'],
  ['experiments', 'Experiments'],
];

/** Ready-made cells worth seeing. */
export function presets(hub: Hub): HTMLElement {
  const text = h('p', { id: 'preset-text', class: 'note', 'aria-live': 'polite' });
  const own = h('option', { value: '' }, 'Your own cell');
  const select = h(
    'select', { id: 'preset', onchange: () => select.value && hub.ask({ do: 'begin', preset: select.value }) },
    own,
    ...GROUPS.map(([group, title]) =>
      h('optgroup', { label: title }, ...hub.about.presets.filter((p) => p.group === group).map((p) => h('option', { value: p.name }, capital(p.title)))),
    ),
  );
  hub.on('cell', (cell) => {
    const found = hub.about.presets.find((p) => p.name === cell.preset);
    select.value = found?.name ?? '';
    own.hidden = found !== undefined;
    text.textContent = found?.text ?? 'A cell of your own: its address holds all of it.';
  });
  return panel('presets', 'Begin with', true, h('label', { for: 'preset', class: 'hidden' }, 'Preset'), select, text);
}

const capital = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);
