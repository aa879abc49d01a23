import type { Hub } from './hub';
import { h, panel } from './dom';
import { throttle } from './throttle';

type Kind = 'toml' | 'nc' | 'movie';
const FILES: [Kind, string, string][] = [
  ['toml', 'cell.toml', 'Settings (TOML)'],
  ['nc', 'run.nc', 'Data (NetCDF)'],
  ['movie', 'movie.mp4', 'Movie (MP4)'],
];

/** The cell as an address, a fingerprint and files. */
export function share(hub: Hub, png: () => Promise<Blob>): HTMLElement {
  // Browsers refuse an address that changes too often.
  const writeAddress = throttle((link: string) => history.replaceState(null, '', `#${link}`), 350);
  // A page that nobody sees asks for nothing, so that its cell can end.
  setInterval(() => { if (!document.hidden) void hub.refresh(); }, 2000);
  const copied = h('span', { class: 'note', role: 'status' });
  const copy = h('button', { id: 'share', class: 'main', onclick: async () => {
    await hub.refresh();
    writeAddress.flush();
    copied.textContent = (await copyText(location.href)) ? 'Copied. It opens this very cell.' : 'Copy the address from the bar above.';
  } }, 'Copy address');
  const hash = h('output', { id: 'hash', class: 'hash' });
  const askHash = h('button', { id: 'ask-hash', onclick: () => hub.ask({ do: 'hash' }), title: 'SHA-256 of the exact state: equal cells have equal fingerprints' }, 'Fingerprint');
  hub.on('hash', ({ t, sha256 }) => {
    hash.textContent = `t = ${t}: ${sha256}`;
    hash.dataset.sha256 = sha256;
    hash.dataset.t = String(t);
  });
  hub.on('cell', (cell) => {
    writeAddress(cell.link);
    if (cell.fresh) hash.textContent = copied.textContent = '';
  });

  const image = busy('export-png', 'Picture (PNG)', async () => save(await png(), 'cyclosis.png'), hub);
  const files = FILES.map(([kind, file, title]) =>
    busy(`export-${kind}`, title, async () => {
      await hub.refresh();
      const answer = await fetch(`api/export/${file}?cell=${encodeURIComponent(hub.link)}`);
      if (!answer.ok) throw new Error(await reason(answer));
      save(await answer.blob(), `cyclosis-${file}`);
    }, hub));
  return panel(
    'share', 'Share and keep', true,
    h('div', { class: 'row wrap' }, copy, askHash),
    copied, hash,
    h('div', { class: 'row wrap', role: 'group', 'aria-label': 'Export' }, image, ...files),
  );
}

function busy(id: string, title: string, act: () => Promise<void>, hub: Hub): HTMLButtonElement {
  const button = h('button', { id, onclick: async () => {
    if (button.getAttribute('aria-busy') === 'true') return;
    button.setAttribute('aria-busy', 'true');
    try {
      await act();
    } catch (error) {
      hub.toast(error instanceof Error ? error.message : String(error));
    } finally {
      button.removeAttribute('aria-busy');
    }
  } }, title);
  return button;
}

async function reason(answer: Response): Promise<string> {
  try {
    const { sentence } = (await answer.json()) as { sentence?: unknown };
    if (typeof sentence === 'string') return sentence;
  } catch {
    // Not an answer of ours: said below.
  }
  return `The file could not be made (status ${answer.status}).`;
}

function save(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  h('a', { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

async function copyText(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    // Pages that are not served securely may only copy a selection.
    const area = h('textarea', { value: text, class: 'hidden' });
    document.body.append(area);
    area.select();
    const done = document.execCommand('copy');
    area.remove();
    return done;
  }
}
