#!/usr/bin/env python3
"""What clients of the API notice of jobs that use every core, on this machine.

usage: api_beside_jobs.py PARKADE DRIVE RIG [--jobs N] [--seconds S] [--runs N]

Starts a service with as many workers as jobs, and gives it the drive for each (demo-data/lot.mcap and demo-data/rig, which
./demo.sh leaves). Prints latencies [ms] of requests,
each in a connection of its own, while nothing is mapped, and while all jobs are, again and again.
"""

import argparse
import http.client
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

PATHS = ["/healthz", "/api/v1/drives", "/api/v1/jobs", "/api/v1/sites", "/metrics"]


def ask(port, method, path, body=None, headers=None):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    try:
        connection.request(method, path, body, headers or {})
        answer = connection.getresponse()
        content = answer.read()
        if answer.status >= 300:
            sys.exit(f"{method} {path}: {answer.status} {content[:300]}")
        return content
    finally:
        connection.close()


def measure(port, seconds):
    durations, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        for path in PATHS:
            began = time.monotonic()
            ask(port, "GET", path)
            durations.append(time.monotonic() - began)
        time.sleep(0.02)
    return sorted(durations)


def say(title, durations):
    at = lambda share: 1000 * durations[min(int(share * len(durations)), len(durations) - 1)]
    print(f"{title}: n={len(durations)} p50={at(0.5):.2f} p99={at(0.99):.2f} max={at(1):.2f} "
          f"(load of the machine {os.getloadavg()[0]:.1f})", flush=True)


def put_rig(port, folder):
    lines = b""
    for file in folder.iterdir():
        lines += f'--edge\r\nContent-Disposition: form-data; name="{file.name}"; filename="{file.name}"\r\n\r\n'.encode()
        lines += file.read_bytes() + b"\r\n"
    ask(port, "PUT", "/api/v1/rigs/demo", lines + b"--edge--\r\n", {"Content-Type": "multipart/form-data; boundary=edge"})


def num_running(port):
    jobs = json.loads(ask(port, "GET", "/api/v1/jobs"))["items"]
    if any(job["state"] == "failed" for job in jobs):
        sys.exit(f"a job failed: {jobs}")
    return sum(job["state"] == "running" for job in jobs)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program")
    parser.add_argument("drive", type=pathlib.Path)
    parser.add_argument("rig", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=10, help="of each run")
    parser.add_argument("--runs", type=int, default=5)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        log = (folder / "log").open("w+")
        service = subprocess.Popen([arguments.program, "serve", "--data", folder / "data", "--listen", "127.0.0.1:0", "--workers",
                                    str(arguments.jobs)], stderr=log)
        try:
            port = None
            while service.poll() is None and port is None:
                time.sleep(0.1)
                log.seek(0)
                found = re.search(r"listening on http://[^:]+:(\d+)", log.read())
                port = int(found[1]) if found else None
            put_rig(port, arguments.rig)
            say("alone", measure(port, arguments.seconds))
            content = arguments.drive.read_bytes()
            for number in range(arguments.jobs):
                ask(port, "PUT", f"/api/v1/drives?filename={arguments.drive.name}&site=site{number}&rig=demo", content)
            while num_running(port) < arguments.jobs:
                time.sleep(0.1)
            for _ in range(arguments.runs):
                durations = measure(port, arguments.seconds)
                say(f"beside {num_running(port)} jobs", durations)
        finally:
            service.terminate()
            service.wait(60)


if __name__ == "__main__":
    main()
