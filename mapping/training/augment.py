"""What is done to pictures so that the network does not learn ours by heart.

Geometry: crops, turns, mirrors; pictures of a plain lens are bent as a fisheye would see them. Appearance: light,
colour, blur, noise, darkness towards the rim; painted and shining floors; bodies of other own cars (own_car.py).
"""
import cv2
import numpy as np

from colors import normals, to_bytes
from kerbs import add_kerb
from level_view import SIZE as LEVEL_SIZE
from level_view import angles_of, level_map, level_map_of_plain, view_map
from own_car import add_own_car
from pictures import DRIVABLE, NOT_DRIVABLE, UNKNOWN
from stripes import band_in_view, paint, paint_stripe
from walls import paint_walls, smooth_walls

EQUIDISTANT_FOCAL = 0.31  # of the simulator's fisheyes, in widths of the picture, to 2 %
AS_MAPPED_SHARE = 0.4  # of level views of calibrated cameras
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


def random_level_map(rng, picture):
    """A picture as a level view (level_view.py) of another camera would show it."""
    u, v = knots_of(LEVEL_SIZE)
    angles = angles_of(u + 0.5 * (LEVEL_SIZE[0] - 1), v + 0.5 * (LEVEL_SIZE[1] - 1))
    x, y = (level_map_of_plain if picture.camera is None else level_map)(rng, picture, *angles)
    return between_knots(x), between_knots(y)


def random_map(rng, picture, size):
    """A picture of `size` as another camera would take it."""
    source_size = picture.image.shape[1::-1]
    other_lens = other_fisheye_map if picture.is_fisheye else fisheye_map
    return (other_lens if rng.random() < 0.5 else affine_map)(rng, source_size, size)


def change_geometry(rng, picture, size):
    """Image, label and weights of `size`; what lies off the picture is black and, mostly, unknown."""
    maps = random_level_map(rng, picture) if size == LEVEL_SIZE else random_map(rng, picture, size)
    border = cv2.BORDER_CONSTANT if rng.random() < 0.7 else cv2.BORDER_REPLICATE
    return bend(rng, picture, maps, border, is_enlarged=picture.camera is not None and size == LEVEL_SIZE)


def bend(rng, picture, maps, border, is_enlarged):
    """Image, label and weights at pixels (x, y) of the picture, or mirrored."""
    source_size = picture.image.shape[1::-1]
    x, y = maps
    if rng.random() < 0.5:
        x, y = x[:, ::-1].copy(), y[:, ::-1].copy()
    outside = UNKNOWN if rng.random() < 0.7 else NOT_DRIVABLE
    image = cv2.remap(picture.image, x, y, cv2.INTER_LINEAR, borderMode=border)
    label = cv2.remap(picture.label, x, y, cv2.INTER_NEAREST, borderMode=cv2.BORDER_CONSTANT, borderValue=outside)
    if is_enlarged:  # outlines between the picture's pixels
        soft = cv2.GaussianBlur(picture.label, (3, 3), 0.6)
        share = cv2.remap(soft, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        is_inside = (np.abs(x / source_size[0] - 0.5) < 0.5) & (np.abs(y / source_size[1] - 0.5) < 0.5)
        label = np.where(is_inside, np.where(share > 127, DRIVABLE, NOT_DRIVABLE), outside).astype(np.uint8)
    weights = np.ones(label.shape, np.float32)
    if picture.weights is not None:
        weights = cv2.remap(picture.weights, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=1)
    return image, label, weights


def show_as_mapped(rng, picture):
    """A calibrated camera's level view as maps show it to the network, but mirrored or in another light: what is painted
    and bent keeps it from learning ours by heart, what is not shows it how sharp outlines can be seen."""
    image, label, weights = bend(rng, picture, view_map(picture.camera), cv2.BORDER_CONSTANT, is_enlarged=True)
    return change_light(rng, image) if rng.random() < 0.5 else image, label, weights


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


def half_plane(rng, size):
    """0 to 1: what lies on one side of a line through the picture."""
    width, height = size
    angle = rng.uniform(0, 2 * np.pi)
    through = rng.uniform([0.1 * width, 0.3 * height], [0.9 * width, 0.9 * height])
    u, v = np.ogrid[:height, :width][::-1]
    side = np.float32((u - through[0]) * np.cos(angle)) + np.float32((v - through[1]) * np.sin(angle))
    return np.clip(side + 0.5, 0, 1)[..., None]


def paint_floor(rng, image, label):
    """Tint, shine, wide lines and a second colour on what is drivable; the label stays."""
    size = image.shape[1::-1]
    ground = cv2.GaussianBlur((label == DRIVABLE).astype(np.float32), (3, 3), 0)[..., None]
    floor = image.astype(np.float32)
    if rng.random() < 0.6:
        floor = floor * np.exp(normals(rng, 0, 0.22, 3)) + normals(rng, 0, 8, 3)
    if rng.random() < 0.4:  # floors of two colours
        other = floor.mean() if rng.random() < 0.5 else floor
        other = (0.7 * other + 0.3 * floor) * np.exp(normals(rng, 0, 0.3) + normals(rng, 0, 0.2, 3))
        side = half_plane(rng, size)
        floor = floor * (1 - side) + other * side
    if rng.random() < 0.4:  # what stands above the horizon, mirrored
        floor = floor + np.float32(rng.uniform(0.05, 0.35)) * np.roll(image[::-1], rng.integers(-40, 40), 0)
    if rng.random() < 0.6:
        for _ in range(rng.integers(1, 4)):
            if size == LEVEL_SIZE:
                floor = paint(rng, floor, band_in_view(rng))
            else:
                floor = paint_stripe(rng, floor, random_polygon(rng, size), where=1)
    return to_bytes(image * (1 - ground) + floor * ground)


def add_lens_rim(rng, image, label):
    """Darkness outside of the image circle, and towards it."""
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


def share_of_own_cars(picture, size):
    if size == LEVEL_SIZE:
        return 0.25  # below the ground that such views are for
    return 0.65 if picture.is_fisheye else 0.25


def augment(rng, picture, size):
    """A picture of `size` (width, height) never seen before, its label and its weights."""
    if size == LEVEL_SIZE and picture.camera is not None and rng.random() < AS_MAPPED_SHARE:
        return show_as_mapped(rng, picture)
    image, label, weights = change_geometry(rng, picture, size)
    if rng.random() < (0.5 if size == LEVEL_SIZE else 0.35):
        image = paint_floor(rng, image, label)
    if rng.random() < 0.15:
        image = add_kerb(rng, image, label)
    # Along a street no wall stands on the outline but a pavement lies behind it, which must not pass for floor.
    if picture.is_fisheye and not picture.name.startswith("street") and rng.random() < 0.35:
        image = smooth_walls(rng, image, label)
    if rng.random() < 0.5:
        image = paint_walls(rng, image, label)
    if rng.random() < share_of_own_cars(picture, size):
        image = add_own_car(rng, image, label)
    image = change_light(rng, image)
    if rng.random() < 0.2:
        image = add_lens_rim(rng, image, label)
    return roughen(rng, image), label, weights
