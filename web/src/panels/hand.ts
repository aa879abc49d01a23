import type { Tool } from '../scene/scene';
import type { Ask } from '../protocol';
import type { Hub } from './hub';
import { h, mathematics, panel } from './dom';
import { explain, table } from './explain';

const TOOLS: [Tool, string, string][] = [
  ['turn', 'Turn', 'drag to turn the cell (1)'],
  ['wound', 'Wound', 'remove all filaments under the brush (2)'],
  ['fragment', 'Fragment', 'break filaments into disorder under the brush (3)'],
  ['align', 'Align', 'turn filaments along one direction under the brush (4)'],
];
const DRUGS: ['cytochalasin' | 'wash_out' | 'inhibit_myosin', string, string][] = [
  ['cytochalasin', 'Cytochalasin', 'stops bundling: α_p becomes 0'],
  ['wash_out', 'Wash out', 'back to the parameters of this cell'],
  ['inhibit_myosin', 'Inhibit myosin', 'the flow no longer turns filaments: α_u becomes 0'],
];

export interface HandTarget {
  setTool(tool: Tool, radius: number): void;
}

export interface Hand {
  element: HTMLElement;
  choose(tool: Tool): void;
  /** A brush stroke from the scene, a piece at a time. */
  stroke(points: [number, number][]): void;
}

/** Tools that act under the brush, and drugs that act everywhere. */
export function hand(hub: Hub, target: HandTarget): Hand {
  let tool: Tool = 'turn';
  const radius = h('input', { id: 'radius', type: 'range', min: 0.1, max: 1.5, step: 0.05, value: '0.4', oninput: () => choose(tool) });
  const radiusValue = h('output', { for: 'radius' });
  const angle = h('input', { id: 'angle', type: 'range', min: -180, max: 180, step: 5, value: '90', oninput: () => choose(tool) });
  const angleValue = h('output', { for: 'angle' });
  const angleRow = h('div', { class: 'row slide' }, h('label', { for: 'angle' }, 'Direction'), angle, angleValue);
  const tip = h('p', { id: 'tool-tip', class: 'note', 'aria-live': 'polite' });
  const buttons = TOOLS.map(([name, title, tip]) =>
    h('button', { id: `tool-${name}`, 'aria-pressed': 'false', title: tip, onclick: () => choose(name) }, title));

  const choose = (wanted: Tool): void => {
    tool = wanted;
    TOOLS.forEach(([name], k) => buttons[k]!.setAttribute('aria-pressed', String(name === tool)));
    tip.textContent = TOOLS.find(([name]) => name === tool)![2].replace(/^./, (letter) => letter.toUpperCase());
    radiusValue.textContent = `${Number(radius.value).toFixed(2)} R`;
    angleValue.textContent = `${angle.value}° ${direction(Number(angle.value))}`;
    angleRow.hidden = tool !== 'align';
    apply.disabled = tool === 'turn';
    target.setTool(tool, Number(radius.value));
  };

  const brush = (points: [number, number][]): void => {
    if (tool === 'turn') return;
    const limit = hub.about.limits.stroke;
    for (let start = 0; start < points.length; start += limit) {
      const message: Ask = { do: 'brush', tool, points: points.slice(start, start + limit), radius: Number(radius.value) };
      if (tool === 'align') message.angle = (Number(angle.value) * Math.PI) / 180;
      hub.ask(message);
    }
  };

  // The brush for those who cannot draw, or prefer not to.
  const theta = h('input', { id: 'at-theta', type: 'number', min: 0, max: 6.29, step: 'any', value: '3.14', 'aria-label': 'θ of the brush in radians' });
  const z = h('input', { id: 'at-z', type: 'number', min: 0, step: 'any', value: '2.5', 'aria-label': 'z of the brush in radii' });
  const along = mathematics('z');
  hub.on('cell', (cell) => {
    const { straight } = hub.modelOf(cell);
    along.textContent = straight ? 'z' : 's';
    z.setAttribute('aria-label', straight ? 'z of the brush in radii' : 's of the brush, the arc length from the south pole in radii');
  });
  const apply = h('button', { id: 'brush-here', onclick: () => brush([[Number(theta.value), Number(z.value)]]) }, 'Apply here');

  const element = panel(
    'hand', 'Your hand', true,
    h('div', { class: 'row segmented', role: 'group', 'aria-label': 'Tool' }, ...buttons),
    tip,
    h('div', { class: 'row slide' }, h('label', { for: 'radius' }, 'Brush'), radius, radiusValue),
    angleRow,
    h('details', { class: 'inner' }, h('summary', {}, 'Brush by numbers'),
      h('div', { class: 'row' }, mathematics('θ'), theta, along, z, apply)),
    h('div', { class: 'row wrap drugs', role: 'group', 'aria-label': 'Drugs' },
      ...DRUGS.map(([name, title, tip]) =>
        h('button', { id: `drug-${name.replace('_', '-')}`, title: tip, onclick: () => hub.ask({ do: 'drug', name }) }, title)),
      explain('each drug', () => [table(DRUGS.map(([, title, tip]) => [title, tip, '']))])),
  );
  choose('turn');
  return { element, choose, stroke: brush };
}

function direction(degrees: number): string {
  if (degrees === 90) return '(up)';
  if (degrees === -90) return '(down)';
  return degrees % 180 === 0 ? '(around)' : '';
}
