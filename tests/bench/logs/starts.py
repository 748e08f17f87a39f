#!/usr/bin/env python3
"""Cuts an EuRoC folder at many points and asks at which of them the odometry starts, and how it drifts.

    starts.py PARKADE CLIP --rig RIG --truth TRUTH.tum [--starts 20] [--cameras cam0 cam1] [--leave-out odom0 gnss0]
              [--shortest 1.2]

Drift is the RMSE of positions after one rigid alignment, divided by the path's length. Needs Debian's python3-numpy.
"""

import argparse
import pathlib
import subprocess
import tempfile

import numpy

from fault_table import rigid_error

NS = 10**9


def rows(table):
    """The header and (stamp [ns], line) of a data.csv."""
    header, *lines = table.read_text().splitlines()
    return header, [(int(line.split(",")[0]), line) for line in lines if line.strip()]


def cut(clip, sensors, begin, out):
    """Writes the part of the clip from `begin` [ns] on; images are links."""
    for sensor in sensors:
        source, target = clip / "mav0" / sensor, out / "mav0" / sensor
        target.mkdir(parents=True)
        header, lines = rows(source / "data.csv")
        kept = [line for stamp, line in lines if stamp >= begin]
        (target / "data.csv").write_text("\n".join([header, *kept]) + "\n")
        for extra in source.iterdir():
            if extra.name != "data.csv":
                (target / extra.name).symlink_to(extra.resolve())


def ask(parkade, log, rig, truth, folder):
    """Share of the images' time that is covered, drift in % and the path's length [m]; a sentence where it failed."""
    command = [parkade, "map", log, "--rig", rig, "--out", folder / "map", "--odometry-only", "--quiet"]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    file = next((folder / "map").glob("*/odometry.tum"), None)
    if done.returncode or file is None:
        return done.stderr.strip()
    estimate = numpy.atleast_2d(numpy.loadtxt(file))
    inside = (estimate[:, 0] >= truth[0, 0]) & (estimate[:, 0] <= truth[-1, 0])
    estimate = estimate[inside]
    at = numpy.stack([numpy.interp(estimate[:, 0], truth[:, 0], truth[:, k]) for k in (1, 2, 3)], axis=1)
    length = numpy.linalg.norm(numpy.diff(at, axis=0), axis=1).sum()
    _, images = rows(log / "mav0" / "cam0" / "data.csv")
    duration = (images[-1][0] - images[0][0]) / NS
    begin = max(images[0][0] / NS, truth[0, 0])
    covered = (min(estimate[-1, 0], images[-1][0] / NS) - max(estimate[0, 0], begin)) / duration
    return covered, 100 * rigid_error(estimate[:, 1:4], at) / length, length


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("parkade")
    parser.add_argument("clip", type=pathlib.Path)
    parser.add_argument("--rig", required=True)
    parser.add_argument("--truth", type=pathlib.Path, required=True)
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--cameras", nargs="*", help="default: all")
    parser.add_argument("--leave-out", nargs="*", default=[], help="sensors")
    parser.add_argument("--shortest", type=float, default=1.2, help="part [s]")
    arguments = parser.parse_args()
    truth = numpy.loadtxt(arguments.truth)
    sensors = [s.name for s in sorted((arguments.clip / "mav0").iterdir()) if s.name not in arguments.leave_out]
    if arguments.cameras:
        sensors = [s for s in sensors if not s.startswith("cam") or s in arguments.cameras]
    _, images = rows(arguments.clip / "mav0" / "cam0" / "data.csv")
    stamps = [stamp for stamp, _ in images]
    last = max(i for i, stamp in enumerate(stamps) if stamps[-1] - stamp >= arguments.shortest * NS)
    drifts = []
    for k in range(arguments.starts):
        first = round(k * last / max(arguments.starts - 1, 1))
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder) / "part"
            cut(arguments.clip, sensors, stamps[first] - NS // 100, log)
            outcome = ask(arguments.parkade, log, arguments.rig, truth, pathlib.Path(folder))
        if isinstance(outcome, str):
            print(f"image {first:3d}: {outcome}", flush=True)
            continue
        covered, drift, length = outcome
        drifts.append(drift)
        print(f"image {first:3d}: {100 * covered:3.0f} % of the time, drift {drift:.3f} % of {length:.1f} m", flush=True)
    print(f"{len(drifts)} of {arguments.starts} started")
    if drifts:
        print(f"drift: median {numpy.median(drifts):.3f} %, worst {max(drifts):.3f} %")


if __name__ == "__main__":
    main()
