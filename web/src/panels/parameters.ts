import type { Definition, Values } from '../protocol';
import type { Cell, Hub } from './hub';
import { h, panel } from './dom';
import { mathematics } from './mathematics';
import { explain } from './explain';
import { plainly } from './plain';
import { prose, symbols } from './prose';
import { fromSlider, STEPS, toSlider } from './scales';
import { throttle } from './throttle';
import { said, say } from '../words/say';

/** Sliders and fields for everything that can be changed in a living cell. */
export function parameters(hub: Hub): HTMLElement {
  let pending: Values = {};
  const flush = throttle<null>(() => {
    hub.ask({ do: 'change', values: pending });
    pending = {};
  }, 80);
  const change = (name: string, value: number | boolean): void => {
    pending[name] = value;
    flush(null);
  };
  const rows = hub.about.parameters.map((definition) => new Row(definition, hub, change));
  hub.on('cell', (cell) => rows.forEach((row) => row.show(cell, hub.modelOf(cell).unused)));
  return panel('parameters', say('parameters.title'), true, ...rows.map((row) => row.element));
}

class Row {
  readonly element: HTMLElement;
  private readonly field: HTMLInputElement;
  private readonly slider: HTMLInputElement | null = null;
  private readonly chip = h('span', { class: 'chip', hidden: true });
  private readonly reset: HTMLButtonElement;
  /** Until when the visitor's input, and not the server, decides what is shown. */
  private held = 0;
  private own: number | boolean = 0;

  constructor(
    private readonly definition: Definition,
    private readonly hub: Hub,
    private readonly change: (name: string, value: number | boolean) => void,
  ) {
    const { name, symbol, kind, usual } = definition;
    const meaning = said(`setting.${name}`, definition.meaning);
    const flag = kind === 'flag';
    const id = `parameter-${name}`;
    this.field = flag
      ? h('input', { id, type: 'checkbox', onchange: () => this.set(this.field.checked) })
      : h('input', {
          id, type: 'number', min: definition.minimum, max: definition.maximum, step: 'any', inputmode: 'decimal',
          oninput: () => this.hold(),
          onblur: () => (this.held = Math.min(this.held, Date.now() + 600)),
          onchange: () => this.typed(),
        });
    if (!flag && usual) {
      this.slider = h('input', {
        id: `slider-${name}`, type: 'range', min: 0, max: STEPS, step: 1, 'aria-label': `${name}: ${meaning}`,
        oninput: () => this.set(fromSlider(Number(this.slider!.value), usual), false),
      });
    }
    this.reset = h('button', {
      id: `reset-${name}`, class: 'quiet', disabled: true, 'aria-label': say('parameters.reset', { name }), onclick: () => this.set(this.own),
    }, '↺');
    const label = h('label', { for: id }, symbol === '-' ? '' : mathematics(symbol), ' ', h('small', {}, ...symbols(meaning)));
    const words = plainly(name);
    const head = h('div', { class: 'head' }, label, words && explain(name, () => [h('p', {}, ...prose(words)), ...this.physical()]));
    this.element = h('div', { class: `parameter ${flag ? 'flag' : ''}`, 'data-name': name }, head, this.chip, this.slider, this.field, this.reset);
  }

  show(cell: Cell, unused: string[]): void {
    const { name, default: fallback } = this.definition;
    this.element.hidden = unused.includes(name);
    const value = cell.parameters[name];
    this.own = (cell.setup.parameters[name] ?? fallback) as number | boolean;
    const special = cell.special[name];
    this.chip.hidden = !special;
    this.chip.textContent = say(special === 'ramp' ? 'parameters.ramp' : 'parameters.field');
    if (Date.now() < this.held && !cell.fresh) return;
    this.display(value as number | boolean);
  }

  /** The value in the units of the cell. */
  private physical(): Node[] {
    const value = this.hub.parameters[this.definition.name];
    const text = typeof value === 'number' ? this.hub.units.parameter(this.definition.name, value) : '';
    return text ? [h('p', { class: 'note' }, say('units.here', { value: text }))] : [];
  }

  private display(value: number | boolean | undefined, slider = true): void {
    if (typeof value === 'boolean') this.field.checked = value;
    else if (typeof value === 'number') {
      this.field.value = String(Number(value.toPrecision(6)));
      if (this.slider && slider) this.slider.value = String(toSlider(value, this.definition.usual!));
      this.slider?.setAttribute('aria-valuetext', this.field.value);
    } else this.field.value = '';
    const same = value === this.own;
    this.reset.disabled = same;
    this.element.classList.toggle('changed', !same);
    this.reset.title = say('parameters.back', { value: String(this.own) });
  }

  /** A number being typed stays as it is until it is entered or left. */
  private hold(): void {
    this.held = Infinity;
  }

  private typed(): void {
    const value = this.field.valueAsNumber;
    if (Number.isFinite(value)) this.set(value);
  }

  private set(value: number | boolean, slider = true): void {
    this.held = Date.now() + 600;
    this.display(value, slider);
    this.change(this.definition.name, value);
  }
}
