import '../style.css';
import { EarlySocket } from '../engine/early';
import { fetchCatalogue, inBrowser, WorkerSocket } from '../engine/socket';
import { keepOffline } from '../offline';
import { h } from '../panels/dom';
import { isDark } from '../panels/dress';
import type { About } from '../protocol';
import { say, spoken } from '../words/say';
import { firstCell } from './begin';
import { Front } from './front';
import { FirstPicture } from './picture';

// The small part of the page that is loaded first. With the engine in the browser it begins the cell and paints its
// first picture, before the larger part with WebGL, charts and panels is run.

/** Milliseconds for which the larger part of the page waits for the first picture. */
const PATIENCE = 4000;

const app = document.getElementById('app')!;

async function fetchAbout(): Promise<About> {
  const answer = await fetch('api/about');
  if (!answer.ok) throw new Error(say('page.status', { status: answer.status }));
  return (await answer.json()) as About;
}

async function start(): Promise<void> {
  const told = fetchAbout();
  told.catch(() => undefined); // until it is awaited
  const early = inBrowser() ? new EarlySocket(new WorkerSocket(fetchCatalogue())) : null;
  document.documentElement.dataset.theme = isDark() ? 'dark' : 'light';
  document.documentElement.lang = spoken();
  await keepOffline();
  const about = await told;
  early?.begin(firstCell(about, location.hash));
  const front = new Front(about);
  app.replaceChildren(...front.elements);
  const picture = new FirstPicture(front);
  if (early) {
    const painted = early.picture.then((frame) => frame && picture.paint(frame));
    await Promise.race([painted, new Promise((done) => setTimeout(done, PATIENCE))]);
  }
  const { build } = await import('../main');
  build(app, front, early, picture);
}

start().catch((error: unknown) => {
  const reason = error instanceof Error ? error.message : String(error);
  app.replaceChildren(h('p', { class: 'loading', role: 'alert' }, say('page.failed', { reason })));
});
