import type { Ask, Said } from '../protocol';
import type { Catalogue } from './definitions';
import { Visit } from './visit';

// The engine in a Web Worker. The first message is the catalogue, all others are requests as JSON text; answers are
// those of the server: JSON text and binary pictures.

/** Milliseconds between signs of life. */
const ALIVE = 1500;

interface Scope {
  onmessage: ((event: MessageEvent<Catalogue | string>) => void) | null;
  postMessage(data: string | ArrayBuffer, transfer?: ArrayBuffer[]): void;
}
const scope = self as unknown as Scope;

let visit: Visit | null = null;
let timer: ReturnType<typeof setTimeout> | undefined;

function say(said: Said): void {
  scope.postMessage(JSON.stringify(said));
}

function begin(about: Catalogue): void {
  const own = new Visit(about, {
    say,
    show: (data) => scope.postMessage(data, [data]),
    now: () => performance.now(),
    later: (wait) => {
      clearTimeout(timer);
      timer = setTimeout(() => own.tick(), wait);
    },
  });
  visit = own;
  say({ type: 'welcome', token: 'browser', received: 0, preparing: null });
  setInterval(() => say({ type: 'alive' }), ALIVE);
}

scope.onmessage = ({ data }) => {
  if (typeof data !== 'string') begin(data);
  else {
    const ask = JSON.parse(data) as Ask;
    // A worker that is new has no session from before: the page begins its cell again.
    if (ask.do === 'resume') say({ type: 'forgotten' });
    else visit?.hear(ask);
  }
};
