import { ownEngine } from './engine/socket';

/** Milliseconds for which opening waits for a release that is to take over. */
const PATIENCE = 3000;

/**
 * Keep a page without a server for times without a network. A newer release, fetched while the last visit lasted,
 * takes over before the page shows anything: then the page loads again, and this never returns.
 */
export async function keepOffline(): Promise<void> {
  if (!ownEngine() || !('serviceWorker' in navigator)) return;
  const { serviceWorker } = navigator;
  try {
    const { waiting } = (await serviceWorker.getRegistration('./')) ?? {};
    if (waiting && serviceWorker.controller) {
      const taken = new Promise<boolean>((done) => {
        serviceWorker.addEventListener('controllerchange', () => done(true), { once: true });
        setTimeout(() => done(false), PATIENCE);
      });
      waiting.postMessage('take over');
      if (await taken) {
        location.reload();
        await new Promise(() => undefined);
      }
    }
    // The first picture comes before the files that are to be kept.
    setTimeout(() => void serviceWorker.register('offline.js', { scope: './' }).catch(() => undefined), 2000);
  } catch {
    // A browser that keeps nothing still shows the page.
  }
}
