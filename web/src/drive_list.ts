import type { Drive, Job, Site } from './api';
import { element } from './dom';
import { formatBytes, formatDuration } from './format';
import { mayUpload, seesDrives, type Caller } from './session';
import { sitesWithoutDrives } from './sites';

/** What the service has, newest first, as it lists them. */
export interface Stock {
  drives: Drive[];
  jobs: Job[];
  sites: Site[];
}

/** Shows drives with the progress of their jobs, and sites that have maps and no drives any more, or none that the
 * caller may know of. */
export function renderDrives(
  place: HTMLElement,
  { drives, jobs, sites }: Stock,
  selectedSite: string | null,
  caller: Caller,
  onSelect: (site: string) => void,
): void {
  const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset['drive'] : undefined;
  const entries = drives.map((drive) =>
    renderDrive(drive, newestJobOf(drive, jobs), drive.site === selectedSite, onSelect),
  );
  const isInside = seesDrives(caller);
  const none = mayUpload(caller) ? 'None yet. Add one above, or with curl.' : isInside ? 'None yet.' : '';
  place.replaceChildren(
    element('h2', {}, isInside ? 'Drives' : 'Sites'),
    ...(entries.length > 0 || none === '' ? entries : [element('p', { class: 'hint' }, none)]),
    ...sitesWithoutDrives(drives, sites).map((site) => {
      const hint = isInside ? 'its drives were deleted, its maps stay' : `version ${site.latest_version}`;
      return renderSite(site.name, hint, site.name === selectedSite, onSelect);
    }),
  );
  if (focused) place.querySelector<HTMLElement>(`[data-drive="${CSS.escape(focused)}"]`)?.focus();
}

function renderSite(name: string, hint: string, isSelected: boolean, onSelect: (site: string) => void): HTMLElement {
  return element(
    'button',
    { class: 'drive', type: 'button', 'data-drive': `site ${name}`, 'aria-pressed': String(isSelected), click: () => onSelect(name) },
    element('span', { class: 'name' }, element('span', {}, name)),
    element('p', { class: 'hint' }, hint),
  );
}

export function newestJobOf(drive: Drive, jobs: Job[]): Job | undefined {
  return jobs.find((job) => job.drives.includes(drive.id));
}

function renderDrive(drive: Drive, job: Job | undefined, isSelected: boolean, onSelect: (site: string) => void): HTMLElement {
  const isRunning = job?.state === 'running' || job?.state === 'queued';
  const hint = drive.error ?? (isRunning ? progressText(job) : `${drive.site} · ${formatBytes(drive.bytes)}`);
  return element(
    'button',
    {
      class: 'drive',
      type: 'button',
      'data-drive': drive.id,
      'aria-pressed': String(isSelected),
      click: () => onSelect(drive.site),
    },
    element(
      'span',
      { class: 'name' },
      element('span', {}, drive.name),
      element('span', { class: `state ${drive.state}` }, drive.state),
    ),
    element('p', { class: drive.error ? 'hint error' : 'hint' }, hint),
    isRunning
      ? element('progress', { max: '1', value: String(job.progress), 'aria-label': `Progress of ${drive.name}` })
      : null,
  );
}

function progressText(job: Job): string {
  if (job.state === 'queued') return 'waiting for its turn';
  const eta = job.eta_seconds === null ? '' : `, ${formatDuration(job.eta_seconds)} left`;
  return `${job.stage ?? 'starting'}: ${Math.round(100 * job.progress)} %${eta}`;
}
