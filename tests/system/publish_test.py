#!/usr/bin/env python3
"""A service that is killed before each step of publishing a map: readers find the old version or the new one, whole.

    publish_test.py PARKADE_SERVE_PROGRAM [--every N] [--steps N]

While a worker is at its map, strace(1) takes hold of the service and kills it at the N-th call with
which any of its threads writes, syncs, renames or removes: one run per step, until one publishes
unharmed. Four readers meanwhile ask for the latest version and compare all its files with its
manifest. The next service has to publish the job, once. Exits with 77 where there is no strace.
"""

import argparse
import hashlib
import http.client
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

from power_cut_test import SKIPPED, Service

CALLS = ("rename,renameat,renameat2,link,linkat,unlink,unlinkat,rmdir,mkdir,mkdirat,chmod,fchmod,fchmodat,ftruncate,"
         "fallocate,pwrite64,fsync,fdatasync,sync_file_range")
SITE = "/api/v1/sites/lot"


class Reader(threading.Thread):
    """Reads the latest version again and again, and notes what is missing, older than before, or mixed."""

    def __init__(self, world):
        super().__init__(daemon=True)
        self.world, self.newest, self.num_read, self.failures = world, 0, 0, []

    def run(self):
        while not self.world.is_over.is_set():
            try:
                self.read()
            except (OSError, http.client.HTTPException):
                time.sleep(0.02)  # between two services

    def read(self):
        ask = self.world.service.ask
        status, fields, _ = ask("GET", SITE + "/maps/latest")
        version = int(fields["Location"].rsplit("/", 1)[1]) if status == 307 else 0
        if version < self.newest:
            self.failures.append(f"latest is {status} {version}, and was {self.newest}")
            return
        self.newest = version
        self.failures += faults_of_version(ask, version)
        status, fields, report = ask("GET", SITE + "/maps/latest/report.json")
        if status != 307 or int(fields["Location"].split("/")[-2]) < version:
            self.failures.append(f"latest/report.json is {status} after version {version}")
        self.num_read += 1


def faults_of_version(ask, version):
    """What of a version is missing, or is not what its manifest says."""
    status, _, body = ask("GET", f"{SITE}/maps/{version}")
    if status != 200:
        return [f"version {version} is {status}"]
    faults = []
    for file in json.loads(body)["files"]:
        status, _, content = ask("GET", file["url"])
        if status != 200 or hashlib.sha256(content).hexdigest() != file["sha256"]:
            faults.append(f"{file['url']} is {status} and not as its manifest says")
    return faults


class World:
    def __init__(self, program, data):
        self.program, self.data, self.is_over = program, data, threading.Event()
        self.service = Service(program, data, lose_syncs=False)

    def ask(self, method, path, body=None):
        status, _, answer = self.service.ask(method, path, body)
        assert 200 <= status < 300, (path, status, answer)
        return json.loads(answer)

    def upload(self, todo, number):
        """Each log gives other files, of its own name."""
        return self.ask("PUT", f"/api/v1/drives?filename=d{number}.bag&site=lot", f"log {todo}\nclean\n{number}\n".encode())

    def job(self, job):
        return self.ask("GET", f"/api/v1/jobs/{job}")

    def wait(self, job, state, seconds=60):
        end = time.monotonic() + seconds
        while self.job(job)["state"] != state:
            assert time.monotonic() < end, f"job {job} is not {state}: {self.job(job)}"
            time.sleep(0.05)

    def attempts_in_use(self, job):
        return list((self.data / "jobs" / job).glob("attempt-*/out"))

    def restart(self):
        self.service.process.wait()
        self.service = Service(self.program, self.data, lose_syncs=False)


def kill_at(world, step, number):
    """The job, and the call before which the service was killed; None where it published the job."""
    job = world.upload("slow", number)["job"]["id"]
    progress = world.data / "jobs" / job / "attempt-1/progress.ndjson"
    while not progress.exists():
        time.sleep(0.01)
    service = world.service.process
    # Threads of strace's own counting: each has its N-th call.
    trace = world.data.parent / "trace"
    strace = subprocess.Popen(["strace", "-f", "-qq", "-o", str(trace), "-p", str(service.pid), "-e", f"trace={CALLS}",
                               "-e", f"inject={CALLS}:signal=SIGKILL:when={step}"], stderr=subprocess.DEVNULL)
    end = time.monotonic() + 60
    is_published = False
    while service.poll() is None and not is_published:
        assert time.monotonic() < end, "neither killed nor published"
        time.sleep(0.02)
        try:
            is_published = world.job(job)["state"] == "done" and not world.attempts_in_use(job)
        except (OSError, http.client.HTTPException):
            time.sleep(0.05)  # killed just now
    if is_published:
        strace.send_signal(signal.SIGTERM)
    strace.wait()
    return job, None if is_published else last_call_of(trace)


def last_call_of(trace):
    """The call before which the service was killed."""
    calls = [line.split("(")[0].split()[-1] for line in trace.read_text().splitlines() if "(" in line and "+++" not in line]
    return calls[-1] if calls else "?"


def faults_after(world, job, versions):
    """What is wrong once the next service has published the job that was killed."""
    world.restart()
    now = world.ask("GET", SITE)["versions"]
    faults = [f"version {version} is gone" for version in versions if version not in now]
    for version in sorted(now)[-2:]:
        faults += faults_of_version(world.service.ask, version)
    world.wait(job, "done")
    published = world.ask("GET", SITE)["versions"]
    if len(published) != len(versions) + 1:
        faults.append(f"{versions} became {published}")
    return faults + faults_of_version(world.service.ask, max(published))


def try_steps(world, arguments, readers):
    failures, kills, step, number = [], 0, 1, 1
    while arguments.steps == 0 or kills < arguments.steps:
        versions = world.ask("GET", SITE)["versions"]
        job, call = kill_at(world, step, number)
        if call is None:
            break
        kills += 1
        print(f"step {step}: {call}", flush=True)
        found = faults_after(world, job, versions)
        failures += [f"step {step}: {fault}" for fault in found]
        for reader in readers:
            failures += [f"step {step}, a reader: {fault}" for fault in reader.failures]
            reader.failures.clear()
        for failure in failures[-3:] if found else ():
            print(failure, flush=True)
        step, number = step + arguments.every, number + 1
    return kills, failures


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--every", type=int, default=1, help="N-th step")
    parser.add_argument("--steps", type=int, default=0, help="at most")
    arguments = parser.parse_args()
    if shutil.which("strace") is None:
        print("skipped: there is no strace")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        world = World(arguments.program, pathlib.Path(folder) / "data")
        world.wait(world.upload("ok", 0)["job"]["id"], "done")
        readers = [Reader(world) for _ in range(4)]
        for reader in readers:
            reader.start()
        try:
            kills, failures = try_steps(world, arguments, readers)
        finally:
            world.is_over.set()
            for reader in readers:
                reader.join()
            world.service.kill()
    for failure in failures[:20]:
        print(failure)
    print(f"killed at {kills} steps, {sum(reader.num_read for reader in readers)} versions read whole by 4 readers, "
          f"{len(failures)} mixed, missing or lost")
    return 1 if failures or kills == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
