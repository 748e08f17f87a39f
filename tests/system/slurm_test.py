#!/usr/bin/env python3
"""Jobs at a real Slurm of one node: none is lost, none is published twice.

    slurm_test.py PARKADE_SERVE_PROGRAM [--kills N] [--seed S] [--only PART...]

Installs Slurm where it is missing and starts it in a folder of its own. First one case after the
other; then N random kills of the service, workers, the node and the controller while jobs run.
Exits with 77 where there can be no Slurm.
"""

import argparse
import json
import os
import pathlib
import random
import signal
import sys
import tempfile
import threading
import time

from one_node_slurm import OneNodeSlurm, install
from power_cut_test import SKIPPED, Service

FINAL = ("done", "failed", "cancelled")


def wait_for(is_so, seconds=10):
    end = time.monotonic() + seconds
    while not is_so():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.05)


class World:
    """A Slurm, a data directory, and services that come and go."""

    def __init__(self, program, folder, slurm, name):
        self.program, self.slurm, self.data = program, slurm, folder / name
        self.service = None
        self.start()

    def start(self):
        self.service = Service(self.program, self.data, lose_syncs=False)

    def stop(self):
        self.service.kill()

    def ask(self, method, path, body=None):
        status, _, answer = self.service.ask(method, path, body)
        return status, json.loads(answer) if answer else None

    def upload(self, todo, site="lot"):
        log = f"log {todo}\nclean\n{random.random()}\n".encode()
        status, answer = self.ask("PUT", f"/api/v1/drives?filename=a.bag&site={site}", log)
        assert status == 201, answer
        return answer["job"]["id"]

    def job(self, job):
        return self.ask("GET", f"/api/v1/jobs/{job}")[1]

    def wait(self, job, *states, seconds=90):
        return self.wait_until(job, lambda found: found["state"] in states, seconds)

    def wait_until(self, job, is_so, seconds=90):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            found = self.job(job)
            if is_so(found):
                return found
            time.sleep(0.05)
        raise AssertionError(f"{found} after {seconds} s\n{self.slurm.ask('squeue', '-l')}")

    def wait_to_run(self, job):
        """At Slurm, not only in the service's hands, which reads the log first."""
        return self.wait_until(job, lambda found: found["state"] == "running" and found["engine"])

    def versions(self):
        return [(site["name"], version) for site in self.ask("GET", "/api/v1/sites?limit=200")[1]["items"]
                for version in site["versions"]]

    def processes(self, word):
        """Of this data directory's attempts: "work" for workers, "run-attempt" for what starts them."""
        found = []
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                words = (process / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            # Not the shell that Slurm starts, and only until it is that program.
            if len(words) > 2 and words[1] == word.encode() and any(
                    one.startswith(str(self.data).encode()) for one in words):
                found.append(int(process.name))
        return found

    def wait_for_process(self, word):
        for _ in range(600):
            if found := self.processes(word):
                return found[0]
            time.sleep(0.05)
        raise AssertionError(f"no process {word}")

    def active_at_slurm(self):
        return self.slurm.ask("squeue", "-h", "-t", "PENDING,RUNNING,SUSPENDED", "-o", "%i").split()

    def left_behind(self):
        """What attempts leave that have ended: nothing but what they said."""
        return [path for path in self.data.glob("jobs/*/attempt-*/*") if path.name in ("out", "input", "tmp", "runs")]


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
    blocker = world.slurm.ask("sbatch", "--parsable", "--exclusive", "--wrap", "sleep 600").strip()
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
    os.kill(next(pid for pid in world.processes("run-attempt") if other.encode() in
                 pathlib.Path(f"/proc/{pid}/cmdline").read_bytes()), signal.SIGSTOP)
    found = world.wait(job, *FINAL)
    assert (found["state"], found["error_code"]) == ("failed", "time_limit"), found
    assert "took longer than 45 seconds" in found["error"], found
    found = world.wait(other, *FINAL, seconds=180)
    assert (found["state"], found["error_code"]) == ("failed", "time_limit"), found
    assert "Slurm stopped the job" in found["error"], found


CASES = (done_and_published, bad_input_is_told, a_full_node_means_queued, cancelled_within_seconds,
         killed_worker_is_started_again, failed_node_is_survived, killed_service_takes_up_its_jobs,
         lost_controller_is_waited_for)


class Killer:
    """Kills whatever there is, at random."""

    def __init__(self, world, rng):
        self.world, self.rng = world, rng
        self.counts = {}

    def kill(self):
        ways = (self.service, self.service, self.worker, self.worker, self.runner, self.node, self.controller)
        way = self.rng.choice(ways)
        self.counts[way.__name__] = self.counts.get(way.__name__, 0) + bool(way())

    def service(self):
        self.world.stop()
        time.sleep(self.rng.uniform(0, 2))
        self.world.start()
        return True

    def process(self, word):
        found = self.world.processes(word)
        if found:
            os.kill(self.rng.choice(found), signal.SIGKILL)
        return bool(found)

    def worker(self):
        return self.process("work")

    def runner(self):
        return self.process("run-attempt")

    def node(self):
        self.world.slurm.lose_node(self.world.processes("work") + self.world.processes("run-attempt"))
        time.sleep(self.rng.uniform(0, 2))
        return self.world.slurm.return_node()

    def controller(self):
        self.world.slurm.kill("slurmctld")
        time.sleep(self.rng.uniform(0, 2))
        self.world.slurm.start_controller()
        return True


def survive_kills(world, kills, rng):
    """What is wrong after `kills` kills: jobs that were lost, or published twice or by halves."""
    jobs, is_over = {}, threading.Event()

    def upload():
        while not is_over.is_set():
            try:
                active = sum(1 for state in ("queued", "running")
                             for _ in world.ask("GET", f"/api/v1/jobs?state={state}")[1]["items"])
                if active < 6:
                    jobs[world.upload(rng.choice(("ok", "slow", "slow")), site=f"lot{rng.randrange(6)}")] = None
            except (OSError, AssertionError, ValueError):
                pass  # killed meanwhile: not acknowledged
            is_over.wait(0.3)

    uploader = threading.Thread(target=upload)
    uploader.start()
    killer = Killer(world, rng)
    while sum(killer.counts.values()) < kills:
        time.sleep(rng.uniform(0.2, 2.5))
        killer.kill()
    is_over.set()
    uploader.join()
    print(f"  {killer.counts}", flush=True)
    # A killed controller may give a number twice, and takes the node out of use then.
    world.slurm.ask("scontrol", "update", f"nodename={world.slurm.host}", "state=resume")

    wrong, ends = [], {}
    for job in jobs:
        try:
            found = world.wait(job, *FINAL, seconds=300)
        except AssertionError as error:
            wrong.append(f"lost: {error}")
            continue
        ends[found["state"]] = ends.get(found["state"], 0) + 1
        jobs[job] = found
        # Three crashes of one job are its end.
        if found["state"] != "done" and (found["error_code"] != "crashed" or found["attempts"] < 3):
            wrong.append(f"ended badly: {found}")
    of_job = {}
    for site, version in world.versions():
        manifest = world.ask("GET", f"/api/v1/sites/{site}/maps/{version}")[1]
        of_job.setdefault(manifest["job"], []).append(version)
        for file in manifest["files"]:
            if world.service.ask("GET", file["url"])[0] != 200:
                wrong.append(f"{file['url']} is visible and damaged")
    wrong += [f"job {job} published {versions}" for job, versions in of_job.items() if len(versions) > 1]
    wrong += [f"job {job} is done without a map" for job, found in jobs.items()
              if found and found["state"] == "done" and of_job.get(job) != [found["map_version"]]]
    time.sleep(8)  # strays are ended
    wrong += [f"stray at Slurm: {job}" for job in world.active_at_slurm()]
    wrong += [f"left behind: {path}" for path in world.left_behind()]
    print(f"  {sum(killer.counts.values())} kills, {len(jobs)} jobs acknowledged, {ends}, {len(wrong)} wrong", flush=True)
    return wrong


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
            long_cases = (late_job_meets_its_limit,) if arguments.kills >= 50 else ()
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
