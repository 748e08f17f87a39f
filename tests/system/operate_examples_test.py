#!/usr/bin/env python3
"""The examples of docs/service.md and docs/operate.md do what the pages say, against a real service.

    operate_examples_test.py PARKADE [--docs FOLDER]

Runs each command of the fenced `sh` blocks, in the order of the pages, in a folder that has what they
name: a drive, its rig, the data directory of a service. A comment `# 404` says which status of HTTP
an example is answered with; without one it is 2xx, and commands succeed. A block below
`<!-- not run: REASON -->` is left out.
"""

import argparse
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tarfile
import tempfile
import time

from full_disk import RealService
from standing_drive import CAMCHAIN, IMU, VEHICLE, write_drive

PAGES = ("service.md", "operate.md")
BLOCK = re.compile(r"(?:<!-- not run: (?P<reason>.+?) -->\n)?^```(?P<language>\w*)\n(?P<text>.*?)^```$", re.S | re.M)
ADDRESS = "http://127.0.0.1:8080"
CURL = """#!/bin/sh
# Says the status on a line of its own, and ends where events would go on for ever.
exec {curl} -sS --max-time 5 -w '%{{stderr}}\\nstatus %{{http_code}}\\n' "$@"
"""
TIMED_OUT = 28  # curl's exit status


def commands_of(text):
    """The commands of a block, each with all of its lines."""
    commands, begun = [], ""
    for line in text.splitlines():
        begun += line
        try:
            is_whole = not line.endswith("\\")
            shlex.split(begun, comments=True)
        except ValueError:  # a quotation goes on
            is_whole = False
        begun += "\n"
        if is_whole:
            if shlex.split(begun, comments=True):
                commands.append(begun.strip())
            begun = ""
    assert not begun, f"a command does not end: {begun}"
    return commands


def examples_of(page):
    """Pairs of a command and the reason why it is not run, if there is one."""
    for block in BLOCK.finditer(page.read_text()):
        assert block["language"], f"a block of {page.name} has no language:\n{block['text']}"
        if block["language"] == "sh":
            for command in commands_of(block["text"]):
                yield command, block["reason"]


class Desk:
    """A folder with what the examples name, and a service."""

    def __init__(self, folder, parkade):
        self.folder, self.parkade = folder, parkade
        self.token = ""
        (folder / "bin").mkdir()
        (folder / "bin/parkade").symlink_to(pathlib.Path(parkade).resolve())
        curl = subprocess.run(["which", "curl"], capture_output=True, text=True, check=True).stdout.strip()
        (folder / "bin/curl").write_text(CURL.format(curl=curl))
        (folder / "bin/curl").chmod(0o755)
        (folder / "rig").mkdir()
        for name, text in (("camchain-imucam", CAMCHAIN.format(topic="cam0")), ("imu0", IMU), ("vehicle", VEHICLE)):
            (folder / f"rig/{name}.yaml").write_text(text)
        with tarfile.open(folder / "drive.bag", "w") as archive:
            archive.add(write_drive(folder / "standing", seconds=4.0), arcname="standing")
        self.service = RealService(parkade, folder / "data")

    def run(self, command):
        """What is wrong with what a command does; nothing where it does as its page says."""
        wanted = re.search(r"#\s*(\d{3})\b", command)
        text = command.replace(ADDRESS, f"http://127.0.0.1:{self.service.port}").replace("/mnt/copy", f"{self.folder}/copy")
        if "token revoke" in text:
            text = text.replace("0123456789abcdef", self.id_of_token("car7"))
        environment = dict(os.environ, PATH=f"{self.folder}/bin:{os.environ['PATH']}", TOKEN=self.token)
        done = subprocess.run(["bash", "-c", text], cwd=self.folder, env=environment, capture_output=True, text=True,
                              timeout=120, check=False)
        if "token create anne" in text:
            self.token = done.stdout.strip().splitlines()[-1] if done.stdout.strip() else ""
        status = re.search(r"^status (\d+)$", done.stderr, re.M)
        is_endless = done.returncode == TIMED_OUT and " -N " in command
        if done.returncode != 0 and not is_endless:
            return f"exit status {done.returncode}: {done.stderr or done.stdout}"
        if status and not (status[1] == wanted[1] if wanted else status[1].startswith("2")):
            return f"{status[1]} and not {wanted[1] if wanted else '2xx'}: {done.stdout}"
        return None

    def id_of_token(self, name):
        listed = subprocess.run([self.parkade, "token", "list", "--data", self.folder / "data"], capture_output=True,
                                text=True, check=True).stdout
        return next(re.search(r"\b[0-9a-f]{16}\b", line)[0] for line in listed.splitlines() if name in line)

    def ask(self, method, path, body=None):
        status, _, answer = self.service.ask(method, path, body, {"Authorization": f"Bearer {self.token}"} if self.token else {})
        return status, json.loads(answer)

    def wait_for_jobs(self):
        """Until nothing is under way, so that the next example finds what the one before asked for."""
        for _ in range(1200):
            if not any(self.ask("GET", f"/api/v1/jobs?state={state}")[1]["items"] for state in ("queued", "running")):
                return
            time.sleep(0.1)
        raise AssertionError("jobs do not end")

    def provide(self, command):
        """What a page takes for granted: a third version on the service, a map in a folder."""
        if '"from":3' in command:
            while len(self.ask("GET", "/api/v1/sites/level-2")[1]["versions"]) < 3:
                assert self.ask("POST", "/api/v1/sites/level-2/maps", b"{}")[0] == 202
                self.wait_for_jobs()
        if "--from MAP" in command and not (self.folder / "MAP").exists():
            subprocess.run([self.parkade, "map", "drive.bag", "--rig", "rig", "--out", "MAP", "--quiet"], cwd=self.folder,
                           check=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("parkade")
    parser.add_argument("--docs", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[2] / "docs")
    arguments = parser.parse_args()
    failures = run_count = 0
    with tempfile.TemporaryDirectory() as name:
        desk = Desk(pathlib.Path(name), arguments.parkade)
        try:
            for page in PAGES:
                for command, reason in examples_of(arguments.docs / page):
                    if reason:
                        print(f"{page}: not run, {reason}: {command.splitlines()[0]}")
                        continue
                    desk.provide(command)
                    wrong = desk.run(command)
                    desk.wait_for_jobs()
                    run_count += 1
                    failures += wrong is not None
                    print(f"{page}: {'well' if wrong is None else 'WRONG'}: {command.splitlines()[0]}", flush=True)
                    if wrong:
                        print(f"  {wrong.strip()}", flush=True)
        finally:
            desk.service.kill()
    print(f"{run_count} examples, {failures} wrong")
    return 1 if failures or run_count < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
