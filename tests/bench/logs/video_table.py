#!/usr/bin/env python3
"""What H.264 costs beside JPEGs of the same drives: their drifts, and the sum of one over that of the other.

    video_table.py PARKADE SIMULATE VIDEO_LOG [--drives 8] [--first 8900] [--codings 3] [--out RESULTS.json]

By chance one coding of a drive's images drifts up to three times as much as another: each drive is coded some times,
as H.264 by rate factors around the encoder's own, as JPEG by what was recorded and gray JPEGs made of it.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

RATE_FACTORS, QUALITIES = [23, 22, 24], [95, 90]
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
    """Drifts [m] of some codings of a drive's images, as JPEGs and as videos."""
    scene = SCENES[seed % len(SCENES)]
    log, coded, truth = folder / "drive.mcap", folder / "coded.mcap", folder / "drive.truth"
    run(arguments.simulate, scene, "--seed", seed, "--duration", arguments.duration, "--rate", arguments.rate, "--size",
        arguments.size, "--gnss", "none", "--out", log, "--quiet")
    drifts, shares = {"jpeg": [drift(arguments.parkade, log, truth, folder / "recorded")], "h264": []}, []
    for name, option, values in [("h264", "--rate-factor", RATE_FACTORS), ("jpeg", "--jpeg", QUALITIES)]:
        for value in values[: arguments.codings - len(drifts[name])]:
            before, after = re.findall(r"([\d.]+) MB", run(arguments.video_log, log, coded, option, value))
            drifts[name].append(drift(arguments.parkade, coded, truth, folder / f"{name}{value}"))
            coded.unlink()
            if name == "h264":
                shares.append(float(after) / float(before))
    return {"drive": f"{scene} {seed}", "bytes": sum(shares) / len(shares), "drifts": drifts}


def mean(values):
    return sum(values) / len(values)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("parkade")
    parser.add_argument("simulate")
    parser.add_argument("video_log")
    parser.add_argument("--drives", type=int, default=8)
    parser.add_argument("--first", type=int, default=8900)
    parser.add_argument("--codings", type=int, default=3, choices=[1, 2, 3])
    parser.add_argument("--duration", type=float, default=15)
    parser.add_argument("--rate", type=float, default=10)
    parser.add_argument("--size", default="640x400")
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    results = []
    for seed in range(arguments.first, arguments.first + arguments.drives):
        with tempfile.TemporaryDirectory() as folder:
            results.append(measure(arguments, seed, pathlib.Path(folder)))
        drifts = results[-1]["drifts"]
        columns = [f"{name} " + ", ".join(f"{1e3 * d:.1f}" for d in drifts[name]) + " mm" for name in ("jpeg", "h264")]
        print(f"{results[-1]['drive']:14} {'  '.join(columns)}  {mean(drifts['h264']) / mean(drifts['jpeg']):.2f} x, "
              f"{100 * results[-1]['bytes']:.0f} % of the bytes", flush=True)
        if arguments.out:
            arguments.out.write_text(json.dumps(results, indent=1))
    of = {name: sum(mean(r["drifts"][name]) for r in results) for name in ("jpeg", "h264")}
    print(f"together: H.264 {of['h264'] / of['jpeg']:.2f} x")


if __name__ == "__main__":
    main()
