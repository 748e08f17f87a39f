"""Kerbs between two lanes: floor on both sides, and nothing that the simulator has."""
import cv2
import numpy as np

from colors import to_bytes
from pictures import DRIVABLE, NOT_DRIVABLE

PAINTS = [((30, 180, 220), (35, 40, 45)), ((225, 225, 225), (40, 40, 190)), ((225, 225, 225), (40, 40, 40))]  # BGR


def curve_across(rng, size, count=160):
    """count x 2 points of a parabola through the picture, as a straight kerb looks through a fisheye."""
    width, height = size
    ends = rng.uniform([[-0.4, 0.25], [0.7, 0.25]], [[0.3, 1.0], [1.4, 1.0]]) * size
    middle = ends.mean(0) + [rng.normal(0, 0.1) * width, rng.normal(-0.1, 0.14) * height]
    t = np.linspace(0, 1, count)[:, None]
    return (1 - t) ** 2 * ends[0] + 2 * t * (1 - t) * middle + t**2 * ends[1]


def colors_along(rng, count):
    """count x 3: two colors in turns, or one as concrete is."""
    if rng.random() < 0.6:
        paint = np.array(PAINTS[rng.integers(len(PAINTS))]) * rng.uniform(0.6, 1.1)
        period = rng.uniform(0.03, 0.3) * count
        return paint[((np.arange(count) + rng.uniform(0, period)) / period * 2).astype(int) % 2]
    return np.tile(rng.uniform(60, 200) + rng.normal(0, 8, 3), (count, 1))


def add_kerb(rng, image, label):
    """Paints a kerb over the floor, and 0 into `label` there; what lies beyond it stays floor, of another tint."""
    height, width = label.shape
    points = curve_across(rng, (width, height))
    ground = (label == DRIVABLE).astype(np.float32)
    painted = image.astype(np.float32)
    if rng.random() < 0.5:
        beyond = np.zeros(label.shape, np.float32)
        cv2.fillPoly(beyond, [np.concatenate([points, [[width, 0], [0, 0]]]).astype(np.int32)], 1.0)
        tint = np.float32(np.exp(rng.normal(0, 0.15) + rng.normal(0, 0.05, 3)))
        painted = painted * (1 + (beyond * ground)[..., None] * (tint - 1))
    # The nearer, the wider: by the row; the face that looks at the camera is darker than the top, or brighter.
    most, face = rng.uniform(4, 22), np.exp(rng.normal(-0.3, 0.25))
    kerb, color = np.zeros(label.shape, np.float32), np.zeros(image.shape, np.float32)
    colors = colors_along(rng, len(points))
    for begin, end, tone in zip(points[:-1], points[1:], colors):
        thick = max(1.5, most * (begin[1] / height - 0.2))
        up, down = np.array([0, -0.6 * thick]), np.array([0, 0.4 * thick])
        for above, below, shade in ((up, 0 * up, 1.0), (0 * up, down, face)):
            corners = np.array([begin + above, end + above, end + below, begin + below])
            cv2.fillConvexPoly(color, np.round(corners).astype(np.int32), (tone * shade).tolist())
            cv2.fillConvexPoly(kerb, np.round(corners).astype(np.int32), 1.0)
    label[(kerb > 0) & (ground > 0)] = NOT_DRIVABLE
    texture = image.astype(np.float32) - cv2.GaussianBlur(image, (0, 0), 6)
    share = (cv2.GaussianBlur(kerb, (3, 3), 0) * ground)[..., None] * np.float32(rng.uniform(0.7, 1))
    return to_bytes(painted * (1 - share) + share * (color + texture))
