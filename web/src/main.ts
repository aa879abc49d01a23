import 'uplot/dist/uPlot.min.css';
import type { EarlySocket } from './engine/early';
import { browserAddress, chosenEngine } from './engine/socket';
import { parted } from './compare/parted';
import { Comparison } from './compare/compare';
import { diagram } from './panels/diagram';
import { h } from './panels/dom';
import { embed, isEmbedded } from './panels/embed';
import { equation } from './panels/equation';
import { save } from './panels/exports';
import { hand } from './panels/hand';
import type { Cell } from './panels/hub';
import { insideSwitch, type InsideSwitch } from './panels/inside';
import { interventions } from './panels/interventions';
import { keys } from './panels/keys';
import { isDark, keptPalette } from './panels/dress';
import { look } from './panels/look';
import { measures } from './panels/measures';
import { makeRoom, showFrame } from './panels/arrivals';
import { newCell } from './panels/newcell';
import { toaster } from './panels/notices';
import { toggle } from './panels/now';
import { parameters } from './panels/parameters';
import { presets } from './panels/presets';
import { recordButton } from './panels/record';
import { restsWhileHidden } from './panels/rest';
import { Unseen } from './panels/seen';
import { share } from './panels/share';
import { SpeedMeter } from './panels/speed';
import { tour } from './panels/tour';
import { traces } from './panels/traces';
import { worksheet } from './panels/worksheet';
import { Waits } from './panels/waits';
import { firstCell } from './opening/begin';
import type { Front } from './opening/front';
import type { FirstPicture } from './opening/picture';
import type { Ask, Said } from './protocol';
import { drawBeside, pngOf } from './scene/picture';
import { Scene } from './scene/scene';
import { Session } from './session';
import { heard, say } from './words/say';

declare global {
  interface Window {
    cyclosis: { statistics(): Record<string, unknown>; latest(): Cell | null; other(): { t: number; link: string } | null; order(): number | null };
  }
}

/** Build the rest of the page around its front. `early` is the engine that has begun the first cell, if the browser computes it. */
export function build(app: HTMLElement, front: Front, early: EarlySocket | null, picture: FirstPicture): void {
  const { about, hub, cylinder, map, stage, panels, handles, screen } = front;
  const { element: toastElement, toast } = toaster();
  front.toast = toast;
  front.ask = (message) => {
    if (message.do === 'change') scene.expect();
    const whole: Ask = message.do === 'begin' ? { scales: hub.scales, ...message } : message;
    if (!comparison.asks(whole)) session.ask(whole);
  };
  front.drawn = () => ({ opened: inner?.on ?? false, closed: !hub.model.straight, axial: hub.cell?.outline?.axial !== false, wheeled: document.documentElement.classList.contains('wheeled') });
  let inner: InsideSwitch | null = null;
  const meter = new SpeedMeter();
  const charts = traces(hub);
  front.charts.replaceWith(charts);
  app.append(toastElement);
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
  scene.onDrawn = (frame) => {
    picture.remove();
    unseen.drawn(frame);
  };
  const guide = tour({ hub, choose: tools.choose });
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
  front.buttons.questions.onclick = () => questions.open();
  front.buttons.tour.onclick = () => guide.start();
  front.buttons.keys.onclick = () => help.open();
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
  const engine = chosenEngine();
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
    first: () => firstCell(about, location.hash),
    moved: () => {
      comparison.moved();
      // Opened again, the address computes the cell in the browser too.
      history.replaceState(null, '', browserAddress());
    },
  }, engine && (() => early?.join() ?? engine()));
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
  front.waits(false);
  session.open();
}
