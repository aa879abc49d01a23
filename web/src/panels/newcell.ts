import type { Definition, Shape, Values } from '../protocol';
import type { Hub } from './hub';
import { h, panel } from './dom';
import { prose, symbols } from './prose';
import { mathematics } from './mathematics';
import { isKey, said, say } from '../words/say';

type Table = 'model' | 'grid' | 'initial' | 'run';
/** A new cell, with the current parameters. */
export function newCell(hub: Hub): HTMLElement {
  const { about } = hub;
  const shape = h('select', { id: 'setting-shape', onchange: () => adapt() }, ...about.shapes.map(({ name }) => h('option', { value: name }, named(name))));
  const chosen = (): Shape => about.shapes.find(({ name }) => name === shape.value) ?? about.shapes[0]!;
  // Settings of one name mean other things for other shapes.
  const grids = about.shapes.map((each, k) => ({
    shape: each,
    entries: each.settings.map((definition) => entry('grid', definition, k === 0 ? '' : `${each.name}-`, `${each.name}.`)),
  }));
  const initial = about.initial.map((definition) => entry('initial', definition));
  const interval = entry('run', about.interval);
  const kind = initial.find((e) => e.definition.name === 'kind');
  const shown = (): Entry[] => [...initial, ...(grids.find((grid) => grid.shape === chosen())?.entries ?? []), interval];
  const adapt = (): void => {
    const { uses } = about.models[chosen().model]!;
    const used = uses[kind?.input.value ?? 'disordered'];
    for (const e of initial) e.element.hidden = e !== kind && used !== undefined && !used.includes(e.definition.name);
    for (const { shape: each, entries } of grids) for (const e of entries) e.element.hidden = each !== chosen();
  };
  kind?.input.addEventListener('change', adapt);
  hub.on('cell', (cell) => {
    if (!cell.fresh) return;
    shape.value = shapeOf(cell.setup.grid);
    for (const e of shown()) {
      const value = cell.setup[e.table][e.definition.name];
      e.input.value = value === null || value === undefined ? '' : String(value);
    }
    adapt();
  });
  const begin = (event: Event): void => {
    event.preventDefault();
    const { name: form, model } = chosen();
    const setup: Record<Table | 'parameters', Values> = { model: {}, parameters: {}, grid: {}, initial: {}, run: {} };
    if (about.models[model]!.straight === false) {
      setup.model.kind = model;
      setup.grid.shape = form;
    }
    const { unused } = about.models[model]!;
    for (const { name } of about.parameters) {
      const value = hub.parameters[name];
      if (unused.includes(name) || value === undefined || value === null || hub.cell?.special[name] === 'field') continue;
      setup.parameters[name] = value;
    }
    for (const e of shown()) {
      if (e.element.hidden || e.input.value === '') continue;
      const number = e.definition.kind === 'number' || e.definition.kind === 'whole';
      setup[e.table][e.definition.name] = number ? Number(e.input.value) : e.input.value;
    }
    hub.ask({ do: 'begin', setup });
  };
  adapt();
  return panel(
    'new-cell', say('new.title'), false,
    h('form', { onsubmit: begin, novalidate: true },
      h('div', { class: 'setting' }, h('label', { for: 'setting-shape' }, h('small', {}, say('new.shape'))), shape),
      ...grids.flatMap(({ entries }) => entries.map((e) => e.element)),
      ...initial.map((e) => e.element), interval.element,
      h('p', { class: 'note' }, ...prose(say('new.note', { points: about.limits.points }))),
      h('button', { id: 'begin', class: 'main', type: 'submit' }, say('new.begin'))),
  );
}

/** What a choice is called in the page. */
function named(choice: string): string {
  const key = `new.${choice}`;
  return isKey(key) ? say(key) : choice;
}

/** The name of the shape that a [grid] table describes. */
export function shapeOf(grid: Values): string {
  return typeof grid.shape === 'string' ? grid.shape : 'cylinder';
}

interface Entry {
  table: Table;
  definition: Definition;
  input: HTMLSelectElement | HTMLInputElement;
  element: HTMLElement;
}

function entry(table: Table, definition: Definition, prefix = '', place = ''): Entry {
  const { name, symbol, allowed } = definition;
  const meaning = said(`setting.${place}${name}`, definition.meaning);
  const id = `setting-${prefix}${name}`;
  const input = allowed.length
    ? h('select', { id }, ...allowed.map((choice) => h('option', { value: choice, selected: choice === definition.default }, named(String(choice)))))
    : h('input', { id, type: 'number', step: 'any', min: definition.minimum, max: definition.maximum, value: definition.default ?? '' });
  const label = h('label', { for: id, title: meaning }, symbol === '-' ? '' : mathematics(symbol), ' ', h('small', {}, ...symbols(meaning)));
  return { table, definition, input, element: h('div', { class: 'setting' }, label, input) };
}
