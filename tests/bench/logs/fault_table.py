#!/usr/bin/env python3
"""Makes faults in a sound drive, one at a time, and asks what a user gets: `inspect` and `map`.

    fault_table.py PARKADE BASE.bag [--kinds KIND...] [--only TEXT...] [--out RESULTS.json] [--jobs N]

BASE.bag is of `parkade-simulate`, its truth beside it, for example
    parkade-simulate lot --seed 5 --duration 12 --rate 5 --size 320x200 --out base.bag
Faults of sensors that the drive does not have are passed over. Well is: the right trajectory, or a
warning or a refusal in one sentence that names the fault. Ends with 1 where one is not well. Needs Debian's python3-rosbag, -nav-msgs, -sensor-msgs, -numpy,
-pil, -yaml, and for restart markers libjpeg-turbo-progs.
"""

import argparse
import collections
import concurrent.futures
import dataclasses
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import numpy

from drive_log import NS, BaseDrive, NotRecorded
from faults import KINDS

LARGEST_ERROR = 0.1  # [m], ATE of a right trajectory of a short drive
SMALLEST_PART = 0.8  # of the drive's time that a right trajectory covers
FARTHEST_DATUM = 300  # [m] from where the drive was
TIME_LIMIT = 300  # [s]
METERS_PER_DEGREE = 111_320
LOGGED = re.compile(r"\d{4}-\d\d-\d\dT\S+ (info|warning) ")  # before the sentence


@dataclasses.dataclass
class Outcome:
    fault: str
    verdict: str  # "right", "said", "refused": well. Else what is wrong
    detail: str = ""
    seconds: float = 0

    @property
    def is_well(self):
        return self.verdict in ("right", "said", "refused")


def rigid_error(estimate, truth):
    """ATE [m] of positions (n x 3) after the best rigid motion (Umeyama 1991, without scale)."""
    a, b = estimate - estimate.mean(axis=0), truth - truth.mean(axis=0)
    u, _, vt = numpy.linalg.svd(b.T @ a)
    turn = u @ numpy.diag([1, 1, numpy.sign(numpy.linalg.det(u @ vt))]) @ vt
    return float(numpy.sqrt(((a @ turn.T - b) ** 2).sum(axis=1).mean()))


def true_times(stamps, log, truth):
    """The true times [s] of estimated stamps [s]; NaN where a stamp belongs to no time of the drive."""
    begin, end = truth[0, 0] - 0.1, truth[-1, 0] + 0.1
    times = numpy.full(len(stamps), numpy.nan)
    for moment in [-1] + [moment for moment, _ in log.leaps]:
        ahead = log.ahead_at(moment)
        for i, t in enumerate(stamps - ahead / NS):
            if begin <= t <= end and log.ahead_at(t * NS) == ahead:
                times[i] = t
    return times


def trajectory(out, log, truth):
    """ATE of the worst part [m], and the share of the drive's time that all parts cover."""
    worst, covered = 0.0, 0.0
    for file in sorted(out.glob("*/odometry.tum")):
        estimate = numpy.atleast_2d(numpy.loadtxt(file))
        if estimate.shape[1] < 8 or len(estimate) < 3:
            continue
        times = true_times(estimate[:, 0], log, truth)
        known = ~numpy.isnan(times)
        if known.mean() < 0.95:
            return float("inf"), 0.0
        times, positions = times[known], estimate[known, 1:4]
        at = numpy.stack([numpy.interp(times, truth[:, 0], truth[:, k]) for k in (1, 2, 3)], axis=1)
        worst = max(worst, rigid_error(positions, at))
        covered += times[-1] - times[0]
    return worst, covered / (truth[-1, 0] - truth[0, 0])


def is_far(datum, place):
    """Whether a map's datum [deg] is not where the drive was, (latitude, longitude) [deg]."""
    north = (datum["latitude_deg"] - place[0]) * METERS_PER_DEGREE
    east = (datum["longitude_deg"] - place[1]) * METERS_PER_DEGREE * numpy.cos(numpy.radians(place[0]))
    return not numpy.hypot(north, east) < FARTHEST_DATUM


def run(command):
    try:
        return subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=TIME_LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return None


def judge(fault, parkade, base, folder):
    log = base.log()
    try:
        fault.make(log)
    except LookupError as error:  # of a camera that the drive does not have
        raise NotRecorded from error
    path = log.write(folder)
    about = re.compile(fault.says)
    looked = run([parkade, "inspect", path, "--rig", folder / "rig", "--json"])
    mapped = run([parkade, "map", path, "--rig", folder / "rig", "--out", folder / "map", "--odometry-only", "--quiet"])
    if looked is None or mapped is None:
        return "TOO SLOW", f"{TIME_LIMIT} s"
    if looked.returncode not in (0, 1, 3) or mapped.returncode not in (0, 1):
        return "CRASH", f"inspect {looked.returncode}, map {mapped.returncode}: {mapped.stderr.strip()[-200:]}"
    said = mapped.stderr.strip()
    if mapped.returncode == 1:
        if len([line for line in said.splitlines() if not LOGGED.match(line)]) != 1:
            return "NOT ONE SENTENCE", said
        return ("refused" if about.search(said) else "REFUSED FOR SOMETHING ELSE"), said
    if looked.returncode == 1:
        return "MAPPED THOUGH UNUSABLE", looked.stdout[:300] + looked.stderr[:300]
    report = json.loads((folder / "map" / "report.json").read_text())
    warnings = "; ".join(report["warnings"])
    notes = "; ".join(f["sentence"] for d in report["drives"] for f in d.get("health", {}).get("findings", []))
    is_said = bool(about.search(warnings) or about.search(notes))
    truth = base.truth if log.last is None else base.truth[base.truth[:, 0] * NS <= log.last]
    error, part = trajectory(folder / "map", log, truth)
    detail = f"ATE {error:.3f} m, {100 * part:.0f} %; {warnings or notes}"
    if report.get("datum") and is_far(report["datum"], base.place):
        return "WRONG PLACE", f"{report['datum']}; {detail}"
    if error <= LARGEST_ERROR and part >= SMALLEST_PART:
        return ("right" if is_said or not fault.must_say else "NOT SAID"), detail
    return ("said" if is_said else "WRONG WITHOUT A WORD"), detail


def outcome_of(fault, parkade, base):
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        try:
            verdict, detail = judge(fault, parkade, base, pathlib.Path(folder))
        except NotRecorded:
            return None
    return Outcome(fault.name, verdict, detail.replace(folder, ""), time.monotonic() - begun)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("parkade")
    parser.add_argument("base", type=pathlib.Path)
    parser.add_argument("--kinds", nargs="*", choices=KINDS, default=list(KINDS))
    parser.add_argument("--only", nargs="*", default=[], help="parts of names")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    base = BaseDrive(arguments.base)
    of_kinds = [fault for kind in arguments.kinds for fault in KINDS[kind]]
    chosen = [f for f in of_kinds if not arguments.only or any(part in f.name for part in arguments.only)]
    outcomes = []
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for outcome in pool.map(lambda fault: outcome_of(fault, arguments.parkade, base), chosen):
            if outcome is None:
                continue
            outcomes.append(outcome)
            print(f"{outcome.seconds:5.1f} s  {outcome.verdict:10} {outcome.fault}: {outcome.detail[:400]}", flush=True)
            if arguments.out:
                arguments.out.write_text(json.dumps([dataclasses.asdict(o) for o in outcomes], indent=1))
    counts = collections.Counter(o.verdict for o in outcomes)
    print(", ".join(f"{count} {verdict}" for verdict, count in counts.most_common()))
    well = sum(o.is_well for o in outcomes)
    print(f"{well} of {len(outcomes)} well ({100 * well / max(len(outcomes), 1):.1f} %)")
    return 0 if well == len(outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
