#!/usr/bin/env python3
"""The long versions of the tests that break something, one after the other, with what each took.

    fault_tests.py PARKADE PARKADE_SERVE_PROGRAM PARKADE_SERVER_HTTP_TESTS [--only PART...]

Fails where one does. Those that this machine lacks something for are named as skipped.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import time

from power_cut_test import SKIPPED

HERE = pathlib.Path(__file__).resolve().parent
TESTS = HERE.parent


def runs_of(arguments, folder):
    python, service = sys.executable, arguments.service
    return {
        "power cuts": [python, HERE / "power_cut_test.py", service, "--cuts", "100"],
        "power cuts are noticed": [python, HERE / "power_cut_test.py", service, "--cuts", "2", "--lose-syncs"],
        "failing syncs": [arguments.http_tests, "--gtest_brief=1", "--gtest_filter=*FailingSync*"],
        "kills in an upload of 2 GiB": ["node", TESTS / "server/http/uploads/tus_client_test.mjs", service, folder / "tus",
                                        "2048", "50"],
        "kills at the steps of publishing": [python, HERE / "publish_test.py", service],
        "full disk": [python, HERE / "full_disk_test.py", service, arguments.parkade],
        "slow clients": [python, TESTS / "bench/http/slow_clients.py", "--limit", "100", "--", arguments.parkade, "serve",
                         "--data", "{data}", "--web", "{web}", "--listen", "127.0.0.1:0"],
        "kills at Slurm": [python, HERE / "slurm_test.py", service, "--kills", "50"],
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("parkade")
    parser.add_argument("service")
    parser.add_argument("http_tests")
    parser.add_argument("--only", nargs="*", default=[], help="parts of names")
    arguments = parser.parse_args()
    ends, begun = {}, time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for name, command in runs_of(arguments, pathlib.Path(folder)).items():
            if arguments.only and not any(part in name for part in arguments.only):
                continue
            print(f"== {name}", flush=True)
            started = time.monotonic()
            status = subprocess.run(command, check=False).returncode
            word = {0: "well", SKIPPED: "skipped"}.get(status, f"FAILED ({status})")
            ends[name] = (word, time.monotonic() - started)
    print(f"== {(time.monotonic() - begun) / 60:.1f} minutes")
    for name, (word, seconds) in ends.items():
        print(f"{name}: {word}, {seconds:.0f} s")
    return 1 if any(word.startswith("FAILED") for word, _ in ends.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
