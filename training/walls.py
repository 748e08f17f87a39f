"""Walls as they are elsewhere: other colors, smooth patches, plain panels that stand on the outline of the floor."""
import cv2
import numpy as np

from colors import normals, to_bytes
from pictures import DRIVABLE, NOT_DRIVABLE


def wall_patch(rng, label):
    """0 to 1: a quadrangle somewhere in the upper part of the picture, turned as walls are at a fisheye's rim; or a
    small one at the outline of the floor, as walls at the far end of an aisle are."""
    height, width = label.shape
    center = rng.uniform([0, 0], [width, 0.7 * height])
    half = np.exp(rng.uniform(np.log([8, 6]), np.log([0.35 * width, 0.25 * height])))
    outline = np.argwhere((label[:-1] == NOT_DRIVABLE) & (label[1:] == DRIVABLE)) if rng.random() < 0.4 else []
    if len(outline):
        center = outline[rng.integers(len(outline))][::-1] + rng.normal(0, 4, 2)
        half = np.exp(rng.uniform(np.log([4, 3]), np.log([0.12 * width, 0.08 * height])))
    angle = np.radians(rng.normal(0, 25))
    axes = np.array([(np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))])
    corners = center + (half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])) @ axes + rng.normal(0, 5, (4, 2))
    patch = np.zeros((height, width), np.float32)
    cv2.fillConvexPoly(patch, corners.astype(np.int32), 1.0)
    return cv2.GaussianBlur(patch, (3, 3), 0)


def wall_paint(rng, image, label):
    """What a patch of wall shows, and where it can: any color, the floor's own, or the floor itself."""
    height, width = label.shape
    kind, ground, everywhere = rng.random(), image[label == DRIVABLE], np.ones(label.shape, np.float32)
    if kind < 0.35 and len(ground):
        shift = (-rng.integers(height // 4, 2 * height // 3), rng.integers(-width // 3, width // 3))
        return np.roll(image, shift, (0, 1)).astype(np.float32), np.roll(label == DRIVABLE, shift, (0, 1))
    shade = np.linspace(rng.uniform(0.6, 1.2), rng.uniform(0.6, 1.2), width, dtype=np.float32)[None, :, None]
    if kind < 0.6 and len(ground):
        return np.float32(ground.mean(0) * np.exp(rng.normal(0, 0.15))) * shade, everywhere
    return np.float32(rng.uniform(20, 220, 3)) * shade, everywhere


def add_moved(area, mask, right, up):
    """Adds to `area` what `mask` covers when it is moved by so many pixels (bool, H x W; up >= 0)."""
    height, width = area.shape
    to, source = slice(max(0, right), width + min(0, right)), slice(max(0, -right), width - max(0, right))
    area[: height - up, to] |= mask[up:, source]


def smooth_walls(rng, image, label):
    """Plain walls and gates that stand on the outline of the floor, side by side, each of one color, and between them
    openings through which one sees ceilings and walls further off."""
    height, width = label.shape
    ground = label == DRIVABLE
    reach = max(4, int(np.exp(rng.uniform(np.log(0.015), np.log(0.4))) * height))  # walls far off are a few rows
    # What lies above the floor in the picture, by up to `reach`; at the rims walls lean, so that the shift does too.
    wall = np.zeros(label.shape, bool)
    lean = rng.uniform(0, 1.2 if rng.random() < 0.3 else 0.5)
    for step in range(0, reach, 2):
        for side in (-1, 1):
            add_moved(wall, ground, int(side * lean * step), step)
    wall = (wall & ~ground).astype(np.float32)
    edges = np.sort(rng.uniform(0, width, rng.integers(0, 6 if rng.random() < 0.7 else 24))).astype(int)
    tilt = rng.normal(0, 0.3)
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    panel = np.searchsorted(edges, u + tilt * (v - height / 2)) if len(edges) else np.zeros((height, width), int)
    floor = image[ground].mean(0) if ground.any() else np.full(3, 100.0)
    paint = np.empty(image.shape, np.float32)
    for index in range(len(edges) + 1):
        color = rng.uniform(15, 190) + rng.uniform(0.2, 1) * rng.uniform(-80, 80, 3)
        paint[panel == index] = floor * np.exp(rng.normal(0, 0.3)) if rng.random() < 0.35 else color
    shift = (int(rng.uniform(0.1, 0.45) * height), int(rng.uniform(-0.4, 0.4) * width))
    beyond, is_beyond = np.roll(image, shift, (0, 1)), np.roll(label == NOT_DRIVABLE, shift, (0, 1))
    for index in range(len(edges) + 1):
        if rng.random() < 0.3:
            opening = (panel == index) & is_beyond
            paint[opening] = beyond[opening] * np.exp(rng.normal(0, 0.3) + rng.normal(0, 0.2, 3))
    shade = np.float32(1 + rng.normal(0, 0.2) * (v / height - 0.5) + rng.normal(0, 0.2) * (u / width - 0.5))
    texture = image.astype(np.float32) - cv2.GaussianBlur(image, (0, 0), 6)
    noise = np.float32(rng.uniform(0, 3)) * rng.standard_normal(image.shape, np.float32)
    paint = paint * shade[..., None] + np.float32(rng.uniform(0, 0.3)) * texture + noise
    share = cv2.GaussianBlur(wall, (3, 3), 0)[..., None]
    if rng.random() < 0.4:
        on_ground = ground[..., None].astype(np.float32)
        image = shine_of(rng, image, paint, wall, reach) * on_ground + image * (1 - on_ground)
    return to_bytes(image * (1 - share) + paint * share)


def shine_of(rng, image, paint, wall, reach):
    """`image` with the wall's colors on the floor at its foot, as a polished floor shows them."""
    box = (5, 2 * reach + 1)
    near = cv2.blur(wall, box)
    color = cv2.blur(paint * wall[..., None], box) / np.maximum(near, 1e-3)[..., None]
    share = (np.minimum(2 * near, 1) * np.float32(rng.uniform(0, 0.7)))[..., None]
    return image * (1 - share) + share * color


def paint_walls(rng, image, label):
    """Other colors, and smooth patches, on what is not drivable: neither smooth nor gray is yet road."""
    wall = cv2.GaussianBlur((label == NOT_DRIVABLE).astype(np.float32), (3, 3), 0)[..., None]
    painted = image.astype(np.float32)
    if rng.random() < 0.6:
        painted = painted * np.exp(normals(rng, 0, 0.5) + normals(rng, 0, 0.3, 3)) + normals(rng, 0, 10, 3)
    for _ in range(rng.integers(0, 5)):
        paint, where = wall_paint(rng, image, label)
        share = (wall_patch(rng, label) * where)[..., None] * np.float32(rng.uniform(0.5, 1.0))
        painted = painted * (1 - share) + share * paint
    return to_bytes(image * (1 - wall) + painted * wall)
