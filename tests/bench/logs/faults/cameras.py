"""Cameras that are swapped, turned, frozen, blind, or not there."""

import numpy

from drive_log import NS, pixels, repaint
from fault import FaultList

FAULTS = FaultList()
ABOUT = r"\bcam\d|camera|image|lens|calibration"


def rename(log, names):
    for r in log.images:
        r.topic = names.get(r.topic, r.topic)


@FAULTS.each("topics of cameras {} are swapped", ["01", "02", "03", "12", "13", "23"], ABOUT, must_say=True)
def _(log, pair):
    a, b = (log.cameras[int(digit)] for digit in pair)
    rename(log, {a: b, b: a})


@FAULTS.add("topics of all cameras go round", ABOUT, must_say=True)
def _(log):
    rename(log, dict(zip(log.cameras, log.cameras[1:] + log.cameras[:1])))


def cameras_of(log, which):
    return log.cameras if which == "all cameras" else log.cameras[1:2]


@FAULTS.each("{}: mirrored", ["one camera", "all cameras"], ABOUT, must_say=True)
def _(log, which):
    repaint(log.of(*cameras_of(log, which)), lambda image, _: image[:, ::-1])


@FAULTS.each("{}: upside down", ["one camera", "all cameras"], ABOUT, must_say=True)
def _(log, which):
    repaint(log.of(*cameras_of(log, which)), lambda image, _: image[::-1, ::-1])


def freeze(records, begin):
    kept = None
    for r in records:
        if r.stamp >= begin:
            kept = kept or r.message
            r.message.data = kept.data


@FAULTS.each("{}: the image of the middle is repeated", ["one camera", "all cameras"], ABOUT)
def _(log, which):
    for topic in cameras_of(log, which):
        freeze(log.of(topic), log.at(0.5))


@FAULTS.add("one camera: the first image is repeated", ABOUT, must_say=True)
def _(log):
    freeze(log.of(log.cameras[1]), 0)


@FAULTS.add("every image comes twice, with a stamp of its own", ABOUT)
def _(log):
    for topic in log.cameras:
        images = log.of(topic)
        for first, second in zip(images[::2], images[1::2]):
            second.message.data = first.message.data


@FAULTS.each("{}: black", ["one camera", "all cameras"], ABOUT)
def _(log, which):
    repaint(log.of(*cameras_of(log, which)), lambda image, _: image * 0)


@FAULTS.each("{}: white", ["one camera", "all cameras"], ABOUT)
def _(log, which):
    repaint(log.of(*cameras_of(log, which)), lambda image, _: image * 0 + 255)


@FAULTS.each("exposure changes by {} every second", [1.5, 3], ABOUT)
def _(log, factor):
    repaint(log.images, lambda image, k: numpy.clip(image * (factor if k // 40 % 2 else 1.0), 0, 255).astype(numpy.uint8))


@FAULTS.each("noise of {} gray levels", [10, 30], ABOUT)
def _(log, sigma):
    draw = numpy.random.default_rng(6)
    repaint(log.images, lambda image, _: numpy.clip(image + draw.normal(0, sigma, image.shape), 0, 255).astype(numpy.uint8))


@FAULTS.add("noise alone in one camera", ABOUT, must_say=True)
def _(log):
    draw = numpy.random.default_rng(7)
    repaint(log.of(log.cameras[1]), lambda image, _: draw.integers(0, 255, image.shape, numpy.uint8))


@FAULTS.add("a bar that stands covers a third of one camera", ABOUT)
def _(log):
    def cover(image, _):
        image = image.copy()
        image[:, image.shape[1] // 3: 2 * image.shape[1] // 3] = 20
        return image

    repaint(log.of(log.cameras[0]), cover)


@FAULTS.each("{}: half the size", ["one camera", "all cameras"], ABOUT + "|size|resolution", must_say=True)
def _(log, which):
    repaint(log.of(*cameras_of(log, which)), lambda image, _: image[::2, ::2])


@FAULTS.add("the size changes in the middle", ABOUT + "|size|resolution")
def _(log):
    middle = log.at(0.5)
    repaint([r for r in log.images if r.stamp > middle], lambda image, _: image[::2, ::2])


@FAULTS.add("cut at the sides, the rig does not know", ABOUT + "|size|resolution", must_say=True)
def _(log):
    repaint(log.images, lambda image, _: image[:, 16:-16])


@FAULTS.each("{} cameras are not in the log", [1, 2, 3, 4], ABOUT, must_say=True)
def _(log, count):
    gone = log.cameras[-count:]
    log.drop(lambda r: r.topic in gone)


@FAULTS.add("one camera ends in the middle", ABOUT)
def _(log):
    middle, topic = log.at(0.5), log.cameras[1]
    log.drop(lambda r: r.topic == topic and r.stamp > middle)


@FAULTS.each("no image for {} s", [1, 3], ABOUT + "|gap")
def _(log, seconds):
    begin = log.at(0.4)
    log.drop(lambda r: r.topic in log.cameras and begin <= r.stamp < begin + seconds * NS)


@FAULTS.each("one of {} images only", [2, 5, 10], ABOUT + "|rate|sparse|few")
def _(log, step):
    kept = {id(r) for topic in log.cameras for r in log.of(topic)[::step]}
    log.drop(lambda r: r.topic in log.cameras and id(r) not in kept)


@FAULTS.add("a third of the images is lost at random", ABOUT)
def _(log):
    draw = numpy.random.default_rng(8)
    log.drop(lambda r: r.topic in log.cameras and draw.random() < 1 / 3)


@FAULTS.add("gray images")
def _(log):
    repaint(log.images, lambda image, _: image if image.ndim == 2 else image.mean(axis=2).astype(numpy.uint8))


@FAULTS.each("shifted by {} pixels, the rig does not know", [8, 30], ABOUT)
def _(log, by):
    repaint(log.images, lambda image, _: numpy.roll(image, by, axis=1))


@FAULTS.add("other rows later: a rolling shutter of 30 ms that the rig does not know", ABOUT)
def _(log):
    for topic in log.cameras:
        images = log.of(topic)
        shown = [pixels(r) for r in images]
        for k, r in enumerate(images[:-1]):
            rows = shown[k].shape[0]
            share = (numpy.arange(rows) / rows * 0.3).reshape(-1, *[1] * (shown[k].ndim - 1))
            shown[k] = (shown[k] * (1 - share) + shown[k + 1] * share).astype(numpy.uint8)
        queue = iter(shown)
        repaint(images, lambda image, _: next(queue))


@FAULTS.each("images are twice as large from the middle on: {}", ["one camera", "all cameras"], ABOUT, must_say=True)
def _(log, which):
    middle = log.at(0.5)
    records = [r for r in log.of(*cameras_of(log, which)) if r.stamp >= middle]
    repaint(records, lambda image, _: image.repeat(2, axis=0).repeat(2, axis=1))
