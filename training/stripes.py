"""Paint on floors, of the colors that lines and arrows have: long quadrangles in the picture, or bands on the ground that
level views show bent, and fields between two of them.
"""
import functools

import cv2
import numpy as np

import level_view

COLORS = [(20, 170, 230), (230, 230, 230), (200, 120, 40), (40, 40, 200), (60, 150, 60)]  # BGR


def random_polygon(rng, size):
    """A long quadrangle, as wide paint on a floor looks."""
    width, height = size
    start = rng.uniform([0, 0.3 * height], [width, height])
    angle, length, thickness = rng.uniform(0, np.pi), rng.uniform(0.15, 0.9) * width, rng.uniform(2, 22)
    along = np.array([np.cos(angle), np.sin(angle) * 0.6])
    across = np.array([-along[1], along[0]])
    taper = rng.uniform(0.2, 1)
    corners = [start + across * thickness, start + along * length + across * thickness * taper,
               start + along * length - across * thickness * taper, start - across * thickness]
    return np.array(corners)


def paint_stripe(rng, picture, corners, where):
    """`picture`, H x W x 3, with a stripe between `corners`, as far as `where`, H x W x 1 of 0 to 1, lets it show."""
    stripe = np.zeros(picture.shape[:2], np.float32)
    cv2.fillConvexPoly(stripe, corners.astype(np.int32), 1.0)
    return paint(rng, picture, cv2.GaussianBlur(stripe, (3, 3), 0)[..., None] * where)


def paint(rng, picture, share):
    """`picture` in another color to a `share`, H x W x 1, which wear makes less."""
    share = share * np.float32(rng.uniform(0.4, 0.95))
    color = np.float32(COLORS[rng.integers(len(COLORS))]) * np.float32(rng.uniform(0.5, 1.1))
    return picture * (1 - share) + share * color


@functools.cache
def ground_of_view():
    """Where level views show the ground: to the right and ahead, in heights of the camera; NaN above it."""
    columns, rows = np.meshgrid(np.arange(level_view.SIZE[0]), np.arange(level_view.SIZE[1]))
    azimuth, elevation = level_view.angles_of(columns, rows)
    distance = np.where(elevation < np.radians(-1), 1 / np.tan(-np.minimum(elevation, -1e-3)), np.nan)
    return np.float32(distance * np.sin(azimuth)), np.float32(distance * np.cos(azimuth))


def log_uniform(rng, low, high):
    return np.exp(rng.uniform(np.log(low), np.log(high)))


def random_width(rng):
    """Of paint on the ground, in heights of the camera."""
    return log_uniform(rng, 0.06, 0.6)


def beyond_line(toward, reach):
    """H x W: how far the ground of a level view lies beyond the line that passes the camera at `reach` in the direction
    `toward` [rad]: 0 is to the right, half pi ahead. In heights of the camera; NaN above the ground."""
    right, ahead = ground_of_view()
    return right * np.float32(np.cos(toward)) + ahead * np.float32(np.sin(toward)) - np.float32(reach)


def band_in_view(rng):
    """H x W x 1, 0 to 1: what a random straight band on the ground covers of a level view; some end."""
    toward = rng.uniform(0, 2 * np.pi)
    share = share_below(np.abs(beyond_line(toward, log_uniform(rng, 0.3, 8))), 0.5 * random_width(rng))
    if rng.random() < 0.5:
        along = beyond_line(toward - 0.5 * np.pi, rng.normal(0, 3))
        share = share * share_below(np.abs(along), rng.uniform(0.5, 4))
    return share[..., None]


def paint_field(rng, floor):
    """`floor`, H x W x 3, of a level view with a field as between parts of a car park: plain ground of a shade of its own
    between two wide lines of one color, which meet, cross or run side by side."""
    toward = rng.uniform(0, 2 * np.pi)
    first = beyond_line(toward, log_uniform(rng, 0.4, 6))
    if rng.random() < 0.3:
        second = -first - np.float32(rng.uniform(0.6, 4))
    else:
        second = beyond_line(toward + rng.uniform(0.3, 2.9) * rng.choice([-1, 1]), log_uniform(rng, 0.4, 6))
    plain = cv2.GaussianBlur(floor, (0, 0), rng.uniform(2, 12))
    plain = plain * np.float32(np.exp(rng.normal(0, 0.25))) * np.float32(np.exp(rng.normal(0, 0.06, 3)))
    between = (share_behind(first) * share_behind(second))[..., None] * np.float32(rng.uniform(0.3, 1))
    floor = floor * (1 - between) + plain * between
    half_width = 0.5 * random_width(rng)
    lines = np.maximum(share_below(np.abs(first), half_width), share_below(np.abs(second), half_width))
    return paint(rng, floor, lines[..., None])


def share_below(values, bound):
    """About how much of a pixel has less than `bound`, of values that are not negative; 0 where the ground is not seen."""
    change = change_per_pixel(values)
    return np.nan_to_num(np.clip(0.5 + (np.float32(bound) - values) / change, 0, np.minimum(1, np.float32(2 * bound) / change)))


def share_behind(values):
    """About how much of a pixel has negative values; 0 where the ground is not seen."""
    return np.nan_to_num(np.clip(0.5 - values / change_per_pixel(values), 0, 1))


def change_per_pixel(values):
    per_row, per_column = np.gradient(values)
    return np.hypot(per_row, per_column) + np.float32(1e-6)
