"""Labelled pictures: CamVid and drives of parkade-simulate (EuRoC folders with --semantic and classes in their masks).

A label is one byte per pixel: 0 not drivable, 255 drivable, 128 unknown (left out of training and figures). Beside it are
labels of classes (classes.py).
"""
import json
import zipfile
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

import classes as surfaces
from ground_area import read_rig, weigh_pixels

NOT_DRIVABLE, UNKNOWN, DRIVABLE = 0, 128, 255


@dataclass
class Picture:
    name: str
    image: np.ndarray  # H x W x 3, BGR
    label: np.ndarray  # H x W
    classes: np.ndarray  # H x W
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


def label_of(classes):
    """What labels of classes say about driving."""
    is_drivable = (classes < surfaces.NUM_FREE) | (classes == surfaces.ROAD)
    label = np.where(is_drivable, DRIVABLE, NOT_DRIVABLE).astype(np.uint8)
    label[classes == surfaces.UNKNOWN] = UNKNOWN
    return label


def load_camvid(folder):
    """Pictures of `folder`/images with class masks of the same name in `folder`/labels."""
    pictures = []
    for path in sorted((Path(folder) / "images").glob("*.jpg")):
        of_camvid = read_image(Path(folder) / "labels" / (path.stem + ".png"), cv2.IMREAD_GRAYSCALE)
        classes = surfaces.OF_CAMVID[of_camvid]
        pictures.append(Picture(path.name, read_image(path), label_of(classes), classes, is_fisheye=False))
    return pictures


def of_fisheye(name, image, classes, camera, weights):
    """A picture of a drive; off the lens, nothing can be driven on."""
    label = np.where(classes < surfaces.NUM_FREE, DRIVABLE, NOT_DRIVABLE).astype(np.uint8)
    return Picture(name, image, label, classes, True, weights, camera)


def load_drive(folder):
    """Pictures of a simulated drive."""
    pictures = []
    rig = read_rig(Path(folder) / "rig_true")
    weights = {name: weigh_pixels(*camera) for name, camera in rig.items()}
    for path in sorted(Path(folder).glob("mav0/cam*/data/*.jpg")):
        mask_path = path.parents[1] / "semantic" / "data" / (path.stem + ".png")
        if not mask_path.exists():
            continue
        camera = path.parents[1].name
        name = f"{Path(folder).name}/{camera}/{path.stem}"
        pictures.append(of_fisheye(name, read_image(path), read_image(mask_path, cv2.IMREAD_GRAYSCALE), rig[camera], weights[camera]))
    return pictures


def decoded(archive, name, flags):
    return cv2.imdecode(np.frombuffer(archive.read(name), np.uint8), flags)


def load_pack(path):
    """Plain pictures and those of drives in a file of pack.py."""
    plain, fisheye = [], []
    with zipfile.ZipFile(path) as archive:
        rigs = {(drive, name): (size, *(np.array(part) for part in parts))
                for drive, rig in json.loads(archive.read("rigs.json")).items() for name, (size, *parts) in rig.items()}
        weights = {key: weigh_pixels(*camera) for key, camera in rigs.items()}
        for member in sorted(name for name in archive.namelist() if name.endswith(".webp")):
            name = member[: -len(".webp")]
            image, classes = decoded(archive, member, cv2.IMREAD_COLOR), decoded(archive, name + ".png", cv2.IMREAD_GRAYSCALE)
            kind, _, name = name.partition("/")
            if kind == "plain":
                plain.append(Picture(name, image, label_of(classes), classes, is_fisheye=False))
            else:
                key = tuple(name.split("/")[:2])
                fisheye.append(of_fisheye(name, image, classes, rigs[key], weights[key]))
    return plain, fisheye


def finished_drives(folder):
    """Drives below `folder` that are complete: the simulator writes summary.json last."""
    return sorted(summary.parent for summary in Path(folder).glob("*/summary.json"))
