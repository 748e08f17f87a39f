import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vite';

const service = process.env['PARKADE_URL'] ?? 'http://127.0.0.1:8080'; // of `npx vite`

export default defineConfig({
  plugins: [svelte()],
  build: { target: 'es2022', assetsInlineLimit: 0, chunkSizeWarningLimit: 900 },
  // The service refuses changes that another page's script asks for.
  server: {
    proxy: Object.fromEntries(
      ['/api', '/viewer.json', '/basemap.pmtiles'].map((path) => [path, { target: service, changeOrigin: true, headers: { origin: service } }]),
    ),
  },
});
