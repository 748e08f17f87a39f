// Drives the page in headless Chromium against a service that has maps, as people would:
//   node e2e/run.mjs ADDRESS [NAME ...] [--pictures FOLDER] [--retries N]
// A check that passes only when tried again is said to be flaky: on a slow machine a page may miss its time.
// Each file of checks/ holds the checks of one part of the page. A check that needs what this service does not
// have (loops, two versions, several decks) says so and is skipped.
import { readdir } from 'node:fs/promises';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

import { openBrowser, openPage } from './browser.mjs';

const { values, positionals } = parseArgs({ allowPositionals: true, options: { pictures: { type: 'string' }, retries: { type: 'string', default: '0' } } });
const [address, ...names] = positionals;
if (!address) throw new Error('usage: node e2e/run.mjs ADDRESS [NAME ...] [--pictures FOLDER] [--retries N]');

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
const picture = (page) => (as) => (values.pictures ? page.screenshot({ path: path.join(values.pictures, `${as}.png`) }) : null);

/** Runs a check on a page of its own: "ok", "skip", or "FAIL" with what there is to say. */
async function run(check) {
  let page = null;
  try {
    page = await openPage(context, 'about:blank');
    await check(page, { ...world, picture: picture(page) });
    if (page.faults.length > 0) throw new Error(`the page complained: ${page.faults.join(' | ')}`);
    return { state: 'ok' };
  } catch (error) {
    return error instanceof Skip ? { state: 'skip', said: error.message } : { state: 'FAIL', said: error.stack };
  } finally {
    await page?.close();
  }
}

let failed = 0;
for (const file of wanted) {
  const { checks } = await import(path.join(folder, file));
  for (const [name, check] of Object.entries(checks)) {
    for (let left = Number(values.retries); ; left -= 1) {
      const started = Date.now();
      const { state, said } = await run(check);
      const label = `${path.basename(file, '.mjs')}: ${name} (${Date.now() - started} ms)`;
      console.log(`${(state === 'FAIL' && left > 0 ? 'flaky' : state).padEnd(5)} ${label}${said ? `: ${said}` : ''}`);
      if (state === 'FAIL' && left > 0) continue;
      if (state === 'FAIL') failed += 1;
      break;
    }
  }
}
await close();
console.log(failed === 0 ? 'all checks of the page passed' : `${failed} checks failed`);
process.exit(failed === 0 ? 0 : 1);
