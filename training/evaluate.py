#!/usr/bin/env python3
"""IoU of drivable ground, and of classes, that an ONNX network reaches, run by OpenCV as Parkade runs it. Needs no PyTorch.

    evaluate.py level.onnx --level --drive DRIVES/val/lot_2000 ...
    evaluate.py freespace.onnx --camvid CAMVID/val --drive DRIVES/val/lot_2000 ... [--overlays DIR]
"""
import argparse
import sys
from pathlib import Path

sys.dont_write_bytecode = True

import cv2
import numpy as np

import classes as surfaces
import level_view
import pictures


def find_scores(network, limit, picture):
    """Classes x H x W; of networks that tell none 1 x H x W, the log-odds of "drivable"."""
    image = cv2.resize(picture.image, pictures.input_size(picture.image, limit), interpolation=cv2.INTER_AREA)
    network.setInput(cv2.dnn.blobFromImage(image))
    size = picture.label.shape[::-1]
    return np.stack([cv2.resize(channel, size, interpolation=cv2.INTER_LINEAR) for channel in network.forward()[0]])


def log_odds_of(scores):
    if len(scores) == 1:
        return scores[0]
    sum_of = lambda some: np.logaddexp.reduce(some, axis=0)
    return sum_of(scores[: surfaces.NUM_FREE]) - sum_of(scores[surfaces.NUM_FREE :])


def overlay(picture, drivable):
    """Right in green, missed in blue, false in red."""
    truth = picture.label == pictures.DRIVABLE
    colors = np.zeros_like(picture.image)
    colors[drivable & truth], colors[~drivable & truth] = (0, 200, 0), (255, 0, 0)
    colors[drivable & (picture.label == pictures.NOT_DRIVABLE)] = (0, 0, 255)
    return cv2.addWeighted(picture.image, 0.6, colors, 0.4, 0)


def evaluate(network, limit, samples, folder):
    """IoU over all labeled pixels, how often a pixel is right at each tenth of probability, and IoUs of merged classes, None
    of a network that tells none."""
    both = either = 0
    right, count = np.zeros(10), np.zeros(10)
    confusion = surfaces.Confusion()
    for picture in samples:
        scores = find_scores(network, limit, picture)
        log_odds = log_odds_of(scores)
        if len(scores) > 1:
            confusion.add(picture.classes, surfaces.merged_class_of(scores))
        known, truth, drivable = picture.label != pictures.UNKNOWN, picture.label == pictures.DRIVABLE, log_odds > 0
        both += int((drivable & truth).sum())
        either += int(((drivable | truth) & known).sum())
        tenth = np.minimum(10 / (1 + np.exp(-log_odds[known])), 9).astype(int)
        count += np.bincount(tenth, minlength=10)
        right += np.bincount(tenth, weights=truth[known], minlength=10)
        if folder:
            cv2.imwrite(str(Path(folder) / (picture.name.replace("/", "_") + ".jpg")), overlay(picture, drivable))
    ious = confusion.ious() if confusion.counts.any() else None
    return both / max(either, 1), right / np.maximum(count, 1), ious


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("onnx")
    parser.add_argument("--camvid", help="folder with images/ and labels/")
    parser.add_argument("--drive", action="append", default=[], help="a simulated drive with masks; may be repeated")
    parser.add_argument("--level", action="store_true", help="drives as level views show them (level_view.py)")
    parser.add_argument("--size", default="640x384", help="of the network's input at most")
    parser.add_argument("--overlays", help="folder for pictures with what was found")
    arguments = parser.parse_args()
    limit = level_view.SIZE if arguments.level else tuple(int(number) for number in arguments.size.split("x"))
    cv2.setNumThreads(1)
    network = cv2.dnn.readNetFromONNX(arguments.onnx)
    if arguments.overlays:
        Path(arguments.overlays).mkdir(parents=True, exist_ok=True)
    sets = [("camvid", pictures.load_camvid(arguments.camvid))] if arguments.camvid else []
    for drive in arguments.drive:
        samples = pictures.load_drive(drive)
        sets.append((Path(drive).name, [level_view.as_seen_level(p) for p in samples] if arguments.level else samples))
    for name, samples in sets:
        iou, share, ious = evaluate(network, limit, samples, arguments.overlays)
        tenths = " ".join(f"{value:.2f}" for value in share)
        print(f"{name}: {len(samples)} pictures, IoU {iou:.4f}; drivable per tenth of probability: {tenths}")
        if ious is None:
            continue
        of_classes = ", ".join(f"{part} {value:.3f}" for part, value in zip(surfaces.MERGED_NAMES, ious))
        print(f"  mean of classes {np.nanmean(ious):.3f}: {of_classes}")


if __name__ == "__main__":
    main()
