#!/usr/bin/env python3
"""What H.264 costs beside JPEGs of the same drives: their drifts, and the sum of one over that of the other.

    video_table.py PARKADE SIMULATE VIDEO_LOG [--drives 8] [--first 8900] [--duration 20] [--out RESULTS.json]

A third log holds gray JPEGs of the same images, coded once more: what it differs by is chance.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

SCENES = ["lot", "street", "garage", "lot", "street", "lot", "street", "garage"]


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr}")
    return done.stdout


def drift(parkade, log, truth, folder):
    """ATE [m] of the odometry."""
    run(parkade, "map", log, "--rig", truth / "rig", "--out", folder, "--odometry-only", "--quiet")
    evaluated = run(parkade, "evaluate", "--truth", truth / "truth.tum", "--estimate", next(folder.glob("*/odometry.tum")), "--json")
    return json.loads(evaluated)["trajectory"]["rigid"]["translation"]["rmse"]


def measure(arguments, seed, folder):
    scene = SCENES[seed % len(SCENES)]
    log, video, gray = folder / "drive.mcap", folder / "video.mcap", folder / "gray.mcap"
    run(arguments.simulate, scene, "--seed", seed, "--duration", arguments.duration, "--rate", arguments.rate, "--size",
        arguments.size, "--gnss", "none", "--out", log, "--quiet")
    before, after = re.findall(r"([\d.]+) MB", run(arguments.video_log, log, video))
    run(arguments.video_log, log, gray, "--jpeg", 95)
    truth = folder / "drive.truth"
    result = {"drive": f"{scene} {seed}", "bytes": float(after) / float(before)}
    for name, path in [("jpeg", log), ("h264", video), ("gray", gray)]:
        result[name] = drift(arguments.parkade, path, truth, folder / name)
    return result


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("parkade")
    parser.add_argument("simulate")
    parser.add_argument("video_log")
    parser.add_argument("--drives", type=int, default=8)
    parser.add_argument("--first", type=int, default=8900)
    parser.add_argument("--duration", type=float, default=20)
    parser.add_argument("--rate", type=float, default=10)
    parser.add_argument("--size", default="640x400")
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    results = []
    for seed in range(arguments.first, arguments.first + arguments.drives):
        with tempfile.TemporaryDirectory() as folder:
            results.append(measure(arguments, seed, pathlib.Path(folder)))
        r = results[-1]
        print(f"{r['drive']:14} JPEG {1e3 * r['jpeg']:5.1f} mm  H.264 {1e3 * r['h264']:5.1f} mm ({r['h264'] / r['jpeg']:.2f} x, "
              f"{100 * r['bytes']:.0f} % of the bytes)  gray JPEG {1e3 * r['gray']:5.1f} mm ({r['gray'] / r['jpeg']:.2f} x)", flush=True)
        if arguments.out:
            arguments.out.write_text(json.dumps(results, indent=1))
    of = {name: sum(r[name] for r in results) for name in ("jpeg", "h264", "gray")}
    print(f"together: H.264 {of['h264'] / of['jpeg']:.2f} x, gray JPEG {of['gray'] / of['jpeg']:.2f} x")


if __name__ == "__main__":
    main()
