// Where each layer's content comes from. Its code is loaded when it is first shown.

import type { Object3D } from 'three';

import { fileUrl, hasFile } from '../api/map_files';
import type { FreeSpaceProperties, MarkingProperties, SlotProperties, SurfaceProperties } from '../api/map_files';
import { kRamp } from '../scene/ground_look';
import { cssOf, kAccepted, kFreeSpace, kKerb, kMarking, kRejected, kSlotColors, kSurfaceColors } from '../scene/layers/colors';
import { kQuantities, type PathColor } from '../scene/layers/path_colors';
import type { Track } from '../scene/layers/track';
import type { MapScene } from '../scene/map_scene';
import { DriveData } from './drive_data';
import type { LayerName } from './layer_address';
import { ticksOf, type Legend } from './legend';
import type { Workspace } from './workspace.svelte';

export interface LayerContext {
  workspace: Workspace;
  data: DriveData;
  scene: MapScene;
  pathColor: PathColor;
}

export interface LayerContent {
  objects: Object3D[];
  count: number | null; // null: nothing that is counted
  note?: string; // what a reader should know of it
  legend?: Legend;
}

export interface LayerSource {
  name: LayerName;
  title: string;
  about: string;
  swatches: string[]; // CSS colors; none: the colors of drives
  isOfDrives: boolean;
  /** How many there are, by the report; null: not known before it is loaded. */
  count: (workspace: Workspace) => number | null;
  load: (context: LayerContext) => Promise<LayerContent>;
}

const countOf = (value: unknown): number | null => (typeof value === 'number' ? value : null);
const drivesOf = ({ workspace }: LayerContext) => workspace.drives;

async function tracksByName(context: LayerContext): Promise<(name: string) => Track | null> {
  const tracks = new Map<string, Track>();
  await Promise.all(drivesOf(context).map(async (drive) => tracks.set(drive.name, await context.data.track(drive))));
  return (name) => tracks.get(name) ?? null;
}

/** What is drawn of edges, said where some have no place. */
function noteOfEdges({ edges, count }: { edges: unknown[]; count: number }, what: string): { note?: string } {
  if (edges.length === count) return {};
  const of = edges.length === 0 ? 'None' : `Only ${edges.length}`;
  return { note: `${of} of ${count} ${what} can be drawn: this version's report does not say when they were seen. Map the site again to see them.` };
}

/** Maps of before say how far each fix is off, and not where it lies. */
async function ringsOfFixes(context: LayerContext): Promise<LayerContent> {
  const [{ makeFixRings, ringsOf }, rings] = await Promise.all([
    import('../scene/layers/gnss'),
    Promise.all(drivesOf(context).map(async (drive) => [await context.data.track(drive), await context.data.plots(drive)] as const)),
  ]);
  const all = rings.flatMap(([track, plots]) => ringsOf(track, plots));
  const { objects, high } = makeFixRings(all);
  const legend: Legend = { kind: 'ramp', title: 'GNSS error', about: 'of each fix off the way', colors: kRamp, ticks: ticksOf(0, high, 'm') };
  const note = 'This version does not say where its fixes lie: a ring is as wide as each is off. Map the site again to see them.';
  return { objects, count: all.length, ...(all.length > 0 ? { legend, note } : {}) };
}

export const kLayers: readonly LayerSource[] = [
  {
    name: 'ground', title: 'Ground', about: 'the mesh, streamed', swatches: [], isOfDrives: false,
    count: () => null,
    load: async () => ({ objects: [], count: null }), // the scene streams it
  },
  {
    name: 'free', title: 'Free space', about: 'outline of where a car may drive', swatches: [cssOf(kFreeSpace)], isOfDrives: false,
    count: () => null,
    load: async ({ workspace, data }) => {
      const [{ makeFreeSpace }, freeSpace] = await Promise.all([
        import('../scene/layers/free_space'),
        data.collection<FreeSpaceProperties>('free_space.geojson'),
      ]);
      return { objects: makeFreeSpace(freeSpace, workspace.toSite), count: freeSpace.features.length };
    },
  },
  {
    name: 'slots', title: 'Slots', about: 'free, occupied, unseen; click one', swatches: Object.values(kSlotColors).map(cssOf), isOfDrives: false,
    count: ({ report }) => countOf((report.map['slots'] as { count?: number } | undefined)?.count),
    load: async ({ data }) => {
      const [{ makeSlots }, slots] = await Promise.all([
        import('../scene/layers/slots'),
        data.collection<SlotProperties>('slots.geojson'),
      ]);
      return { objects: makeSlots(slots), count: slots.features.length };
    },
  },
  {
    name: 'markings', title: 'Markings', about: 'painted lines and areas', swatches: [cssOf(kMarking)], isOfDrives: false,
    count: ({ report }) => countOf(report.map['num_markings']),
    load: async ({ workspace, data }) => {
      const [{ isPaint, makeMarkings }, markings] = await Promise.all([
        import('../scene/layers/markings'),
        data.collection<MarkingProperties>('markings.geojson'),
      ]);
      return { objects: makeMarkings(markings, workspace.toSite), count: markings.features.filter(isPaint).length };
    },
  },
  {
    name: 'kerbs', title: 'Kerbs and bumps', about: 'as high as they are', swatches: [cssOf(kKerb)], isOfDrives: false,
    count: ({ report }) => (countOf(report.map['num_kerbs']) ?? 0) + (countOf(report.map['num_speed_bumps']) ?? 0),
    load: async ({ workspace, data }) => {
      const [{ isKerb, isSpeedBump, makeKerbs }, markings] = await Promise.all([
        import('../scene/layers/kerbs'),
        data.collection<MarkingProperties>('markings.geojson'),
      ]);
      const count = markings.features.filter((feature) => isKerb(feature) || isSpeedBump(feature)).length;
      return { objects: makeKerbs(markings, workspace.toSite), count };
    },
  },
  {
    name: 'surfaces', title: 'Surfaces', about: 'what lies beside free space', swatches: Object.values(kSurfaceColors).slice(0, 3).map(cssOf), isOfDrives: false,
    count: ({ map }) => (hasFile(map, 'surfaces.geojson') ? null : 0),
    load: async ({ workspace, data }) => {
      const [{ areasOf, makeSurfaces, surfaceColor }, surfaces] = await Promise.all([
        import('../scene/layers/surfaces'),
        data.collection<SurfaceProperties>('surfaces.geojson'),
      ]);
      const entries = areasOf(surfaces).map(([surface, area]) => ({ color: surfaceColor(surface), label: `${surface}, ${Math.round(area)} m²` }));
      const legend: Legend = { kind: 'list', title: 'Surfaces', about: '', entries };
      return {
        objects: makeSurfaces(surfaces, workspace.toSite),
        count: surfaces.features.length,
        ...(entries.length > 0 ? { legend } : {}),
      };
    },
  },
  {
    name: 'ortho', title: 'Orthophoto', about: 'ortho.png, over the highest deck', swatches: [], isOfDrives: false,
    count: ({ map }) => (hasFile(map, 'ortho.png') && hasFile(map, 'ortho.pgw') ? null : 0),
    load: async ({ workspace: { map }, scene }) => {
      const [{ makeOrthophoto }, png, worldFile] = await Promise.all([
        import('../scene/layers/orthophoto'),
        fetch(fileUrl(map, 'ortho.png')).then((answer) => (answer.ok ? answer.blob() : Promise.reject(new Error('the orthophoto could not be loaded')))),
        fetch(fileUrl(map, 'ortho.pgw')).then((answer) => answer.text()),
      ]);
      const height = map.bounds?.max[2] ?? 0;
      const picture = await makeOrthophoto(png, worldFile, (x, y) => scene.groundFromAbove(x, y), height);
      return { objects: [picture], count: null };
    },
  },
  {
    name: 'paths', title: 'Trajectories', about: 'the way of each drive', swatches: [], isOfDrives: true,
    count: ({ drives }) => drives.length,
    load: async (context) => {
      const { data, pathColor } = context;
      const [{ makeTrajectories }, ways] = await Promise.all([
        import('../scene/layers/trajectories'),
        Promise.all(
          drivesOf(context).map(async (drive) => ({
            track: await data.track(drive),
            color: drive.color,
            plots: pathColor === 'drive' ? null : await data.plots(drive),
          })),
        ),
      ]);
      const { objects, high } = makeTrajectories(ways, pathColor);
      const legend: Legend =
        pathColor === 'drive'
          ? { kind: 'list', title: 'Drives', about: '', entries: drivesOf(context).map(({ color, name }) => ({ color, label: name })) }
          : {
              kind: 'ramp', title: `Trajectories: ${kQuantities[pathColor].title}`, about: kQuantities[pathColor].about,
              colors: kRamp, ticks: ticksOf(0, high, kQuantities[pathColor].unit),
            };
      return { objects, count: ways.length, legend };
    },
  },
  {
    name: 'keyframes', title: 'Keyframes', about: 'where pictures were taken from', swatches: [], isOfDrives: true,
    count: ({ report }) => report.drives.reduce((sum, { num_keyframes }) => sum + num_keyframes, 0),
    load: async (context) => {
      const [{ makeKeyframes }, drives] = await Promise.all([
        import('../scene/layers/keyframes'),
        Promise.all(
          drivesOf(context).map(async (drive) => ({ keyframes: await context.data.keyframes(drive), color: drive.color })),
        ),
      ]);
      const count = drives.reduce((sum, { keyframes }) => sum + keyframes.count, 0);
      const shown = drives.reduce((sum, { keyframes }) => sum + keyframes.keyframes.length, 0);
      return { objects: makeKeyframes(drives), count, ...(shown < count ? { note: `Every ${Math.round(count / shown)}th is drawn.` } : {}) };
    },
  },
  {
    name: 'loops', title: 'Loop edges', about: 'solid: accepted, broken: not', swatches: [cssOf(kAccepted)], isOfDrives: true,
    count: ({ report }) => report.drives.reduce((sum, { loops }) => sum + (loops?.candidates.length ?? 0), 0),
    load: async (context) => {
      const { loopsOf, makeEdges } = await import('../scene/layers/links');
      const found = loopsOf(context.workspace.report, await tracksByName(context));
      return { objects: makeEdges(found.edges), count: found.count, ...noteOfEdges(found, 'loops') };
    },
  },
  {
    name: 'links', title: 'Drive links', about: 'same places in two drives; solid: accepted, broken: not', swatches: [cssOf(kAccepted)], isOfDrives: true,
    count: ({ report }) => ((report.join?.pairs ?? []) as { links: unknown[] }[]).reduce((sum, { links }) => sum + links.length, 0),
    load: async (context) => {
      const { linksOf, makeEdges } = await import('../scene/layers/links');
      const found = linksOf(context.workspace.report, await tracksByName(context));
      return { objects: makeEdges(found.edges), count: found.count, ...noteOfEdges(found, 'links') };
    },
  },
  {
    name: 'gnss', title: 'GNSS fixes', about: 'where they lie; a disc: used, a cross: not', swatches: [kAccepted, kRejected].map(cssOf), isOfDrives: true,
    count: ({ report }) => report.drives.reduce((sum, { gnss }) => sum + (countOf((gnss as { num_fixes?: number } | null | undefined)?.num_fixes) ?? 0), 0),
    load: async (context) => {
      const files = await Promise.all(drivesOf(context).map(async (drive) => [drive.name, await context.data.fixes(drive)] as const));
      if (files.every(([, file]) => file === null)) return ringsOfFixes(context);
      const { fixesOf, kFixStates, makeFixes } = await import('../scene/layers/fixes');
      const fixes = files.flatMap(([name, file]) => (file ? fixesOf(name, file) : []));
      const entries = Object.entries(kFixStates)
        .map(([state, { color, label }]) => ({ color, label, count: fixes.filter((fix) => fix.state === state).length }))
        .filter(({ count }) => count > 0)
        .map(({ color, label, count }) => ({ color, label: `${label}, ${count}` }));
      const legend: Legend = { kind: 'list', title: 'GNSS fixes', about: 'discs placed their drive, crosses did not', entries };
      return { objects: makeFixes(fixes), count: fixes.length, ...(entries.length > 0 ? { legend } : {}) };
    },
  },
];

/** Colors of drives as stripes of a swatch. */
export const driveSwatches = (workspace: Workspace) => workspace.drives.slice(0, 4).map(({ color }) => cssOf(color));
