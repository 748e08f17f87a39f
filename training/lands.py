"""Pavements, lawns and other land as they are elsewhere: other colors and textures on ground that is not for cars."""
import cv2
import numpy as np

import classes as surfaces
from colors import normals, to_bytes

# OpenCV's hue, saturation and value, from and to: of what is laid and of what grows or lies there.
PAVED = (((0, 0, 60), (179, 30, 255)), ((0, 60, 70), (14, 150, 210)), ((14, 20, 110), (28, 90, 240)))
GROWN = (((28, 60, 60), (52, 210, 230)), ((20, 50, 90), (32, 150, 230)), ((4, 50, 40), (18, 150, 150)), ((0, 0, 60), (179, 40, 190)))

SHARE_OF_LAWNS = 0.4  # of pavements that are repainted


def color_of(rng, ranges):
    low, high = ranges[rng.integers(len(ranges))]
    hsv = rng.uniform(low, high).astype(np.uint8)
    return cv2.cvtColor(hsv[None, None], cv2.COLOR_HSV2BGR)[0, 0].astype(np.float32)


def grain(rng, shape):
    """H x W x 1 around 0: of one or two sizes, the finer the nearer."""
    height, width = shape
    field = np.zeros(shape, np.float32)
    for _ in range(rng.integers(1, 3)):
        cell = np.exp(rng.uniform(0, np.log(24)))
        noise = rng.standard_normal((max(2, int(height / cell)), max(2, int(width / cell))), np.float32)
        field += np.float32(np.exp(rng.uniform(np.log(0.01), np.log(0.25)))) * cv2.resize(noise, (width, height))
    return field[..., None]


def repaint_land(rng, image, classes):
    """`image` with other pavements, and with other lawns or soil, half of the time each; shadows stay. Some pavements become
    lawns, and `classes` say so."""
    for labels, ranges in (((surfaces.PAVEMENT, surfaces.PAVED), PAVED), ((surfaces.VEGETATION,), GROWN)):
        region = np.isin(classes, labels)
        if rng.random() < 0.5 or not region.any():
            continue
        if ranges is PAVED and rng.random() < SHARE_OF_LAWNS:
            ranges, classes[region] = GROWN, surfaces.VEGETATION
        gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(np.float32)
        light = cv2.GaussianBlur(gray, (0, 0), rng.uniform(2, 8)) / max(gray[region].mean(), 1)
        fine = (gray - cv2.GaussianBlur(gray, (0, 0), 4)) * np.float32(rng.uniform(0, 1.2))
        color = color_of(rng, ranges) * np.exp(normals(rng, 0, 0.05, 3))
        painted = color * np.clip(light, 0.2, 2)[..., None] * (1 + grain(rng, classes.shape)) + fine[..., None]
        share = cv2.GaussianBlur(region.astype(np.float32), (3, 3), 0)[..., None] * np.float32(rng.uniform(0.6, 1))
        image = to_bytes(image * (1 - share) + painted * share)
    return image
