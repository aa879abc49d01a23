import { defineConfig } from 'vite';

// Addresses in the page are relative, so that it works under any path.
export default defineConfig({
  base: './',
  build: { outDir: '../src/cyclosis/explorer/page', emptyOutDir: true, chunkSizeWarningLimit: 900 },
  server: { proxy: { '/api': 'http://127.0.0.1:8765', '/cell': { target: 'ws://127.0.0.1:8765', ws: true } } },
});
