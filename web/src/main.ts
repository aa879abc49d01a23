import 'uplot/dist/uPlot.min.css';
import './style.css';
import { browserAddress, chosenEngine } from './engine/socket';
import { parted } from './compare/address';
import { Comparison } from './compare/compare';
import { diagram } from './panels/diagram';
import { h } from './panels/dom';
import { embed, isEmbedded } from './panels/embed';
import { equation } from './panels/equation';
import { save } from './panels/exports';
import { hand } from './panels/hand';
import { Hub, type Cell } from './panels/hub';
import { insideSwitch, type InsideSwitch } from './panels/inside';
import { interventions } from './panels/interventions';
import { key } from './panels/key';
import { keys } from './panels/keys';
import { isDark, keptPalette, look } from './panels/look';
import { measures } from './panels/measures';
import { makeRoom, showFrame } from './panels/arrivals';
import { newCell } from './panels/newcell';
import { toaster } from './panels/notices';
import { now, toggle } from './panels/now';
import { parameters } from './panels/parameters';
import { projector } from './panels/projector';
import { presets } from './panels/presets';
import { recordButton } from './panels/record';
import { restsWhileHidden } from './panels/rest';
import { Unseen } from './panels/seen';
import { share } from './panels/share';
import { SpeedMeter } from './panels/speed';
import { firstPreset } from './panels/story';
import { tour } from './panels/tour';
import { traces } from './panels/traces';
import { worksheet } from './panels/worksheet';
import { Waits } from './panels/waits';
import { keepOffline } from './offline';
import type { About, Ask, Said } from './protocol';
import { drawBeside, pngOf } from './scene/picture';
import { Scene } from './scene/scene';
import { Session } from './session';
import { heard, say, spoken } from './words/say';

declare global {
  interface Window {
    cyclosis: { statistics(): Record<string, unknown>; latest(): Cell | null; other(): { t: number; link: string } | null; order(): number | null };
  }
}

const app = document.getElementById('app')!;

async function start(): Promise<void> {
  document.documentElement.dataset.theme = isDark() ? 'dark' : 'light';
  document.documentElement.lang = spoken();
  await keepOffline();
  const answer = await fetch('api/about');
  if (!answer.ok) throw new Error(say('page.status', { status: answer.status }));
  build((await answer.json()) as About);
}

function build(about: About): void {
  const { element: toastElement, toast } = toaster();
  const ask = (message: Ask): void => {
    if (message.do === 'change') scene.expect();
    const whole: Ask = message.do === 'begin' ? { scales: hub.scales, ...message } : message;
    if (!comparison.asks(whole)) session.ask(whole);
  };
  const hub = new Hub(about, ask, toast);
  let inner: InsideSwitch | null = null;
  const meter = new SpeedMeter();
  const cylinder = h('div', { id: 'cylinder' });
  const map = h('div', { id: 'map' });
  const stage = h('section', { id: 'stage', role: 'main', 'aria-label': say('page.stage') }, cylinder, map, key(() => ({ opened: inner?.on ?? false, closed: !hub.model.straight, axial: hub.cell?.outline?.axial !== false, wheeled: document.documentElement.classList.contains('wheeled') })));
  const header = h('header', {});
  const panels = h('section', { id: 'panels', 'aria-label': say('page.controls') });
  const charts = traces(hub);
  const handles = now(hub);
  app.replaceChildren(header, stage, handles, charts, panels, toastElement);
  // Presets can be chosen while another cell is prepared; sharing and appearance concern only the page.
  const holding = ['hand', 'parameters', 'diagram', 'new-cell'].map((id) => `#panel-${id} > .body`).join(', ');
  const waits = new Waits(app, () => [...handles.querySelectorAll<HTMLElement>(':scope > .row:not(.spread)'), ...panels.querySelectorAll<HTMLElement>(holding)]);
  cylinder.append(waits.over);
  handles.append(waits.beside);

  const scene = new Scene({ cylinder, map, palette: keptPalette(about.palettes), dark: isDark(), notice: toast });
  inner = insideSwitch(hub, scene, app);
  cylinder.append(inner.element);
  hub.on('units', (units) => scene.setUnits(units));
  const comparison = new Comparison({ hub, scene, app, stage, charts, ask: (message) => session.ask(message), close: () => inner?.on && inner.toggle() }, parted(location.hash));
  const tools = hand(hub, {
    setTool: (tool, radius) => {
      scene.setTool(tool, radius);
      comparison.setTool(tool, radius);
    },
  });
  scene.onStroke = tools.stroke;
  const unseen = new Unseen((frame) => hub.ask({ do: 'seen', frame }));
  scene.onDrawn = (frame) => unseen.drawn(frame);
  const guide = tour({ hub, choose: tools.choose });
  const screen = projector(() => hub.emit('look', null));
  handles.querySelector('.transport')!.append(screen.leave);
  const help = keys([
    [' ', say('keys.play'), () => toggle(hub)],
    ['.', say('keys.step'), () => hub.ask({ do: 'step' })],
    ['b', say('keys.again'), () => hub.ask({ do: 'again' })],
    ['z', say('keys.undo'), () => hub.cell?.undo && hub.ask({ do: 'undo' })],
    ['n', say('keys.seed'), () => hub.ask({ do: 'new_seed' })],
    ['1', say('keys.turn'), () => tools.choose('turn')],
    ['2', say('keys.wound'), () => tools.choose('wound')],
    ['3', say('keys.fragment'), () => tools.choose('fragment')],
    ['4', say('keys.align'), () => tools.choose('align')],
    ['v', say('keys.inside'), () => comparison.active || inner?.toggle()],
    ['f', say('keys.project'), screen.toggle],
    ['t', say('keys.tour'), () => { screen.off(); guide.start(); }],
    ['?', say('keys.list'), () => help.open()],
  ]);
  const questions = worksheet(hub);
  header.append(
    h('h1', {}, 'cyclosis'),
    h('p', { class: 'motto' }, say('page.motto')),
    h('nav', { 'aria-label': say('page.help') },
      screen.enter,
      h('button', { id: 'questions', onclick: () => questions.open() }, say('worksheet.title')),
      h('button', { id: 'tour', class: 'main', onclick: () => guide.start() }, say('page.tour')),
      h('button', { id: 'keys', 'aria-label': say('page.keys'), title: `${say('page.keys')} (?)`, onclick: () => help.open() }, '?')),
  );
  panels.append(
    presets(hub), tools.element, parameters(hub), diagram(hub), comparison.panel.element, interventions(hub),
    share(hub, () => pngOf(comparison.canvases(true), cylinder), recordButton(hub, {
      draw: (onto) => drawBeside(onto, comparison.canvases(false), cylinder),
      save,
    })), equation(hub), newCell(hub), measures(hub), look(hub, scene),
    h('p', { class: 'note foot' }, say('page.foot', { version: about.version })),
  );
  if (matchMedia('(max-width: 820px)').matches) {
    panels.querySelectorAll<HTMLDetailsElement>('details.panel').forEach((panel) => (panel.open = panel.id === 'panel-presets' || panel.id === 'panel-hand'));
  }

  const shown = { hub, waits, scene, unseen };
  const hear = (raw: Said): void => {
    const said = comparison.hears(raw);
    if (said.type === 'cell') {
      makeRoom(said, shown);
      if (said.fresh) app.classList.toggle('ball', said.outline?.axial === false);
      scene.playing = said.playing;
      scene.hurry();
      hub.emit('cell', said);
    } else if (said.type === 'refused') toast(heard(said.sentence));
    else if (said.type === 'hash') hub.emit('hash', said);
    else if (said.type === 'curves') hub.emit('curves', said);
  };
  const session = new Session({
    hub,
    waits,
    said: hear,
    frame: (frame) => {
      meter.add(performance.now(), frame.t);
      showFrame(frame, shown);
      comparison.came(frame);
    },
    inside: (inside) => {
      if (inside.begun === hub.cell?.begun) scene.showInside(inside);
    },
    lost: () => {
      scene.playing = false;
      unseen.forget();
    },
    first: () => {
      const { link } = parted(location.hash);
      const preset = firstPreset(about.presets)?.name;
      return link ? { do: 'begin', link } : preset ? { do: 'begin', preset } : { do: 'begin', setup: {} };
    },
    moved: () => {
      comparison.moved();
      // Opened again, the address computes the cell in the browser too.
      history.replaceState(null, '', browserAddress());
    },
  }, chosenEngine());
  restsWhileHidden(hub, () => session.isOpen);
  if (isEmbedded()) embed(hub, stage);
  app.append(guide.element, help.element, questions.element, session.banner);
  addEventListener('hashchange', () => {
    const { link, other } = parted(location.hash);
    if (!link || link === hub.link) return;
    comparison.open(other);
    hub.ask({ do: 'begin', link });
  });
  window.cyclosis = {
    other: () => comparison.other,
    order: () => hub.frame?.regime?.order ?? null,
    statistics: () => ({
      ...scene.statistics,
      t: hub.frame?.t ?? hub.cell?.t ?? 0,
      speedMeasured: meter.measured(performance.now()),
      frame: hub.frame?.frame ?? 0,
    }),
    latest: () => hub.cell,
  };
  session.open();
}

start().catch((error: unknown) => {
  const reason = error instanceof Error ? error.message : String(error);
  app.replaceChildren(h('p', { class: 'loading', role: 'alert' }, say('page.failed', { reason })));
});
