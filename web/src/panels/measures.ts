import type { Hub } from './hub';
import { h, panel } from './dom';
import { mathematics } from './mathematics';
import { say } from '../words/say';

/** The long internodal cell of Chara. */
const CHARA = { radius_um: 500, speed_um_s: 75 };

/** The units in which the cell is shown: radii and R/U, or micrometres and seconds. */
export function measures(hub: Hub): HTMLElement {
  const field = (id: string, value: number): HTMLInputElement =>
    h('input', { id, type: 'number', min: 0, step: 'any', inputmode: 'decimal', value, onchange: () => ask() });
  const radius = field('units-radius', CHARA.radius_um);
  const speed = field('units-speed', CHARA.speed_um_s);
  const on = h('select', { id: 'units', onchange: () => ask() },
    h('option', { value: 'none' }, say('units.none')), h('option', { value: 'some' }, say('units.some')));
  const ask = (): void => {
    const [radius_um, speed_um_s] = [radius.valueAsNumber, speed.valueAsNumber];
    const usable = radius_um > 0 && speed_um_s > 0;
    if (on.value === 'some' && !usable) hub.toast(say('units.positive'));
    else hub.ask({ do: 'units', scales: on.value === 'some' ? { radius_um, speed_um_s } : null });
    rows.forEach((row) => (row.hidden = on.value === 'none'));
  };
  const rows = [
    h('div', { class: 'setting' }, h('label', { for: radius.id }, mathematics('R'), ' ', h('small', {}, say('units.radius'))), radius),
    h('div', { class: 'setting' }, h('label', { for: speed.id }, mathematics('U'), ' ', h('small', {}, say('units.speed'))), speed),
    h('p', { class: 'note' }, say('units.note')),
  ];
  hub.on('units', ({ scales }) => {
    on.value = scales ? 'some' : 'none';
    rows.forEach((row) => (row.hidden = !scales));
    if (!scales) return;
    radius.value = String(scales.radius_um);
    speed.value = String(scales.speed_um_s);
  });
  rows.forEach((row) => (row.hidden = true));
  return panel('units', say('units.title'), false,
    h('div', { class: 'setting' }, h('label', { for: on.id }, say('units.choice')), on), ...rows);
}
