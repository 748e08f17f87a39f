"""Labelled pictures: CamVid and drives of parkade-simulate (EuRoC folders with --semantic).

A label is one byte per pixel: 0 not drivable, 255 drivable, 128 unknown (left out of training and figures).
"""
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from ground_area import read_rig, weigh_pixels

NOT_DRIVABLE, UNKNOWN, DRIVABLE = 0, 128, 255
CAMVID_ROAD, CAMVID_UNLABELLED = 3, 11


@dataclass
class Picture:
    name: str
    image: np.ndarray  # H x W x 3, BGR
    label: np.ndarray  # H x W
    is_fisheye: bool
    weights: np.ndarray = None  # H x W, see ground_area.py; None: all the same
    camera: tuple = None  # see ground_area.read_rig; None: not known


def read_image(path, flags=cv2.IMREAD_COLOR):
    image = cv2.imread(str(path), flags)
    if image is None:
        raise SystemExit(f"cannot read the picture {path}")
    return image


def input_size(image, limit):
    """(width, height) at which Parkade runs its own network: in the picture's proportions, sides rounded up to multiples of
    32."""
    scale = min(limit[0] / image.shape[1], limit[1] / image.shape[0])
    return tuple(32 * int(np.ceil(scale * length / 32 - 1e-6)) for length in image.shape[1::-1])


def load_camvid(folder):
    """Pictures of `folder`/images with class masks of the same name in `folder`/labels."""
    pictures = []
    for path in sorted((Path(folder) / "images").glob("*.jpg")):
        classes = read_image(Path(folder) / "labels" / (path.stem + ".png"), cv2.IMREAD_GRAYSCALE)
        label = np.where(classes == CAMVID_ROAD, DRIVABLE, NOT_DRIVABLE).astype(np.uint8)
        label[classes == CAMVID_UNLABELLED] = UNKNOWN
        pictures.append(Picture(path.name, read_image(path), label, is_fisheye=False))
    return pictures


def load_drive(folder):
    """Pictures of a simulated drive."""
    pictures = []
    rig = read_rig(Path(folder) / "rig_true")
    weights = {name: weigh_pixels(*camera) for name, camera in rig.items()}
    for path in sorted(Path(folder).glob("mav0/cam*/data/*.jpg")):
        mask_path = path.parents[1] / "semantic" / "data" / (path.stem + ".png")
        if not mask_path.exists():
            continue
        image, label = read_image(path), read_image(mask_path, cv2.IMREAD_GRAYSCALE)
        camera = path.parents[1].name
        name = f"{Path(folder).name}/{camera}/{path.stem}"
        pictures.append(Picture(name, image, label, True, weights[camera], rig[camera]))
    return pictures


def finished_drives(folder):
    """Drives below `folder` that are complete: the simulator writes summary.json last."""
    return sorted(summary.parent for summary in Path(folder).glob("*/summary.json"))
