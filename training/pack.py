#!/usr/bin/env python3
"""Packs labelled pictures into one small file that travels to the machine that trains; see README.md.

    pack.py --camvid CAMVID/train --drives DRIVES/train --every 3 --out pictures.zip

Pictures are WebP, labels of classes PNG. Of drives, every so many-th picture of a camera is taken.
"""
import argparse
import json
import zipfile
from pathlib import Path

import cv2
import numpy as np

import pictures
from ground_area import read_rig


def encoded(kind, image, *how):
    done, code = cv2.imencode(kind, image, list(how))
    if not done:
        raise SystemExit(f"OpenCV cannot write {kind}")
    return code.tobytes()


def add(archive, name, image, classes, quality):
    archive.writestr(name + ".webp", encoded(".webp", image, cv2.IMWRITE_WEBP_QUALITY, quality))
    archive.writestr(name + ".png", encoded(".png", classes, cv2.IMWRITE_PNG_COMPRESSION, 9))


def as_json(camera):
    return [value.tolist() if isinstance(value, np.ndarray) else value for value in camera]


def pack(arguments):
    with zipfile.ZipFile(arguments.out, "w", zipfile.ZIP_STORED) as archive:
        for picture in pictures.load_camvid(arguments.camvid) if arguments.camvid else []:
            add(archive, "plain/" + Path(picture.name).stem, picture.image, picture.classes, arguments.quality)
        rigs = {}
        for place, drive in enumerate(pictures.finished_drives(arguments.drives)):
            rigs[drive.name] = {name: as_json(camera) for name, camera in read_rig(drive / "rig_true").items()}
            # Another phase per place and camera, so that one camera's neighbor is seen at another time.
            for index, (name, path) in enumerate(sorted((p.parents[1].name, p) for p in drive.glob("mav0/cam*/data/*.jpg"))):
                mask = path.parents[1] / "semantic" / "data" / (path.stem + ".png")
                if (index + place) % arguments.every == 0 and mask.exists():
                    add(archive, f"drives/{drive.name}/{name}/{path.stem}", pictures.read_image(path),
                        pictures.read_image(mask, cv2.IMREAD_GRAYSCALE), arguments.quality)
        archive.writestr("rigs.json", json.dumps(rigs))
    print(f"{arguments.out}: {Path(arguments.out).stat().st_size / 1e6:.1f} MB")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--camvid", help="folder with images/ and labels/")
    parser.add_argument("--drives", required=True, help="folder of simulated drives")
    parser.add_argument("--every", type=int, default=3)
    parser.add_argument("--quality", type=int, default=65, help="of WebP, 1 to 100")
    parser.add_argument("--out", required=True)
    pack(parser.parse_args())


if __name__ == "__main__":
    main()
