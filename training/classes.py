"""What surfaces are: the classes that the networks of free space tell apart. Numbers are the channels of their output, and
those of masks that parkade-simulate writes with `--set semantic_kind=classes`.
"""
import numpy as np

NAMES = ("drivable", "marking", "pavement", "vegetation", "kerb", "vehicle", "person", "structure", "own_car")
(DRIVABLE, MARKING, PAVEMENT, VEGETATION, KERB, VEHICLE, PERSON, STRUCTURE, OWN_CAR) = range(len(NAMES))
# Labels that leave open which of two classes it is, and those that leave open all.
ROAD, PAVED, UNKNOWN = 9, 10, 255
NUM_FREE = 2  # the first classes are drivable

# CamVid's 11 classes: its road has markings, its pavement kerbs, and its trees are all that grows.
OF_CAMVID = np.full(256, UNKNOWN, np.uint8)
OF_CAMVID[:11] = (STRUCTURE, STRUCTURE, STRUCTURE, ROAD, PAVED, VEGETATION, STRUCTURE, STRUCTURE, VEHICLE, PERSON, PERSON)

# Classes as figures count them where labels do not tell two apart.
MERGED_NAMES = ("road", "pavement", "vegetation", "vehicle", "person", "structure")
MERGED = np.full(256, UNKNOWN, np.uint8)
MERGED[: ROAD + 2] = (0, 0, 1, 2, 1, 3, 4, 5, 5, 0, 1)


def possible():
    """(number of labels) x (classes), 0 or 1: which classes a label of 0 to PAVED may be."""
    table = np.eye(PAVED + 1, len(NAMES), dtype=np.float32)
    table[ROAD, [DRIVABLE, MARKING]] = table[PAVED, [PAVEMENT, KERB]] = 1
    return table


class Confusion:
    """Counts of merged classes that were found, per class that is true."""

    def __init__(self):
        self.counts = np.zeros((len(MERGED_NAMES), len(MERGED_NAMES)), np.int64)

    def add(self, truth, found):
        """`truth`, H x W: labels; `found`, H x W: classes."""
        truth, found = MERGED[truth], MERGED[found]
        known = truth != UNKNOWN
        pairs = truth[known].astype(int) * len(MERGED_NAMES) + found[known]
        self.counts += np.bincount(pairs, minlength=self.counts.size).reshape(self.counts.shape)

    def ious(self):
        """Per merged class; NaN where there is none."""
        right = np.diag(self.counts)
        either = self.counts.sum(0) + self.counts.sum(1) - right
        return np.where(self.counts.sum(1) > 0, right / np.maximum(either, 1), np.nan)


def merged_class_of(scores):
    """H x W: a class that stands for the most probable merged one, of `scores`, classes x H x W, before their softmax."""
    exponents = np.exp(scores - scores.max(0))
    merged = np.stack([exponents[[number for number in range(len(NAMES)) if MERGED[number] == index]].sum(0)
                       for index in range(len(MERGED_NAMES))])
    stand_for = np.array([int(np.argmax(MERGED[: len(NAMES)] == index)) for index in range(len(MERGED_NAMES))], np.uint8)
    return stand_for[merged.argmax(0)]
