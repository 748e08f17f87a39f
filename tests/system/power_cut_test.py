#!/usr/bin/env python3
"""Power cuts while logs are uploaded, by PUT and by tus: what was acknowledged is there afterwards.

    power_cut_test.py PARKADE_SERVE_PROGRAM [--cuts N] [--lose-syncs]

The service writes to an ext4 of its own, in a file. At any moment it is stopped, the filesystem is
shut down without writing its journal (FS_IOC_SHUTDOWN, as a power cut leaves it), mounted again, and
a new service has to know everything that the old one acknowledged. With --lose-syncs the service's
syncs do nothing, and the test succeeds only if it notices that. Needs root; exits with 77 where a
filesystem cannot be mounted.
"""

import argparse
import base64
import fcntl
import hashlib
import http.client
import json
import os
import pathlib
import random
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

FS_IOC_SHUTDOWN = 0x8004587D
NO_LOG_FLUSH = 2
SKIPPED = 77
TUS = {"Tus-Resumable": "1.0.0"}


def run(*command):
    return subprocess.run(command, check=False, capture_output=True).returncode == 0


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Disk:
    """An ext4 in a file."""

    def __init__(self, folder):
        self.image, self.mount_point = folder / "disk", folder / "mnt"
        self.mount_point.mkdir()
        with open(self.image, "wb") as image:
            image.truncate(400 << 20)
        if not run("mkfs.ext4", "-q", "-F", "-m0", str(self.image)) or not self.mount():
            print("skipped: no filesystem can be mounted here")
            sys.exit(SKIPPED)

    def mount(self):
        return run("mount", "-o", "loop", str(self.image), str(self.mount_point))

    def unmount(self):
        for _ in range(100):
            if run("umount", str(self.mount_point)):
                return
            time.sleep(0.05)
        raise RuntimeError("the filesystem stays busy")

    def leave(self):
        try:
            self.unmount()
        except RuntimeError:
            run("umount", "-l", str(self.mount_point))

    def cut_power(self):
        folder = os.open(self.mount_point, os.O_RDONLY)
        fcntl.ioctl(folder, FS_IOC_SHUTDOWN, struct.pack("I", NO_LOG_FLUSH))
        os.close(folder)

    def restore_power(self):
        for _ in range(100):
            self.unmount()
            assert self.mount(), "the filesystem cannot be mounted any more"
            if self.takes_writes():
                return
            time.sleep(0.1)  # a mount namespace of somebody else's still holds the one that was shut down
        raise RuntimeError("the filesystem stays shut down")

    def takes_writes(self):
        try:
            (self.mount_point / "probe").touch()
            (self.mount_point / "probe").unlink()
            return True
        except OSError:
            return False


class Service:
    def __init__(self, program, data, lose_syncs):
        self.port = free_port()
        environment = dict(os.environ, LISTEN=f"127.0.0.1:{self.port}")
        if lose_syncs:
            environment["LOSE_SYNCS"] = "1"
        self.process = subprocess.Popen([program, "serve", str(data)], env=environment, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)
        end = time.monotonic() + 60
        while time.monotonic() < end and self.process.poll() is None:
            try:
                if self.ask("GET", "/healthz")[0] == 200:
                    return
            except OSError:
                time.sleep(0.02)
        self.kill()
        raise RuntimeError("the service does not start")

    def ask(self, method, path, body=None, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        try:
            connection.request(method, path, body, headers or {})
            answer = connection.getresponse()
            return answer.status, dict(answer.getheaders()), answer.read()
        finally:
            connection.close()

    def freeze(self):
        """Stops it, so that nothing is acknowledged any more."""
        self.process.send_signal(signal.SIGSTOP)
        stat = pathlib.Path(f"/proc/{self.process.pid}/stat")
        while stat.read_text().rsplit(")", 1)[1].split()[0] != "T":
            time.sleep(0.001)

    def kill(self):
        self.process.kill()
        self.process.wait()


def make_log(rng, size):
    return b"log ok\nclean\n" + rng.randbytes(size)


class Uploader(threading.Thread):
    """Uploads logs until the service is gone, and notes what was acknowledged."""

    def __init__(self, service, seed):
        super().__init__()
        self.service, self.rng = service, random.Random(seed)
        self.drives = {}  # id: hash of the log
        self.offsets = {}  # address of an upload: (log, offset that was acknowledged)

    def run(self):
        try:
            while True:
                self.put() if self.rng.random() < 0.5 else self.resume()
        except (OSError, http.client.HTTPException, RuntimeError):
            pass

    def put(self):
        log = make_log(self.rng, self.rng.randrange(1, 200_000))
        status, _, body = self.service.ask("PUT", "/api/v1/drives?filename=a.bag", log)
        if status != 201:
            raise RuntimeError(status)
        self.drives[json.loads(body)["drive"]["id"]] = hashlib.sha256(log).hexdigest()

    def resume(self):
        log = make_log(self.rng, self.rng.randrange(100_000, 600_000))
        name = base64.b64encode(b"a.bag").decode()
        status, fields, _ = self.service.ask("POST", "/api/v1/uploads", b"", dict(
            TUS, **{"Upload-Length": str(len(log)), "Upload-Metadata": f"filename {name}"}))
        if status != 201:
            raise RuntimeError(status)
        address, offset = fields["Location"], 0
        self.offsets[address] = (log, 0)
        while offset < len(log):
            part = log[offset:offset + 150_000]
            status, fields, _ = self.service.ask("PATCH", address, part, dict(
                TUS, **{"Upload-Offset": str(offset), "Content-Type": "application/offset+octet-stream"}))
            if status != 204:
                raise RuntimeError(status)
            offset += len(part)
            self.offsets[address] = (log, offset)
        self.drives[fields["Upload-Drive"]] = hashlib.sha256(log).hexdigest()


def find_losses(service, data, uploaders):
    """What was acknowledged and is not there, or is not what it was."""
    losses = []
    for uploader in uploaders:
        for drive, sha256 in uploader.drives.items():
            status, _, body = service.ask("GET", f"/api/v1/drives/{drive}")
            log = data / "logs" / sha256[:2] / sha256
            if status != 200 or json.loads(body)["sha256"] != sha256:
                losses.append(f"drive {drive}: {status}")
            elif not log.exists() or hashlib.sha256(log.read_bytes()).hexdigest() != sha256:
                losses.append(f"log of drive {drive}")
        for address, (log, acknowledged) in uploader.offsets.items():
            status, fields, _ = service.ask("HEAD", address, headers=TUS)
            offset = int(fields.get("Upload-Offset", -1))
            if status != 200 or offset < acknowledged:
                losses.append(f"{address}: {status}, {offset} of {acknowledged} bytes")
                continue
            part = data / "uploads" / address.rsplit("/", 1)[1]
            if offset < len(log) and part.read_bytes()[:offset] != log[:offset]:
                losses.append(f"{address}: other bytes than were sent")
    for site in json.loads(service.ask("GET", "/api/v1/sites?limit=200")[2])["items"]:
        for version in site["versions"]:
            manifest = json.loads(service.ask("GET", f"/api/v1/sites/{site['name']}/maps/{version}")[2])
            for file in manifest["files"]:
                if service.ask("GET", file["url"])[0] != 200:
                    losses.append(f"{file['url']} is visible and damaged")
    return losses


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--cuts", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lose-syncs", action="store_true")
    arguments = parser.parse_args()

    rng = random.Random(arguments.seed)
    acknowledged = cuts_with_losses = 0
    with tempfile.TemporaryDirectory() as folder:
        disk = Disk(pathlib.Path(folder))
        try:
            for cut in range(arguments.cuts):
                data = disk.mount_point / f"data-{cut}"
                service = Service(arguments.program, data, arguments.lose_syncs)
                uploaders = [Uploader(service, rng.random()) for _ in range(3)]
                for uploader in uploaders:
                    uploader.start()
                time.sleep(rng.uniform(0.05, 0.9))
                service.freeze()
                disk.cut_power()
                service.kill()
                for uploader in uploaders:
                    uploader.join()
                disk.restore_power()
                acknowledged += sum(len(one.drives) + len(one.offsets) for one in uploaders)
                try:
                    service = Service(arguments.program, data, lose_syncs=False)
                    losses = find_losses(service, data, uploaders)
                    service.kill()
                except RuntimeError as error:
                    losses = [str(error)]
                cuts_with_losses += bool(losses)
                for loss in losses[:3]:
                    print(f"cut {cut}: {loss}", flush=True)
                run("rm", "-rf", str(data))
        finally:
            disk.leave()
    print(f"{arguments.cuts} cuts, {acknowledged} uploads acknowledged, {cuts_with_losses} cuts with losses")
    return 0 if (cuts_with_losses > 0) == arguments.lose_syncs else 1


if __name__ == "__main__":
    sys.exit(main())
