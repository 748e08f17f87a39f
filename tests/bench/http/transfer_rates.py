#!/usr/bin/env python3
"""How fast maps go out and logs come in, beside what the machine does without the service.

usage: transfer_rates.py PARKADE_SERVE_PROGRAM [--runs N] [--map-mib N] [--log-mib N] [--folder DIR]

Downloads of a map.glb: from nginx that serves the file itself, from the service's port, through nginx with
X-Accel-Redirect and through nginx without, each in turn. Uploads of a log by PUT, which are hashed and synced, beside
`cp` and `sha256sum` of the same file, the copy synced and not; and the memory that the service's process grows by.
Prints MiB/s, and the ratios of the medians.
"""

import argparse
import json
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "system"))
import nginx_site  # noqa: E402
from nginx_site import HOST  # noqa: E402

MESH = "/api/v1/sites/lot/maps/1/map.glb"


def curl(*words):
    """[s] until curl has the answer."""
    began = time.monotonic()
    done = subprocess.run(["curl", "-sS", "--fail", "--insecure", *words], stdout=subprocess.PIPE, check=False)
    seconds = time.monotonic() - began
    if done.returncode != 0:
        sys.exit(f"curl {' '.join(words)} failed")
    return seconds, done.stdout


def say(title, mib, seconds):
    rates = sorted(mib / value for value in seconds)
    print(f"{title}: " + " ".join(f"{rate:.0f}" for rate in rates) + " MiB/s", flush=True)
    return statistics.median(rates)


def download(arguments, folder):
    service = nginx_site.Service([arguments.program, "serve", "{data}"], folder, PROXY_HOST=HOST,
                                 ACCEL_REDIRECT="/parkade-files/", MAP_MIB=str(arguments.map_mib))
    try:
        service.ask("PUT", "/api/v1/drives?filename=a.bag&site=lot", b"log ok\nclean\n")
        while service.ask("HEAD", MESH)[0] != 200:
            time.sleep(0.1)
        file = next(service.data.glob("maps/*/map.glb"))
        # The same nginx serves the file itself, and hands requests on in plain HTTP: TLS would hide the difference.
        nginx = nginx_site.Nginx(folder, service, more=f"""
  server {{
    listen 127.0.0.1:{{free_port}};
    proxy_max_temp_file_size 0;
    location = /map.glb {{ alias {file}; }}
    location /proxied/ {{ proxy_set_header Host localhost; proxy_http_version 1.1; proxy_pass http://parkade/; }}
    location /parkade-files/maps/ {{ internal; etag off; alias {service.data}/maps/; add_header ETag $upstream_http_etag; }}
    location / {{ proxy_set_header Host {HOST}; proxy_http_version 1.1; proxy_pass http://parkade; }}
  }}""")
        try:
            plain = f"http://127.0.0.1:{nginx.extra_port}"
            ways = {"nginx itself": f"{plain}/map.glb",
                    "the service": f"http://127.0.0.1:{service.port}{MESH}",
                    "nginx, X-Accel-Redirect": plain + MESH,
                    "nginx, handed on": f"{plain}/proxied{MESH}",
                    "nginx, X-Accel-Redirect, TLS": f"https://{HOST}:{nginx.port}{MESH}"}
            resolve = ["--resolve", f"{HOST}:{nginx.port}:127.0.0.1", "-H",
                       "Authorization: " + service.fields["Authorization"]]
            seconds = {way: [] for way in ways}
            for _ in range(arguments.runs + 1):
                for way, address in ways.items():
                    seconds[way].append(curl(*resolve, "-o", "/dev/null", address)[0])
            rates = {way: say(f"download, {way}", arguments.map_mib, values[1:]) for way, values in seconds.items()}
            for way, rate in rates.items():
                print(f"  {way}: {rate / rates['nginx itself']:.2f} of nginx itself")
        finally:
            nginx.stop()
    finally:
        service.stop()


def memory_of(service, name):
    status = pathlib.Path(f"/proc/{service.process.pid}/status").read_text()
    return int(status.split(name + ":")[1].split()[0]) / 1024


def upload(arguments, folder):
    log, copy = folder / "a.bag", folder / "copy"
    rng = random.Random(1)
    with log.open("wb") as file:
        file.write(b"log ok\nclean\n")
        for _ in range(arguments.log_mib):
            file.write(rng.randbytes(1 << 20))
    service = nginx_site.Service([arguments.program, "serve", "{data}"], folder)
    seconds = {"PUT": [], "cp, sha256sum": [], "cp, sync, sha256sum": []}
    growth = []
    try:
        for _ in range(arguments.runs):
            subprocess.run(["sync"], check=True)
            before = memory_of(service, "VmRSS")
            pathlib.Path(f"/proc/{service.process.pid}/clear_refs").write_text("5")  # VmHWM begins anew
            taken, answer = curl("-T", str(log), f"http://127.0.0.1:{service.port}/api/v1/drives?filename=a.bag&site=lot")
            seconds["PUT"].append(taken)
            growth.append(memory_of(service, "VmHWM") - before)
            answer = json.loads(answer)
            while json.loads(service.ask("GET", f"/api/v1/jobs/{answer['job']['id']}")[2])["state"] not in ("done", "failed"):
                time.sleep(0.1)
            service.ask("DELETE", f"/api/v1/drives/{answer['drive']['id']}")
            for way, sync in (("cp, sha256sum", []), ("cp, sync, sha256sum", ["sync", str(copy)])):
                subprocess.run(["sync"], check=True)
                began = time.monotonic()
                subprocess.run(["cp", log, copy], check=True)
                if sync:
                    subprocess.run(sync, check=True)
                subprocess.run(["sha256sum", copy], stdout=subprocess.DEVNULL, check=True)
                seconds[way].append(time.monotonic() - began)
                copy.unlink()
        rates = {way: say(f"upload, {way}", arguments.log_mib, values) for way, values in seconds.items()}
        for way in ("cp, sha256sum", "cp, sync, sha256sum"):
            print(f"  PUT: {rates['PUT'] / rates[way]:.2f} of {way}")
        print("  memory grown by at most: " + " ".join(f"{value:.1f}" for value in growth) + " MiB")
    finally:
        service.stop()


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--map-mib", type=int, default=200)
    parser.add_argument("--log-mib", type=int, default=1024)
    parser.add_argument("--folder", help="on the disk to measure")
    arguments = parser.parse_args()
    for measure in (download, upload):
        with tempfile.TemporaryDirectory(dir=arguments.folder) as name:
            measure(arguments, pathlib.Path(name))


if __name__ == "__main__":
    main()
