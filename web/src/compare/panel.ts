import { h, panel } from '../panels/dom';
import type { Hub } from '../panels/hub';
import { mathematics } from '../panels/mathematics';
import { fromSlider, short, STEPS, toSlider } from '../panels/scales';
import type { Definition } from '../protocol';
import { said, say } from '../words/say';
import type { Value } from './address';

/** The name of a cell in a comparison: the value of the parameter in it. */
export function called({ symbol, name }: Definition, value: Value): string {
  return `${symbol === '-' ? name.replaceAll('_', ' ') : symbol} = ${typeof value === 'boolean' ? say(value ? 'compare.yes' : 'compare.no') : short(value)}`;
}

/** A telling value for the second cell: none of it, or if the first has none, half of what is usual. */
export function proposal({ usual, kind }: Definition, own: Value): Value {
  if (kind === 'flag') return !own;
  const [low, high] = usual ?? [0, 1];
  return own === low ? Number(((low + high) / 2).toPrecision(2)) : low;
}

export interface Chosen {
  begin(name: string, value: Value): void;
  change(value: Value): void;
  end(): void;
}

export interface ComparePanel {
  element: HTMLElement;
  /** Show a comparison that is on, or none. */
  show(name: string | null, value: Value): void;
}

/** Which parameter differs, its value in the second cell, and a button. */
export function comparePanel(hub: Hub, act: Chosen): ComparePanel {
  const { parameters } = hub.about;
  let on = false;
  const select = h('select', { id: 'compare-parameter', onchange: () => propose() },
    ...parameters.map(({ name, symbol, meaning }) => h('option', { value: name }, `${symbol === '-' ? '' : `${symbol}: `}${said(`setting.${name}`, meaning)}`)));
  const slider = h('input', { id: 'compare-slider', type: 'range', min: 0, max: STEPS, step: 1, 'aria-label': say('compare.value'), oninput: () => slid(), onchange: () => changed() });
  const field = h('input', { id: 'compare-value', type: 'number', step: 'any', inputmode: 'decimal', onchange: () => changed() });
  const flag = h('input', { id: 'compare-flag', type: 'checkbox', 'aria-label': say('compare.value'), onchange: () => changed() });
  const label = h('label', { for: 'compare-value' });
  const button = h('button', { id: 'compare', class: 'main', onclick: () => (on ? act.end() : act.begin(select.value, value())) }, say('compare.begin'));
  const chosen = (): Definition => parameters.find(({ name }) => name === select.value)!;
  const value = (): Value => (chosen().kind === 'flag' ? flag.checked : field.valueAsNumber);
  const display = (to: Value): void => {
    const { kind, usual, minimum, maximum } = chosen();
    const isFlag = kind === 'flag';
    flag.hidden = !isFlag;
    field.hidden = isFlag;
    slider.hidden = isFlag || !usual;
    label.htmlFor = isFlag ? flag.id : field.id;
    label.replaceChildren(mathematics(chosen().symbol === '-' ? '' : chosen().symbol), ' ', h('small', {}, say('compare.value')));
    flag.checked = to === true;
    [field.min, field.max] = [String(minimum), String(maximum)];
    field.value = String(to);
    if (usual && typeof to === 'number') slider.value = String(toSlider(to, usual));
  };
  const propose = (): void => {
    const definition = chosen();
    display(proposal(definition, (hub.parameters[definition.name] ?? definition.default) as Value));
  };
  const slid = (): void => {
    field.value = String(fromSlider(Number(slider.value), chosen().usual!));
  };
  const changed = (): void => {
    const { usual } = chosen();
    if (usual && Number.isFinite(field.valueAsNumber)) slider.value = String(toSlider(field.valueAsNumber, usual));
    if (on && (chosen().kind === 'flag' || Number.isFinite(field.valueAsNumber))) act.change(value());
  };
  let proposed = false;
  hub.on('cell', (cell) => {
    const { unused } = hub.modelOf(cell);
    for (const option of select.options) option.hidden = option.disabled = unused.includes(option.value);
    if (!on && (!proposed || cell.fresh)) propose();
    proposed = true;
  });
  const first = parameters.find(({ name }) => name === 'alpha_u') ?? parameters[0]!;
  select.value = first.name;
  propose();
  const element = panel('compare', say('compare.title'), false,
    h('p', { class: 'note' }, say('compare.about')),
    h('div', { class: 'setting one' }, h('label', { for: 'compare-parameter', class: 'hidden' }, say('compare.parameter')), select),
    h('div', { class: 'parameter compared' }, h('div', { class: 'head' }, label), slider, field, flag),
    button);
  return {
    element,
    show: (name, to) => {
      on = name !== null;
      select.disabled = on;
      button.textContent = say(on ? 'compare.end' : 'compare.begin');
      if (name !== null) {
        select.value = name;
        display(to);
      }
    },
  };
}
