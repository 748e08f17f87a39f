// What the page costs, against floors that hold and goals that are aimed at:
//   node e2e/budget.mjs ADDRESS [--site NAME] [--minutes 1] [--slow FACTOR]
// Prints a line for each, and ends with 1 where a floor is missed. --slow stretches the floor of times, for machines
// that do other work meanwhile; bytes, draw calls and memory are what they are.
import { readdir, readFile } from 'node:fs/promises';
import { parseArgs } from 'node:util';

import { openBrowser, openPage, mapShown } from './browser.mjs';

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: { site: { type: 'string' }, minutes: { type: 'string', default: '1' }, slow: { type: 'string', default: '1' } },
});
const address = positionals[0]?.replace(/\/$/, '');
if (!address) throw new Error('usage: node e2e/budget.mjs ADDRESS [--site NAME] [--minutes 1] [--slow FACTOR]');

const { items: sites } = await (await fetch(`${address}/api/v1/sites`)).json();
const area = ({ bounds }) => (bounds ? (bounds.max[0] - bounds.min[0]) * (bounds.max[1] - bounds.min[1]) : 0);
const site = values.site ? sites.find(({ name }) => name === values.site) : [...sites].filter((one) => one.latest_version).sort((a, b) => area(b) - area(a))[0];
if (!site) throw new Error('this service has no such map');

let missed = 0;
function report(what, value, unit, floor, goal) {
  const isMissed = !(value <= floor);
  if (isMissed) missed += 1;
  console.log(`${isMissed ? 'MISS' : value <= goal ? 'goal' : 'ok  '}  ${what}: ${value} ${unit} (floor ${floor}, goal ${goal})`);
}

/** A page whose scripts are counted as they came over the wire. */
async function openCounting(context) {
  const page = await openPage(context, 'about:blank');
  const cdp = await context.newCDPSession(page);
  await cdp.send('Network.enable');
  await cdp.send('Network.setCacheDisabled', { cacheDisabled: true });
  const scripts = new Set();
  const counted = { bytes: 0 };
  cdp.on('Network.responseReceived', ({ requestId, response }) => {
    if (/javascript/.test(response.mimeType)) scripts.add(requestId);
  });
  cdp.on('Network.loadingFinished', ({ requestId, encodedDataLength }) => {
    if (scripts.has(requestId)) counted.bytes += encodedDataLength;
  });
  return { page, cdp, counted };
}

const kilobytes = ({ bytes }) => Math.round(bytes / 1000);

async function checkList(context) {
  const { page, counted } = await openCounting(context);
  await page.goto(`${address}/sites`);
  await page.locator(`main a[href^="/sites/${site.name}"]`).first().waitFor({ timeout: 60_000 });
  report('scripts before the list of sites', kilobytes(counted), 'kB', 120, 60);
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

async function checkMap(context) {
  const { page, cdp, counted } = await openCounting(context);
  const started = Date.now();
  await page.goto(`${address}/sites/${site.name}/maps/latest`, { waitUntil: 'commit' });
  await mapShown(page, `${site.name}/${site.latest_version}`);
  const seconds = (Date.now() - started) / 1000;
  report('scripts before the first picture of a map', kilobytes(counted), 'kB', 500, 300);
  report(`first picture of ${site.name}, cold`, Number(seconds.toFixed(2)), 's', 3 * Number(values.slow), 1);

  const most = { calls: 0, triangles: 0 };
  await fly(page, 60 * Number(values.minutes), async () => {
    const { calls, triangles } = await costOf(page);
    most.calls = Math.max(most.calls, calls);
    most.triangles = Math.max(most.triangles, triangles);
  });
  report('draw calls while flying about', most.calls, 'calls', 150, 60);
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
process.exit(missed === 0 ? 0 : 1);
