import type { Hub } from './hub';

/**
 * Pause the cell while nobody sees the page, which spares the battery, and let it go on when the page is seen again.
 * `open` says whether requests are received: after a long time the connection may have to be made again first.
 */
export function restsWhileHidden(hub: Hub, open: () => boolean): void {
  let resting = false;
  const wake = (): void => {
    if (!resting || document.hidden || !open()) return;
    resting = false;
    hub.ask({ do: 'play' });
  };
  document.addEventListener('visibilitychange', () => {
    if (document.hidden && hub.cell?.playing) {
      resting = true;
      hub.ask({ do: 'pause' });
    } else wake();
  });
  hub.on('cell', wake);
}
