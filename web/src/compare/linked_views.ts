// Two scenes whose cameras look at the same place, whichever of them is turned.

import type { Matrix4 } from 'three';

import type { MapScene } from '../scene/map_scene';
import { movedView } from './alignment';

/** Returns what ends it. */
export function linkViews(later: MapScene, earlier: MapScene, laterFromEarlier: Matrix4): () => void {
  const earlierFromLater = laterFromEarlier.clone().invert();
  let isFollowing = false;
  const follow = (leader: MapScene, follower: MapScene, matrix: Matrix4) => () => {
    if (isFollowing) return; // it is the other's echo
    isFollowing = true;
    follower.view = movedView(leader.view, matrix);
    isFollowing = false;
  };
  const toEarlier = follow(later, earlier, earlierFromLater);
  toEarlier();
  const stops = [later.on('view', toEarlier), earlier.on('view', follow(earlier, later, laterFromEarlier))];
  return () => stops.forEach((stop) => stop());
}
