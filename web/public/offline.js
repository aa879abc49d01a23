// The page without a network: a service worker that keeps one release of it, whole.
// `cyclosis explore --static` fills in the two constants; a server's page is not kept.

const VERSION = '';
const FILES = [];

const PREFIX = 'cyclosis-';
const NAME = PREFIX + VERSION;

// A release is kept only if all of its files have come.
self.addEventListener('install', (event) => {
  const fresh = FILES.map((file) => new Request(file, { cache: 'reload' }));
  event.waitUntil(caches.open(NAME).then((kept) => kept.addAll(fresh)));
});

self.addEventListener('activate', (event) => {
  const others = (names) => names.filter((name) => name.startsWith(PREFIX) && name !== NAME);
  event.waitUntil(
    caches
      .keys()
      .then((names) => Promise.all(others(names).map((name) => caches.delete(name))))
      .then(() => self.clients.claim()),
  );
});

// Files of one release go together, so they are taken from what is kept, and the network has only what is not.
self.addEventListener('fetch', (event) => {
  if (event.request.method !== 'GET') return;
  const kept = caches.open(NAME).then((cache) => cache.match(event.request, { ignoreSearch: true }));
  event.respondWith(kept.then((found) => found || fetch(event.request)));
});

// A page that opens lets a newer release take over, before it shows anything.
self.addEventListener('message', ({ data }) => {
  if (data === 'take over') self.skipWaiting();
});
