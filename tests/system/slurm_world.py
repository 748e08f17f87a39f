"""A service with jobs at a Slurm of one node, and what can be asked of both."""

import json
import pathlib
import random
import time

from power_cut_test import Service

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

    def wait_for_process(self, word, of=""):
        """`of` is a job, where it matters whose."""
        for _ in range(600):
            for pid in self.processes(word):
                try:
                    if of.encode() in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes():
                        return pid
                except OSError:
                    pass  # ended meanwhile
            time.sleep(0.05)
        raise AssertionError(f"no process {word} {of}")

    def active_at_slurm(self):
        return self.slurm.ask("squeue", "-h", "-t", "PENDING,RUNNING,SUSPENDED", "-o", "%i").split()

    def left_behind(self):
        """What attempts leave that have ended: nothing but what they said."""
        return [
            path
            for path in [*self.data.glob("jobs/*/attempt-*/*"), *self.data.glob("jobs/*/worker/*")]
            if path.name not in ("log.txt", "work")
        ]
