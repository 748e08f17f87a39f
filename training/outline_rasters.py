"""Reads what parkade-outline-rasters wrote, cuts squares out of it and changes them; compares outlines with the truth."""
import json
from pathlib import Path

import cv2
import numpy as np

from outline_network import (CERTAINTY, COLORS, FREE, LOG_ODDS, LOG_ODDS_UNIT, MEASURED, OCCUPIED, RAISED, SEEN)

NOT_DRIVABLE, DRIVABLE, UNSEEN, FAR = range(4)  # of the truth; UNSEEN: drivable, but no camera saw it


def load_raster(name):
    """-> channels x H x W (float32), H x W (uint8)."""
    shape = json.loads(name.with_suffix(".json").read_text())
    size = shape["rows"], shape["columns"]
    features = np.fromfile(name.with_suffix(".features"), np.float32).reshape(shape["channels"], *size)
    return features, np.fromfile(name.with_suffix(".truth"), np.uint8).reshape(size)


def load_rasters(folder, known=()):
    """-> list of (name, features, truth), but for those whose (folder, name) is known. The truth is written last."""
    names = [name for name in sorted(Path(folder).glob("*.truth")) if (folder, name.stem) not in known]
    return [(name.stem, *load_raster(name)) for name in names]


def cut_square(rng, features, truth, side, share_turned=0.6):
    """A square with an outline in it, where there is one; beyond the raster nothing was seen. A share of the squares lies
    askew and is larger or smaller than others: simulated places have right angles, and a map lies as its drive began."""
    for _ in range(20):
        middle = rng.uniform((0, 0), truth.shape[::-1])
        angle, scale = 0.0, 1.0
        if rng.random() < share_turned:
            angle, scale = rng.uniform(0, 2 * np.pi), np.exp(rng.normal(0, 0.05))
        else:
            middle = np.floor(middle)
        turn = scale * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        raster_from_square = np.column_stack([turn, middle - turn @ np.full(2, side // 2)])
        label = warp(truth, raster_from_square, side, cv2.INTER_NEAREST, FAR)
        if (label <= DRIVABLE).sum() > 0.25 * side * side and (label == NOT_DRIVABLE).any():
            break
    cut = [warp(channel, raster_from_square, side, cv2.INTER_LINEAR, 0) for channel in features]
    return np.stack(cut), label


def warp(image, source_from_target, side, interpolation, beyond):
    return cv2.warpAffine(image, source_from_target, (side, side), flags=interpolation | cv2.WARP_INVERSE_MAP,
                          borderMode=cv2.BORDER_CONSTANT, borderValue=beyond)


def augment(rng, features, truth):
    """Turns, mirrors, changes colors and light, how sure the first network was, and where it erred."""
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
    if rng.random() < 0.25:  # a place of which it is unsure altogether
        features[LOG_ODDS] = np.clip(features[LOG_ODDS] - rng.uniform(0, 0.5) * seen[0], -1, 1)
    if rng.random() < 0.3:
        features[LOG_ODDS] += seen[0] * smooth_noise(rng, truth.shape, rng.uniform(8, 40)) * rng.uniform(0.2, 1) / LOG_ODDS_UNIT
    change_heights(rng, features)
    return features, truth


def change_heights(rng, features):
    """Steps are higher and lower than in the simulator, the road bends away from where it would go on to, and what views
    agreed on is missing at random."""
    shape, seen = features.shape[1:], features[SEEN] > 0
    is_measured = features[CERTAINTY] > 0
    if rng.random() < 0.5:
        scale = np.exp(rng.normal(0, 0.3))
        features[RAISED] *= scale
        features[MEASURED] *= scale
    if rng.random() < 0.6:
        rows, columns = np.mgrid[: shape[0], : shape[1]]
        slope = rng.normal(0, 0.12, 2) / 10  # 0.1 m per pixel of 0.1 m: percents
        bend = slope[0] * (columns - shape[1] / 2) + slope[1] * (rows - shape[0] / 2)
        bend = bend + smooth_noise(rng, shape, rng.uniform(40, 100)) * rng.uniform(0, 0.6)
        features[RAISED] += seen * bend
        features[MEASURED] += is_measured * bend
    if rng.random() < 0.3:
        is_lost = smooth_noise(rng, shape, rng.uniform(4, 30)) > rng.uniform(0.3, 1.5)
        features[MEASURED][is_lost] = 0
        features[CERTAINTY][is_lost] = 0
    np.clip(features[RAISED], -2, 2, out=features[RAISED])
    np.clip(features[MEASURED], -2, 2, out=features[MEASURED])


def smooth_noise(rng, shape, length):
    """Normal errors that are alike over `length` pixels: another network errs elsewhere."""
    knots = rng.normal(0, 1, [int(size / length) + 2 for size in shape]).astype(np.float32)
    return cv2.resize(knots, shape[::-1], interpolation=cv2.INTER_CUBIC)


def change_colors(rng, colors, seen):
    """0..1 times `seen`."""
    kind = rng.random()
    if kind < 0.1:
        return np.broadcast_to(0.5 * seen, colors.shape)  # colors say nothing
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
