import { readFileSync } from 'node:fs';
import { defineConfig, type Plugin } from 'vite';

// The Draco decoder is fetched at run time by three's DRACOLoader: it is served
// from our own folder, never from a CDN.
function dracoDecoder(): Plugin {
  const folder = new URL('./node_modules/three/examples/jsm/libs/draco/gltf/', import.meta.url);
  return {
    name: 'draco-decoder',
    apply: 'build',
    generateBundle() {
      for (const name of ['draco_decoder.wasm', 'draco_wasm_wrapper.js'])
        this.emitFile({ type: 'asset', fileName: `draco/${name}`, source: readFileSync(new URL(name, folder)) });
    },
  };
}

export default defineConfig({
  plugins: [dracoDecoder()],
  build: { target: 'es2022', assetsInlineLimit: 0, chunkSizeWarningLimit: 900 },
  server: { proxy: { '/api': 'http://127.0.0.1:8080' } },
});
