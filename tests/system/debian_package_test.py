#!/usr/bin/env python3
"""The Debian package in a fresh root: it installs with what it depends on, serves, maps a drive, and leaves the data there.

    debian_package_test.py PACKAGE PARKADE_SIMULATE [--folder DIR] [--drive FOLDER]

Makes the smallest root that debootstrap knows, from the mirror that this machine's apt uses, installs the package with apt,
checks the unit, and runs the unit's own command as the unit's user in the root: systemd itself does not run there. The
service is alone in a network of its own. A drive is simulated, unless FOLDER holds lot.mcap and rig/. Takes minutes, 3 GB of disk, and root; exits with 77 without debootstrap.
"""

import argparse
import ctypes
import http.client
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

SKIPPED = 77
CLONE_NEWNET = 0x40000000
DRIVE = ["lot", "--seed", "1", "--duration", "24", "--rate", "5"]
UNIT = "usr/lib/systemd/system/parkade.service"


def say(text):
    print(f"== {text}", flush=True)


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def mirror():
    """Release and address of the archive that this machine's apt uses."""
    targets = output_of("apt-get", "indextargets", "--format", "$(CODENAME) $(COMPONENT) $(REPO_URI)",
                        "Created-By: Packages", "Origin: Debian", "Label: Debian")
    for line in targets.splitlines():
        codename, component, address = line.split(" ", 2)
        if component == "main" and "-" not in codename:
            return codename, address
    sys.exit("apt knows no mirror of Debian")


class Root:
    def __init__(self, folder):
        self.path = folder / "root"
        codename, address = mirror()
        subprocess.run(["debootstrap", "--variant=minbase", codename, self.path, address], check=True,
                       stdout=subprocess.DEVNULL)
        (self.path / "etc/apt/sources.list").write_text(f"deb {address} {codename} main\n")
        settings = [line for line in output_of("apt-config", "dump").splitlines() if re.match("Acquire::(https?|Retries|Check)", line)]
        (self.path / "etc/apt/apt.conf.d/90host").write_text("\n".join(settings) + "\n")
        if pathlib.Path("/etc/apt/auth.conf.d").is_dir():
            shutil.copytree("/etc/apt/auth.conf.d", self.path / "etc/apt/auth.conf.d", dirs_exist_ok=True)
        shutil.copy("/etc/resolv.conf", self.path / "etc/resolv.conf")
        # As in every root that is made for something else: services do not start.
        policy = self.path / "usr/sbin/policy-rc.d"
        policy.write_text("#!/bin/sh\nexit 101\n")
        policy.chmod(0o755)
        self.mounts = []
        for kind, where in (("proc", "proc"), ("sysfs", "sys"), ("tmpfs", "dev/shm")):
            (self.path / where).mkdir(exist_ok=True)
            subprocess.run(["mount", "-t", kind, kind, self.path / where], check=True)
            self.mounts.append(self.path / where)

    def run(self, *command, user=None, **keywords):
        return subprocess.run(self.command(*command, user=user), check=True, **keywords)

    def command(self, *command, user=None):
        as_user = [f"--userspec={user}:{user}"] if user else []
        return ["chroot", *as_user, str(self.path), "/usr/bin/env", "-i", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "LANG=C.UTF-8",
                "DEBIAN_FRONTEND=noninteractive", *command]

    def close(self):
        for where in reversed(self.mounts):
            subprocess.run(["umount", "-l", where], check=False)


def leave_network():
    """This process and what it starts see no network but a loopback device of their own."""
    if ctypes.CDLL(None, use_errno=True).unshare(CLONE_NEWNET) != 0:
        sys.exit("no network of its own: " + os.strerror(ctypes.get_errno()))
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)


class Service:
    """As the unit would start it."""

    def __init__(self, root):
        unit = (root.path / UNIT).read_text()
        setting = lambda name: re.search(rf"^{name}=(.*)$", unit, re.MULTILINE)[1]
        command = [word for word in shlex.split(setting("ExecStart")) if word != "$PARKADE_OPTIONS"]
        self.address = command[command.index("--listen") + 1]
        say("as " + setting("User") + ": " + " ".join(command))
        self.process = subprocess.Popen(root.command(*command, user=setting("User")), stderr=subprocess.PIPE, text=True)
        said = ""
        while "listening on" not in said:
            line = self.process.stderr.readline()
            said += line
            if not line:
                sys.exit("the service ended: " + said)

    def ask(self, method, path, body=None, headers=None):
        connection = http.client.HTTPConnection(self.address, timeout=120)
        try:
            connection.request(method, path, body, headers or {})
            answer = connection.getresponse()
            content = answer.read()
            if answer.status >= 300:
                sys.exit(f"{method} {path}: {answer.status} {content[:500]}")
            return content
        finally:
            connection.close()

    def stop(self):
        self.process.terminate()
        self.process.communicate(timeout=60)
        return self.process.returncode


def form_of(folder):
    lines = b""
    for file in folder.iterdir():
        lines += (f'--edge\r\nContent-Disposition: form-data; name="{file.name}"; filename="{file.name}"\r\n\r\n').encode()
        lines += file.read_bytes() + b"\r\n"
    return lines + b"--edge--\r\n", {"Content-Type": "multipart/form-data; boundary=edge"}


def map_drive(service, folder):
    """The size of the map.glb of a small simulated drive."""
    service.ask("PUT", "/api/v1/rigs/demo", *form_of(folder / "rig"))
    log = (folder / "lot.mcap").read_bytes()
    job = json.loads(service.ask("PUT", "/api/v1/drives?filename=lot.mcap&site=demo&rig=demo", log))["job"]["id"]
    began = time.monotonic()
    while (state := json.loads(service.ask("GET", f"/api/v1/jobs/{job}")))["state"] in ("queued", "running"):
        if time.monotonic() - began > 1200:
            sys.exit(f"the job does not end: {state}")
        time.sleep(1)
    if state["state"] != "done":
        sys.exit(f"{state}\n{service.ask('GET', f'/api/v1/jobs/{job}/log').decode()[-2000:]}")
    mesh = service.ask("GET", "/api/v1/sites/demo/maps/1/map.glb")
    assert mesh[:4] == b"glTF" and len(mesh) > 10_000, mesh[:100]
    return len(mesh), time.monotonic() - began


def check(arguments, folder):
    say("a fresh root")
    root = Root(folder)
    try:
        say("installing")
        shutil.copy(arguments.package, root.path / "parkade.deb")
        root.run("apt-get", "update", "-q", stdout=subprocess.DEVNULL)
        root.run("apt-get", "install", "-y", "-q", "--no-install-recommends", "/parkade.deb", stdout=subprocess.DEVNULL)
        print(f"{len(output_of(*root.command('dpkg-query', '-f', '.', '-W')))} packages, "
              f"{output_of('du', '-shx', root.path).split()[0]}")
        installed = root.path / "var/lib/parkade"
        owner = output_of(*root.command("stat", "-c", "%U %G %a", "/var/lib/parkade")).strip()
        assert owner == "parkade parkade 750", owner
        assert (root.path / "etc/systemd/system/multi-user.target.wants/parkade.service").is_symlink(), "not enabled"
        for file in ("share/doc/parkade/examples/nginx.conf", "share/doc/parkade/copyright", "share/parkade/web/index.html",
                     "share/parkade/models/freespace.onnx"):
            assert (root.path / "usr" / file).exists(), file
        say("the unit")
        root.run("apt-get", "install", "-y", "-q", "--no-install-recommends", "systemd", stdout=subprocess.DEVNULL)
        root.run("systemd-analyze", "verify", "--man=no", "parkade.service")

        drive = arguments.drive or folder
        if not arguments.drive:
            say("a drive")
            subprocess.run([arguments.simulate, *DRIVE, "--out", folder / "lot.mcap", "--rig-out", folder / "rig"],
                           check=True, stdout=subprocess.DEVNULL)
        leave_network()
        service = Service(root)
        assert b"<!doctype html>" in service.ask("GET", "/").lower()
        size, seconds = map_drive(service, drive)
        print(f"map.glb: {size} bytes, {seconds:.0f} s after the upload")
        assert service.stop() == 0, "the service did not end well"

        say("removing")
        database = installed / "db/main.db"
        for step in ("remove", "purge"):
            root.run("apt-get", step, "-y", "-q", "parkade", stdout=subprocess.DEVNULL)
            assert not (root.path / "usr/bin/parkade").exists()
            assert database.exists(), f"{step} took the data"
        assert not (root.path / "etc/default/parkade").exists()
    finally:
        root.close()
    say("the package installs, serves, maps, and leaves its data")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("package", type=pathlib.Path)
    parser.add_argument("simulate", type=pathlib.Path)
    parser.add_argument("--folder", help="on a disk with room")
    parser.add_argument("--drive", type=pathlib.Path)
    arguments = parser.parse_args()
    if os.geteuid() != 0 or not shutil.which("debootstrap"):
        print("skipped: needs root and debootstrap")
        return SKIPPED
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        check(arguments, pathlib.Path(folder))
    return 0


if __name__ == "__main__":
    sys.exit(main())
