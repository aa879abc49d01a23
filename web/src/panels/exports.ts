import { madeHere } from '../engine/files';
import type { Hub } from './hub';
import { h } from './dom';
import { made, type Far } from './making';
import { heard, say } from '../words/say';

type Kind = 'toml' | 'nc' | 'movie';
const FILES: [Kind, string][] = [['toml', 'cell.toml'], ['nc', 'run.nc'], ['movie', 'movie.mp4']];

/** Buttons for files, and below them those being made, with their progress and a way to cancel. */
export function exportsOf(hub: Hub, png: () => Promise<Blob>): HTMLElement[] {
  const jobs = h('div', { id: 'making', role: 'group', 'aria-label': say('files.making'), hidden: true });
  const shown = (): void => {
    jobs.hidden = jobs.childElementCount === 0;
  };
  const image = once('export-png', say('files.png'), async () => {
    try {
      save(await png(), 'cyclosis.png');
    } catch (error) {
      hub.toast(message(error));
    }
  });
  const files = FILES.map(([kind, file]) => once(`export-${kind}`, say(`files.${kind}`), async () => {
    const job = new Job(kind, say(`files.${kind}`), shown);
    jobs.querySelector(`#making-${kind}`)?.remove();
    jobs.append(job.element);
    shown();
    try {
      await hub.refresh();
      const here = madeHere(kind, hub.link);
      if (here) {
        save(here, `cyclosis-${file}`);
        job.end();
        return;
      }
      const address = `api/export/${file}?cell=${encodeURIComponent(hub.link)}${kind === 'toml' ? '' : '&told=true'}`;
      const answer = await fetch(address, { signal: job.given.signal });
      if (!answer.ok) throw new Error(await reason(answer));
      save(kind === 'toml' ? await answer.blob() : await made(answer, (far) => job.tell(far)), `cyclosis-${file}`);
      job.end();
    } catch (error) {
      if (job.given.signal.aborted) job.end();
      else job.fail(message(error));
    }
  }));
  return [h('div', { class: 'row wrap', role: 'group', 'aria-label': say('files.label') }, image, ...files), jobs];
}

/** A file being made. */
class Job {
  readonly given = new AbortController();
  readonly element: HTMLElement;
  private readonly bar: HTMLProgressElement;
  private readonly doing = h('span', { class: 'note' }, say('files.asking'));
  private readonly button: HTMLButtonElement;

  constructor(kind: Kind, private readonly title: string, private readonly changed: () => void) {
    this.bar = h('progress', { max: 1, 'aria-label': title });
    this.button = h('button', { id: `cancel-${kind}`, 'aria-label': say('files.cancel-one', { title }), onclick: () => this.given.abort() }, say('files.cancel'));
    this.element = h('div', { id: `making-${kind}`, class: 'job' }, h('span', {}, title), this.button, this.bar, this.doing);
  }

  tell({ share, doing }: Far): void {
    if (share === null) this.bar.removeAttribute('value');
    else this.bar.value = share;
    this.doing.textContent = share === null ? heard(doing) : `${Math.floor(100 * share)} %: ${heard(doing)}`;
  }

  end(): void {
    this.element.remove();
    this.changed();
  }

  fail(sentence: string): void {
    this.bar.hidden = true;
    this.doing.setAttribute('role', 'alert');
    this.doing.classList.add('warn');
    this.doing.textContent = sentence;
    const close = h('button', { class: 'quiet', 'aria-label': say('files.dismiss', { title: this.title }), onclick: () => this.end() }, '✕');
    this.button.replaceWith(close);
  }
}

/** A button that ignores clicks while its action is running. */
function once(id: string, title: string, act: () => Promise<void>): HTMLButtonElement {
  const button = h('button', { id, onclick: async () => {
    if (button.getAttribute('aria-busy') === 'true') return;
    button.setAttribute('aria-busy', 'true');
    try {
      await act();
    } finally {
      button.removeAttribute('aria-busy');
    }
  } }, title);
  return button;
}

function message(error: unknown): string {
  if (error instanceof TypeError) return say('files.unreached');
  return error instanceof Error ? heard(error.message) : String(error);
}

async function reason(answer: Response): Promise<string> {
  try {
    const { sentence } = (await answer.json()) as { sentence?: unknown };
    if (typeof sentence === 'string') return heard(sentence);
  } catch {
    // Not an answer of this server: reported below.
  }
  return say('files.status', { status: answer.status });
}

export function save(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  h('a', { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
