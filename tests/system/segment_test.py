#!/usr/bin/env python3
"""`parkade segment` and `--freespace-model` from the outside.

segment_test.py PARKADE
"""

import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

PARKADE = sys.argv.pop(1)


def run(*arguments):
    return subprocess.run([PARKADE, *map(str, arguments)], capture_output=True, text=True, timeout=120)


def write_png(path, width, height):
    rows = b"".join(b"\0" + bytes((x * 37 + y * 91) % 256 for x in range(width)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def size_of(path):
    return struct.unpack(">II", path.read_bytes()[16:24])


CAMERA = """{name}:
  camera_model: pinhole
  intrinsics: [{focal}, {focal}, 79.5, 49.5]
  distortion_model: equidistant
  distortion_coeffs: [0, 0, 0, 0]
  resolution: [160, 100]
  rostopic: {name}
  T_cam_imu: [[0, -1, 0, 0], [0, 0, -1, 1], [1, 0, 0, -3], [0, 0, 0, 1]]
"""
IMU = """rostopic: imu0
update_rate: 100
accelerometer_noise_density: 0.01
accelerometer_random_walk: 0.001
gyroscope_noise_density: 0.001
gyroscope_random_walk: 0.0001
"""
VEHICLE = "T_imu_body: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"


def write_rig(folder, **cameras):
    """Cameras a meter above the ground that look ahead, each with a focal length [px]."""
    folder.mkdir()
    (folder / "camchain-imucam.yaml").write_text("".join(CAMERA.format(name=n, focal=f) for n, f in cameras.items()))
    (folder / "imu0.yaml").write_text(IMU)
    (folder / "vehicle.yaml").write_text(VEHICLE)


class Segment(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        write_png(self.folder / "a.png", 160, 100)
        write_png(self.folder / "b.png", 97, 61)

    def test_every_picture_gets_a_mask_of_its_name_and_size(self):
        done = run("segment", self.folder / "a.png", self.folder / "b.png", "--out", self.folder / "masks", "--overlay")

        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(size_of(self.folder / "masks/a.png"), (160, 100))
        self.assertEqual(size_of(self.folder / "masks/b.png"), (97, 61))
        self.assertTrue((self.folder / "masks/a_overlay.jpg").exists())
        self.assertEqual(len(done.stdout.splitlines()), 2)

    def test_pictures_of_a_calibrated_camera_are_segmented_as_maps_do_it(self):
        write_rig(self.folder / "rig", cam0=49.5, cam1=400)
        command = ("segment", self.folder / "a.png", "--out", self.folder / "masks", "--rig", self.folder / "rig")
        done = run(*command, "--camera", "cam0")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(size_of(self.folder / "masks/a.png"), (160, 100))

        for options, code, said in (((), 2, "cam0, cam1"), (("--camera", "front"), 2, "cam0, cam1"),
                                    (("--camera", "cam1"), 1, "less than half of the ground"),
                                    (("--camera", "cam0", "--freespace-model", "x.onnx"), 2, "excludes")):
            done = run(*command, *options)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(said, done.stderr)
        done = run("segment", self.folder / "b.png", "--out", self.folder / "masks", "--rig", self.folder / "rig", "--camera", "cam0")
        self.assertEqual(done.returncode, 1)
        self.assertIn("160x100", done.stderr)
        (self.folder / "rig/vehicle.yaml").unlink()
        self.assertIn("vehicle.yaml", run(*command, "--camera", "cam0").stderr)

    def test_what_is_no_picture_is_named(self):
        (self.folder / "c.png").write_text("hello")
        for name in ("c.png", "missing.png"):
            done = run("segment", self.folder / name, "--out", self.folder / "masks")
            self.assertEqual(done.returncode, 1)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn(name, done.stderr)

    def test_two_pictures_of_one_name_are_refused(self):
        (self.folder / "other").mkdir()
        write_png(self.folder / "other/a.png", 20, 20)
        done = run("segment", self.folder / "a.png", self.folder / "other/a.png", "--out", self.folder / "masks")
        self.assertEqual(done.returncode, 2)
        self.assertFalse((self.folder / "masks").exists())

    def test_a_picture_is_never_replaced_by_a_mask(self):
        before = (self.folder / "a.png").read_bytes()
        done = run("segment", self.folder / "a.png", "--out", self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("a.png", done.stderr)
        self.assertEqual((self.folder / "a.png").read_bytes(), before)

    def test_a_model_that_is_none_is_named_in_one_sentence_by_both_commands(self):
        (self.folder / "model.onnx").write_text("hello")
        (self.folder / "drive.bag").write_text("not read")
        commands = (("segment", self.folder / "a.png", "--out", self.folder / "masks"),
                    ("map", self.folder / "drive.bag", "--out", self.folder / "map"))
        for command in commands:
            done = run(*command, "--freespace-model", self.folder / "model.onnx")
            self.assertEqual(done.returncode, 1)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn("model.onnx", done.stderr)
            self.assertIn("network", done.stderr)


if __name__ == "__main__":
    unittest.main()
