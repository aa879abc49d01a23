import type { Hub } from './hub';
import { h, panel } from './dom';
import { exportsOf } from './exports';
import { throttle } from './throttle';
import { say } from '../words/say';

/** The cell as an address, a fingerprint and files. */
export function share(hub: Hub, png: () => Promise<Blob>, record: HTMLElement): HTMLElement {
  // Browsers refuse an address that changes too often.
  const writeAddress = throttle((link: string) => history.replaceState(null, '', `#${link}`), 350);
  // A hidden page requests nothing, so that its cell can end.
  setInterval(() => { if (!document.hidden) void hub.refresh(); }, 2000);
  const copied = h('span', { class: 'note', role: 'status' });
  const copy = h('button', { id: 'share', class: 'main', onclick: async () => {
    await hub.refresh();
    writeAddress.flush();
    copied.textContent = say((await copyText(location.href)) ? 'share.copied' : 'share.by-hand');
  } }, say('share.copy'));
  const hash = h('output', { id: 'hash', class: 'hash' });
  const askHash = h('button', { id: 'ask-hash', onclick: () => hub.ask({ do: 'hash' }), title: say('share.fingerprint-tip') }, say('share.fingerprint'));
  hub.on('hash', ({ t, sha256 }) => {
    hash.textContent = `t = ${t}: ${sha256}`;
    hash.dataset.sha256 = sha256;
    hash.dataset.t = String(t);
  });
  hub.on('cell', (cell) => {
    writeAddress(cell.link + hub.suffix);
    if (cell.fresh) hash.textContent = copied.textContent = '';
  });

  return panel(
    'share', say('share.title'), true,
    h('div', { class: 'row wrap' }, copy, askHash),
    copied, hash,
    ...exportsOf(hub, png),
    record,
  );
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
