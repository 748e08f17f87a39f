import './style.css';

import { fileUrl, latestMap, listDrives, listJobs, listSites, report, slots, surfaces, watchEvents, type Job } from './api';
import { byId } from './dom';
import { renderDrives } from './drive_list';
import { renderMapPanel } from './map_panel';
import { MapView } from './map_view';
import { PinPanel } from './pin_panel';
import { siteFromGeoJson } from './geo';
import { mayReview, mayUpload, seesDrives, type Caller } from './session';
import { awaitCaller, showCaller } from './sign_in';
import { firstSite, hasMap } from './sites';
import { countStates, renderSlotLegend } from './slot_layer';
import { createToolbar } from './toolbar';
import { createUpload } from './upload';

const message = byId('message');
const panel = byId('map-panel');
const toolbar = byId('toolbar');
const view = new MapView(byId<HTMLCanvasElement>('canvas'));
const pins = new PinPanel(byId('pin-panel'), view, () => void requestRefresh());
let caller: Caller | null = null; // nobody yet
const siteInUrl = new URLSearchParams(location.search).get('site');

let selectedSite: string | null = siteInUrl;
let shownMap = ''; // "site/version", or the address of a preview, on the canvas

function say(text: string): void {
  message.textContent = text;
}

async function showSite(site: string): Promise<void> {
  selectedSite = site;
  history.replaceState(null, '', `?site=${encodeURIComponent(site)}`);
  await refresh();
}

async function showLatestMap(site: string): Promise<void> {
  const map = await latestMap(site);
  const name = `${map.site}/${map.version}`;
  if (name === shownMap) return;
  shownMap = name;
  say('Loading the map …');
  try {
    const [isLatest, figures, parking, land] = await Promise.all([
      view.load(fileUrl(map, 'map.glb')),
      report(map),
      slots(map),
      surfaces(map),
    ]);
    if (!isLatest) return;
    view.setSlots(parking);
    view.setSurfaces(land, siteFromGeoJson(map.datum));
    renderMapPanel(panel, map, figures);
    renderSlotLegend(byId('legend'), countStates(parking));
    byId('badge').hidden = true;
    view.setCoveredHeight(panel.offsetHeight + 16);
    view.lookAround();
    pins.show(map, figures);
    setPinning(true);
    toolbar.querySelector<HTMLButtonElement>('[data-surfaces]')!.hidden = land.features.length === 0;
    toolbar.hidden = false;
    say('');
    document.body.dataset['shown'] = name; // for tests and scripts that wait for the picture
  } catch (error) {
    shownMap = '';
    throw error;
  }
}

function setPinning(isPossible: boolean): void {
  const toggle = toolbar.querySelector<HTMLButtonElement>('[data-pins]');
  if (!toggle) return;
  if (!isPossible && toggle.getAttribute('aria-pressed') === 'true') toggle.click();
  toggle.disabled = !isPossible || !caller || !mayReview(caller); // pins make a new version
}

/** What the next version will look like, while it is made. False where it is gone already. */
async function showPreview({ preview }: Job): Promise<boolean> {
  if (!preview) return false;
  if (shownMap === preview) return true;
  const isReplaced = shownMap.split('?')[0] === preview.split('?')[0];
  const isAnotherSite = !isReplaced && !shownMap.startsWith(`${selectedSite}/`);
  try {
    if (!(await view.load(preview))) return true;
  } catch {
    return false; // the map is there
  }
  shownMap = preview;
  setPinning(false); // its points are those of no version
  if (isAnotherSite) view.lookAround();
  byId('legend').hidden = true;
  byId('badge').hidden = false;
  toolbar.hidden = false;
  document.body.dataset['shown'] = preview;
  return true;
}

async function refresh(): Promise<void> {
  if (!caller) return;
  try {
    const isInside = seesDrives(caller);
    const [drives, jobs, sites] = await Promise.all([
      isInside ? listDrives() : [],
      isInside ? listJobs() : [],
      listSites(),
    ]);
    selectedSite ??= firstSite(drives, sites);
    renderDrives(byId('drives'), { drives, jobs, sites }, selectedSite, caller, (site) => void showSite(site));
    const inWork = jobs.find((job) => job.site === selectedSite && job.state === 'running' && job.preview);
    if (inWork && (await showPreview(inWork))) return;
    if (selectedSite && hasMap(selectedSite, sites)) {
      await showLatestMap(selectedSite);
    } else if (shownMap.split('/')[0] !== selectedSite) {
      clearMap(selectedSite ? `${selectedSite} has no map yet` : mayUpload(caller) ? 'Add a drive to see its map' : 'There is no map yet');
    }
  } catch (error) {
    say(error instanceof Error ? error.message : String(error));
  }
}

function clearMap(why: string): void {
  view.clear();
  shownMap = '';
  panel.hidden = true;
  toolbar.hidden = true;
  byId('legend').hidden = true;
  byId('badge').hidden = true;
  say(why);
}

// Events come in bursts; one refresh at a time, and one more when any came meanwhile.
let isRefreshing = false;
let isRefreshWanted = false;
async function requestRefresh(): Promise<void> {
  isRefreshWanted = true;
  if (isRefreshing) return;
  isRefreshing = true;
  while (isRefreshWanted) {
    isRefreshWanted = false;
    await refresh();
  }
  isRefreshing = false;
}

async function start(): Promise<void> {
  caller = await awaitCaller(byId('stage'));
  if (caller.name !== 'local') showCaller(byId('caller'), caller);
  createToolbar(toolbar, view, byId('legend'), pins);
  if (mayUpload(caller)) createUpload(byId('upload'), () => void requestRefresh());
  if (seesDrives(caller)) watchEvents(() => void requestRefresh());
  await requestRefresh();
}

start().catch((error: unknown) => say(error instanceof Error ? error.message : String(error)));
