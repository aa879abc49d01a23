import type { Socket } from '../connection';
import type { Catalogue } from './definitions';

/** What of a Web Worker is used. */
export type Engine = Pick<Worker, 'onmessage' | 'onerror' | 'postMessage' | 'terminate'>;

const [CONNECTING, OPEN, CLOSED] = [0, 1, 3];

/** The engine in the place of a server: to the page's connection a Web Worker looks like a WebSocket. */
export class WorkerSocket implements Socket {
  readonly local = true;
  readyState = CONNECTING;
  binaryType: BinaryType = 'arraybuffer';
  onopen: Socket['onopen'] = null;
  onclose: Socket['onclose'] = null;
  onmessage: Socket['onmessage'] = null;
  private readonly engine: Engine;

  constructor(catalogue: Promise<Catalogue>, make: () => Engine = newEngine) {
    this.engine = make();
    this.engine.onmessage = (event: MessageEvent) => this.onmessage?.call(this as never, event);
    this.engine.onerror = () => this.fail();
    catalogue.then((about) => this.begin(about), () => this.fail());
  }

  get opened(): boolean {
    return this.readyState === OPEN;
  }

  get ended(): boolean {
    return this.readyState === CLOSED;
  }

  send(text: string): void {
    if (this.readyState === OPEN) this.engine.postMessage(text);
  }

  close(): void {
    this.readyState = CLOSED;
    this.engine.terminate();
  }

  private begin(about: Catalogue): void {
    if (this.readyState !== CONNECTING) return;
    this.readyState = OPEN;
    this.engine.postMessage(about);
    this.onopen?.call(this as never, new Event('open'));
  }

  private fail(): void {
    if (this.readyState === CLOSED) return;
    this.close();
    this.onclose?.call(this as never, new Event('close') as CloseEvent);
  }
}

export function newEngine(): Engine {
  return new Worker(new URL('./worker.ts', import.meta.url), { type: 'module' });
}

/** What the package tells the engine, next to the page. */
export async function fetchCatalogue(): Promise<Catalogue> {
  const answer = await fetch('api/engine');
  if (!answer.ok) throw new Error(`status ${answer.status}`);
  return (await answer.json()) as Catalogue;
}

/** Whether the cell is computed in the browser: the address asks for it, or the page itself. */
export function inBrowser(address = location.href, page: Document = document): boolean {
  const asked = new URL(address).searchParams.get('engine');
  return (asked ?? (ownEngine(page) ? 'browser' : null)) === 'browser';
}

/** Whether the page was written to be served without a server of its own. */
export function ownEngine(page: Document = document): boolean {
  return page.querySelector<HTMLMetaElement>('meta[name="cyclosis-engine"]')?.content === 'browser';
}

/** The address of this page with the cell computed in the browser. */
export function browserAddress(address = location.href): string {
  const own = new URL(address);
  own.searchParams.set('engine', 'browser');
  return own.href;
}

/** Sockets of the engine in the browser if that is chosen; else none. */
export function chosenEngine(): (() => WorkerSocket) | undefined {
  return inBrowser() ? () => new WorkerSocket(fetchCatalogue()) : undefined;
}
