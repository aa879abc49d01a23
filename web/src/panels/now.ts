import type { Hub } from './hub';
import { h } from './dom';
import { fromSlider, short, STEPS, toSlider } from './scales';
import { throttle } from './throttle';

/** What the cell is doing now, and the handles of time. */
export function now(hub: Hub): HTMLElement {
  const { about } = hub;
  const { ask } = hub;
  const name = h('strong', { id: 'regime-name' }, '…');
  const reason = h('span', { id: 'regime-reason' });
  const regime = h('p', { id: 'regime' }, name, ' ', reason);
  // The reason's numbers change at every frame: only another regime is read out.
  const spoken = h('p', { id: 'regime-spoken', class: 'hidden', role: 'status', 'aria-live': 'polite' });
  const clock = h('output', { id: 'clock', 'aria-live': 'off', title: 'time in units of R/U' }, 't = 0');
  const catching = h('progress', { id: 'catching', max: 1, hidden: true, 'aria-label': 'catching up with the saved cell' });

  const play = h('button', { id: 'play', class: 'main', 'aria-pressed': 'false', onclick: () => toggle(hub) }, '▶ Play');
  const step = h('button', { id: 'step', onclick: () => ask({ do: 'step' }), title: 'one frame (.)' }, 'Step');
  const seed = h('button', { id: 'new-seed', onclick: () => ask({ do: 'new_seed' }), title: 'the same cell from another random disorder (n)' }, 'New seed');

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
    value.textContent = `${short(wanted)} t/s`;
    speed.setAttribute('aria-valuetext', `${short(wanted)} time units a second`);
  };

  hub.on('cell', (cell) => {
    play.setAttribute('aria-pressed', String(cell.playing));
    play.textContent = cell.playing ? '❚❚ Pause' : '▶ Play';
    if (document.activeElement !== speed) {
      speed.value = String(toSlider(cell.speed, range, true));
      describe(cell.speed);
    }
    if (cell.fresh) {
      name.textContent = '…';
      reason.textContent = '';
    }
    catchUp(cell.t);
    clock.textContent = time(cell.t);
  });
  const catchUp = (t: number): void => {
    const end = hub.cell?.catching_up ?? null;
    catching.hidden = end === null;
    if (end !== null) catching.value = end > 0 ? Math.min(1, t / end) : 1;
  };
  hub.on('frame', (frame) => {
    clock.textContent = time(frame.t);
    catchUp(frame.t);
    if (!frame.regime) return;
    if (name.textContent !== frame.regime.name) {
      name.textContent = frame.regime.name;
      spoken.textContent = `${frame.regime.name}: ${frame.regime.reason}`;
    }
    if (reason.textContent !== frame.regime.reason) reason.textContent = frame.regime.reason;
  });

  return h(
    'section', { id: 'now', 'aria-label': 'The cell now' },
    h('div', { class: 'row spread' }, regime, spoken, clock),
    catching,
    h('div', { class: 'row' }, play, step, seed),
    h('div', { class: 'row speed' }, h('label', { for: 'speed' }, 'Speed'), speed, value),
  );
}

export function toggle(hub: Hub): void {
  hub.ask({ do: hub.cell?.playing ? 'pause' : 'play' });
}

function time(t: number): string {
  return `t = ${t.toFixed(1)}`;
}
