#!/usr/bin/env python3
"""Jobs at a real Slurm of one node: none is lost, none is published twice.

    slurm_test.py PARKADE_SERVE_PROGRAM [--kills N] [--seed S] [--only PART...]

Installs Slurm where it is missing and starts it in a folder of its own. First one case after the
other; then N random kills of the service, workers, the node and the controller while jobs run.
Exits with 77 where there can be no Slurm.
"""

import argparse
import os
import pathlib
import random
import signal
import sys
import tempfile
import time

from one_node_slurm import OneNodeSlurm, install
from power_cut_test import SKIPPED
from slurm_kills import survive_kills
from slurm_world import FINAL, World, wait_for


def done_and_published(world):
    job = world.upload("slow")
    running = world.wait_to_run(job)
    assert running["engine"]["name"] == "slurm" and running["engine"]["id"].isdigit(), running
    found = world.wait(job, "done")
    assert found["map_version"] == 1 and found["attempts"] == 1, found
    assert world.service.ask("GET", "/api/v1/sites/lot/maps/1/map.glb")[0] == 200
    log = world.service.ask("GET", f"/api/v1/jobs/{job}/log")[2].decode()
    assert "working on" in log and "shut off from the network" in log, log
    wait_for(lambda: not world.left_behind(), seconds=60)


def bad_input_is_told(world):
    found = world.wait(world.upload("bad-input"), *FINAL)
    assert (found["state"], found["error_code"], found["error"]) == ("failed", "invalid_input", "the log has no IMU")


def a_full_node_means_queued(world):
    blocker = world.slurm.ask("sbatch", "--parsable", "--exclusive", "--output=/dev/null",
                                "--wrap", "sleep 600").strip()
    job = world.upload("ok")
    found = world.wait_until(job, lambda one: one["engine"] and one["engine"]["reason"])
    assert found["state"] == "queued" and found["started_at"] is None, found
    other = world.upload("ok", site="other")
    world.wait_until(other, lambda one: one["engine"] and one["engine"]["id"])
    assert world.ask("POST", f"/api/v1/jobs/{other}/cancel", b"")[0] == 202
    world.wait(other, "cancelled", seconds=5)
    queued = world.ask("GET", "/api/v1/jobs?state=queued")[1]["items"]
    assert [one["id"] for one in queued] == [job], queued
    world.slurm.ask("scancel", blocker)
    assert world.wait(job, *FINAL)["state"] == "done"


def cancelled_within_seconds(world):
    for todo in ("hang", "stubborn"):
        job = world.upload(todo)
        world.wait_to_run(job)
        world.wait_for_process("work")
        begun = time.monotonic()
        assert world.ask("POST", f"/api/v1/jobs/{job}/cancel", b"")[0] == 202
        found = world.wait(job, *FINAL, seconds=5)
        print(f"  {todo}: cancelled after {time.monotonic() - begun:.1f} s", flush=True)
        assert found["state"] == "cancelled", found
        wait_for(lambda: not world.processes("work") and not world.active_at_slurm(), seconds=3)
    job = world.upload("hang")
    world.wait_to_run(job)
    world.slurm.ask("scancel", world.job(job)["engine"]["id"])
    assert world.wait(job, *FINAL)["state"] == "cancelled"


def killed_worker_is_started_again(world):
    for word in ("work", "run-attempt"):
        job = world.upload("slow")
        pid = world.wait_for_process(word)
        world.wait_to_run(job)
        os.kill(pid, signal.SIGKILL)
        found = world.wait(job, *FINAL)
        assert (found["state"], found["attempts"]) == ("done", 2), found


def failed_node_is_survived(world):
    job = world.upload("slow")
    world.wait_to_run(job)
    world.wait_for_process("work")
    world.slurm.lose_node(world.processes("work") + world.processes("run-attempt"))
    world.wait(job, "queued")
    assert world.slurm.return_node()
    found = world.wait(job, *FINAL, seconds=120)
    assert (found["state"], found["attempts"]) == ("done", 1), found


def killed_service_takes_up_its_jobs(world):
    running, waiting = world.upload("slow"), world.upload("hang", site="other")
    world.wait_to_run(running)
    world.wait_until(waiting, lambda one: one["engine"] and one["engine"]["id"])
    number = world.job(waiting)["engine"]["id"]
    world.stop()
    time.sleep(4)  # the first ends without a service
    world.start()
    found = world.wait(running, *FINAL)
    assert (found["state"], found["attempts"], found["map_version"]) == ("done", 1, len(world.versions())), found
    found = world.wait_to_run(waiting)
    assert (found["attempts"], found["engine"]["id"]) == (1, number), found
    world.ask("POST", f"/api/v1/jobs/{waiting}/cancel", b"")
    world.wait(waiting, "cancelled")


def lost_controller_is_waited_for(world):
    job = world.upload("slow")
    world.wait_to_run(job)
    world.wait_for_process("work")
    world.slurm.kill("slurmctld")
    assert world.wait(job, *FINAL)["state"] == "done"  # by its own last word
    later = world.upload("ok")
    found = world.wait_until(later, lambda one: one["engine"] and one["engine"]["reason"])
    assert found["state"] == "queued", found
    world.slurm.start_controller()
    assert world.wait(later, *FINAL, seconds=120)["state"] == "done"


def late_job_meets_its_limit(world):
    world.stop()
    os.environ["JOB_MINUTES"] = "1"
    world.start()
    del os.environ["JOB_MINUTES"]
    # One is ended by its own watch, one by Slurm.
    job = world.upload("busy")
    other = world.upload("busy", site="other")
    world.wait_to_run(other)
    os.kill(world.wait_for_process("run-attempt", of=other), signal.SIGSTOP)
    found = world.wait(job, *FINAL)
    assert (found["state"], found["error_code"]) == ("failed", "time_limit"), found
    assert "took longer than 45 seconds" in found["error"], found
    found = world.wait(other, *FINAL, seconds=180)
    assert (found["state"], found["error_code"]) == ("failed", "time_limit"), found
    assert "Slurm stopped the job" in found["error"], found


CASES = (done_and_published, bad_input_is_told, a_full_node_means_queued, cancelled_within_seconds,
         killed_worker_is_started_again, failed_node_is_survived, killed_service_takes_up_its_jobs,
         lost_controller_is_waited_for)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--kills", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*", default=[], help="parts of the names of cases, or kills")
    arguments = parser.parse_args()
    if reason := install():
        print(f"skipped: no Slurm: {reason}")
        return SKIPPED
    failures = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        slurm = OneNodeSlurm(folder / "slurm")
        os.environ.update(SLURM_CONF=slurm.environment["SLURM_CONF"], ENGINE="slurm")
        try:
            if not slurm.start():
                print("skipped: Slurm does not start here:", (slurm.folder / "slurmd.log").read_text()[-500:])
                return SKIPPED
            long_cases = (late_job_meets_its_limit,) if arguments.kills >= 50 or arguments.only else ()
            for case in CASES + long_cases:
                if arguments.only and not any(part in case.__name__ for part in arguments.only):
                    continue
                world = World(arguments.program, folder, slurm, case.__name__)
                begun = time.monotonic()
                try:
                    case(world)
                    print(f"{case.__name__}: well after {time.monotonic() - begun:.1f} s", flush=True)
                except AssertionError as error:
                    failures += 1
                    print(f"{case.__name__}: {error}", flush=True)
                world.stop()
                slurm.ask("scancel", "--user=root")
            if arguments.kills and (not arguments.only or "kills" in arguments.only):
                world = World(arguments.program, folder, slurm, "kills")
                for wrong in survive_kills(world, arguments.kills, random.Random(arguments.seed)):
                    failures += 1
                    print(wrong, flush=True)
                world.stop()
        finally:
            slurm.stop()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
