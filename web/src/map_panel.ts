import { fileUrl, type MapVersion, type Report } from './api';
import { element } from './dom';
import { formatArea, formatBytes, formatDuration, formatMeters } from './format';

/** Figures and downloads of one map version. */
export function renderMapPanel(place: HTMLElement, map: MapVersion, report: Report): void {
  const length = report.drives.reduce((sum, drive) => sum + drive.length, 0);
  const duration = report.drives.reduce((sum, drive) => sum + drive.duration, 0);
  const computing = report.stages.reduce((sum, stage) => sum + stage.seconds, 0);
  const figures: [string, string][] = [
    ['driven', formatMeters(length)],
    ['recorded', formatDuration(duration)],
    ['ground', formatArea(report.map.ground_area)],
    ['triangles', report.map.num_triangles.toLocaleString('en')],
    ['mapped in', formatDuration(computing)],
  ];
  place.replaceChildren(
    element('h2', {}, `${map.site}, version ${map.version}`),
    element(
      'dl',
      { class: 'figures' },
      ...figures.map(([name, value]) => element('div', {}, element('dt', {}, name), element('dd', {}, value))),
    ),
    ...report.warnings.map((warning) => element('p', { class: 'hint error' }, warning)),
    downloads(map, map.files.filter((file) => isMainFile(file.name))),
    element(
      'details',
      {},
      element('summary', {}, 'More files'),
      downloads(map, map.files.filter((file) => !isMainFile(file.name))),
    ),
  );
  place.hidden = false;
}

/** What most people came for; the rest is one click further. */
function isMainFile(name: string): boolean {
  return ['map.glb', 'ground.ply', 'ortho.png'].includes(name) || name.endsWith('/trajectory.tum');
}

function downloads(map: MapVersion, files: MapVersion['files']): HTMLElement {
  const link = (file: MapVersion['files'][number]) =>
    element(
      'a',
      { href: fileUrl(map, file.name), download: file.name.replaceAll('/', '_') },
      file.name,
      element('small', {}, formatBytes(file.bytes)),
    );
  return element('div', { class: 'downloads', role: 'group', 'aria-label': 'Downloads' }, ...files.map(link));
}
