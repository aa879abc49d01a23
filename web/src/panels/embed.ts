import { h } from './dom';
import type { Hub } from './hub';
import { say } from '../words/say';


/** Whether the page is a small part of another one: its address says so. */
export function isEmbedded(address = location.href): boolean {
  return new URL(address).searchParams.has('embed');
}

/** The address of the whole page with the same cell. */
export function wholeAddress(link: string, address = location.href): string {
  const whole = new URL(address);
  whole.searchParams.delete('embed');
  whole.hash = link;
  return whole.href;
}

/**
 * The page as a small living cell in another page: only the pictures, and a link to all of it. It plays while it can
 * be seen, unless the visitor prefers less motion.
 */
export function embed(hub: Hub, stage: HTMLElement): void {
  document.documentElement.classList.add('embedded');
  const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
  const link = h('a', { id: 'whole', target: '_top' }, say('embed.open'));
  const button = h('button', { id: 'embedded-play', class: 'quiet', onclick: () => {
    wanted = !hub.cell?.playing;
    hub.ask({ do: wanted ? 'play' : 'pause' });
  } });
  stage.append(h('p', { class: 'row embedded-row' }, button, link));
  let wanted = !calm;
  let seen = false;
  const look = (): void => {
    const plays = wanted && seen && !document.hidden;
    if (hub.cell && hub.cell.catching_up === null && plays !== hub.cell.playing) hub.ask({ do: plays ? 'play' : 'pause' });
  };
  hub.on('cell', (cell) => {
    link.href = wholeAddress(cell.link);
    button.textContent = cell.playing ? '❚❚' : '▶';
    button.setAttribute('aria-label', say(cell.playing ? 'embed.pause' : 'embed.play'));
    if (cell.fresh) look();
  });
  new IntersectionObserver(([entry]) => {
    seen = entry!.isIntersecting;
    look();
  }).observe(stage);
}
