import type { Definition, Values } from '../protocol';
import type { Hub } from './hub';
import { h, mathematics, panel } from './dom';

type Table = 'grid' | 'initial' | 'run';
/** A new cell, with the current parameters. */
export function newCell(hub: Hub): HTMLElement {
  const { about } = hub;
  const entries = [
    ...about.initial.map((definition) => entry('initial', definition)),
    ...about.grid.map((definition) => entry('grid', definition)),
    entry('run', about.interval),
  ];
  const kind = entries.find((e) => e.definition.name === 'kind');
  const adapt = (): void => {
    const used = about.uses[kind?.input.value ?? 'disordered'];
    for (const e of entries) {
      if (e.table !== 'initial' || e === kind) continue;
      e.element.hidden = used !== undefined && !used.includes(e.definition.name);
    }
  };
  kind?.input.addEventListener('change', adapt);
  hub.on('cell', (cell) => {
    if (!cell.fresh) return;
    for (const e of entries) {
      const value = cell.setup[e.table][e.definition.name];
      e.input.value = value === null || value === undefined ? '' : String(value);
    }
    adapt();
  });
  const begin = (event: Event): void => {
    event.preventDefault();
    const setup: Record<Table | 'parameters', Values> = { parameters: {}, grid: {}, initial: {}, run: {} };
    for (const { name } of about.parameters) {
      const value = hub.parameters[name];
      if (value !== undefined && value !== null && !(hub.cell?.special[name] === 'field')) setup.parameters[name] = value;
    }
    for (const e of entries) {
      if (e.element.hidden || e.input.value === '') continue;
      const number = e.definition.kind === 'number' || e.definition.kind === 'whole';
      setup[e.table][e.definition.name] = number ? Number(e.input.value) : e.input.value;
    }
    hub.ask({ do: 'begin', setup });
  };
  return panel(
    'new-cell', 'New cell', false,
    h('form', { onsubmit: begin, novalidate: true }, ...entries.map((e) => e.element),
      h('p', { class: 'note' }, `At most ${about.limits.points} grid points in each direction. Begins at t = 0 with the current parameters.`),
      h('button', { id: 'begin', class: 'main', type: 'submit' }, 'Begin')),
  );
}

function entry(table: Table, definition: Definition) {
  const { name, symbol, meaning, allowed } = definition;
  const id = `setting-${name}`;
  const input = allowed.length
    ? h('select', { id }, ...allowed.map((choice) => h('option', { value: choice }, choice)))
    : h('input', { id, type: 'number', step: 'any', min: definition.minimum, max: definition.maximum });
  const label = h('label', { for: id, title: meaning }, symbol === '-' ? '' : mathematics(symbol), ' ', h('small', {}, meaning));
  return { table, definition, input, element: h('div', { class: 'setting' }, label, input) };
}
