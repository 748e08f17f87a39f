#!/usr/bin/env python3
"""parkade-simulate from the outside, as its help and docs/simulator.md promise.

command_line_test.py PARKADE_SIMULATE
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SIMULATE = sys.argv.pop(1)

# A drive of seconds: ten of them, small and few pictures.
SMALL = ["--duration", "10", "--rate", "1", "--size", "96x64", "--set", "ground_texel=0.1"]


def run(*arguments):
    return subprocess.run([SIMULATE, *map(str, arguments)], capture_output=True, text=True, timeout=120)


class CommandLine(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def refuses(self, status, word, *arguments):
        done = run(*arguments)
        self.assertEqual(done.returncode, status, done.stderr)
        self.assertIn(word, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)

    def test_the_list_names_scenes_and_presets_with_their_length(self):
        listed = run("--list").stdout
        for word in ["lot", "garage", "street", "sim4", "out15", "in5", "lot-day3", "807 m"]:
            self.assertIn(word, listed)

    def test_nonsense_gets_one_sentence(self):
        out = self.folder / "drive"
        self.refuses(2, "moon", "moon", "--out", out)
        self.refuses(2, "--out", "lot")
        self.refuses(2, "unknown option", "lot", "--out", out, "--set", "faults.snow=1")
        self.refuses(2, "640x400", "lot", "--out", out, "--size", "big")
        self.refuses(2, "season", "lot", "--out", out, "--set", "season=spring")
        self.refuses(2, "dirt", "lot", "--out", out, "--set", "lens.dirt=2")
        self.refuses(2, "flare", "lot", "--out", out, "--set", "lens.flare=-1")
        self.refuses(2, "before it begins", "lot", "--out", out, "--set", "faults.slip.begin=5", "--set",
                     "faults.slip.end=4")
        self.refuses(2, "out99", "suite", "--only", "out99", "--out", out)
        self.assertFalse(out.exists())

    def test_a_preset_can_be_changed_word_by_word(self):
        done = run("out11", "--quick", *SMALL, "--set", "sensors.imu=rt3000", "--set", "faults.imu_gap.begin=3", "--set",
                   "faults.imu_gap.end=4", "--out", self.folder / "drive.bag")
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = json.loads((self.folder / "drive.truth" / "summary.json").read_text())
        options = summary["options"]
        self.assertEqual(options["sensors"]["imu"], "rt3000")
        self.assertEqual(options["rig"]["width"], 96)
        self.assertGreater(options["drive"]["rolling_start"], 0)
        self.assertEqual(options["drive"]["length"], 0)
        self.assertAlmostEqual(summary["drive"]["duration_s"], 10)
        self.assertEqual(summary["faults"]["records_concerned"]["gap.imu"], 100)
        for name in ["rig", "rig_true", "truth.tum", "ground_truth.ply", "slots.geojson", "kerbs.geojson"]:
            self.assertTrue((self.folder / "drive.truth" / name).exists(), name)

    def test_an_existing_log_is_kept(self):
        log = self.folder / "drive.mcap"
        log.write_text("precious")
        self.refuses(2, "exists already", "lot", *SMALL, "--out", log)
        self.assertEqual(log.read_text(), "precious")

    def test_the_height_of_the_ground_depends_on_the_deck(self):
        heights = {run("garage", "--height", f"20,10,{z}").stdout for z in (0, 3, 6)}
        self.assertEqual(len(heights), 3)

    def test_true_kerbs_can_be_had_without_a_drive(self):
        file = self.folder / "kerbs.geojson"
        done = run("lot", "--seed", "3", "--kerbs", file)
        self.assertEqual(done.returncode, 0, done.stderr)
        kerbs = json.loads(file.read_text())["features"]
        self.assertGreater(len(kerbs), 100)
        for kerb in kerbs:
            self.assertAlmostEqual(kerb["properties"]["height_m"], 0.114, delta=0.0061)


if __name__ == "__main__":
    unittest.main()
