// Drives the page in headless Chromium against a service that has maps, as people would:
//   node e2e/run.mjs ADDRESS [NAME ...] [--pictures FOLDER]
// Each file of checks/ holds the checks of one part of the page. A check that needs what this service does not
// have (loops, two versions, several decks) says so and is skipped.
import { readdir } from 'node:fs/promises';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { openBrowser, openPage } from './browser.mjs';

const { values, positionals } = parseArgs({ allowPositionals: true, options: { pictures: { type: 'string' } } });
const [address, ...names] = positionals;
if (!address) throw new Error('usage: node e2e/run.mjs ADDRESS [NAME ...] [--pictures FOLDER]');

const folder = path.join(path.dirname(fileURLToPath(import.meta.url)), 'checks');
const files = (await readdir(folder)).filter((name) => name.endsWith('.mjs')).sort();
const wanted = files.filter((name) => names.length === 0 || names.includes(path.basename(name, '.mjs')));

/** What a check throws where this service has nothing to check. */
class Skip extends Error {}

const world = {
  address: address.replace(/\/$/, ''),
  async json(route) {
    const response = await fetch(this.address + route);
    if (!response.ok) throw new Error(`${route}: ${response.status}`);
    return response.json();
  },
  skip(why) {
    throw new Skip(why);
  },
};
world.sites = (await world.json('/api/v1/sites')).items;
world.drives = (await world.json('/api/v1/drives')).items;
/** The site with most versions: [name, latest version]. */
world.site = [...world.sites].sort((a, b) => b.versions.length - a.versions.length)[0];

const { context, close } = await openBrowser();
let failed = 0;
for (const file of wanted) {
  const { checks } = await import(path.join(folder, file));
  for (const [name, check] of Object.entries(checks)) {
    const started = Date.now();
    const page = await openPage(context, 'about:blank');
    const label = `${path.basename(file, '.mjs')}: ${name}`;
    try {
      await check(page, { ...world, picture: (as) => (values.pictures ? page.screenshot({ path: path.join(values.pictures, `${as}.png`) }) : null) });
      if (page.faults.length > 0) throw new Error(`the page complained: ${page.faults.join(' | ')}`);
      console.log(`ok    ${label} (${Date.now() - started} ms)`);
    } catch (error) {
      if (error instanceof Skip) console.log(`skip  ${label}: ${error.message}`);
      else {
        failed += 1;
        console.log(`FAIL  ${label}: ${error.stack}`);
      }
    }
    await page.close();
  }
}
await close();
console.log(failed === 0 ? 'all checks of the page passed' : `${failed} checks failed`);
process.exit(failed === 0 ? 0 : 1);
