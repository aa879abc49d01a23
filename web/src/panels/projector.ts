import { h } from './dom';
import { say } from '../words/say';

export interface Projector {
  /** The way in, and the way out. */
  enter: HTMLElement;
  leave: HTMLElement;
  toggle(): void;
  off(): void;
}

/** Full screen with large print for a class: the cell, its colours, what it does, and the time. */
export function projector(changed: () => void): Projector {
  const root = document.documentElement;
  const on = (): boolean => root.classList.contains('projected');
  const set = (wanted: boolean): void => {
    if (wanted === on()) return;
    root.classList.toggle('projected', wanted);
    enter.setAttribute('aria-pressed', String(wanted));
    if (!wanted) scrollTo({ top: 0 });
    changed();
  };
  const toggle = (): void => {
    if (on()) {
      off();
      return;
    }
    set(true);
    // Where the browser refuses, the page is arranged likewise in its window.
    void root.requestFullscreen?.().catch(() => undefined);
  };
  const off = (): void => {
    set(false);
    if (document.fullscreenElement) void document.exitFullscreen().catch(() => undefined);
  };
  document.addEventListener('fullscreenchange', () => document.fullscreenElement || set(false));
  document.addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && on() && !document.querySelector('dialog[open], :popover-open')) off();
  });
  const enter = h('button', { id: 'project', 'aria-pressed': 'false', title: say('project.tip'), onclick: toggle }, say('project.enter'));
  const leave = h('button', { id: 'unproject', onclick: off }, say('project.leave'));
  return { enter, leave, toggle, off };
}
