// The colors of the ground that a reader chose, and their legend.

import { fileUrl, hasFile } from '../api/map_files';
import { kPalette, kRamp, type GroundColors } from '../scene/ground_look';
import { niceEnd } from '../scene/layers/path_colors';
import { floorOf, type Deck } from '../scene/decks';
import type { DriveData } from './drive_data';
import type { GroundColor } from './layer_address';
import { ticksOf, type Legend } from './legend';
import type { Workspace } from './workspace.svelte';

export interface Coloring {
  colors: GroundColors;
  legend: Legend | null;
}

export const kGroundColorTitles: Record<GroundColor, string> = {
  picture: 'Picture', height: 'Height', slope: 'Slope', sigma: 'Sigma of height', session: 'Last drive', age: 'Age',
};

const kSteepest = 0.16; // of the legend: ramps of garages are rarely steeper

/** Height has one ramp for the site, or for the deck that is chosen. */
function byHeight({ map }: Workspace, deck: Deck | null): Coloring {
  const { low, high } = deck ? floorOf(deck) : { low: map.bounds?.min[2] ?? 0, high: map.bounds?.max[2] ?? 1 };
  const about = deck ? `of level ${deck.level}; its ramps lie beyond` : "above the site's origin";
  return {
    colors: { by: 'height', low, high },
    legend: { kind: 'ramp', title: 'Height', about, colors: kRamp, ticks: ticksOf(low, high, 'm') },
  };
}

async function bySigma({ map }: Workspace): Promise<Coloring> {
  if (!hasFile(map, 'ground.ply')) throw new Error('this version has no ground.ply, which says how sure heights are');
  const [{ sigmaOf }, answer] = await Promise.all([import('../scene/layers/ground_values'), fetch(fileUrl(map, 'ground.ply'))]);
  if (!answer.ok) throw new Error('ground.ply could not be loaded: try again');
  const { valueAt, sigmas } = sigmaOf(await answer.arrayBuffer());
  const high = niceEnd(Array.from(sigmas));
  return {
    colors: { by: 'value', low: 0, high, colors: kRamp, valueAt },
    legend: { kind: 'ramp', title: 'Sigma of height', about: 'how sure the ground is', colors: kRamp, ticks: ticksOf(0, 1000 * high, 'mm') },
  };
}

async function bySession(workspace: Workspace, data: DriveData): Promise<Coloring> {
  const [{ lastPassOf }, tracks] = await Promise.all([
    import('../scene/layers/ground_values'),
    Promise.all(workspace.drives.map((drive) => data.track(drive))),
  ]);
  return {
    colors: { by: 'value', low: 0, high: 1, colors: kPalette, isPalette: true, valueAt: lastPassOf(tracks) },
    legend: {
      kind: 'list', title: 'Last drive', about: 'that passed within 12 m',
      entries: workspace.drives.map(({ color, name }) => ({ color, label: name })),
    },
  };
}

async function byAge(workspace: Workspace, data: DriveData): Promise<Coloring> {
  const [{ agesOf, lastPassOf }, tracks] = await Promise.all([
    import('../scene/layers/ground_values'),
    Promise.all(workspace.drives.map((drive) => data.track(drive))),
  ]);
  const { ages, until } = agesOf(tracks, workspace.map.created_at);
  const last = lastPassOf(tracks);
  const [low, most] = [Math.floor(Math.min(...ages)), Math.ceil(Math.max(...ages))];
  const high = Math.max(most, low + 1);
  const date = new Date(1000 * until).toISOString().slice(0, 10);
  return {
    colors: { by: 'value', low, high, colors: kRamp, valueAt: (x, y, z) => ages[last(x, y, z)] ?? NaN },
    legend: { kind: 'ramp', title: 'Age', about: `days from the last drive there to ${date}`, colors: kRamp, ticks: ticksOf(low, high, 'd') },
  };
}

export async function coloringOf(color: GroundColor, workspace: Workspace, data: DriveData, deck: Deck | null): Promise<Coloring> {
  switch (color) {
    case 'height':
      return byHeight(workspace, deck);
    case 'slope':
      return {
        colors: { by: 'slope', high: kSteepest },
        legend: { kind: 'ramp', title: 'Slope', about: 'rise per run', colors: kRamp, ticks: ticksOf(0, 100 * kSteepest, '%') },
      };
    case 'sigma':
      return bySigma(workspace);
    case 'session':
      return bySession(workspace, data);
    case 'age':
      return byAge(workspace, data);
    case 'picture':
      return { colors: { by: 'picture' }, legend: null };
  }
}
