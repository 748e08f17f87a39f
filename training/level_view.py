"""Pictures of calibrated cameras as mapping/networks/level_view.h shows them to the network: columns are azimuths, rows are
elevations, and rows are dense where the ground is far.
"""
import cv2
import numpy as np

import classes as surfaces
from pictures import DRIVABLE, NOT_DRIVABLE, Picture

SIZE = (832, 288)  # width, height
AZIMUTH_STEP = 0.23  # [degrees] per column; column 0 is the leftmost
# Elevation of a row: PIVOT - SPREAD sinh((row + 0.5 - PIVOT_ROW) FINEST / SPREAD).
PIVOT, SPREAD, FINEST, PIVOT_ROW = -6.0, 12.0, 0.142, 93.0  # degrees, degrees per row at the pivot
MAX_THETA = np.radians(110)  # from the optical axis: no lens sees farther


def angles_of(columns, rows):
    """Azimuth to the right of the view's middle and elevation [rad] of pixels of the view."""
    azimuth = np.radians((columns + 0.5 - SIZE[0] / 2) * AZIMUTH_STEP)
    elevation = np.radians(PIVOT - SPREAD * np.sinh((rows + 0.5 - PIVOT_ROW) * FINEST / SPREAD))
    return azimuth, elevation


def pixel_of(azimuth, elevation):
    """Inverse of angles_of."""
    columns = np.degrees(azimuth) / AZIMUTH_STEP + SIZE[0] / 2 - 0.5
    rows = np.arcsinh((PIVOT - np.degrees(elevation)) / SPREAD) * SPREAD / FINEST + PIVOT_ROW - 0.5
    return columns, rows


def rays_of(azimuth, elevation, heading):
    """Unit rays in body (z up), `heading` [rad] being the azimuth of the view's middle from body's x to its y."""
    toward = heading - azimuth
    return np.stack([np.cos(elevation) * np.cos(toward), np.cos(elevation) * np.sin(toward), np.sin(elevation)], -1)


def heading_of(body_from_camera):
    """Azimuth [rad] of the optical axis."""
    return np.arctan2(body_from_camera[1, 2], body_from_camera[0, 2])


def project(rays_in_camera, matrix, coefficients):
    """Pixels of the equidistant fisheye, also beyond 90 degrees; -1e4 where no lens sees."""
    x, y, z = np.moveaxis(rays_in_camera, -1, 0)
    along = np.hypot(x, y) + 1e-12
    theta = np.arctan2(along, z)
    square = theta**2
    k = coefficients
    bent = theta * (1 + square * (k[0] + square * (k[1] + square * (k[2] + square * k[3])))) / along
    is_seen = theta < MAX_THETA
    return (np.where(is_seen, matrix[0, 0] * bent * x + matrix[0, 2], -1e4),
            np.where(is_seen, matrix[1, 1] * bent * y + matrix[1, 2], -1e4))


def view_map(camera):
    """Pixels (x, y; float32) of a camera of ground_area.read_rig at every pixel of its level view."""
    _, matrix, coefficients, body_from_camera = camera
    columns, rows = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    rays = rays_of(*angles_of(columns, rows), heading_of(body_from_camera))
    x, y = project(rays @ body_from_camera[:3, :3], matrix, coefficients)
    return x.astype(np.float32), y.astype(np.float32)


def show(image, maps, how=cv2.INTER_LINEAR, beyond=0):
    """The level view of a picture; what lies off it is black, or `beyond`."""
    return cv2.remap(image, *maps, how, borderMode=cv2.BORDER_CONSTANT, borderValue=beyond)


def as_seen_level(picture):
    """A picture of a drive and its label as the level view shows them."""
    maps = view_map(picture.camera)
    label = np.where(show(picture.label, maps) > 127, DRIVABLE, NOT_DRIVABLE).astype(np.uint8)
    classes = show(picture.classes, maps, cv2.INTER_NEAREST, surfaces.UNKNOWN)
    return Picture(picture.name, show(picture.image, maps), label, classes, True)


def seen_otherwise(rng, azimuth, elevation):
    """The same angles of a camera at another height, turned a little, of another lens: the ground stays a plane."""
    azimuth = azimuth * np.exp(rng.normal(0, 0.1)) + np.radians(rng.uniform(-15, 15))
    height = np.exp(rng.uniform(np.log(0.7), np.log(1.45)))
    lean, nod = np.radians(rng.normal(0, 0.7, 2))
    elevation = np.arctan(np.tan(elevation) / height) + nod * np.cos(azimuth) + lean * np.sin(azimuth)
    return azimuth, elevation


def level_map(rng, picture, azimuth, elevation):
    """Maps for cv2.remap of a picture whose camera is known."""
    _, matrix, coefficients, body_from_camera = picture.camera
    rays = rays_of(*seen_otherwise(rng, azimuth, elevation), heading_of(body_from_camera))
    return project(rays @ body_from_camera[:3, :3], matrix, coefficients)


def level_map_of_plain(rng, picture, azimuth, elevation):
    """Maps for cv2.remap of a plain picture, taken to be level and to have a random field of view. It is widened, since a
    fisheye sees more."""
    width, height = picture.image.shape[1::-1]
    focal = 0.5 * width / np.tan(np.radians(rng.uniform(25, 40)))
    azimuth = azimuth / rng.uniform(1.4, 2.4) + np.radians(rng.normal(0, 6))
    elevation = elevation / rng.uniform(0.9, 2.2) + np.radians(rng.normal(0, 2)) + np.radians(rng.normal(0, 3)) * azimuth
    x = focal * np.tan(azimuth) + 0.5 * (width - 1)
    y = -focal * np.tan(elevation) / np.cos(azimuth) + 0.5 * (height - 1)
    return x, y
