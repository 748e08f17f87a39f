#!/usr/bin/env python3
"""A service that is killed at each step of publishing a map: readers find the old version or the new one, whole.

    publish_test.py PARKADE_SERVE_PROGRAM [--every N] [--all]

When a worker has made its map, strace(1) takes hold of the thread that publishes it. A first run
lists the thread's calls that write, sync, rename or remove: the steps. In each further one the
service is killed as it begins one of them. Four readers meanwhile ask for the latest version and
compare all its files with its manifest. The next service has to publish the job, once. Exits with
77 where there is no strace.
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
         "fallocate,write,pwrite64,fsync,fdatasync,sync_file_range")
OTHER_CALLS = ",openat,fcntl"  # leave the disk as it is, but for locks
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
                time.sleep(0.01)
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
    def __init__(self, program, data, calls):
        self.program, self.data, self.calls, self.is_over = program, data, calls, threading.Event()
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


def publish(world, number, kill_at=None):
    """Publishes a job's map: the job, whether the service was killed, and the calls of the thread that publishes.

    `kill_at` is a call and how often the thread has made it then, counted from 1."""
    job = world.upload("slow", number)["job"]["id"]
    progress = world.data / "jobs" / job / "worker/attempt-1/progress.ndjson"
    while not progress.exists():
        time.sleep(0.01)
    service = world.service.process
    thread = thread_of_job(service.pid)
    world.service.freeze()  # until the worker has made its map
    while '"mesh"' not in progress.read_text():
        time.sleep(0.01)
    time.sleep(0.1)
    trace = world.data.parent / "trace"
    inject = ["-e", f"inject={kill_at[0]}:signal=SIGKILL:when={kill_at[1]}"] if kill_at else []
    strace = subprocess.Popen(["strace", "-qq", "-o", str(trace), "-p", thread, "-e", f"trace={world.calls}", *inject],
                              stderr=subprocess.DEVNULL)
    tracer = pathlib.Path(f"/proc/{service.pid}/task/{thread}/status")
    while "TracerPid:\t0\n" in tracer.read_text():
        time.sleep(0.01)
    service.send_signal(signal.SIGCONT)
    end = time.monotonic() + 60
    is_published = False
    while service.poll() is None and not is_published:
        assert time.monotonic() < end, "neither killed nor published"
        time.sleep(0.02)
        try:
            is_published = world.job(job)["state"] == "done" and not world.attempts_in_use(job)
        except (OSError, http.client.HTTPException):
            time.sleep(0.05)  # killed just now
    if service.poll() is None:
        strace.send_signal(signal.SIGTERM)
    strace.wait()
    time.sleep(0.1)  # it may be killed just after it has published
    calls = [line.split("(")[0] for line in trace.read_text().splitlines() if "(" in line and line[0].isalpha()]
    return job, service.poll() is not None, calls


def thread_of_job(pid):
    """The thread of the service that started the worker, and will publish its map."""
    for _ in range(500):
        for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
            if (task / "children").read_text():
                return task.name
        time.sleep(0.01)
    raise AssertionError("no thread has a worker")


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
    """How often the service was killed, and what was wrong then."""
    calls = publish(world, 1)[2]
    steps = [(call, calls[:i + 1].count(call)) for i, call in enumerate(calls)][::arguments.every]
    failures, kills = [], 0
    for number, step in enumerate(steps):
        versions = world.ask("GET", SITE)["versions"]
        job, is_killed, _ = publish(world, 2 + number, step)
        if not is_killed:
            continue  # this time there were fewer such calls
        kills += 1
        found = faults_after(world, job, versions)
        for reader in readers:
            found += [f"a reader: {fault}" for fault in reader.failures]
            reader.failures.clear()
        failures += [f"{step}: {fault}" for fault in found]
        for fault in found[:3]:
            print(f"{step}: {fault}", flush=True)
    print(f"{len(calls)} steps: " + ", ".join(f"{calls.count(call)} {call}" for call in sorted(set(calls))))
    return kills, failures


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--every", type=int, default=1, help="N-th step")
    parser.add_argument("--all", action="store_true", help="also at calls that open and lock")
    arguments = parser.parse_args()
    if shutil.which("strace") is None:
        print("skipped: there is no strace")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        world = World(arguments.program, pathlib.Path(folder) / "data",
                      CALLS + OTHER_CALLS if arguments.all else CALLS)
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
    print(f"killed at {kills} of them, {sum(reader.num_read for reader in readers)} versions read whole by 4 readers, "
          f"{len(failures)} mixed, missing or lost")
    return 1 if failures or kills == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
