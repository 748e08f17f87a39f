#!/usr/bin/env python3
"""Trains the network of outlines for a given time on two processor cores, one of which makes the squares.

    nice train_outlines.py --rasters RASTERS --val RASTERS --minutes 40 --out outlines.pt

RASTERS are folders that parkade-outline-rasters filled. The checkpoint holds the moving average of the weights.
"""
import argparse
import copy
import itertools
import os
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before PyTorch is loaded: its threads spin while they wait for a busy core

import cv2
import numpy as np
import torch
from torch.nn import functional

import outline_rasters as rasters
from huge_pages import use_huge_pages
from outline_network import LOG_ODDS, LOG_ODDS_UNIT, OutlineNetwork, corrected, load, with_correction
from network import in_bfloat16
from train import follow, make_optimizer

SIDE = 224  # pixels of a square
RIM = 12  # pixels: a square about as large as the disc of 1.5 m that the measure takes; a multiple of 2
PREFETCHED = 6  # batches


class Squares(torch.utils.data.IterableDataset):
    """Batches of squares without end, made by a process of their own."""

    def __init__(self, arguments):
        self.folders, self.known, self.pool = arguments.rasters, set(), []
        self.batch, self.rng = arguments.batch, np.random.default_rng(arguments.seed)
        self.take_in_new_rasters()

    def take_in_new_rasters(self):
        """Those that were finished while training runs."""
        for folder in self.folders:
            new = rasters.load_rasters(folder, self.known)
            self.known |= {(folder, name) for name, _, _ in new}
            self.pool += new
        areas = np.array([(truth <= rasters.DRIVABLE).sum() for _, _, truth in self.pool], float)
        self.shares = areas / areas.sum()

    def __iter__(self):
        cv2.setNumThreads(1)
        for count in itertools.count():
            if count % 200 == 199:
                self.take_in_new_rasters()
            squares = [self.square() for _ in range(self.batch)]
            yield tuple(np.stack(part) for part in zip(*squares))

    def square(self):
        _, features, truth = self.pool[self.rng.choice(len(self.pool), p=self.shares)]
        features, truth = rasters.augment(self.rng, *rasters.cut_square(self.rng, features, truth, SIDE))
        return features, truth, rasters.weights_of(features, truth)


def loss_of(log_odds, seen, truth, weights):
    """Cross entropy, soft IoU and soft boundary IoU.
    log_odds, seen (0 or 1), truth (of outline_rasters) and weights: N x H x W."""
    drivable = (truth == rasters.DRIVABLE).float()
    entropy = (functional.binary_cross_entropy_with_logits(log_odds, drivable, reduction="none") * weights).sum()
    probability = torch.sigmoid(log_odds) * seen
    area = soft_iou(probability, drivable, (weights > 0).float())
    known = (truth <= rasters.DRIVABLE).float()
    inside = drivable + (truth == rasters.UNSEEN).float()
    rims = soft_iou(rim_of(torch.where(known > 0, probability, inside)), rim_of(inside), eroded(known, beyond=0))
    return entropy / weights.sum().clamp(min=1) + 0.5 * (1 - area) + 0.5 * (1 - rims)


def soft_iou(found, truth, counts):
    both = (torch.minimum(found, truth) * counts).sum()
    return (both + 50) / ((torch.maximum(found, truth) * counts).sum() + 50)


def rim_of(area):
    """What of an area (N x H x W, 0..1) lies within RIM of its outline. One wrong pixel far from all outlines makes a rim of
    its own, which costs as much as a wrong line: that is why rims are asked for on their own."""
    return area - eroded(area, beyond=1)


def eroded(area, beyond):
    """The least within RIM rows and columns; `beyond`: what lies around the square. By squares of two pixels, which takes
    a sixth of the time."""
    least = -functional.max_pool2d(-area, 2)
    reach = RIM // 2
    padded = -functional.pad(least, (reach, reach, reach, reach), value=beyond)
    by_rows = functional.max_pool2d(padded, (2 * reach + 1, 1), 1)
    return -functional.interpolate(functional.max_pool2d(by_rows, (1, 2 * reach + 1), 1)[:, None], scale_factor=2)[:, 0]


def measure(network, pool, prints=True):
    network.eval()
    before, after = [], []
    for name, features, truth in pool:
        with torch.no_grad():
            log_odds = corrected(network, torch.from_numpy(features[None]))[0, 0].numpy()
        before.append(rasters.compare(features, truth, LOG_ODDS_UNIT * features[LOG_ODDS]))
        after.append(rasters.compare(features, truth, log_odds))
        if prints:
            print(f"  {name:16}", figures(before[-1:], after[-1:]))
    print("  mean            ", figures(before, after), flush=True)


def figures(before, after):
    mean = lambda rows, key: np.mean([row[key] for row in rows])
    return ", ".join(f"{key} {mean(before, key):.4f} -> {mean(after, key):.4f}" for key in before[0])


def train(arguments):
    torch.set_num_threads(arguments.threads)
    cv2.setNumThreads(1)
    torch.manual_seed(arguments.seed)
    network = load(arguments.resume) if arguments.resume else OutlineNetwork()
    average = copy.deepcopy(network)
    network = network.to(memory_format=torch.channels_last)
    optimizer = make_optimizer(network, arguments.rate)
    val = [raster for folder in arguments.val for raster in rasters.load_rasters(folder)]
    squares = Squares(arguments)
    print(f"{sum(p.numel() for p in network.parameters())} parameters, {len(squares.pool)} rasters", flush=True)
    batches = torch.utils.data.DataLoader(squares, batch_size=None, num_workers=1, prefetch_factor=PREFETCHED,
                                          collate_fn=lambda batch: batch)
    begin = last_report = time.monotonic()
    step, losses = 0, []
    for features, truth, weights in batches:
        elapsed = (time.monotonic() - begin) / 60
        progress = elapsed / arguments.minutes
        rate = arguments.rate * min(1, (step + 1) / 100) * 0.5 * (1 + np.cos(np.pi * min(progress, 1)))
        for group in optimizer.param_groups:
            group["lr"] = rate
        network.train()
        features, truth, weights = map(torch.from_numpy, (features, truth, weights))
        seen = (features[:, rasters.SEEN] > 0).float()
        features = features.contiguous(memory_format=torch.channels_last)
        with in_bfloat16(arguments.bfloat16):
            correction = network(features)
        loss = loss_of(with_correction(features, correction.float())[:, 0], seen, truth, weights)
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimizer.step()
        follow(average, network, min(0.995, (step + 1) / (step + 10)))
        losses.append(loss.item())
        step += 1
        is_over = progress >= 1 or (arguments.steps and step >= arguments.steps)
        if is_over or time.monotonic() - last_report > 60 * arguments.report_minutes:
            last_report = time.monotonic()
            torch.save({"network": average.state_dict(), "steps": step}, arguments.out)
            print(f"{elapsed:.1f} min, step {step}, loss {np.mean(losses):.4f}", flush=True)
            if val:
                measure(average, val, prints=is_over)
            losses = []
        if is_over:
            return


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rasters", required=True, nargs="+", help="folders to learn from")
    parser.add_argument("--val", default=[], nargs="+", help="folders to measure on")
    parser.add_argument("--out", required=True, help="checkpoint to write")
    parser.add_argument("--resume", help="checkpoint to start from")
    parser.add_argument("--minutes", type=float, default=40)
    parser.add_argument("--steps", type=int, default=0, help="0: as many as the time allows")
    parser.add_argument("--rate", type=float, default=2e-3)
    parser.add_argument("--batch", type=int, default=4)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--bfloat16", action="store_true", help="calculate in bfloat16: faster where the processor knows it")
    parser.add_argument("--report-minutes", type=float, default=5)
    parser.add_argument("--seed", type=int, default=1)
    train(parser.parse_args())


if __name__ == "__main__":
    use_huge_pages()
    main()
