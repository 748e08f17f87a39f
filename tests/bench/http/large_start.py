#!/usr/bin/env python3
"""How long a service with many drives and maps takes to start, on this machine.

usage: large_start.py PARKADE [--drives N] [--maps N] [--sites N] [--files N] [--runs N] [--data DIR]

Lets a service make an empty data directory, fills it as one that has run for long (each drive with its
log and its job, whose folder has a log; each map with small files), and starts it again and again.
Prints seconds until /readyz says 200: with what was just written in the page cache, and, as root,
with nothing in it.
"""

import argparse
import hashlib
import http.client
import json
import os
import pathlib
import re
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

TIME = "2026-01-01T00:00:00.000Z"


class Service:
    def __init__(self, program, data):
        self.log = tempfile.TemporaryFile("w+")
        self.began = time.monotonic()
        self.process = subprocess.Popen([program, "serve", "--data", data, "--listen", "127.0.0.1:0"],
                                        stderr=self.log)

    def seconds_until_ready(self):
        port = None
        while self.process.poll() is None:
            self.log.seek(0)
            found = re.search(r"listening on http://[^:]+:(\d+)", self.log.read())
            port = int(found[1]) if found else None
            if port and self.answers(port, "/readyz") == 200:
                return time.monotonic() - self.began
            time.sleep(0.005)
        self.log.seek(0)
        sys.exit("the service does not start: " + self.log.read())

    @staticmethod
    def answers(port, path):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
        try:
            connection.request("GET", path)
            return connection.getresponse().status
        except OSError:
            return 0
        finally:
            connection.close()

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(60)


def id_of(kind, number):
    return hashlib.sha256(f"{kind}{number}".encode()).hexdigest()[:16]


def write(path, content):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    path.chmod(0o444)
    return len(content), hashlib.sha256(content).hexdigest()


def fill(data, arguments):
    database = sqlite3.connect(data / "db/main.db")
    insert = lambda table, **row: database.execute(
        f"INSERT INTO {table} ({', '.join(row)}) VALUES ({', '.join('?' * len(row))})", list(row.values()))
    checked = lambda path: insert("file_checks", path=path, checked_at=TIME)
    for site in range(arguments.sites):
        insert("sites", name=f"site{site}", created_at=TIME)
    streams = json.dumps([{"topic": f"/camera/{i}", "rate": 10.0, "messages": 12000} for i in range(6)])
    for number in range(arguments.drives):
        drive, job, site = id_of("drive", number), id_of("job", number), f"site{number % arguments.sites}"
        log = f"log of drive {number}".encode()
        sha256 = hashlib.sha256(log).hexdigest()
        path = f"logs/{sha256[:2]}/{sha256}"
        write(data / path, log)
        checked(path)
        insert("drives", id=drive, name=f"drive{number}", filename="a.mcap", site=site, state="ready", bytes=len(log),
               sha256=sha256, streams=streams, created_at=TIME, updated_at=TIME, inspection_state="clean",
               inspection=json.dumps({"topics": json.loads(streams), "missing": []}))
        insert("jobs", id=job, site=site, state="done", attempt=1, created_at=TIME, started_at=TIME, finished_at=TIME)
        insert("job_drives", job=job, position=0, drive=drive)
        write(data / f"jobs/{job}/attempt-1/log.txt", b"mapped\n")
    for number in range(arguments.maps):
        version, folder = id_of("map", number), data / "maps" / id_of("map", number)
        drives = [id_of("drive", number + i * arguments.maps) for i in range(arguments.drives // arguments.maps)]
        insert("maps", id=version, site=f"site{number % arguments.sites}", version=number // arguments.sites + 1,
               job=id_of("job", number), sha256="0" * 64, created_at=TIME)
        for i in range(arguments.files):
            name = ["map.glb", "report.json"][i] if i < 2 else f"tiles/{i}.glb"
            size, sha256 = write(folder / name, f"file {i} of map {number}".encode())
            checked(f"maps/{version}/{name}")
            insert("map_files", map=version, name=name, bytes=size, sha256=sha256)
        for position, drive in enumerate(drives):
            insert("map_drives", map=version, position=position, drive=drive)
    database.commit()
    database.close()


def drop_caches():
    os.sync()
    pathlib.Path("/proc/sys/vm/drop_caches").write_text("3")


def measure(title, arguments, data, before=lambda: None):
    seconds = []
    for _ in range(arguments.runs):
        before()
        service = Service(arguments.program, data)
        seconds.append(service.seconds_until_ready())
        service.stop()
    print(f"{title}: " + " ".join(f"{value:.2f}" for value in sorted(seconds)), flush=True)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program")
    parser.add_argument("--drives", type=int, default=10_000)
    parser.add_argument("--maps", type=int, default=1_000)
    parser.add_argument("--sites", type=int, default=100)
    parser.add_argument("--files", type=int, default=30, help="of each map")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--data", help="folder to keep; one that is there is not filled again")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        data = pathlib.Path(arguments.data or folder) / "data"
        if not data.exists():
            service = Service(arguments.program, data)
            print(f"empty: {service.seconds_until_ready():.2f}")
            service.stop()
            fill(data, arguments)
        measure("in the page cache [s]", arguments, data)
        if os.geteuid() == 0:
            measure("not in the page cache [s]", arguments, data, drop_caches)


if __name__ == "__main__":
    main()
