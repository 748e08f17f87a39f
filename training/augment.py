"""What is done to pictures so that the network does not learn ours by heart: geometry (views.py), light, color, blur, noise,
darkness toward the rim; painted and shining floors; other land (lands.py); bodies of other own cars (own_car.py).
"""
import cv2
import numpy as np

import classes as surfaces
from colors import normals, to_bytes
from kerbs import add_kerb
from lands import repaint_land
from own_car import add_own_car
from pictures import DRIVABLE, NOT_DRIVABLE, UNKNOWN
from walls import paint_walls, smooth_walls

SHARE_OF_ISLANDS = 0.5
MOST_CHANGE = 12  # of a channel: what changes more is painted over


def half_plane(rng, size):
    """0 to 1: what lies on one side of a line through the picture."""
    width, height = size
    angle = rng.uniform(0, 2 * np.pi)
    through = rng.uniform([0.1 * width, 0.3 * height], [0.9 * width, 0.9 * height])
    u, v = np.ogrid[:height, :width][::-1]
    side = np.float32((u - through[0]) * np.cos(angle)) + np.float32((v - through[1]) * np.sin(angle))
    return np.clip(side + 0.5, 0, 1)[..., None]


def paint_floor(rng, image, label, view):
    """Tint, shine, wide lines, fields between lines and a second color on what is drivable; the label stays."""
    size = image.shape[1::-1]
    ground = cv2.GaussianBlur((label == DRIVABLE).astype(np.float32), (3, 3), 0)[..., None]
    floor = image.astype(np.float32)
    if rng.random() < 0.6:
        floor = floor * np.exp(normals(rng, 0, 0.22, 3)) + normals(rng, 0, 8, 3)
    if rng.random() < 0.4:  # floors of two colors
        other = floor.mean() if rng.random() < 0.5 else floor
        other = (0.7 * other + 0.3 * floor) * np.exp(normals(rng, 0, 0.3) + normals(rng, 0, 0.2, 3))
        side = half_plane(rng, size)
        floor = floor * (1 - side) + other * side
    if rng.random() < 0.4:  # what stands above the horizon, mirrored
        floor = floor + np.float32(rng.uniform(0.05, 0.35)) * np.roll(image[::-1], rng.integers(-40, 40), 0)
    if rng.random() < 0.5:
        floor = view.paint_field(rng, floor)
    if rng.random() < 0.6:
        for _ in range(rng.integers(1, 4)):
            floor = view.paint_stripe(rng, floor)
    return to_bytes(image * (1 - ground) + floor * ground)


def paint_over(change, rng, image, label, classes, found):
    """What `change(rng, image, label)` makes of the picture; where it writes 0 into the label, `found` is seen."""
    marked = np.where(label == DRIVABLE, DRIVABLE, UNKNOWN).astype(np.uint8)
    image = change(rng, image, marked)
    is_painted = marked == NOT_DRIVABLE
    label[is_painted], classes[is_painted] = NOT_DRIVABLE, found
    return image


def change_ground(rng, image, label, classes, view):
    """Other land and floors, and kerbs and islands on some."""
    image = repaint_land(rng, image, classes)
    if rng.random() < view.share_of_floors:
        image = paint_floor(rng, image, label, view)
        classes[label == DRIVABLE] = surfaces.ROAD
    if rng.random() < view.share_of_kerbs:
        image = paint_over(add_kerb, rng, image, label, classes, surfaces.KERB)
    return view.add_island(rng, image, label, classes) if rng.random() < SHARE_OF_ISLANDS else image


def change_walls(rng, picture, image, label, classes):
    """Other walls; what is painted over is no class any more."""
    before = image
    # Along a street no wall stands on the outline but a pavement lies behind it, which must not pass for floor.
    if picture.is_fisheye and not picture.name.startswith("street") and rng.random() < 0.35:
        image = smooth_walls(rng, image, label)
    if rng.random() < 0.5:
        image = paint_walls(rng, image, label)
    if image is not before:
        is_painted = (cv2.absdiff(image, before).max(2) > MOST_CHANGE) & (label != DRIVABLE)
        classes[is_painted] = surfaces.UNKNOWN
    return image


def add_lens_rim(rng, image, label):
    """Darkness outside of the image circle, and toward it."""
    height, width = label.shape
    u, v = np.linspace(-1, 1, width), np.linspace(-1, 1, height)[:, None] * height / width
    radius = np.hypot(np.float32(u - rng.normal(0, 0.03)), np.float32(v - rng.normal(0, 0.03)))
    rim = rng.uniform(0.85, 1.15)
    softness = rng.uniform(0.01, 0.15)
    light = np.clip((rim - radius) / softness, 0, 1)
    label[radius > rim - 0.3 * softness] = NOT_DRIVABLE
    glow = np.float32(rng.uniform(0, 25, 3))
    return to_bytes(image * light[..., None] + glow * (1 - light[..., None]))


def change_light(rng, image):
    """Exposure, contrast, gamma, white balance, saturation: one table per channel."""
    if rng.random() < 0.15:
        image = cv2.cvtColor(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)
    elif rng.random() < 0.5:
        hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV)
        hsv[..., 0] = (hsv[..., 0].astype(int) + rng.integers(-12, 13)) % 180
        hsv[..., 1] = np.clip(hsv[..., 1] * rng.uniform(0.3, 1.7), 0, 255)
        image = cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR)
    level = np.arange(256) / 255.0
    gamma, gain = np.exp(rng.normal(0, 0.28)), np.exp(rng.normal(0, 0.22))
    tables = [255 * np.exp(rng.normal(0, 0.08)) * gain * level**gamma + rng.normal(0, 8) for _ in range(3)]
    table = np.clip(np.stack(tables, -1), 0, 255).astype(np.uint8)[None]
    return cv2.LUT(image, table)


def roughen(rng, image):
    """Blur of focus or motion, noise of the sensor, blocks of JPEG."""
    if rng.random() < 0.3:
        image = cv2.GaussianBlur(image, (0, 0), rng.uniform(0.4, 1.6))
    if rng.random() < 0.15:
        kernel = np.zeros((7, 7), np.float32)
        angle = rng.uniform(0, np.pi)
        offset = 3 * np.array([np.cos(angle), np.sin(angle)])
        cv2.line(kernel, tuple(np.int32(3 - offset).tolist()), tuple(np.int32(np.round(3 + offset)).tolist()), 1)
        image = cv2.filter2D(image, -1, kernel / kernel.sum())
    if rng.random() < 0.4:
        shape = image.shape[:2] + (1 if rng.random() < 0.5 else 3,)
        image = to_bytes(image + np.float32(rng.uniform(1, 9)) * rng.standard_normal(shape, np.float32))
    if rng.random() < 0.15:
        _, code = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, int(rng.uniform(30, 80))])
        image = cv2.imdecode(code, cv2.IMREAD_COLOR)
    return image


def augment(rng, picture, view):
    """A picture never seen before, in a view of views.py, its labels and its weights. A share is shown as maps show it, most of
    that unchanged: what is bent and painted keeps the network from learning ours by heart, what is not shows it how sharp
    outlines can be seen."""
    if picture.camera is not None and rng.random() < view.share_as_mapped:
        image, label, classes, weights = view.show_as_mapped(rng, picture)
        if rng.random() < 0.35:
            image = change_ground(rng, image, label, classes, view)
        return change_light(rng, image) if rng.random() < 0.5 else image, label, classes, weights
    image, label, classes, weights = view.change_geometry(rng, picture)
    image = change_ground(rng, image, label, classes, view)
    image = change_walls(rng, picture, image, label, classes)
    if rng.random() < view.share_of_own_cars(picture):
        image = paint_over(add_own_car, rng, image, label, classes, surfaces.OWN_CAR)
    image = change_light(rng, image)
    if rng.random() < 0.2:
        image = paint_over(add_lens_rim, rng, image, label, classes, surfaces.UNKNOWN)
    return roughen(rng, image), label, classes, weights
