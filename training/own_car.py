"""Bodies of other own cars, painted over the lower part of a picture: lacquer mirrors the ground in front of it, takes
on its color, has rims, seams, plates, lamps and grilles. Only "where" tells it from the floor, and its edge.
"""
from dataclasses import dataclass

import cv2
import numpy as np

from pictures import DRIVABLE, NOT_DRIVABLE
from stripes import paint_stripe


@dataclass
class Body:
    """Rows `top` and below of the picture. H' x W arrays, pixels."""

    top: int
    column: np.ndarray
    row: np.ndarray
    depth: np.ndarray  # below the body's edge, at right angles to it; negative above
    edge: np.ndarray  # row where the body begins; W
    normal: tuple  # out of the body, at the nearest point of the edge above; each W


def smooth_noise(rng, count, knots):
    """`count` values of a smooth curve through normal random ones."""
    return cv2.resize(rng.normal(0, 1, (1, knots)), (count, 1), interpolation=cv2.INTER_CUBIC)[0]


def edge_of_body(rng, size):
    """For each column the row where the body begins."""
    width, height = size
    across = np.linspace(-1, 1, width) - rng.normal(0, 0.2)
    if rng.random() < 0.7:  # fisheyes look over a body that sags in the middle
        sides, middle, reach = rng.uniform(0.3, 0.75), rng.uniform(0.75, 1.08), rng.uniform(0.85, 1.6)
        row = sides + max(middle - sides, 0.1) * np.sqrt(np.maximum(1 - (across / reach) ** 2, 0))
    else:
        row = rng.uniform(0.65, 0.97) + rng.uniform(0.02, 0.5) * np.abs(across) ** rng.uniform(1.5, 5)
    row = row + rng.normal(0, 0.06) * across
    if rng.random() < 0.3:
        row = row + 0.01 * smooth_noise(rng, width, rng.integers(4, 12))
    return height * row


def lead_stripes_to(rng, image, label, body):
    """Paint on the floor that ends at the body's edge: what tells its mirror image from the floor is but a bend."""
    height, width = label.shape
    ground = cv2.GaussianBlur((label == DRIVABLE).astype(np.float32), (3, 3), 0)[..., None]
    painted = image.astype(np.float32)
    for _ in range(rng.integers(1, 4)):
        x = rng.integers(0, width)
        foot = np.array([x, min(body.edge[x], height) + 4])
        angle, length = rng.uniform(0.15, 0.85) * np.pi, rng.uniform(0.1, 0.7) * width
        tip = foot - length * np.array([np.cos(angle), np.sin(angle)])
        half = rng.uniform(2, 22) * np.array([np.sin(angle), -np.cos(angle)])
        left, right = rng.uniform(0.2, 1, 2)
        corners = np.array([foot - half, foot + half, tip + left * half, tip - right * half])
        painted = paint_stripe(rng, painted, corners, ground)
    return np.clip(painted, 0, 255).astype(np.uint8)


def shape_body(rng, size):
    """A body, or None if it lies below the picture."""
    width, height = size
    edge = edge_of_body(rng, size)
    top = max(int(edge.min()) - 1, 0)
    if top >= height - 8:
        return None
    column, row = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(top, height, dtype=np.float32))
    slope = np.gradient(edge).clip(-4, 4)
    length = np.sqrt(1 + slope**2)
    depth = ((row - edge) / length).astype(np.float32)
    return Body(top, column, row, depth, edge, (slope / length, -1 / length))


def mirrored(rng, image, body):
    """The picture as the body's edge mirrors it, the smaller the more the body is bent."""
    away = (1 + rng.uniform(0.5, 4)) * body.depth
    x, y = body.column + away * body.normal[0], body.row + away * body.normal[1]
    picture = cv2.remap(image, x.astype(np.float32), y.astype(np.float32), cv2.INTER_LINEAR,
                        borderMode=cv2.BORDER_REFLECT_101)
    return cv2.GaussianBlur(picture, (0, 0), rng.uniform(0.5, 5)).astype(np.float32)


def lacquer_color(rng, image, label):
    """BGR: of the floor itself, of the whole place, gray, or any."""
    kind, ground = rng.random(), image[label == DRIVABLE]
    if kind < 0.5 and len(ground):
        return ground.mean(0) * np.exp(rng.normal(0, 0.2)) + rng.normal(0, 6, 3)
    if kind < 0.6:
        return image.reshape(-1, 3).mean(0) * np.exp(rng.normal(0, 0.4)) + rng.normal(0, 6, 3)
    if kind < 0.85:
        return rng.uniform(8, 245) + rng.normal(0, 5, 3)
    return rng.uniform(5, 240, 3)


def lacquer(rng, image, label, body):
    """The bare body: its color, shaded across and along, and what it mirrors, most of all near its edge."""
    height = image.shape[0]
    level = (body.depth / (0.5 * height)).clip(0, 1)
    knots = np.linspace(0, 1, rng.integers(2, 6))
    across = np.interp(level, knots, np.exp(rng.normal(0, 0.25, len(knots))))
    along = np.exp(0.2 * smooth_noise(rng, image.shape[1], rng.integers(2, 6)))
    surface = lacquer_color(rng, image, label) * (across * along)[..., None]
    if rng.random() < 0.75:
        share = rng.uniform(0, 0.4) + rng.uniform(0, 0.6) * np.exp(-level / rng.uniform(0.05, 0.5))
        share = share[..., None]
        surface = surface * (1 - share) + share * mirrored(rng, image, body) * rng.uniform(0.6, 1.2)
    return surface


def add_lines(rng, surface, body):
    """The edge, where metal is bent or shadow lies, and seams along it; their width comes and goes."""
    width = surface.shape[1]
    places = [0.0] if rng.random() < 0.6 else []
    places += list(rng.uniform(3, 90, rng.integers(0, 4)))
    for place in places:
        half = rng.uniform(0.5, 4) * np.clip(1 + rng.uniform(0, 1) * smooth_noise(rng, width, 8), 0, 4)
        line = np.clip(half - np.abs(body.depth - place) + 0.5, 0, 1)[..., None] * rng.uniform(0.3, 1)
        tone = rng.uniform(0, 60) if rng.random() < 0.6 else rng.uniform(120, 255)
        surface = surface * (1 - line) + line * tone
    return surface


def texture_of_part(rng, image, shape):
    """Plates with letters, grilles, lamps: something else in place of the lacquer; h x w x 3."""
    kind, colors = rng.random(), rng.uniform(0, 255, (2, 3))
    if rng.random() < 0.5:
        colors = colors.mean(1, keepdims=True) + rng.normal(0, 6, (2, 3))
    if kind < 0.35:  # letters
        ink = rng.random((rng.integers(3, 8), rng.integers(6, 40))) < 0.4
        ink[0] = ink[-1] = False
    elif kind < 0.6:  # bars or a mesh
        rows, columns = rng.integers(1, 8), rng.integers(1, 50)
        ink = (np.arange(rows)[:, None] + (np.arange(columns) if rng.random() < 0.7 else 0)) % 2 > 0
        ink = np.broadcast_to(ink, (rows, columns))
    elif kind < 0.75:  # plain
        ink = np.zeros((1, 1), bool)
    else:  # a piece of the picture, which has all that a lamp shows
        height, width = image.shape[:2]
        x, y = rng.integers(0, width - 40), rng.integers(0, height - 30)
        piece = image[y : y + rng.integers(8, 120), x : x + rng.integers(8, 160)]
        return cv2.resize(piece, shape[::-1]).astype(np.float32) * np.exp(rng.normal(0, 0.3, 3))
    ink = cv2.resize(ink.astype(np.float32), shape[::-1], interpolation=cv2.INTER_NEAREST)[..., None]
    return colors[0] * (1 - ink) + colors[1] * ink


def add_part(rng, image, surface, body):
    """A part follows the body's edge; it may reach beyond it a little, like a bracket."""
    height, width = surface.shape[:2]
    left, length = rng.uniform(-0.1, 0.9) * width, rng.uniform(0.03, 0.6) * width
    begin, thick = rng.uniform(0, 50), rng.uniform(6, 70)
    texture = texture_of_part(rng, image, (64, 256)).astype(np.float32)
    along, across = (body.column - left) / length, (body.depth - begin) / thick
    if rng.random() < 0.35:
        inside = (2 * along - 1) ** 2 + (2 * across - 1) ** 2 < 1
    else:
        inside = (np.abs(along - 0.5) < 0.5) & (np.abs(across - 0.5) < 0.5)
    part = cv2.remap(texture, 255 * along, 63 * across, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    share = cv2.GaussianBlur(inside.astype(np.float32), (3, 3), 0)[..., None] * rng.uniform(0.5, 1)
    return surface * (1 - share) + share * part


def add_own_car(rng, image, label):
    """Paints a body over the picture, and 0 into `label` there; returns the picture."""
    body = shape_body(rng, image.shape[1::-1])
    if body is None:
        return image
    if rng.random() < 0.4:
        image = lead_stripes_to(rng, image, label, body)
    surface = lacquer(rng, image, label, body)
    for _ in range(rng.integers(0, 5) if rng.random() < 0.7 else 0):
        surface = add_part(rng, image, surface, body)
    surface = add_lines(rng, surface, body)
    if rng.random() < 0.3:  # dirt
        grain = rng.normal(0, rng.uniform(0.02, 0.1), [max(1, side // rng.integers(2, 12)) for side in body.depth.shape])
        surface = surface * np.exp(cv2.resize(grain, body.depth.shape[::-1]))[..., None]
    inside = np.clip(body.depth / rng.uniform(1, 3) + 0.5, 0, 1)[..., None]
    label[body.top :][body.depth > 0] = NOT_DRIVABLE
    painted = image.copy()
    painted[body.top :] = np.clip(image[body.top :] * (1 - inside) + surface * inside, 0, 255)
    return painted
