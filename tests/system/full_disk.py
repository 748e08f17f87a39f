"""A small disk that can be filled to its last block, a service on it, and readers that must notice nothing."""

import hashlib
import http.client
import json
import os
import subprocess
import threading
import time

from power_cut_test import Disk, Service, free_port

LISTS = ("/api/v1/drives", "/api/v1/jobs", "/api/v1/sites", "/healthz")
MESH = "/api/v1/sites/first/maps/1/map.glb"
FINAL = ("done", "failed", "cancelled")
BLOCK = 4096


class SmallDisk(Disk):
    def free(self):
        info = os.statvfs(self.mount_point)
        return info.f_bavail * info.f_frsize

    def fill(self, leave=0):
        """Takes all room but `leave` bytes; without any, the last block too."""
        with open(self.mount_point / "filling", "ab") as filling:
            piece = self.free() - leave
            while piece >= BLOCK:
                try:
                    os.posix_fallocate(filling.fileno(), filling.seek(0, os.SEEK_END), piece)
                except OSError:
                    pass
                piece = min(piece // 2, self.free() - leave)

    def make_room(self):
        (self.mount_point / "filling").unlink()
        os.sync()


class RealService(Service):
    """`parkade serve` with its own workers, where Service has scripted ones."""

    def __init__(self, program, data):
        self.port = free_port()
        self.process = subprocess.Popen([program, "serve", "--data", data, "--listen", f"127.0.0.1:{self.port}",
                                         "--disk-reserve", "0"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 60
        while time.monotonic() < end and self.process.poll() is None:
            try:
                if self.ask("GET", "/healthz")[0] == 200:
                    return
            except OSError:
                time.sleep(0.05)
        self.kill()
        raise RuntimeError("the service does not start")


class Readers(threading.Thread):
    """Asks for lists and the mesh of a map without a pause, and notes what is not answered well."""

    def __init__(self, service, sha256):
        super().__init__(daemon=True)
        self.service, self.sha256 = service, sha256
        self.is_over, self.answers, self.failures = threading.Event(), 0, []

    def run(self):
        while not self.is_over.wait(0.005):
            for path in (*LISTS, MESH):
                try:
                    status, _, body = self.service.ask("GET", path)
                except (OSError, http.client.HTTPException) as error:
                    status, body = repr(error), b""
                whole = hashlib.sha256(body).hexdigest() == self.sha256 if path == MESH else body
                self.answers += 1
                if status != 200 or not whole:
                    self.failures.append(f"GET {path}: {status}, {len(body)} bytes")

    def stop(self):
        self.is_over.set()
        self.join()


class World:
    """A service with one map, on a disk of its own."""

    def __init__(self, disk, service, log):
        self.disk, self.service = disk, service
        self.drives = {}  # id: hash of the log, as acknowledged
        assert self.job(self.upload(log, "first"))["state"] == "done"
        status, _, mesh = service.ask("GET", MESH)
        assert status == 200
        self.readers = Readers(service, hashlib.sha256(mesh).hexdigest())
        self.readers.start()

    def ask(self, method, path, body=None, headers=None):
        """Status and body; an answer that is not 2xx has to be a problem in the words of RFC 9457."""
        if isinstance(body, dict):
            body, headers = json.dumps(body).encode(), {"Content-Type": "application/json"}
        status, fields, answer = self.service.ask(method, path, body, headers)
        if status >= 300:
            assert fields["Content-Type"] == "application/problem+json", (path, status, answer)
            problem = json.loads(answer)
            assert problem["status"] == status and problem["detail"], problem
            if status == 507:
                assert problem["code"] == "disk_full", problem
        return status, answer

    def make_room(self):
        """After the readers have had some time with a full disk."""
        enough, end = self.readers.answers + 50, time.monotonic() + 30
        while self.readers.answers < enough:
            assert time.monotonic() < end, "nobody can read on the full disk"
            time.sleep(0.02)
        self.disk.make_room()

    def upload(self, log, site):
        status, answer = self.ask("PUT", f"/api/v1/drives?filename=a.bag&site={site}", log)
        assert status == 201, answer
        answer = json.loads(answer)
        self.drives[answer["drive"]["id"]] = hashlib.sha256(log).hexdigest()
        return answer["job"]["id"]

    def job(self, job, states=FINAL, seconds=120):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            status, answer = self.ask("GET", f"/api/v1/jobs/{job}")
            assert status == 200, answer
            if json.loads(answer)["state"] in states:
                return json.loads(answer)
            time.sleep(0.05)
        raise AssertionError(f"job {job} is not {states} after {seconds} s: {answer}")

    def take_until_refused(self, ask, limit=5000):
        """How often `ask` was acknowledged before the full disk refused it."""
        for count in range(limit):
            status, answer = ask(count)
            if status == 507:
                return count
            assert 200 <= status < 300, (status, answer)
        raise AssertionError(f"{limit} changes are acknowledged on a full disk")

    def losses(self):
        """What was acknowledged and is not there."""
        found = []
        for drive, sha256 in self.drives.items():
            status, answer = self.ask("GET", f"/api/v1/drives/{drive}")
            log = self.disk.mount_point / "data/logs" / sha256[:2] / sha256
            if status != 200 or json.loads(answer)["sha256"] != sha256:
                found.append(f"drive {drive}: {status}")
            elif hashlib.sha256(log.read_bytes()).hexdigest() != sha256:
                found.append(f"log of drive {drive}")
        return found
