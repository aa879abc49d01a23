import type { Hub } from './hub';
import { h } from './dom';
import { explain, table } from './explain';
import { fromSlider, short, STEPS, toSlider } from './scales';
import { prose } from './prose';
import { throttle } from './throttle';
import { numbers, pace, seen, title, unitOfTime } from './words';
import { say } from '../words/say';

/** The state of the cell, and the controls of time. */
export function now(hub: Hub): HTMLElement {
  const { about } = hub;
  const { ask } = hub;
  const name = h('strong', { id: 'regime-name' }, '…');
  const reason = h('span', { id: 'regime-reason' });
  let said = '';
  const settling = h('span', { id: 'regime-pace' });
  const more = explain(say('now.this'), () => {
    const found = hub.frame?.regime;
    return found ? [table(numbers(found)), h('p', { class: 'note' }, ...prose(unitOfTime(hub.units)))] : [say('now.nothing')];
  });
  const regime = h('p', { id: 'regime' }, name, ' ', reason, ' ', settling);
  // Numbers change at every frame: only a change of regime is read out.
  const spoken = h('p', { id: 'regime-spoken', class: 'hidden', role: 'status', 'aria-live': 'polite' });
  const clock = h('output', { id: 'clock', 'aria-live': 'off' }, 't = 0');
  const catching = h('progress', { id: 'catching', max: 1, hidden: true, 'aria-label': say('now.catching') });

  const again = h('button', { id: 'again', class: 'icon', 'aria-label': say('now.again'), title: say('now.again-tip'), onclick: () => ask({ do: 'again' }) }, '❙◀');
  const undo = h('button', { id: 'undo', disabled: true, title: say('now.undo-tip'), onclick: () => ask({ do: 'undo' }) }, say('now.undo'));
  const play = h('button', { id: 'play', class: 'main', 'aria-pressed': 'false', onclick: () => toggle(hub) }, say('now.play'));
  const step = h('button', { id: 'step', onclick: () => ask({ do: 'step' }), title: say('now.step-tip') }, say('now.step'));
  const seed = h('button', { id: 'new-seed', onclick: () => ask({ do: 'new_seed' }), title: say('now.seed-tip') }, say('now.seed'));

  const range: [number, number] = [0.5, about.limits.fastest];
  const value = h('output', { for: 'speed' });
  const send = throttle((speed: number) => ask({ do: 'speed', value: speed }), 80);
  const speed = h('input', {
    id: 'speed', type: 'range', min: 0, max: STEPS, step: 1,
    oninput: () => {
      const wanted = fromSlider(Number(speed.value), range, true);
      describe(wanted);
      send(wanted);
    },
  });
  const describe = (wanted: number): void => {
    const { scales, second } = hub.units;
    value.textContent = say(scales ? 'now.speed-times' : 'now.speed-value', { speed: short(wanted * second) });
    speed.setAttribute('aria-valuetext', say('now.speed-spoken', { speed: short(wanted) }));
  };

  hub.on('cell', (cell) => {
    undo.disabled = cell.undo === 0;
    play.setAttribute('aria-pressed', String(cell.playing));
    play.textContent = say(cell.playing ? 'now.pause' : 'now.play');
    if (document.activeElement !== speed) {
      speed.value = String(toSlider(cell.speed, range, true));
      describe(cell.speed);
    }
    if (cell.fresh) {
      name.textContent = '…';
      said = reason.textContent = settling.textContent = '';
    }
    catchUp(cell.t);
    clock.textContent = hub.units.clock(cell.t);
  });
  hub.on('units', () => hub.cell && describe(hub.cell.speed));
  const catchUp = (t: number): void => {
    const end = hub.cell?.catching_up ?? null;
    catching.hidden = end === null;
    if (end !== null) catching.value = end > 0 ? Math.min(1, t / end) : 1;
  };
  hub.on('frame', (frame) => {
    clock.textContent = hub.units.clock(frame.t);
    catchUp(frame.t);
    if (!frame.regime) return;
    const [called, sentence] = [title(frame.regime), seen(frame.regime, frame.profile_P, hub.units)];
    if (name.textContent !== called) {
      name.textContent = called;
      spoken.textContent = `${called}: ${sentence}`;
    }
    if (said !== sentence) reason.replaceChildren(...prose((said = sentence)));
    const settles = pace(frame.regime, hub.units);
    if (settling.textContent !== settles) settling.textContent = settles;
  });

  return h(
    'section', { id: 'now', 'aria-label': say('now.label') },
    h('div', { class: 'state' }, regime, spoken, h('span', { class: 'row clock' }, clock, more)),
    catching,
    h('div', { class: 'row wrap transport' }, again, play, step, undo, seed),
    h('div', { class: 'row speed' }, h('label', { for: 'speed' }, say('now.speed')), speed, value),
  );
}

export function toggle(hub: Hub): void {
  hub.ask({ do: hub.cell?.playing ? 'pause' : 'play' });
}
