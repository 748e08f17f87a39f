// What the page costs, against floors that hold and goals that are aimed at:
//   node e2e/budget.mjs ADDRESS [--site NAME] [--hectares 100] [--minutes 1] [--runs 1] [--slow FACTOR]
// Prints a line for each, and ends with 1 where a floor is missed. --slow stretches the floor of times, for machines
// that do other work meanwhile; bytes, draw calls and memory are what they are. --hectares makes the site that large of copies
// of its map (big_site.mjs). Of several --runs, each in a browser of its own, the middle one counts.
import { readdir, readFile } from 'node:fs/promises';
import { loadavg } from 'node:os';
import { parseArgs } from 'node:util';

import { largestSite, serveBigSite } from './big_site.mjs';
import { openBrowser, openPage } from './browser.mjs';

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    site: { type: 'string' },
    hectares: { type: 'string' },
    minutes: { type: 'string', default: '1' },
    runs: { type: 'string', default: '1' },
    slow: { type: 'string', default: '1' },
  },
});
const service = positionals[0]?.replace(/\/$/, '');
if (!service) throw new Error('usage: node e2e/budget.mjs ADDRESS [--site NAME] [--hectares 100] [--minutes 1] [--runs 1] [--slow FACTOR]');

const big = values.hectares ? await serveBigSite(service, { hectares: Number(values.hectares), site: values.site }) : null;
const address = big?.address ?? service;
const site = big?.site ?? (await largestSite(service, values.site));
const what = big ? `${values.hectares} hectares of ${site.name}` : site.name;

let missed = 0;
function report(what, value, unit, floor, goal) {
  const isMissed = !(value <= floor);
  if (isMissed) missed += 1;
  console.log(`${isMissed ? 'MISS' : value <= goal ? 'goal' : 'ok  '}  ${what}: ${value} ${unit} (floor ${floor}, goal ${goal})`);
}

/** Goes to an address as somebody does who was never there. Tells when a part of the page was in it, and what scripts had come until then. */
async function arrive(context, path, part) {
  const page = await openPage(context, 'about:blank');
  const cdp = await context.newCDPSession(page);
  await cdp.send('Network.enable');
  await cdp.send('Network.setCacheDisabled', { cacheDisabled: true });
  await page.addInitScript((part) => {
    new MutationObserver((_, observer) => {
      if (!document.querySelector(part)) return;
      performance.mark('there');
      observer.disconnect();
    }).observe(document, { attributes: true, childList: true, subtree: true });
  }, part);
  await page.goto(address + path, { waitUntil: 'commit' });
  await page.waitForFunction(() => performance.getEntriesByName('there').length > 0, null, { timeout: 60_000 });
  const { time, bytes } = await page.evaluate(() => {
    const [{ startTime: time }] = performance.getEntriesByName('there');
    const scripts = performance.getEntriesByType('resource').filter(({ name, responseEnd }) => name.endsWith('.js') && responseEnd <= time);
    return { time, bytes: scripts.reduce((sum, { transferSize }) => sum + transferSize, 0) };
  });
  return { page, cdp, seconds: time / 1000, kilobytes: Math.round(bytes / 1000) };
}

const openList = (context) => arrive(context, '/sites', `main a[href^="/sites/${site.name}"]`);
/** The page says that a map is shown when the frame after the one begins that the ground is in. */
const openMap = (context) => arrive(context, `/sites/${site.name}/maps/latest`, `body[data-shown="${site.name}/${site.latest_version}"]`);

async function checkList(context) {
  const { page, kilobytes } = await openList(context);
  report('scripts before the list of sites', kilobytes, 'kB', 120, 60);
  await page.close();
}

/** The last picture's cost, as the scene tells it. */
const costOf = (page) =>
  page.evaluate(() => {
    const detail = {};
    document.getElementById('canvas').dispatchEvent(new CustomEvent('cost', { detail }));
    return detail;
  });

async function fly(page, seconds, onStep) {
  const { x, y, width, height } = await page.locator('#canvas').boundingBox();
  const at = (right, down) => [x + right * width, y + down * height];
  const end = Date.now() + 1000 * seconds;
  for (let step = 0; Date.now() < end; step++) {
    const isOrbit = step % 2 === 0; // the right button turns, the left moves
    await page.mouse.move(...at(0.5, 0.5));
    await page.mouse.down({ button: isOrbit ? 'right' : 'left' });
    for (let i = 1; i <= 8; i++) {
      await page.mouse.move(...at(0.5 + 0.04 * i * Math.cos(step), 0.5 + 0.03 * i * Math.sin(step)));
      await onStep();
    }
    await page.mouse.up({ button: isOrbit ? 'right' : 'left' });
    await page.mouse.wheel(0, step % 6 < 3 ? -240 : 240);
    await onStep();
  }
}

/** [MB] of the largest of the browser's pages, with what it holds outside of the script's heap: Linux tells. */
async function memoryOfPages() {
  const parents = new Map();
  for (const pid of (await readdir('/proc')).filter((name) => /^\d+$/.test(name))) {
    const stat = await readFile(`/proc/${pid}/stat`, 'utf8').catch(() => '');
    parents.set(pid, stat.slice(stat.lastIndexOf(')')).split(' ')[2]);
  }
  const isMine = (pid) => pid === String(process.pid) || (parents.has(pid) && isMine(parents.get(pid)));
  let most = 0;
  for (const pid of [...parents.keys()].filter(isMine)) {
    const command = await readFile(`/proc/${pid}/cmdline`, 'utf8').catch(() => '');
    if (!command.includes('--type=renderer')) continue;
    const memory = await readFile(`/proc/${pid}/smaps_rollup`, 'utf8').catch(() => '');
    most = Math.max(most, Number(/^Pss:\s+(\d+)/m.exec(memory)?.[1] ?? 0) / 1000);
  }
  return Math.round(most);
}

/** A browser remembers what its graphics driver compiled: each run has a new one, that has shown the list of sites. */
async function timeFurtherRuns() {
  const times = [];
  while (times.length < Number(values.runs) - 1) {
    const { context, close } = await openBrowser();
    await (await openList(context)).page.close();
    times.push((await openMap(context)).seconds);
    await close();
  }
  return times;
}

async function checkMap(context) {
  const { page, cdp, seconds, kilobytes } = await openMap(context);
  report('scripts before the first picture of a map', kilobytes, 'kB', 500, 300);
  const times = [seconds, ...(await timeFurtherRuns())].sort((a, b) => a - b);
  report(`first picture of ${what}, cold`, Number(times[times.length >> 1].toFixed(2)), 's', 3 * Number(values.slow), 1);
  if (times.length > 1) console.log(`      of ${times.map((time) => time.toFixed(2)).join(', ')} s, at a load of ${loadavg()[0].toFixed(1)}`);

  const most = { calls: 0, triangles: 0 };
  await fly(page, 60 * Number(values.minutes), async () => {
    const { calls, triangles } = await costOf(page);
    most.calls = Math.max(most.calls, calls);
    most.triangles = Math.max(most.triangles, triangles);
  });
  // The floor is for two hectares; from above a larger site more tiles are in view.
  const isLarge = Number(values.hectares ?? 0) > 2;
  report('draw calls while flying about', most.calls, 'calls', isLarge ? Infinity : 150, 60);
  report('triangles while flying about', Number((most.triangles / 1e6).toFixed(3)), 'million', 1.5, 0.8);

  await page.waitForTimeout(1000);
  const before = (await costOf(page)).frame;
  await page.waitForTimeout(2000);
  report('pictures drawn in 2 s of rest', (await costOf(page)).frame - before, 'pictures', 2, 0);

  await cdp.send('HeapProfiler.collectGarbage');
  report('memory of the page afterwards', await memoryOfPages(), 'MB', 1000, 500);
  const { geometries, textures } = await costOf(page);
  console.log(`      ${geometries} geometries and ${textures} textures on the graphics card`);
  if (page.faults.length > 0) {
    missed += 1;
    console.log(`MISS  the page complained: ${page.faults.join(' | ')}`);
  }
  await page.close();
}

const { context, close } = await openBrowser();
await checkList(context);
await checkMap(context);
await close();
big?.close();
process.exit(missed === 0 ? 0 : 1);
