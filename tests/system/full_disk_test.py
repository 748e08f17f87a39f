#!/usr/bin/env python3
"""A full disk at ten points: what cannot be kept is refused, reads go on, and room is all it takes to recover.

    full_disk_test.py PARKADE_SERVE_PROGRAM PARKADE

The data directory lies on a small ext4 of its own. At each point the disk is filled to its last
block; the answer is 507, or true; lists and a map are read all the while; then room is made, and the
same is done again, by the same process. At the end the service is killed, and the next one has to
know all that was acknowledged. Needs root; exits with 77 where a filesystem cannot be mounted.
"""

import argparse
import os
import pathlib
import sys
import tarfile
import tempfile
import time

from full_disk import RealService, SmallDisk, World
from full_disk_points import POINTS, REAL_POINTS, comments_of
from power_cut_test import Service
from standing_drive import write_drive


def try_points(world, points, failures):
    for point in points:
        before, begun = world.readers.answers, time.monotonic()
        try:
            point(world)
            assert world.service.process.poll() is None, "the service has ended"
            print(f"{point.__name__}: well after {time.monotonic() - begun:.1f} s, "
                  f"{world.readers.answers - before} answers to readers", flush=True)
        except Exception as error:  # whatever it is, the other points are tried too
            failures.append(f"{point.__name__}: {error!r}")
            print(failures[-1][:2000], flush=True)
            if (world.disk.mount_point / "filling").exists():
                world.disk.make_room()
    world.readers.stop()
    failures += world.readers.failures
    for failure in world.readers.failures[:5]:
        print(failure, flush=True)


def with_disk(try_it):
    with tempfile.TemporaryDirectory() as folder:
        disk = SmallDisk(pathlib.Path(folder))
        try:
            try_it(disk, disk.mount_point / "data")
        finally:
            disk.leave()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("parkade")
    parser.add_argument("--only", nargs="*", default=[], help="parts of the names of points")
    arguments = parser.parse_args()
    chosen = lambda points: [point for point in points
                             if not arguments.only or any(part in point.__name__ for part in arguments.only)]
    failures = []
    # The disk itself is to say no, not a look at the free space beforehand.
    os.environ["RESERVE"] = str(-10**12)

    def scripted(disk, data):
        service = Service(arguments.program, data, lose_syncs=False)
        try:
            world = World(disk, service, b"log ok\nclean\n")
            world.parkade = arguments.parkade
            try_points(world, chosen(POINTS), failures)
            comments = comments_of(world)
            service.kill()
            service = world.service = Service(arguments.program, data, lose_syncs=False)
            failures.extend(world.losses())
            if comments_of(world) != comments:
                failures.append("comments are lost at the next start")
        finally:
            service.kill()

    def real(disk, data):
        service = RealService(arguments.parkade, data)
        try:
            with tempfile.TemporaryDirectory() as name:
                drive = pathlib.Path(name) / "drive.tar"
                with tarfile.open(drive, "w") as archive:
                    archive.add(write_drive(pathlib.Path(name) / "standing", seconds=4.0), arcname="standing")
                world = World(disk, service, drive.read_bytes())
            try_points(world, chosen(REAL_POINTS), failures)
            failures.extend(world.losses())
        finally:
            service.kill()

    if chosen(POINTS):
        with_disk(scripted)
    if chosen(REAL_POINTS):
        with_disk(real)
    print(f"{len(chosen(POINTS + REAL_POINTS))} points, {len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
