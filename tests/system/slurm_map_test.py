#!/usr/bin/env python3
"""Real maps of one site, made by the program itself at a real Slurm of one node.

    slurm_map_test.py PARKADE RIG_FOLDER DRIVE...

The drives, of one place, and their rig are such as parkade-simulate writes. Says what Slurm's queue
showed, and how long the last map took in the service's eyes and in the worker's. Drives after the
first two have to come into one version, and to be prepared by an array of jobs. Exits with 77 where
there can be no Slurm.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import urllib.request

from one_node_slurm import OneNodeSlurm, free_port, install
from power_cut_test import SKIPPED

FINAL = ("done", "failed", "cancelled")


def main():
    parkade, rig, drives = sys.argv[1], pathlib.Path(sys.argv[2]), [pathlib.Path(drive) for drive in sys.argv[3:]]
    if reason := install():
        print(f"skipped: no Slurm: {reason}")
        return SKIPPED
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        slurm = OneNodeSlurm(folder / "slurm")
        if not slurm.start():
            print("skipped: Slurm does not start here")
            return SKIPPED
        address = f"http://127.0.0.1:{free_port()}"
        service = subprocess.Popen([parkade, "serve", "--data", folder / "data", "--listen", address[len("http://"):],
                                    "--engine", "slurm", "--slurm-partition", "maps", "--job-memory", "3000",
                                    "--job-time", "60", "--job-cpus", str(os.cpu_count())], env=slurm.environment)
        try:
            return follow(slurm, address, drives, rig)
        finally:
            service.terminate()
            service.wait()
            slurm.stop()


def ask(address, path):
    with urllib.request.urlopen(address + path, timeout=30) as answer:
        return json.loads(answer.read())


def follow(slurm, address, drives, rig):
    for _ in range(300):
        try:
            ask(address, "/api/v1/jobs")
            break
        except OSError:
            time.sleep(0.1)
    words = [word for file in sorted(rig.iterdir()) for word in ("-F", f"{file.name}=@{file}")]
    subprocess.run(["curl", "-sSf", "-X", "PUT", f"{address}/api/v1/rigs/car", *words], check=True, capture_output=True)
    begun = time.monotonic()
    jobs = [upload(address, drive) for drive in drives]
    found = [wait(slurm, address, job, begun) for job in jobs]
    if any(job["state"] != "done" for job in found):
        return 1
    version = max(job["map_version"] for job in found)
    report = ask(address, f"/api/v1/sites/lot/maps/{version}/report.json")
    print(f"version {version} of {len(report['drives'])} drives, "
          f"stages took {sum(stage['seconds'] for stage in report['stages']):.1f} s")
    return 0 if len(report["drives"]) == len(drives) and version <= 2 else 1


def upload(address, drive):
    answer = subprocess.run(["curl", "-sSf", "-T", drive, f"{address}/api/v1/drives?filename={drive.name}&site=lot&rig=car"],
                            check=True, capture_output=True).stdout
    return json.loads(answer)["job"]["id"]


def wait(slurm, address, job, begun):
    shown = ""
    while (found := ask(address, f"/api/v1/jobs/{job}"))["state"] not in FINAL:
        queue = slurm.ask("squeue", "-r", "-o", "%.8i %.9P %.8j %.10T %.10M %.10l %.4C %.8m %R %k")
        state = f"{found['state']} {found['stage']} {found['engine']}"
        if state != shown:
            print(f"{time.monotonic() - begun:6.1f} s  {state}\n{queue}", flush=True)
            shown = state
        time.sleep(0.5)
    print(f"{time.monotonic() - begun:6.1f} s  {found}")
    return found


if __name__ == "__main__":
    sys.exit(main())
