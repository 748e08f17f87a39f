#!/usr/bin/env python3
"""What healthy clients notice of a thousand slow ones behind nginx with the site that is shipped, on this machine.

usage: slow_through_nginx.py PARKADE_SERVE_PROGRAM [--slow N] [--seconds S] [--runs N]

A third of the slow clients send a byte per second of a head, a third one of a drive log, a third one of a part; they come
from many addresses, and again when they are ended. Prints latencies [ms] of healthy requests, each in a TLS connection of
its own that is open before, and in one that is made for it.
"""

import argparse
import multiprocessing
import pathlib
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "system"))
import nginx_site  # noqa: E402
from nginx_site import HOST  # noqa: E402

PATHS = ["/healthz", "/api/v1/drives", "/api/v1/sites"]
SLOW = [f"GET /healthz HTTP/1.1\r\nHost: {HOST}\r\nX-Field: ",
        f"PUT /api/v1/drives?site=slow HTTP/1.1\r\nHost: {HOST}\r\nContent-Length: 100000000\r\n\r\n",
        f"PATCH /api/v1/uploads/0123456789abcdef HTTP/1.1\r\nHost: {HOST}\r\nContent-Length: 60000000\r\n\r\n"]


def open_slow(nginx, number):
    client = nginx.connect(source=f"127.0.{1 + number % 40}.1")
    client.sendall(SLOW[number % len(SLOW)].encode())
    client.setblocking(False)
    return client


def be_slow(nginx, count, num_ended, num_open, stop):
    clients = {}
    while not stop.is_set():
        began = time.monotonic()
        for number in range(count):
            try:
                if number not in clients:
                    clients[number] = open_slow(nginx, number)
                else:
                    clients[number].send(b"x")
            except BlockingIOError:
                pass
            except OSError:
                num_ended.value += number in clients
                clients.pop(number, None)
        num_open.value = len(clients)
        stop.wait(max(0.0, 1.0 - (time.monotonic() - began)))


def ask(nginx, client, path):
    authorization = "Authorization: " + nginx.fields["Authorization"]
    client.sendall(f"GET {path} HTTP/1.1\r\nHost: {HOST}\r\n{authorization}\r\n\r\n".encode())
    answer = b""
    while b"\r\n\r\n" not in answer:
        answer += client.recv(65536) or sys.exit("a healthy request is not answered")
    head, body = answer.split(b"\r\n\r\n", 1)
    if not head.startswith(b"HTTP/1.1 200"):
        sys.exit(f"a healthy request is refused: {head[:200]}")
    length = int(head.lower().split(b"content-length:")[1].split(b"\r\n")[0])
    while len(body) < length:
        body += client.recv(65536)


def measure(nginx, seconds):
    """[s] of requests in a connection that is there, and in new ones."""
    kept, fresh, end = [], [], time.monotonic() + seconds
    client = nginx.connect()
    for number in range(1_000_000):
        if time.monotonic() > end:
            break
        path = PATHS[number % len(PATHS)]
        if number % 200 == 199:  # nginx ends one after a thousand requests
            client.close()
            client = nginx.connect()
        began = time.monotonic()
        ask(nginx, client, path)
        kept.append(time.monotonic() - began)
        began = time.monotonic()
        with nginx.connect() as new:
            ask(nginx, new, path)
        fresh.append(time.monotonic() - began)
        time.sleep(0.02)
    client.close()
    return sorted(kept), sorted(fresh)


def say(title, figures):
    for name, durations in zip(("kept", "new"), figures):
        at = lambda share: 1000 * durations[min(int(share * len(durations)), len(durations) - 1)]
        print(f"{title}, {name} connection: n={len(durations)} p50={at(0.5):.2f} p99={at(0.99):.2f} max={at(1):.2f}",
              flush=True)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program")
    parser.add_argument("--slow", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=15)
    parser.add_argument("--runs", type=int, default=3)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        service = nginx_site.Service([arguments.program, "serve", "{data}"], folder, PROXY_HOST=HOST)
        nginx = nginx_site.Nginx(folder, service)
        stop, num_ended, num_open = multiprocessing.Event(), multiprocessing.Value("i"), multiprocessing.Value("i")
        slow = multiprocessing.Process(target=be_slow, args=(nginx, arguments.slow, num_ended, num_open, stop))
        try:
            say("alone", measure(nginx, 5))
            slow.start()
            while num_open.value < arguments.slow:
                time.sleep(0.1)
            for _ in range(arguments.runs):
                say(f"beside {num_open.value} slow ones", measure(nginx, arguments.seconds))
            print(f"slow clients ended meanwhile: {num_ended.value}")
        finally:
            stop.set()
            if slow.pid:
                slow.join()
            nginx.stop()
            service.stop()


if __name__ == "__main__":
    main()
