import { h } from '../panels/dom';
import { dress, isDark, keptPalette } from '../panels/dress';
import { isEmbedded } from '../panels/embed';
import { grouped } from '../panels/grouped';
import { Hub } from '../panels/hub';
import { key, type Drawn } from '../panels/key';
import { now } from '../panels/now';
import { projector, type Projector } from '../panels/projector';
import type { About, Ask } from '../protocol';
import { say } from '../words/say';

/**
 * What the page shows before its larger part is loaded, each at its final place: the header, the place of the pictures,
 * the controls of time, and room for the charts. Nothing in it answers yet.
 */
export class Front {
  readonly hub: Hub;
  readonly cylinder = h('div', { id: 'cylinder' });
  readonly map = h('div', { id: 'map' });
  readonly stage: HTMLElement;
  readonly header: HTMLElement;
  readonly handles: HTMLElement;
  readonly charts: HTMLElement;
  readonly panels = h('section', { id: 'panels', 'aria-label': say('page.controls') });
  readonly screen: Projector;
  readonly buttons = {
    questions: h('button', { id: 'questions' }, say('worksheet.title')),
    tour: h('button', { id: 'tour', class: 'main' }, say('page.tour')),
    keys: h('button', { id: 'keys', 'aria-label': say('page.keys'), title: `${say('page.keys')} (?)` }, '?'),
  };
  /** What the larger part of the page does with requests and sentences, once it is there. */
  ask: (message: Ask) => void = () => undefined;
  toast: (sentence: string) => void = () => undefined;
  drawn: () => Drawn = () => ({ opened: false, closed: false, axial: true, wheeled: document.documentElement.classList.contains('wheeled') });

  constructor(readonly about: About) {
    dress(keptPalette(about.palettes), isDark());
    if (isEmbedded()) document.documentElement.classList.add('embedded');
    this.hub = new Hub(about, (message) => this.ask(message), (sentence) => this.toast(sentence));
    this.screen = projector(() => this.hub.emit('look', null));
    this.stage = h('section', { id: 'stage', role: 'main', 'aria-label': say('page.stage') }, this.cylinder, this.map, key(() => this.drawn()));
    const { questions, tour, keys } = this.buttons;
    this.header = h('header', {},
      h('h1', {}, 'cyclosis'),
      h('p', { class: 'motto' }, say('page.motto')),
      h('nav', { 'aria-label': say('page.help') }, this.screen.enter, questions, tour, keys));
    this.handles = now(this.hub);
    this.handles.querySelector('.transport')!.append(this.screen.leave);
    this.charts = roomForCharts(this.hub);
    this.waits(true);
  }

  /** Whether nothing answers yet. */
  waits(waiting: boolean): void {
    for (const element of [this.header.querySelector('nav')!, this.handles]) element.inert = waiting;
  }

  get elements(): HTMLElement[] {
    return [this.header, this.stage, this.handles, this.charts, this.panels];
  }
}

/** As many empty charts as there will be. */
function roomForCharts(hub: Hub): HTMLElement {
  const count = grouped(hub.model.traces).length + (hub.model.straight ? 1 : 0);
  const one = (): HTMLElement => h('figure', { class: 'chart' }, h('figcaption', {}, h('strong', { class: 'room' }, '\u00a0')), h('div', { class: 'plot' }));
  return h('section', { id: 'charts', 'aria-hidden': 'true' }, ...Array.from({ length: count }, one));
}
