"""Reads what parkade-outline-rasters wrote, cuts squares out of it and changes them; compares outlines with the truth."""
import json
from pathlib import Path

import cv2
import numpy as np

from outline_network import COLORS, FREE, LOG_ODDS, OCCUPIED, SEEN

NOT_DRIVABLE, DRIVABLE, UNSEEN, FAR = range(4)  # of the truth; UNSEEN: drivable, but no camera saw it


def load_raster(name):
    """-> channels x H x W (float32), H x W (uint8)."""
    shape = json.loads(name.read_text())
    size = shape["rows"], shape["columns"]
    features = np.fromfile(name.with_suffix(".features"), np.float32).reshape(shape["channels"], *size)
    return features, np.fromfile(name.with_suffix(".truth"), np.uint8).reshape(size)


def load_rasters(folder):
    """-> list of (name, features, truth)."""
    return [(name.stem, *load_raster(name)) for name in sorted(Path(folder).glob("*.json"))]


def cut_square(rng, features, truth, side):
    """A square with an outline in it, where there is one; beyond the raster nothing was seen."""
    height, width = truth.shape
    for _ in range(20):
        top, left = rng.integers(-side // 2, height - side // 2), rng.integers(-side // 2, width - side // 2)
        rows, columns = slice(max(0, top), min(height, top + side)), slice(max(0, left), min(width, left + side))
        inside = truth[rows, columns]
        if (inside <= DRIVABLE).sum() > 0.25 * side * side and (inside == NOT_DRIVABLE).any():
            break
    cut = np.zeros((len(features), side, side), np.float32)
    label = np.full((side, side), FAR, np.uint8)
    into = (slice(rows.start - top, rows.stop - top), slice(columns.start - left, columns.stop - left))
    cut[(slice(None), *into)] = features[:, rows, columns]
    label[into] = inside
    return cut, label


def augment(rng, features, truth):
    """Turns, mirrors, changes colours and light, and how sure the first network was."""
    turns = rng.integers(4)
    features, truth = np.rot90(features, turns, (1, 2)), np.rot90(truth, turns)
    if rng.random() < 0.5:
        features, truth = features[:, :, ::-1], truth[:, ::-1]
    features, truth = features.copy(), np.ascontiguousarray(truth)
    seen = features[SEEN : SEEN + 1]
    features[COLORS] = change_colors(rng, features[COLORS] + 0.5 * seen, seen) - 0.5 * seen
    if rng.random() < 0.5:
        certainty = np.exp(rng.normal(0, 0.25))
        features[LOG_ODDS] = np.clip(features[LOG_ODDS] * certainty, -1, 1)
        for channel in (FREE, OCCUPIED):  # roots
            features[channel] = np.clip(features[channel] * np.sqrt(certainty), 0, 1)
    return features, truth


def change_colors(rng, colors, seen):
    """0..1 times `seen`."""
    kind = rng.random()
    if kind < 0.1:
        return np.broadcast_to(0.5 * seen, colors.shape)  # colours say nothing
    gain = np.exp(rng.normal(0, 0.35) + rng.normal(0, 0.12, (3, 1, 1)))
    colors = np.clip(colors * gain + rng.normal(0, 0.06) * seen, 0, seen)
    if kind < 0.3:
        colors = np.broadcast_to(colors.mean(0, keepdims=True), colors.shape)
    elif kind < 0.5:
        colors = colors[rng.permutation(3)]
    return colors


def weights_of(features, truth, reach=15, most=4.0):
    """H x W, float32: 0 where nothing is known or was seen, more near what is not drivable."""
    near = cv2.distanceTransform((truth != NOT_DRIVABLE).astype(np.uint8), cv2.DIST_L2, 3) < reach
    known = (truth <= DRIVABLE) & (features[SEEN] > 0)
    return np.where(known, np.where(near, most, 1), 0).astype(np.float32)


def compare(features, truth, log_odds, width=15):
    """IoU, share of the ground that is missed, share of the found that is false, boundary IoU over `width` pixels
    (about as `parkade evaluate --ground` has them)."""
    found, drivable, counts = (log_odds > 0) & (features[SEEN] > 0), truth == DRIVABLE, truth <= DRIVABLE
    both = (found & drivable).sum()

    def depth(area):
        return cv2.distanceTransform(area.astype(np.uint8), cv2.DIST_L2, 5)

    is_clear = depth(truth <= DRIVABLE) > width
    rim_of_truth = drivable & (depth((truth == DRIVABLE) | (truth == UNSEEN)) <= width) & is_clear
    rim_found = found & counts & (depth(found) <= width) & is_clear
    return {
        "iou": both / max(1, ((found | drivable) & counts).sum()),
        "missed": 1 - both / max(1, drivable.sum()),
        "false": (found & (truth == NOT_DRIVABLE)).sum() / max(1, (found & counts).sum()),
        "boundary": (rim_found & rim_of_truth).sum() / max(1, (rim_found | rim_of_truth).sum()),
    }
