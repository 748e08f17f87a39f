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
