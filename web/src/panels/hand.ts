import type { Tool } from '../scene/scene';
import type { Ask } from '../protocol';
import type { Hub } from './hub';
import { h, panel } from './dom';
import { mathematics } from './mathematics';
import { explain, table } from './explain';
import { say } from '../words/say';
import { decimals } from './scales';

const TOOLS: Tool[] = ['turn', 'wound', 'fragment', 'align'];
const DRUGS = ['cytochalasin', 'wash_out', 'inhibit_myosin'] as const;

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
  const angleRow = h('div', { class: 'row slide' }, h('label', { for: 'angle' }, say('hand.direction')), angle, angleValue);
  const tip = h('p', { id: 'tool-tip', class: 'note', 'aria-live': 'polite' });
  const buttons = TOOLS.map((name) =>
    h('button', { id: `tool-${name}`, 'aria-pressed': 'false', title: say(`hand.${name}-tip`), onclick: () => choose(name) }, say(`hand.${name}`)));

  const choose = (wanted: Tool): void => {
    tool = wanted;
    TOOLS.forEach((name, k) => buttons[k]!.setAttribute('aria-pressed', String(name === tool)));
    tip.textContent = say(`hand.${tool}-tip`);
    radiusValue.textContent = hub.units.scales ? hub.units.reaching(Number(radius.value)) : `${decimals(Number(radius.value), 2)} R`;
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
  const theta = h('input', { id: 'at-theta', type: 'number', min: 0, max: 6.29, step: 'any', value: '3.14', 'aria-label': say('hand.theta') });
  const z = h('input', { id: 'at-z', type: 'number', min: 0, step: 'any', value: '2.5', 'aria-label': say('hand.z') });
  const along = mathematics('z');
  hub.on('cell', (cell) => {
    const { straight } = hub.modelOf(cell);
    along.textContent = straight ? 'z' : 's';
    z.setAttribute('aria-label', say(straight ? 'hand.z' : 'hand.s'));
  });
  const apply = h('button', { id: 'brush-here', onclick: () => brush([[Number(theta.value), Number(z.value)]]) }, say('hand.apply'));

  const element = panel(
    'hand', say('hand.title'), true,
    h('div', { class: 'row segmented', role: 'group', 'aria-label': say('hand.tools') }, ...buttons),
    tip,
    h('div', { class: 'row slide' }, h('label', { for: 'radius' }, say('hand.brush')), radius, radiusValue),
    angleRow,
    h('details', { class: 'inner' }, h('summary', {}, say('hand.numbers')),
      h('div', { class: 'row' }, mathematics('θ'), theta, along, z, apply)),
    h('div', { class: 'row wrap drugs', role: 'group', 'aria-label': say('hand.drugs') },
      ...DRUGS.map((name) =>
        h('button', { id: `drug-${name.replace('_', '-')}`, title: say(`hand.${name}-tip`), onclick: () => hub.ask({ do: 'drug', name }) }, say(`hand.${name}`))),
      explain(say('hand.each-drug'), () => [table(DRUGS.map((name) => [say(`hand.${name}`), say(`hand.${name}-tip`), '']))])),
  );
  hub.on('units', () => choose(tool));
  choose('turn');
  return { element, choose, stroke: brush };
}

function direction(degrees: number): string {
  if (degrees === 90) return say('hand.up');
  if (degrees === -90) return say('hand.down');
  return degrees % 180 === 0 ? say('hand.around') : '';
}
