"""How pictures are shown to the network in training: as cameras take them, or level; by other lenses, mounted otherwise,
cropped, turned and mirrored.
"""
import cv2
import numpy as np

import classes as surfaces
import level_view
from islands import add_island
from pictures import DRIVABLE, NOT_DRIVABLE, UNKNOWN
from stripes import band_in_view, paint, paint_field, paint_stripe, random_polygon

EQUIDISTANT_FOCAL = 0.31  # of the simulator's fisheyes, in widths of the picture, to 2 %
KNOT = 8  # pixels between those that a bend is calculated for; sides of pictures are multiples of it


def knots_of(size):
    """Columns and rows, from the picture's middle, of a pixel in KNOT; one more all around."""
    u, v = (np.arange(-1, side // KNOT + 1) * KNOT + 0.5 * (KNOT - side) for side in size)
    return np.meshgrid(u, v)


def between_knots(values):
    """A float32 per pixel; bends are smooth, so that it is a tenth of a pixel off at most, but at the rims of a few."""
    rows, columns = values.shape
    fine = cv2.resize(values.astype(np.float32), (columns * KNOT, rows * KNOT), interpolation=cv2.INTER_LINEAR)
    return fine[KNOT:-KNOT, KNOT:-KNOT]


def affine_map(rng, source_size, size):
    """Random crop (or a little more than all), turn and stretch, as maps for cv2.remap."""
    width, height = size
    zoom = np.exp(rng.uniform(np.log(0.88), np.log(1.7)))
    stretch = np.exp(rng.normal(0, 0.06))
    angle = np.radians(rng.normal(0, 4))
    scale_x, scale_y = source_size[0] / width / zoom * stretch, source_size[1] / height / zoom / stretch
    slack = np.abs(1 - 1 / zoom) * 0.5 * np.array(source_size)
    center = 0.5 * np.array(source_size) + rng.uniform(-1, 1, 2) * slack
    u, v = knots_of(size)
    x = (u * np.cos(angle) - v * np.sin(angle)) * scale_x + center[0]
    y = (u * np.sin(angle) + v * np.cos(angle)) * scale_y + center[1]
    return between_knots(x), between_knots(y)


def bearing_of_fisheye(rng, size, half_angle):
    """Unit rays, at the knots, of a random fisheye: Kannala-Brandt's theta(r) with one coefficient, or Mei's sphere."""
    u, v = knots_of(size)
    radius = np.hypot(u, v) + 1e-9
    along = radius / (0.5 * size[0])
    if rng.random() < 0.5:
        bend = rng.uniform(-0.12, 0.12)
        theta = half_angle * along * (1 + bend * along**2) / (1 + bend)
    else:
        xi = rng.uniform(0.4, 1.2)
        focal = (np.cos(half_angle) + xi) / np.sin(half_angle)
        m = along / focal
        root = np.maximum(1 + (1 - xi**2) * m**2, 0)
        z = (xi + np.sqrt(root)) / (m**2 + 1)
        theta = np.arctan2(z * m, z - xi)
    return np.stack([np.sin(theta) * u / radius, np.sin(theta) * v / radius, np.cos(theta)], -1)


def turn(rng, rays, sigmas):
    """Rays of a camera mounted otherwise, by random angles about x, y and z [degrees]."""
    rotation, _ = cv2.Rodrigues(np.radians(rng.normal(0, sigmas)))
    return rays @ rotation.T


def other_fisheye_map(rng, source_size, size):
    """A picture of the simulator's fisheyes as another fisheye, mounted otherwise, would see it."""
    rays = turn(rng, bearing_of_fisheye(rng, size, np.radians(rng.uniform(55, 98))), [9, 9, 6])
    focal = EQUIDISTANT_FOCAL * source_size[0]
    along = np.hypot(rays[..., 0], rays[..., 1]) + 1e-9
    radius = focal * np.arctan2(along, rays[..., 2]) / along
    x = radius * rays[..., 0] + 0.5 * (source_size[0] - 1)
    y = radius * rays[..., 1] + 0.5 * (source_size[1] - 1)
    return between_knots(x), between_knots(y)


def fisheye_map(rng, source_size, size):
    """A plain picture, taken to have a random field of view, as a random fisheye would see it."""
    source_focal = 0.5 * source_size[0] / np.tan(np.radians(rng.uniform(32, 55)))
    half_angle = np.arctan(0.5 * source_size[0] / source_focal) * rng.uniform(0.7, 1.15)
    rays = turn(rng, bearing_of_fisheye(rng, size, half_angle), [7, 9, 5])
    depth = np.where(rays[..., 2] > 0.05, rays[..., 2], np.nan)
    x = rays[..., 0] / depth * source_focal + 0.5 * (source_size[0] - 1)
    y = rays[..., 1] / depth * source_focal + 0.5 * (source_size[1] - 1)
    return between_knots(np.nan_to_num(x, nan=-1e4)), between_knots(np.nan_to_num(y, nan=-1e4))


class CameraView:
    """Pictures of `size` (width, height) as cameras take them."""

    share_as_mapped = 0  # of pictures of calibrated cameras
    share_of_floors = 0.35  # that are painted
    share_of_kerbs = 0.15
    recycled_spread = (0.06, 0.18, 0.18, 0.12, 0.1)  # see recycling.grid_of

    def __init__(self, size):
        self.size = size

    def change_geometry(self, rng, picture):
        """Image, label, classes and weights as another camera would take them; what lies off the picture is black and, mostly,
        unknown."""
        source_size = picture.image.shape[1::-1]
        other_lens = other_fisheye_map if picture.is_fisheye else fisheye_map
        maps = (other_lens if rng.random() < 0.5 else affine_map)(rng, source_size, self.size)
        return bend(rng, picture, maps, random_border(rng))

    def share_of_own_cars(self, picture):
        return 0.65 if picture.is_fisheye else 0.25

    def paint_stripe(self, rng, floor):
        return paint_stripe(rng, floor, random_polygon(rng, self.size), where=1)

    def paint_field(self, rng, floor):
        return floor  # where the ground lies is not known

    def add_island(self, rng, image, label, classes):
        return image  # likewise


class LevelView:
    """Pictures as level_view.py shows them."""

    size = level_view.SIZE
    share_as_mapped = 0.55
    share_of_floors = 0.7
    share_of_kerbs = 0.25  # the more paint, the more of what looks like it
    recycled_spread = (0, 0.06, 0, 0.1, 0.008)

    def change_geometry(self, rng, picture):
        """Image, label, classes and weights as the view of another camera would show them."""
        u, v = knots_of(self.size)
        angles = level_view.angles_of(u + 0.5 * (self.size[0] - 1), v + 0.5 * (self.size[1] - 1))
        map_of = level_view.level_map_of_plain if picture.camera is None else level_view.level_map
        x, y = map_of(rng, picture, *angles)
        return bend(rng, picture, (between_knots(x), between_knots(y)), random_border(rng), picture.camera is not None)

    def show_as_mapped(self, rng, picture):
        """Image, label, classes and weights of a calibrated camera as maps show them to the network, but for a mirror."""
        return bend(rng, picture, level_view.view_map(picture.camera), cv2.BORDER_CONSTANT, is_enlarged=True)

    def share_of_own_cars(self, picture):
        return 0.25  # below the ground that such views are for

    def paint_stripe(self, rng, floor):
        return paint(rng, floor, band_in_view(rng))

    def paint_field(self, rng, floor):
        return paint_field(rng, floor)

    def add_island(self, rng, image, label, classes):
        return add_island(rng, image, label, classes)


def random_border(rng):
    return cv2.BORDER_CONSTANT if rng.random() < 0.7 else cv2.BORDER_REPLICATE


def bend(rng, picture, maps, border, is_enlarged=False):
    """Image, label, classes and weights at pixels (x, y) of the picture, or mirrored."""
    source_size = picture.image.shape[1::-1]
    x, y = maps
    if rng.random() < 0.5:
        x, y = x[:, ::-1].copy(), y[:, ::-1].copy()
    outside = UNKNOWN if rng.random() < 0.7 else NOT_DRIVABLE
    image = cv2.remap(picture.image, x, y, cv2.INTER_LINEAR, borderMode=border)
    label = cv2.remap(picture.label, x, y, cv2.INTER_NEAREST, borderMode=cv2.BORDER_CONSTANT, borderValue=outside)
    classes = cv2.remap(picture.classes, x, y, cv2.INTER_NEAREST, borderMode=cv2.BORDER_CONSTANT, borderValue=surfaces.UNKNOWN)
    if is_enlarged:  # outlines between the picture's pixels
        soft = cv2.GaussianBlur(picture.label, (3, 3), 0.6)
        share = cv2.remap(soft, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        is_inside = (np.abs(x / source_size[0] - 0.5) < 0.5) & (np.abs(y / source_size[1] - 0.5) < 0.5)
        label = np.where(is_inside, np.where(share > 127, DRIVABLE, NOT_DRIVABLE), outside).astype(np.uint8)
    weights = np.ones(label.shape, np.float32)
    if picture.weights is not None:
        weights = cv2.remap(picture.weights, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=1)
    return image, label, classes, weights
