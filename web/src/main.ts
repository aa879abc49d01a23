import 'uplot/dist/uPlot.min.css';
import './style.css';
import { Connection } from './connection';
import { diagram } from './panels/diagram';
import { h } from './panels/dom';
import { equation } from './panels/equation';
import { hand } from './panels/hand';
import { Hub, type Cell } from './panels/hub';
import { interventions } from './panels/interventions';
import { keys } from './panels/keys';
import { isDark, keptPalette, look } from './panels/look';
import { newCell } from './panels/newcell';
import { lostBanner, toaster } from './panels/notices';
import { now, toggle } from './panels/now';
import { parameters } from './panels/parameters';
import { presets } from './panels/presets';
import { Unseen } from './panels/seen';
import { share } from './panels/share';
import { SpeedMeter } from './panels/speed';
import { firstPreset } from './panels/story';
import { tour } from './panels/tour';
import { traces } from './panels/traces';
import type { About, Ask, Said } from './protocol';
import { Scene } from './scene/scene';

declare global {
  interface Window {
    cyclosis: { statistics(): Record<string, unknown>; latest(): Cell | null };
  }
}

const app = document.getElementById('app')!;

async function start(): Promise<void> {
  document.documentElement.dataset.theme = isDark() ? 'dark' : 'light';
  const answer = await fetch('api/about');
  if (!answer.ok) throw new Error(`the server answered with status ${answer.status}`);
  build((await answer.json()) as About);
}

function build(about: About): void {
  const { element: toastElement, toast } = toaster();
  const ask = (message: Ask): void => {
    if (message.do === 'change') scene.expect();
    connection.ask(message);
  };
  const hub = new Hub(about, ask, toast);
  const meter = new SpeedMeter();
  const cylinder = h('div', { id: 'cylinder' });
  const map = h('div', { id: 'map' });
  const key = h('div', { class: 'key-bar', 'aria-hidden': 'true' }, 'down', h('span', { class: 'bar' }), 'up');
  const stage = h('section', { id: 'stage', role: 'main', 'aria-label': 'The cell' }, cylinder, map, key);
  const header = h('header', {});
  const panels = h('section', { id: 'panels', 'aria-label': 'Controls' });
  const charts = traces(hub);
  app.replaceChildren(header, stage, now(hub), charts, panels, toastElement);

  const scene = new Scene({ cylinder, map, palette: keptPalette(about.palettes), dark: isDark(), notice: toast });
  const tools = hand(hub, scene);
  scene.onStroke = tools.stroke;
  const unseen = new Unseen((frame) => hub.ask({ do: 'seen', frame }));
  scene.onDrawn = (frame) => unseen.drawn(frame);
  const guide = tour({ hub, choose: tools.choose });
  const help = keys([
    [' ', 'play or pause', () => toggle(hub)],
    ['.', 'one step', () => hub.ask({ do: 'step' })],
    ['n', 'new seed', () => hub.ask({ do: 'new_seed' })],
    ['1', 'turn the cell', () => tools.choose('turn')],
    ['2', 'wound', () => tools.choose('wound')],
    ['3', 'fragment', () => tools.choose('fragment')],
    ['4', 'align', () => tools.choose('align')],
    ['t', 'the tour', () => guide.start()],
    ['?', 'this list', () => help.open()],
  ]);
  header.append(
    h('h1', {}, 'cyclosis'),
    h('p', { class: 'motto' }, 'How streaming in a living cell organises itself'),
    h('nav', { 'aria-label': 'Help' },
      h('button', { id: 'tour', class: 'main', onclick: () => guide.start() }, 'Tour'),
      h('button', { id: 'keys', 'aria-label': 'keys', title: 'keys (?)', onclick: () => help.open() }, '?')),
  );
  panels.append(
    presets(hub), tools.element, parameters(hub), diagram(hub), interventions(hub),
    share(hub, () => scene.png()), equation(hub), newCell(hub), look(hub, scene),
    h('p', { class: 'note foot' }, `cyclosis ${about.version}, after Woodhouse & Goldstein, PNAS 110 (2013).`),
  );
  const lost = lostBanner(() => connection.open());
  app.append(guide.element, help.element, lost.element);
  if (matchMedia('(max-width: 820px)').matches) {
    panels.querySelectorAll<HTMLDetailsElement>('details.panel').forEach((panel) => (panel.open = panel.id === 'panel-presets' || panel.id === 'panel-hand'));
  }

  const hear = (said: Said): void => {
    if (said.type === 'cell') {
      if (said.fresh) {
        scene.clear();
        unseen.dropped();
        hub.frame = null;
      }
      scene.playing = said.playing;
      scene.hurry();
      hub.emit('cell', said);
    } else if (said.type === 'refused') toast(said.sentence);
    else if (said.type === 'hash') hub.emit('hash', said);
    else if (said.type === 'curves') hub.emit('curves', said);
    else if (said.type === 'ended') ended = said.sentence;
  };
  let ended = '';
  const connection = new Connection({
    open: () => {
      lost.hide();
      unseen.forget();
      ended = '';
      const link = hub.link || location.hash.slice(1);
      const preset = firstPreset(about.presets)?.name;
      hub.ask(link ? { do: 'begin', link } : preset ? { do: 'begin', preset } : { do: 'begin', setup: {} });
    },
    said: hear,
    frame: (frame) => {
      unseen.came(frame.frame);
      meter.add(performance.now(), frame.t);
      scene.show(frame);
      hub.emit('frame', frame);
    },
    lost: () => {
      scene.playing = false;
      lost.show(ended || 'The connection to the cell is lost; its address still holds all of it.');
    },
  });
  addEventListener('hashchange', () => {
    const link = location.hash.slice(1);
    if (link && link !== hub.link) hub.ask({ do: 'begin', link });
  });
  window.cyclosis = {
    statistics: () => ({
      ...scene.statistics,
      t: hub.frame?.t ?? hub.cell?.t ?? 0,
      speedMeasured: meter.measured(performance.now()),
      frame: hub.frame?.frame ?? 0,
    }),
    latest: () => hub.cell,
  };
  connection.open();
}

start().catch((error: unknown) => {
  const reason = error instanceof Error ? error.message : String(error);
  app.replaceChildren(h('p', { class: 'loading', role: 'alert' }, `The page could not be opened: ${reason}.`));
});
