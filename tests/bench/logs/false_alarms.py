#!/usr/bin/env python3
"""Maps sound drives and counts what is said against them, which should be nothing.

    false_alarms.py PARKADE SIMULATE [--drives 60] [--first 0] [--duration 12] [--out RESULTS.json]
    false_alarms.py PARKADE --logs LOG RIG [LOG RIG ...]

Simulated drives differ in scene, place, looks, weather, sun, rig, lens, size, rate and IMU, by their
number. A drive fails with a warning or a refusal; notes are listed.
"""

import argparse
import json
import pathlib
import random
import subprocess
import sys
import tempfile


def choose(number):
    """What `parkade-simulate` is asked for."""
    draw = random.Random(7000 + number)
    scene = draw.choice(["lot", "lot", "garage", "street"])
    command = [scene, "--seed", 7000 + number, "--size", draw.choice(["320x200"] * 5 + ["640x400"])]
    command += ["--rate", draw.choice([5, 5, 8]), "--gnss", draw.choice(["standard", "rtk", "none"])]
    command += ["--lens", draw.choice(["kb", "kb", "ds", "eucm"]), "--set", "looks=" + draw.choice(["known", "mixed", "unknown"])]
    command += ["--set", "faults.extrinsic_rotation_deg=[" + draw.choice(["0", "0.3", "1"]) + "]"]
    if scene != "garage":
        command += ["--weather", draw.choice(["dry", "overcast", "wet", "dusk"])]
    if draw.random() < 0.3:
        command += ["--no-wheels"]
    if draw.random() < 0.3:
        command += ["--traffic", draw.choice([2, 5])]
    if draw.random() < 0.2:
        command += ["--drop", "0.05"]
    return command


def run(*command):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)


def ask(parkade, log, rig, folder):
    """Warnings, notes and the error [m] of one drive."""
    looked = run(parkade, "inspect", log, "--rig", rig, "--json")
    mapped = run(parkade, "map", log, "--rig", rig, "--out", folder / "map", "--odometry-only", "--quiet")
    if mapped.returncode:
        return [mapped.stderr.strip()], []
    report = json.loads((folder / "map" / "report.json").read_text())
    findings = [f for d in report["drives"] for f in d.get("health", {}).get("findings", [])]
    notes = [f["sentence"] for f in findings if f["severity"] == "note"]
    warnings = [f["sentence"] for f in findings if f["severity"] != "note"]
    if looked.returncode == 1:
        warnings.append("inspect: " + looked.stdout[-300:])
    return warnings + [w for w in report["warnings"] if not any(n in w for n in notes + warnings)], notes


def error_of(parkade, truth, folder):
    estimate = next((folder / "map").glob("*/odometry.tum"), None)
    if estimate is None or not truth.exists():
        return ""
    lines = run(parkade, "evaluate", "--truth", truth, "--estimate", estimate).stdout.splitlines()
    return next((line.strip() for line in lines if "ATE" in line), "")


def simulated(arguments):
    for number in range(arguments.first, arguments.first + arguments.drives):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            options = choose(number)
            made = run(arguments.simulate, *options, "--duration", arguments.duration, "--out", folder / "drive.mcap",
                       "--threads", 1, "--quiet")
            if made.returncode:
                sys.exit(f"{options}: {made.stderr}")
            truth = folder / "drive.truth"
            warnings, notes = ask(arguments.parkade, folder / "drive.mcap", truth / "rig", folder)
            yield " ".join(map(str, options)), warnings, notes, error_of(arguments.parkade, truth / "truth.tum", folder)


def given(arguments):
    for log, rig in zip(arguments.logs[::2], arguments.logs[1::2]):
        with tempfile.TemporaryDirectory() as folder:
            warnings, notes = ask(arguments.parkade, log, rig, pathlib.Path(folder))
            yield log, warnings, notes, ""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("parkade")
    parser.add_argument("simulate", nargs="?")
    parser.add_argument("--drives", type=int, default=60)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--duration", type=float, default=12)
    parser.add_argument("--logs", nargs="*", help="pairs of a log and its rig")
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    results = []
    for name, warnings, notes, error in given(arguments) if arguments.logs else simulated(arguments):
        results.append({"drive": name, "warnings": warnings, "notes": notes, "error": error})
        print(f"{'ALARM' if warnings else 'silent'}  {name}  {error}  {'; '.join(warnings)}  ({'; '.join(notes)})", flush=True)
        if arguments.out:
            arguments.out.write_text(json.dumps(results, indent=1))
    alarms = sum(bool(r["warnings"]) for r in results)
    print(f"{alarms} of {len(results)} sound drives were warned of or refused")
    return 1 if alarms else 0


if __name__ == "__main__":
    sys.exit(main())
