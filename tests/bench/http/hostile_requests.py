#!/usr/bin/env python3
"""What hostile requests on the bare port cost the service [MiB], each by itself.

usage: hostile_requests.py PARKADE [--limit MIB]
"""

import argparse
import gzip
import io
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import time
import zipfile

HOST = b"Host: localhost\r\n"


def bomb(name):
    """A zip whose only file has 500 MB of zeros."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, bytes(500_000_000))
    return packed.getvalue()


def put(path, body, fields=b"", method=b"PUT"):
    return [method + b" " + path + b" HTTP/1.1\r\n" + HOST + fields + b"Content-Length: %d\r\n\r\n" % len(body) + body]


def requests():
    many = b",".join(b"%d-%d" % (i, i + 1) for i in range(2000))
    keys = b",".join(b"k%d YQ==" % i for i in range(3000))
    post = b"POST /api/v1/sites/x/maps HTTP/1.1\r\n" + HOST
    return {
        "endless head": [b"GET / HTTP/1.1\r\n" + HOST] + [b"X-%d: " % i + b"a" * 60000 + b"\r\n" for i in range(2000)],
        "endless line": [b"G" * 100_000] * 1000,
        "body of 16 MB": put(b"/api/v1/sites/x/maps", b"[" * 16_000_000, method=b"POST"),
        "body of 100 MB": put(b"/api/v1/upload-sets", b"[" * 100_000_000, method=b"POST"),
        "chunked body": [post + b"Transfer-Encoding: chunked\r\n\r\n"] + [b"100000\r\n" + bytes(0x100000) + b"\r\n"] * 100,
        "2000 ranges": [b"GET / HTTP/1.1\r\n" + HOST + b"Range: bytes=" + many + b"\r\n\r\n"],
        "gzip bomb": put(b"/api/v1/sites/x/maps", gzip.compress(bytes(100_000_000)), b"Content-Encoding: gzip\r\n",
                         method=b"POST"),
        "zip bomb for a log": put(b"/api/v1/drives?site=b&filename=b.zip", bomb("mav0/imu0/data.csv")),
        "zip bomb for a rig": put(b"/api/v1/rigs/car", bomb("imu0.yaml")),
        "two lengths": [post + b"Content-Length: 5\r\nContent-Length: 50\r\n\r\n" + b"x" * 1_000_000],
        "3000 words of an upload": [b"POST /api/v1/uploads HTTP/1.1\r\n" + HOST + b"Tus-Resumable: 1.0.0\r\n"
                                    b"Upload-Length: 9223372036854775807\r\nUpload-Metadata: " + keys + b"\r\n\r\n"],
    }


def ask(port, pieces):
    """The first line of the answer, if any."""
    with socket.create_connection(("127.0.0.1", port), timeout=10) as client:
        try:
            for piece in pieces:
                client.sendall(piece)
        except OSError:
            pass  # it is refused meanwhile
        try:
            return client.recv(600).split(b"\r\n")[0].decode()
        except OSError:
            return "no answer"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("parkade")
    parser.add_argument("--limit", type=float, default=16)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        service = subprocess.Popen([arguments.parkade, "serve", "--data", f"{folder}/data", "--listen", "127.0.0.1:0"],
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        line = next(line for line in service.stdout if "http://" in line)
        port = int(line.rsplit(":", 1)[1].split()[0])
        threading.Thread(target=lambda: [None for _ in service.stdout], daemon=True).start()
        process = pathlib.Path(f"/proc/{service.pid}")

        def peak():
            return next(int(line.split()[1]) for line in (process / "status").read_text().splitlines()
                        if line.startswith("VmHWM")) / 1024

        worst = 0
        for name, pieces in requests().items():
            (process / "clear_refs").write_text("5")  # the peak begins anew
            before = peak()
            answer = ask(port, pieces)
            time.sleep(0.5)
            cost = peak() - before
            worst = max(worst, cost)
            print(f"{name}: {cost:.1f} MiB, {answer}", flush=True)
        service.terminate()
        service.wait()
    return 0 if worst <= arguments.limit else 1


if __name__ == "__main__":
    sys.exit(main())
