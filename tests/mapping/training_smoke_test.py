#!/usr/bin/env python3
"""Two steps of training on made-up pictures, exported and read by OpenCV. Skipped (77) where PyTorch is not installed.

training_smoke_test.py TRAINING_FOLDER
"""
import pathlib
import subprocess
import sys
import tempfile

try:
    import cv2
    import numpy as np
    import torch  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)


def write_picture(folder, name, rng):
    """A bright sky over a dark road."""
    classes = np.zeros((90, 120), np.uint8)
    classes[50:] = 3
    image = np.where(classes[..., None] == 3, 70, 200) + rng.normal(0, 5, (90, 120, 3))
    (folder / "images").mkdir(parents=True, exist_ok=True)
    (folder / "labels").mkdir(exist_ok=True)
    cv2.imwrite(str(folder / "images" / (name + ".jpg")), image.clip(0, 255).astype(np.uint8))
    cv2.imwrite(str(folder / "labels" / (name + ".png")), classes)


def main():
    training = pathlib.Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        rng = np.random.default_rng(1)
        for part in ("train", "val"):
            for name in "abc":
                write_picture(folder / "camvid" / part, name, rng)

        def run(script, *arguments):
            command = [sys.executable, "-B", str(training / script), *map(str, arguments)]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr
            return done.stdout

        log = run("train.py", "--camvid", folder / "camvid", "--drives", folder, "--steps", 2, "--batch", 2, "--out", folder / "a.pt")
        assert "step 2" in log and "camvid" in log, log
        assert "difference" in run("export.py", folder / "a.pt", folder / "a.onnx")
        figures = run("evaluate.py", folder / "a.onnx", "--camvid", folder / "camvid/val")
        assert "3 pictures, IoU" in figures, figures


if __name__ == "__main__":
    main()
