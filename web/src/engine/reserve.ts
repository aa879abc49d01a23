import type { Catalogue } from './definitions';
import { fetchCatalogue, newEngine, WorkerSocket, type Engine } from './socket';

/**
 * The engine in the browser, loaded while the server is still there, so that a cell can go on without it. It costs
 * nothing until it is used: a Web Worker that waits.
 */
export class Reserve {
  private spare: Engine | null = null;
  private catalogue: Catalogue | null = null;
  private begun = false;

  constructor(
    private readonly fetched: () => Promise<Catalogue> = fetchCatalogue,
    private readonly make: () => Engine = newEngine,
  ) {}

  get ready(): boolean {
    return this.catalogue !== null;
  }

  /** Load it, once. */
  prepare(): void {
    if (this.begun) return;
    this.begun = true;
    this.spare = this.make();
    this.fetched().then((catalogue) => (this.catalogue = catalogue), () => this.failed());
  }

  /** A socket of the engine: the one that waits, or later ones. */
  socket(): WorkerSocket {
    const { spare, catalogue } = this;
    this.spare = null;
    return new WorkerSocket(catalogue ? Promise.resolve(catalogue) : this.fetched(), () => spare ?? this.make());
  }

  end(): void {
    this.spare?.terminate();
    this.spare = null;
  }

  /** What could not be loaded is loaded with a later picture. */
  private failed(): void {
    this.end();
    this.begun = false;
  }
}
