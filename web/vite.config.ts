import { defineConfig, type Plugin } from 'vite';

/** The larger part of the page is fetched from the beginning, but after what the first picture needs. */
const ahead: Plugin = {
  name: 'ahead',
  transformIndexHtml: {
    order: 'post',
    handler: (_html, { bundle = {} }) =>
      Object.values(bundle)
        .filter((part) => part.type === 'chunk' && part.isDynamicEntry)
        .map(({ fileName }) => ({ tag: 'link', attrs: { rel: 'modulepreload', fetchpriority: 'low', href: `./${fileName}` }, injectTo: 'head' as const })),
  },
};

// Addresses in the page are relative, so that it works under any path.
export default defineConfig({
  base: './',
  plugins: [ahead],
  build: { outDir: '../src/cyclosis/explorer/page', emptyOutDir: true, chunkSizeWarningLimit: 900 },
  server: { proxy: { '/api': 'http://127.0.0.1:8765', '/cell': { target: 'ws://127.0.0.1:8765', ws: true } } },
});
