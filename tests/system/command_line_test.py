#!/usr/bin/env python3
"""The command line from the outside: bad input gets one sentence and the right exit status, and leaves nothing behind.

command_line_test.py PARKADE
"""

import json
import math
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest

from standing_drive import CAMCHAIN, IMU, WRITE_BAG, write_drive

PARKADE = sys.argv.pop(1)


def run(*arguments, **environment):
    return subprocess.run([PARKADE, *map(str, arguments)], capture_output=True, text=True, timeout=120,
                          env={**os.environ, **environment})


def write_geoid(folder, undulation):
    """A sea that lies equally high everywhere, in the format of GeographicLib's data files."""
    folder.mkdir()
    header = "P5\n# Offset -108\n# Scale 0.003\n# Origin 90N 0E\n12 7\n65535\n"
    (folder / "egm96-5.pgm").write_bytes(header.encode() + struct.pack(">H", round((undulation + 108) / 0.003)) * 84)
    return folder


class CommandLine(unittest.TestCase):
    def setUp(self):
        self.folder_guard = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.folder_guard.name)
        self.out = self.folder / "out"

    def tearDown(self):
        self.folder_guard.cleanup()

    def refuse(self, *arguments, status=1, names):
        """`map` says one sentence on stderr that holds `names`, and leaves nothing."""
        result = run("map", *arguments, "--out", self.out)
        self.assertEqual(result.returncode, status, result.stderr)
        sentences = [line for line in result.stderr.splitlines() if line.startswith("parkade: ")]
        self.assertEqual(len(sentences), 1, result.stderr)
        for name in names:
            self.assertIn(name, sentences[0])
        self.assertFalse(self.out.exists(), "something was left behind")

    def test_help_and_version_answer(self):
        self.assertEqual(run("--help").returncode, 0)
        self.assertRegex(run("--version").stdout, r"^parkade \d+\.\d+\.\d+")
        for command in ("map", "serve", "inspect", "convert", "evaluate"):
            self.assertEqual(run(command, "--help").returncode, 0)

    def test_usage_errors_exit_with_2(self):
        self.assertEqual(run().returncode, 2)
        danced = run("dance")
        self.assertEqual((danced.returncode, danced.stderr), (2, "parkade: there is no command 'dance', see parkade --help\n"))
        self.assertEqual(run("map", "--frobnicate").returncode, 2)
        self.assertEqual(run("evaluate").returncode, 2)
        self.refuse("x.bag", "--set", "odometry.no_such=1", status=2, names=["odometry.no_such"])
        self.refuse("x.bag", "--set", "odometry.use_wheels=7", status=2, names=["odometry.use_wheels"])

    def test_a_log_is_converted_into_one_that_is_clean_and_never_over_another(self):
        drive = write_drive(self.folder / "parked", seconds=2.0)
        clean = self.folder / "clean.mcap"

        result = run("convert", drive, "--out", clean)

        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("0 left out", result.stdout)
        self.assertEqual(run("inspect", clean, "--rig", self.folder / "clean_rig").returncode, 0)
        again = run("convert", drive, "--out", clean)
        self.assertEqual((again.returncode, again.stderr),
                         (1, f"parkade: '{clean}' is there already: choose another --out\n"))
        self.assertEqual(run("convert", drive, "--out", self.folder / "clean.bag").returncode, 2)
        self.assertEqual(sorted(os.listdir(self.folder)), ["clean.mcap", "clean_rig", "parked"])

    def test_options_are_printed_as_json_and_can_be_set(self):
        options = json.loads(run("map", "--print-options", "--set", "mapping.cell_size=0.1").stdout)
        self.assertEqual(options["mapping"]["cell_size"], 0.1)

    def test_what_is_not_a_log_is_named(self):
        shopping = self.folder / "shopping.bag"
        shopping.write_text("milk, eggs, bread")
        self.refuse(shopping, names=["shopping.bag"])

    def test_an_empty_file_is_named(self):
        empty = self.folder / "empty.mcap"
        empty.touch()
        self.refuse(empty, names=["empty.mcap"])

    def test_one_of_several_logs_that_cannot_be_used_is_named(self):
        drive = write_drive(self.folder / "parked", seconds=4.0)
        shopping = self.folder / "shopping.bag"
        shopping.write_text("milk, eggs, bread")
        dark = write_drive(self.folder / "dark", images=False)
        self.refuse(drive, shopping, names=["shopping.bag' cannot be used", "--skip-bad"])
        self.refuse(dark, drive, names=["dark' cannot be used", "images"])
        self.refuse(drive, self.folder / "nowhere.bag", "--skip-bad", names=["nowhere.bag"])
        self.refuse(shopping, dark, "--skip-bad", names=["none of the logs can be used"])

    def test_a_bad_log_is_skipped_where_that_was_said(self):
        drive = write_drive(self.folder / "parked", seconds=4.0)
        shopping = self.folder / "shopping.bag"
        shopping.write_text("milk, eggs, bread")
        result = run("map", drive, shopping, "--skip-bad", "--out", self.out, "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads((self.out / "report.json").read_text())
        self.assertEqual([one["name"] for one in report["drives"]], ["parked"])
        self.assertEqual([one["name"] for one in report["left_out"]], ["shopping"])
        self.assertTrue(report["warnings"][0].startswith("drive 'shopping' is left out: "), report["warnings"])
        last = result.stderr.splitlines()[-len(report["warnings"]):]
        for line, warning in zip(last, report["warnings"]):
            self.assertTrue(line.endswith(warning), result.stderr)

    def test_a_missing_file_is_named(self):
        self.refuse(self.folder / "nowhere.bag", names=["nowhere.bag"])

    def test_a_log_without_imu_says_so(self):
        self.refuse(write_drive(self.folder / "blind", imu=False), names=["IMU"])

    def test_a_log_without_images_says_so(self):
        self.refuse(write_drive(self.folder / "dark", images=False), names=["image"])

    def test_an_uncalibrated_camera_is_named(self):
        self.refuse(write_drive(self.folder / "raw", calibrated=False), names=["cam0"])

    def test_a_rig_whose_topics_do_not_match_is_named(self):
        bag = self.folder / "drive.bag"
        # Debian's own python has ROS' bag writer.
        subprocess.run(["/usr/bin/python3", "-c", WRITE_BAG, bag], check=True)
        rig = self.folder / "rig"
        rig.mkdir()
        (rig / "camchain-imucam.yaml").write_text(CAMCHAIN.format(topic="/camera/front"))
        (rig / "imu0.yaml").write_text(IMU)
        self.refuse(bag, "--rig", rig, names=["/camera/front"])

    def test_an_output_that_is_a_file_is_refused(self):
        drive = write_drive(self.folder / "drive")
        self.out.write_text("precious")
        result = run("map", drive, "--out", self.out)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(self.out.read_text(), "precious")

    def test_a_car_that_stands_still_is_mapped_without_moving(self):
        drive = write_drive(self.folder / "tiles", seconds=4.0)  # a map has a folder of that name
        result = run("map", drive, "--out", self.out, "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        poses = [line.split() for line in (self.out / "drivetiles/trajectory.tum").read_text().splitlines() if line[0] != "#"]
        self.assertGreater(len(poses), 70)
        self.assertLess(max(abs(float(value)) for pose in poses for value in pose[1:4]), 0.02)
        report = json.loads((self.out / "report.json").read_text())
        self.assertTrue(report["warnings"], "a map without ground comes without a warning")
        for library in ("Eigen", "OpenCV", "Ceres", "PCL", "CGAL", "Draco", "GeographicLib"):
            self.assertRegex(report["libraries"][library], r"^[0-9]+\.[0-9]+")
        self.assertEqual([name for name in os.listdir(self.out) if name.startswith(".")], [])

    def test_a_map_is_pinned_to_earth_and_stays_so(self):
        drive = write_drive(self.folder / "parked", seconds=4.0)
        relative, pinned, later, unpinned = (self.folder / name for name in ("relative", "pinned", "later", "unpinned"))
        self.assertEqual(run("map", drive, "--out", relative, "--quiet").returncode, 0)
        self.assertIsNone(json.loads((relative / "report.json").read_text())["georeference"])

        # 20 m along the site's y are 20 m to the east, by the radius of curvature at 48 degrees north.
        radius = 6378137 / math.sqrt(1 - 0.00669437999014 * math.sin(math.radians(48)) ** 2) + 500
        east = 11 + math.degrees(20 / (radius * math.cos(math.radians(48))))
        pins = ["--pin", "-1.5,0,0=48,11,500", "--pin", f"-1.5,20,0=48,{east:.10f},500"]
        geoids = write_geoid(self.folder / "geoids", undulation=46.5)
        result = run("map", drive, "--from", relative, *pins, "--out", pinned, "--quiet",
                     GEOGRAPHICLIB_GEOID_PATH=str(geoids))
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads((pinned / "report.json").read_text())
        self.assertAlmostEqual(report["datum"]["latitude_deg"], 48, places=9)
        self.assertEqual(report["georeference"]["source"], "pins")
        self.assertEqual(report["georeference"]["geoid"]["model"], "egm96-5")
        self.assertAlmostEqual(report["georeference"]["geoid"]["undulation"], 46.5, delta=0.01)
        self.assertAlmostEqual(report["georeference"]["yaw_sigma"], 0.2 / math.sqrt(200), places=6)
        for value, expected in zip(report["pins"][1]["point"], (20, 0, 0)):
            self.assertAlmostEqual(value, expected, delta=0.01)
        kml = (pinned / "parked/trajectory.kml").read_text()
        self.assertIn("above mean sea level (egm96-5)", kml)
        height = float(kml.split("<coordinates>")[1].split()[0].split(",")[2])
        z = float((pinned / "parked/trajectory.tum").read_text().splitlines()[1].split()[3])
        self.assertAlmostEqual(height, 500 + z - 46.5, delta=0.02)
        csv_file = self.folder / "covariance.csv"
        self.assertEqual(run("export", pinned, "--format", "covariance", "--out", csv_file).returncode, 0)
        self.assertEqual(len(csv_file.read_text().splitlines()[1].split(",")), 26)

        preview = self.folder / "preview.glb"
        self.assertEqual(run("map", drive, "--from", pinned, "--preview", preview, "--out", later, "--quiet").returncode, 0)
        self.assertEqual(preview.read_bytes()[:4], b"glTF")
        self.assertEqual(json.loads((later / "report.json").read_text())["datum"], report["datum"])
        self.assertEqual(run("map", drive, "--from", pinned, "--no-pins", "--out", unpinned, "--quiet").returncode, 0)
        self.assertIsNone(json.loads((unpinned / "report.json").read_text())["datum"])
        # What was kept of the ground gives the same surface, and is one file of all these versions.
        for name in ("surface.bin", "ground.ply", "map.glb", "parked/heights.bin"):
            self.assertEqual((unpinned / name).read_bytes(), (relative / name).read_bytes(), name)
        self.assertTrue(os.path.samefile(unpinned / "parked/ground.bin", relative / "parked/ground.bin"))

        # Where a map lay, nothing of it passes for a part of the next one.
        self.assertTrue((later / "ortho.tif").exists() and (later / "parked/trajectory.kml").exists())
        (self.folder / "renamed").mkdir()
        renamed = shutil.copytree(drive, self.folder / "renamed/moved")
        (later / ".staging.99999999").mkdir()  # of a run that was ended
        self.assertEqual(run("map", renamed, "--out", later, "--quiet").returncode, 0)
        self.assertEqual([name for name in ("ortho.tif", "parked", ".staging.99999999") if (later / name).exists()], [])
        report = json.loads((later / "report.json").read_text())
        report["drives"] = [{"name": name} for name in ("../relative", "..", ".", "", "/")]
        (later / "report.json").write_text(json.dumps(report))
        self.assertEqual(run("map", renamed, "--out", later, "--quiet").returncode, 0)
        self.assertTrue((relative / "map.glb").exists() and (later / "moved").exists(), "what lies beside it is not its own")
        # A drive of the same name and stamps from another log is not taken for the one that was mapped.
        (self.folder / "longer").mkdir()
        longer = write_drive(self.folder / "longer/parked", seconds=5.0)
        result = run("map", longer, "--from", relative, "--out", self.folder / "other", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("of another log", result.stderr)

        def refuse(*bad, names, status=1):
            self.refuse(drive, "--from", relative, *bad, status=status, names=names)

        refuse(*pins[:2], names=["two points or more"])
        refuse(*pins[:2], *pins[:2], names=["0.00 m of each other"])
        refuse(*pins[:2], "--pin", "0,20,0=98,11", names=["latitude of pin 2"])
        refuse(*pins[:2], "--pin", f"0,25,0=48,{east:.10f}", names=["do not fit each other"])
        refuse(*pins[:2], "--pin", f"moved:-1.5,20,0=48,{east:.10f}", names=["no drive 'moved'"])
        refuse(*pins[:2], "--pin", "here", names=["'here'"])
        self.refuse(drive, *pins, status=2, names=["--from"])
        self.refuse(drive, "--from", self.folder / "nowhere", status=1, names=["nowhere"])
        for out in ("nowhere/map.glb", "relative/report.json/map.glb"):
            result = run("export", relative, "--format", "glb", "--out", self.folder / out)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("there is no folder", result.stderr)
        result = run("export", relative, "--format", "glb", "--out", pinned)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("is a folder", result.stderr)
        self.refuse(drive, "--preview", preview, status=2, names=["--from"])
        result = run("export", pinned, "--format", "autoware", "--out", f"{self.folder}/autoware/")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.folder / "autoware/map_projector_info.yaml").exists())
        result = run("export", pinned, "--format", "lanelet2", "--out", f"{self.folder}/lanelet2")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("neither free ground nor parking slots", result.stderr)
        self.assertFalse((self.folder / "lanelet2").exists())

    def test_a_map_pinned_without_heights_is_one_to_go_on_from(self):
        drive = write_drive(self.folder / "parked", seconds=4.0)
        relative, flat, later = (self.folder / name for name in ("relative", "flat", "later"))
        self.assertEqual(run("map", drive, "--out", relative, "--quiet").returncode, 0)
        pins = ["--pin", "-1.5,0,0=48,11", "--pin", "-1.5,20,0=48,11.000268"]
        self.assertEqual(run("map", drive, "--from", relative, *pins, "--out", flat, "--quiet").returncode, 0)
        self.assertIsNone(json.loads((flat / "report.json").read_text())["georeference"]["position_sigma"][2])
        result = run("map", drive, "--from", flat, "--out", later, "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        result = run("compare", flat, later, "--out", self.folder / "changes")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_map_replaces_nothing_but_a_map(self):
        drive = write_drive(self.folder / "parked", seconds=2.0)
        (self.folder / "site/tiles").mkdir(parents=True)
        (self.folder / "site/tiles/mine.txt").write_text("mine")
        before = sorted(self.folder.rglob("*"))
        for out, name in ((self.folder, "parked"), (self.folder / "site", "tiles")):
            result = run("map", drive, "--out", out)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn(f"{name}', which is of no map", result.stderr)
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def test_other_options_of_odometry_track_a_drive_again(self):
        drive = write_drive(self.folder / "parked", seconds=4.0)
        relative, same, other = (self.folder / name for name in ("relative", "same", "other"))
        only = ("--odometry-only", "--quiet")
        self.assertEqual(run("map", drive, *only, "--out", relative).returncode, 0)
        self.assertNotIn("tracked again", run("map", drive, *only, "--from", relative, "--out", same).stderr)
        result = run("map", drive, *only, "--from", relative, "--set", "odometry.smoother.landmarks=60", "--out", other)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("other options", result.stderr)

    def test_a_map_made_from_another_counts_what_its_log_holds(self):
        drive = write_drive(self.folder / "torn", seconds=4.0)
        image = drive / "mav0/cam0/data/b.png"
        image.write_bytes((drive / "mav0/cam0/data/a.png").read_bytes()[:400])
        lines = (drive / "mav0/cam0/data.csv").read_text().splitlines()
        torn = [line.replace("a.png", "b.png") if i % 10 == 5 else line for i, line in enumerate(lines)]
        (drive / "mav0/cam0/data.csv").write_text("\n".join(torn) + "\n")
        num_torn = sum("b.png" in line for line in torn)
        first, second = self.folder / "first", self.folder / "second"
        self.assertEqual(run("map", drive, "--out", first, "--quiet").returncode, 0)
        result = run("map", drive, "--from", first, "--out", second, "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        for out in (first, second):
            streams = json.loads((out / "report.json").read_text())["drives"][0]["streams"]
            camera = next(stream for stream in streams if stream["role"] == "cam0")
            self.assertEqual(camera["dropped"], {"damaged": num_torn})
            self.assertEqual(camera["delivered"], len(lines) - 1 - num_torn)

    def test_a_full_disk_is_said_and_leaves_nothing(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], capture_output=True).returncode != 0:
            self.skipTest("needs the right to mount a small disk")
        try:
            self.out = disk / "out"
            self.refuse(write_drive(self.folder / "parked", seconds=30.0), status=3, names=["No space left"])
        finally:
            subprocess.run(["umount", disk], check=True)

    def test_inspect_exits_0_for_clean_and_1_for_unusable(self):
        clean = run("inspect", write_drive(self.folder / "clean"), "--json")
        self.assertEqual(clean.returncode, 0, clean.stdout)
        self.assertIn("cam0", clean.stdout)
        unusable = run("inspect", write_drive(self.folder / "dark", images=False))
        self.assertEqual(unusable.returncode, 1, unusable.stdout)

    def test_inspect_exits_3_when_images_are_damaged(self):
        drive = write_drive(self.folder / "torn")
        image = drive / "mav0/cam0/data/b.png"
        image.write_bytes((drive / "mav0/cam0/data/a.png").read_bytes()[:400])
        with open(drive / "mav0/cam0/data.csv", "a") as file:
            file.write("3000000000,b.png\n")
        result = run("inspect", drive)
        self.assertEqual(result.returncode, 3, result.stdout)

    def test_a_service_that_has_just_begun_stops_when_told_to(self):
        with tempfile.TemporaryDirectory() as folder:
            service = subprocess.Popen([PARKADE, "serve", "--data", folder, "--listen", "127.0.0.1:0"],
                                       stderr=subprocess.PIPE, text=True)
            said = ""
            while "listening on" not in said:
                line = service.stderr.readline()
                self.assertTrue(line, said)
                said += line
            service.send_signal(signal.SIGTERM)
            rest = service.communicate(timeout=20)[1]
            self.assertEqual(service.returncode, 0, said + rest)
            self.assertIn("stopped", rest)

    def test_evaluate_compares_a_trajectory_with_itself(self):
        truth = self.folder / "truth.tum"
        truth.write_text("".join(f"{i}.000000000 {i} {i * i * 0.1} 0 0 0 0 1\n" for i in range(20)))
        result = json.loads(run("evaluate", "--truth", truth, "--estimate", truth, "--json").stdout)
        self.assertLess(result["trajectory"]["drift_percent"], 1e-6)

    def test_evaluate_paints_where_a_surface_is_wrong(self):
        header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        header += "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
        for name, width in (("true.ply", 6), ("found.ply", 5)):
            corners = f"0 0 0\n{width} 0 0\n{width} 4 0\n0 4 0\n"
            (self.folder / name).write_text(header + corners + "3 0 1 2\n3 0 2 3\n")
        picture = self.folder / "wrong.png"

        done = run("evaluate", "--ground", self.folder / "true.ply", "--surface", self.folder / "found.ply", "--picture", picture)

        self.assertEqual(done.returncode, 0, done.stderr)
        png = picture.read_bytes()
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", png[16:24]), (60, 40), "10 cm to a pixel")
        self.assertEqual(run("evaluate", "--slots", "x", "--map", "y", "--picture", picture).returncode, 2)


if __name__ == "__main__":
    unittest.main()
