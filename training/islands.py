"""Islands and verges that stand up behind kerbs, on the ground of level views: lawns, soil, gravel and paving of any color behind
stones of any color; and areas of the same shapes that are but framed by paint, which can be driven on.
"""
import cv2
import numpy as np

import classes as surfaces
from colors import normals, to_bytes
from lands import GROWN, PAVED, color_of, grain
from pictures import DRIVABLE, NOT_DRIVABLE
from stripes import change_per_pixel, ground_of_view, log_uniform, paint, share_below

SHARE_OF_FRAMES = 0.45
STEPS = 5  # between a kerb's foot and its top


def shape_island(rng):
    """A function that gives the signed distance [heights of the camera] to the island's rim, negative within, of ground points:
    a rounded rectangle beside the car, or all that lies beyond a line, as pavements and verges do."""
    toward, reach = rng.uniform(0, 2 * np.pi), log_uniform(rng, 0.9, 7)
    along, across = np.array([np.cos(toward), np.sin(toward)]), np.array([-np.sin(toward), np.cos(toward)])
    lean = rng.uniform(0, np.pi)
    if rng.random() < 0.35:
        return lambda right, ahead: np.float32(reach) - (right * np.float32(along[0]) + ahead * np.float32(along[1]))
    half = np.array([log_uniform(rng, 0.5, 8), log_uniform(rng, 0.4, 5)])
    round_by = rng.uniform(0, 1) * half.min()
    # The nearest corner lies `reach` away or farther.
    center = along * (reach + np.hypot(*half) * rng.uniform(0.3, 1)) + across * rng.normal(0, 1)

    def distance(right, ahead):
        x, y = right - np.float32(center[0]), ahead - np.float32(center[1])
        u = np.abs(x * np.float32(np.cos(lean)) + y * np.float32(np.sin(lean))) - np.float32(half[0] - round_by)
        v = np.abs(y * np.float32(np.cos(lean)) - x * np.float32(np.sin(lean))) - np.float32(half[1] - round_by)
        return np.hypot(np.maximum(u, 0), np.maximum(v, 0)) + np.minimum(np.maximum(u, v), 0) - np.float32(round_by)

    return distance


def stone_color(rng, island):
    kind = rng.random()
    if kind < 0.6:  # concrete, granite, white paint
        return rng.uniform(70, 250) * np.exp(rng.normal(0, 0.04, 3))
    if kind < 0.8:  # hardly told from what lies behind
        return island * np.exp(rng.normal(0, 0.15))
    return rng.uniform(20, 240, 3)


def paint_frame(rng, image, label, classes, distance):
    """A painted line along an outline, and at times another shade of floor within."""
    ground = label == DRIVABLE
    half_width = rng.uniform(0.03, 0.13)
    where = cv2.GaussianBlur(ground.astype(np.float32), (3, 3), 0)[..., None]
    if rng.random() < 0.3:
        within = np.nan_to_num(np.clip(0.5 - distance / change_per_pixel(distance), 0, 1))[..., None] * where
        image = image * (1 + within * (np.exp(normals(rng, 0, 0.15) + normals(rng, 0, 0.06, 3)) - 1))
    line = share_below(np.abs(distance), half_width)
    classes[ground & (line > 0.5)] = surfaces.MARKING
    return to_bytes(paint(rng, image.astype(np.float32), line[..., None] * where))


def add_island(rng, image, label, classes):
    """The picture of a level view with an island, or the frame of one, on its drivable ground; `label` and `classes` say so."""
    right, ahead = ground_of_view()
    distance = shape_island(rng)
    if rng.random() < SHARE_OF_FRAMES:
        return paint_frame(rng, image, label, classes, distance(right, ahead))
    height, stone = rng.uniform(0.05, 0.25), rng.uniform(0.06, 0.25)  # heights of the camera
    on_top = distance(right * np.float32(1 - height), ahead * np.float32(1 - height))
    lowest = on_top.copy()  # smallest along the ray below the top: what the island or its face hides
    for step in range(STEPS):
        scale = np.float32(1 - height * step / STEPS)
        lowest = np.minimum(lowest, distance(right * scale, ahead * scale))
    ground = label == DRIVABLE
    with np.errstate(invalid="ignore"):
        covers = (lowest < 0) & ground
        is_top = covers & (on_top < 0)
        is_stone = is_top & (on_top > -stone)
    if covers.sum() < 200 or covers.sum() > 0.6 * ground.sum():
        return image
    grows = rng.random() < 0.65
    color = color_of(rng, GROWN if grows else PAVED)
    own = rng.random() < 0.2  # of the floor's own material
    texture = image.astype(np.float32) - cv2.GaussianBlur(image, (0, 0), 4)
    light = cv2.GaussianBlur(image.max(2), (0, 0), 5).astype(np.float32) / max(float(image.max(2)[ground].mean()), 1)
    inside = image * np.exp(normals(rng, 0, 0.12, 3)) if own else color * np.clip(light, 0.3, 1.6)[..., None]
    inside = inside * (1 + np.float32(rng.uniform(0.2, 1)) * grain(rng, label.shape)) + np.float32(rng.uniform(0, 0.8)) * texture
    top = stone_color(rng, inside[covers].mean(0)) * np.exp(rng.normal(0, 0.1))
    face = top * np.exp(rng.normal(-0.3, 0.3))
    worn = 1 + np.float32(rng.uniform(0.1, 0.6)) * grain(rng, label.shape)
    painted = np.where(is_stone[..., None], np.float32(top) * worn, inside)
    painted = np.where((covers & ~is_top)[..., None], np.float32(face) * worn, painted)
    soft = np.nan_to_num(np.clip(0.5 - lowest / change_per_pixel(lowest), 0, 1))
    share = (soft * cv2.GaussianBlur(covers.astype(np.float32), (3, 3), 0))[..., None]
    if rng.random() < 0.4:  # dirt, water or a shadow at the foot
        near = np.nan_to_num(np.exp(-np.maximum(lowest, 0) / np.float32(rng.uniform(0.03, 0.2)))) * ground
        image = image * (1 - near[..., None] * np.float32(rng.uniform(0.1, 0.5)))
    label[covers] = NOT_DRIVABLE
    classes[covers] = surfaces.VEGETATION if grows and not own else surfaces.PAVEMENT
    classes[is_stone | (covers & ~is_top)] = surfaces.KERB
    return to_bytes(image * (1 - share) + painted * share)
