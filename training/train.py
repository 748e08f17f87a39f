#!/usr/bin/env python3
"""Trains the network for a given time on two processor cores, one of which makes the pictures, or on a graphics card; see
README.md.

    nice train.py --camvid CAMVID --drives DRIVES --minutes 60 --out freespace.pt
    train.py --pack pictures.zip --device cuda --workers 14 --batch 64 --bfloat16 --minutes 9 --out freespace.pt

DRIVES/train/* and DRIVES/val/* are folders of `parkade-simulate ... --semantic --out`. The checkpoint holds the moving average
of the weights and what --resume needs.
"""
import argparse
import copy
import os
import threading
import time
from pathlib import Path

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before PyTorch is loaded: its threads spin while they wait for a busy core

import cv2
import numpy as np
import torch
from torch.nn import functional

import augment
import classes as surfaces
import level_view
import pictures
import recycling
from huge_pages import use_huge_pages
from network import FreespaceNetwork, count_parameters, fold, in_bfloat16, load, log_odds_of
from views import CameraView, LevelView

SIZE = (640, 384)  # of the network's input: width, height
# Small pictures first: shapes and colors are learnt at a fraction of the cost. Until which part, size.
STAGES = ((0.3, (320, 192)), (0.6, (448, 256)), (1.0, SIZE))
EDGE_WEIGHT = 4.0  # of pixels at an outline, where others weigh 1: far ground is but a few rows of pixels
MOST_WEIGHT = 12.0
EDGE_REACH = 1 / 100  # of the picture's width, to both sides
PREFETCHED = 4  # batches
MADE_AT_ONCE = 16  # pictures, by a worker for the pool
FEWEST_IN_POOL = 1024
CLASSES_WEIGHT = 1.0  # of their loss, that of drivable ground weighing 1
# Of a pixel by its label: what is small and rare would be overlooked.
RARE = {surfaces.MARKING: 2, surfaces.KERB: 3, surfaces.VEHICLE: 2, surfaces.PERSON: 6}


def to_batch(images):
    """N x H x W x 3 to what the network takes."""
    return torch.from_numpy(images).permute(0, 3, 1, 2).float()


def weights_of(label, area):
    """H x W, float32: 0 where nothing is known, else `area` (ground_area.py), the more at outlines of drivable ground."""
    drivable = (label == pictures.DRIVABLE).astype(np.uint8)
    reach = max(1, round(EDGE_REACH * label.shape[1]))
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    edge = cv2.morphologyEx(drivable, cv2.MORPH_GRADIENT, kernel)
    weights = np.minimum(area * np.where(edge, EDGE_WEIGHT, 1), MOST_WEIGHT)
    return np.where(label == pictures.UNKNOWN, 0, weights).astype(np.float32)


def loss_of(log_odds, labels, weights):
    """Cross entropy, which keeps probabilities honest, and soft IoU, which is what is asked for."""
    known = (labels != pictures.UNKNOWN).float()
    target = (labels == pictures.DRIVABLE).float()
    entropy = (functional.binary_cross_entropy_with_logits(log_odds, target, reduction="none") * weights).sum()
    probability = torch.sigmoid(log_odds) * known
    both = (probability * target).sum((1, 2))
    either = (probability + target * known).sum((1, 2)) - both
    soft_iou = ((both + 50) / (either + 50)).mean()
    return entropy / weights.sum().clamp(min=1) + 0.3 * (1 - soft_iou)


def class_loss_of(scores, classes):
    """Cross entropy, labels that leave several classes open counting for each, and soft IoU, which is for the rare ones."""
    known = classes != surfaces.UNKNOWN
    labels = torch.where(known, classes, 0).long()
    possible = torch.from_numpy(surfaces.possible()).to(scores.device)[labels].permute(0, 3, 1, 2)  # N x classes x H x W
    of_label = [float(RARE.get(label, 1)) for label in range(surfaces.PAVED + 1)]
    weights = torch.tensor(of_label, device=scores.device)[labels] * known
    scores = scores - torch.logsumexp(scores, 1, keepdim=True)
    entropy = -torch.logsumexp(scores + torch.log(possible.clamp(min=1e-9)), 1) * weights
    certain = ((possible.sum(1) == 1) & known)[:, None]
    probability, target = scores.exp() * certain, possible * certain
    both = (probability * target).sum((0, 2, 3))
    either = (probability + target).sum((0, 2, 3)) - both
    seen = target.sum((0, 2, 3)) > 50
    soft_iou = ((both + 5) / (either + 5))[seen].mean() if seen.any() else 1.0
    return entropy.sum() / weights.sum().clamp(min=1) + 0.3 * (1 - soft_iou)


def size_at(progress):
    return next((size for end, size in STAGES if progress < end), SIZE)


def upsample(scores, size):
    return functional.interpolate(scores, size=size, mode="bilinear", align_corners=False)


def measure_iou(network, samples, is_level):
    """IoU of drivable ground over all pixels with a label, at the labels' resolution, and the mean of those of classes."""
    network.eval()
    both = either = 0
    confusion = surfaces.Confusion()
    with torch.no_grad():
        for picture in samples:
            if is_level:
                picture = level_view.as_seen_level(picture)
                image = picture.image
            else:
                image = cv2.resize(picture.image, pictures.input_size(picture.image, SIZE), interpolation=cv2.INTER_AREA)
            scores = upsample(network(to_batch(image[None])), picture.label.shape)
            log_odds = log_odds_of(scores)[0].numpy()
            confusion.add(picture.classes, surfaces.merged_class_of(scores[0].numpy()))
            known, truth = picture.label != pictures.UNKNOWN, picture.label == pictures.DRIVABLE
            found = (log_odds > 0) & known
            both += int((found & truth).sum())
            either += int((found | (truth & known)).sum())
    return both / max(either, 1), float(np.nanmean(confusion.ious()))


class Samples(torch.utils.data.IterableDataset):
    """Batches of augmented pictures without end, from plain and fisheye lenses in fixed shares, made by processes of their
    own. `view` gives the view for the next batch."""

    def __init__(self, plain, fisheye, arguments, count, view):
        self.plain, self.fisheye, self.count, self.view = plain, fisheye, count, view
        self.share_of_plain = 0.15 if arguments.level else 0.5  # narrow lenses have the other network
        self.seed = arguments.seed

    def __iter__(self):
        cv2.setNumThreads(1)
        self.rng = np.random.default_rng([self.seed, torch.utils.data.get_worker_info().id])
        while True:
            yield self.batch(self.view())

    def batch(self, view):
        images, labels, classes, weights = [], [], [], []
        for _ in range(self.count):
            is_plain = not self.fisheye or (self.plain and self.rng.random() < self.share_of_plain)
            pool = self.plain if is_plain else self.fisheye
            image, label, of_pixels, area = augment.augment(self.rng, pool[self.rng.integers(len(pool))], view)
            images.append(image)
            labels.append(label)
            classes.append(of_pixels[::2, ::2])  # the network's output has half the size
            weights.append(weights_of(label, area))
        return np.stack(images), np.stack(labels), np.stack(classes), np.stack(weights)


def loader_of(samples, arguments):
    return torch.utils.data.DataLoader(samples, batch_size=None, num_workers=arguments.workers, prefetch_factor=PREFETCHED,
                                       collate_fn=lambda batch: batch)


def batches_once(plain, fisheye, arguments, progress):
    """Tensors of pictures, each seen once; what processors train on."""
    def view():
        return LevelView() if arguments.level else CameraView(size_at(progress()))

    for images, *labels in loader_of(Samples(plain, fisheye, arguments, arguments.batch, view), arguments):
        yield to_batch(images), *(torch.from_numpy(part) for part in labels)


def batches_of_pool(plain, fisheye, arguments, progress):
    """Tensors of pictures that come back changed (recycling.py); what graphics cards train on."""
    view = LevelView() if arguments.level else CameraView(SIZE)
    pool = recycling.Pool(arguments.device, arguments.pool)
    loader = loader_of(Samples(plain, fisheye, arguments, MADE_AT_ONCE, lambda: view), arguments)

    def fill():
        for batch in loader:
            pool.put(*batch)

    threading.Thread(target=fill, daemon=True).start()
    while pool.count < min(FEWEST_IN_POOL, arguments.pool):
        time.sleep(0.1)
    while True:
        varied = recycling.vary(*pool.draw(arguments.batch), view.recycled_spread)
        yield varied if arguments.level else recycling.resized(*varied, size_at(progress()))


def follow(average, network, decay):
    """Moves the average toward the network."""
    values = network.state_dict()
    with torch.no_grad():
        for name, kept in average.state_dict().items():
            if kept.dtype.is_floating_point:
                kept.lerp_(values[name], 1 - decay)
            else:
                kept.copy_(values[name])


def make_optimizer(network, rate):
    """Weights decay, biases and scales do not."""
    decays = [parameter for parameter in network.parameters() if parameter.ndim > 1]
    others = [parameter for parameter in network.parameters() if parameter.ndim <= 1]
    return torch.optim.AdamW([{"params": decays, "weight_decay": 0.02}, {"params": others, "weight_decay": 0.0}], lr=rate)


def load_pictures(arguments):
    """Plain pictures and those of drives, to train on."""
    if arguments.pack:
        plain, fisheye = pictures.load_pack(arguments.pack)
    else:
        plain = pictures.load_camvid(Path(arguments.camvid) / "train") if arguments.camvid else []
        fisheye = [picture for drive in pictures.finished_drives(Path(arguments.drives) / "train") for picture in pictures.load_drive(drive)]
    if arguments.without:
        plain = [picture for picture in plain if not picture.name.startswith(arguments.without)]
    return plain, fisheye


def start(arguments):
    network = load(arguments.resume) if arguments.resume else FreespaceNetwork()
    if arguments.fold:
        network = fold(network)
    return network.to(arguments.device, memory_format=torch.channels_last)


def train(arguments):
    torch.set_num_threads(1)
    cv2.setNumThreads(1)
    torch.manual_seed(arguments.seed)
    network = start(arguments)
    average = copy.deepcopy(network)
    optimizer = make_optimizer(network, arguments.rate)
    plain, fisheye = load_pictures(arguments)
    print(f"{count_parameters(network)} parameters, {len(plain)} plain pictures, {len(fisheye)} of drives", flush=True)
    begin = last_report = time.monotonic()
    budget, step, losses = 60 * arguments.minutes, 0, []
    batches_of = batches_of_pool if arguments.pool else batches_once
    for batch in batches_of(plain, fisheye, arguments, lambda: arguments.begin + (1 - arguments.begin) * (time.monotonic() - begin) / budget):
        elapsed = time.monotonic() - begin
        progress = elapsed / budget
        # The schedule follows the clock: on a shared machine nobody knows how many steps an hour has.
        rate = arguments.rate * min(1, (step + 1) / 100) * 0.5 * (1 + np.cos(np.pi * min(progress, 1)))
        for group in optimizer.param_groups:
            group["lr"] = rate
        network.train()
        images, labels, classes, weights = batch
        with in_bfloat16(arguments.bfloat16, arguments.device):
            scores = network(images.contiguous(memory_format=torch.channels_last)).float()
        log_odds = upsample(log_odds_of(scores)[:, None], labels.shape[1:])[:, 0]
        loss = loss_of(log_odds, labels, weights) + CLASSES_WEIGHT * class_loss_of(scores, classes)
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 5.0)
        optimizer.step()
        follow(average, network, min(arguments.average, (step + 1) / (step + 10)))
        losses.append(loss.detach())
        step += 1
        is_over = progress >= 1 or (arguments.steps and step >= arguments.steps)
        if is_over or time.monotonic() - last_report > 60 * arguments.report_minutes:
            last_report = time.monotonic()
            save(average, step, arguments)
            report(arguments, average, step, losses, elapsed)
            losses = []
        if is_over:
            return


def save(average, step, arguments):
    weights = {name: value.cpu() for name, value in average.state_dict().items()}
    torch.save({"network": weights, "steps": step, "size": level_view.SIZE if arguments.level else SIZE}, arguments.out)


def report(arguments, average, step, losses, elapsed):
    loss = float(torch.stack(losses).mean())
    print(f"{elapsed / 60:.1f} min, step {step}, loss {loss:.4f}", flush=True)
    if arguments.pack:  # nothing to measure on travels with it
        return
    figures = []
    if arguments.camvid and not arguments.level:
        val = pictures.load_camvid(Path(arguments.camvid) / "val")[:: arguments.val_stride]
        figures.append("camvid {:.4f} {:.3f}".format(*measure_iou(average, val, False)))
    for drive in pictures.finished_drives(Path(arguments.drives) / "val"):
        val = pictures.load_drive(drive)[:: arguments.val_stride]
        figures.append("{} {:.4f} {:.3f}".format(drive.name, *measure_iou(average, val, arguments.level)))
    print("  IoU of drivable, mean of classes: " + ", ".join(figures), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--camvid", help="folder with train/ and val/, each with images/ and labels/")
    parser.add_argument("--drives", help="folder with train/ and val/ of simulated drives")
    parser.add_argument("--pack", help="file of pack.py, in place of the two")
    parser.add_argument("--without", help="leave out plain pictures whose names begin so: sequences to measure on")
    parser.add_argument("--out", required=True, help="checkpoint to write")
    parser.add_argument("--level", action="store_true", help="train on level views of calibrated cameras (level_view.py)")
    parser.add_argument("--resume", help="checkpoint, or ONNX file of a folded network, to start from")
    parser.add_argument("--fold", action="store_true", help="fold batch normalization first: further steps take half the time")
    parser.add_argument("--begin", type=float, default=0, help="part of STAGES that is over: 1 for large pictures only")
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--steps", type=int, default=0, help="end earlier, after so many steps")
    parser.add_argument("--rate", type=float, default=2e-3, help="learning rate at its highest")
    parser.add_argument("--batch", type=int, default=16)
    parser.add_argument("--bfloat16", action="store_true", help="calculate in bfloat16: faster where the processor knows it")
    parser.add_argument("--device", default="cpu", help="cpu or cuda")
    parser.add_argument("--workers", type=int, default=1, help="processes that augment pictures")
    parser.add_argument("--pool", type=int, help="pictures that come back (recycling.py); default: 0 on a CPU, 6000 on a card")
    parser.add_argument("--average", type=float, default=0.995, help="what the moving average keeps of itself at a step")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--report-minutes", type=float, default=8)
    parser.add_argument("--val-stride", type=int, default=4, help="measure on every so many-th picture")
    arguments = parser.parse_args()
    if not arguments.pack and not arguments.drives:
        parser.error("give --drives or --pack")
    if arguments.pool is None:
        arguments.pool = 0 if arguments.device == "cpu" else 6000
    train(arguments)


if __name__ == "__main__":
    use_huge_pages()
    main()
