#!/usr/bin/env python3
"""What healthy clients of the service notice of slow ones, on this machine.

usage: slow_clients.py [--heads N] [--bodies N] [--readers N] [--seconds S] [--limit MS] -- COMMAND ...

COMMAND starts a service on a free port; {data} and {web} in it stand for folders that are made:
  slow_clients.py -- parkade serve --data {data} --web {web} --listen 127.0.0.1:0
  slow_clients.py --readers 0 -- parkade_serve_program serve {data}

Slow clients send a byte per second of a head or of a drive log, or read one of a large file; those
that the service ends come again. Prints latencies [ms] of healthy requests, each in a connection of
its own, before the slow ones come and while they are there. Fails where one is lost, or p99 is over the limit.
"""

import argparse
import multiprocessing
import re
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

LARGE_FILE = "/assets/large-12345678.js"
PATHS = ["/healthz", "/api/v1/drives", "/metrics", "/"]
PATIENCE = 30.0  # [s] for one healthy request
HEAD = "GET /healthz HTTP/1.1\r\nX-Field: "
BODY = "PUT /api/v1/drives?site=slow HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000000\r\n\r\n"
READER = f"GET {LARGE_FILE} HTTP/1.1\r\nHost: localhost\r\n\r\n"


def start(command, folder):
    """The process and the port it listens on."""
    web = folder / "web"
    (web / "assets").mkdir(parents=True)
    (web / "index.html").write_text("<!doctype html>")
    (web / LARGE_FILE[1:]).write_bytes(bytes(8 << 20))
    command = [word.format(data=folder / "data", web=web) for word in command]
    log = folder / "log"
    process = subprocess.Popen(command, stderr=log.open("w"))
    for _ in range(200):
        found = re.search(r"listening on http://[^:]+:(\d+)", log.read_text())
        if found:
            return process, int(found[1])
        time.sleep(0.05)
    process.kill()
    sys.exit(f"the service does not listen: {log.read_text()}")


def connect(port, text, small_window=False):
    client = socket.socket()
    if small_window:
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    client.settimeout(1.0)
    try:
        client.connect(("127.0.0.1", port))
        client.sendall(text.encode())
    except OSError:
        pass
    client.setblocking(False)
    return client


def is_open(client, reads):
    """Does the slow client's one step of a second; false once the service has ended it."""
    try:
        if not reads:
            client.send(b"x")
        return client.recv(1) != b"" and reads
    except BlockingIOError:
        return True
    except OSError:
        return False


def be_slow(port, counts, num_ended, stop):
    kinds = [(HEAD, False)] * counts[0] + [(BODY, False)] * counts[1] + [(READER, True)] * counts[2]
    clients = [connect(port, text, reads) for text, reads in kinds]
    while not stop.wait(1.0):
        for i, (text, reads) in enumerate(kinds):
            if is_open(clients[i], reads):
                continue
            clients[i].close()
            clients[i] = connect(port, text, reads)
            num_ended.value += 1


def ask(port, path):
    """[s] until the whole answer is there; PATIENCE where it does not come."""
    began = time.monotonic()
    try:
        with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as client:
            client.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode())
            answer = b""
            while piece := client.recv(65536):
                answer += piece
        if not answer.startswith((b"HTTP/1.1 200", b"HTTP/1.1 404")):
            return PATIENCE
    except OSError:
        return PATIENCE
    return time.monotonic() - began


def measure(port, seconds):
    durations, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        durations += [ask(port, path) for path in PATHS]
        time.sleep(0.02)
    return sorted(durations)


def say(title, durations):
    at = lambda share: 1000 * durations[min(int(share * len(durations)), len(durations) - 1)]
    num_lost = sum(duration >= PATIENCE for duration in durations)
    print(f"{title}: n={len(durations)} p50={at(0.5):.2f} p99={at(0.99):.2f} max={at(1):.2f} lost={num_lost}",
          flush=True)
    return num_lost == 0, at(0.99)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--heads", type=int, default=300)
    parser.add_argument("--bodies", type=int, default=300)
    parser.add_argument("--readers", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--limit", type=float, default=float("inf"), help="[ms] of p99 beside slow clients")
    parser.add_argument("command", nargs="+")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        service, port = start(arguments.command, Path(folder))
        stop, num_ended = multiprocessing.Event(), multiprocessing.Value("i")
        counts = (arguments.heads, arguments.bodies, arguments.readers)
        slow = multiprocessing.Process(target=be_slow, args=(port, counts, num_ended, stop))
        try:
            say("alone", measure(port, 3))
            slow.start()
            time.sleep(3)
            none_lost, p99 = say(f"beside {counts[0]} heads, {counts[1]} bodies, {counts[2]} readers",
                                 measure(port, arguments.seconds))
            print(f"slow clients ended meanwhile: {num_ended.value}")
        finally:
            stop.set()
            if slow.pid:
                slow.join()
            service.terminate()
            service.wait(30)
    return 0 if none_lost and p99 <= arguments.limit else 1


if __name__ == "__main__":
    sys.exit(main())
