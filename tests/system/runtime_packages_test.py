#!/usr/bin/env python3
"""Every library that the program is linked with comes from a package that `install_packages.sh --runtime` installs,
directly or because one of those depends on it.

runtime_packages_test.py PARKADE INSTALL_SCRIPT
"""

import pathlib
import re
import shutil
import subprocess
import sys
import unittest

PARKADE, SCRIPT = sys.argv[1], pathlib.Path(sys.argv[2])


def output_of(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def listed_packages():
    array = re.search(r"^runtime_packages=\((.*?)^\)", SCRIPT.read_text(), re.MULTILINE | re.DOTALL).group(1)
    return array.split()


def with_dependencies(packages):
    text = output_of("apt-cache", "depends", "--recurse", "--installed", "--no-recommends", "--no-suggests",
                     "--no-conflicts", "--no-breaks", "--no-replaces", "--no-enhances", *packages)
    return {line.split(":")[0] for line in text.splitlines() if line and not line.startswith((" ", "<", "|"))}


def names_of(library):
    """dpkg knows a file by the name it was unpacked under, before or after /lib became /usr/lib."""
    paths = {library, str(pathlib.Path(library).resolve())}
    return paths | {path.removeprefix("/usr") for path in paths}


def owners_of(libraries):
    """Each library with its package, or None."""
    names = [name for library in libraries for name in names_of(library)]
    text = subprocess.run(["dpkg", "-S", *names], capture_output=True, text=True).stdout
    owners = {name: package for package, name in re.findall(r"^([^:,\s]+)\S*: (/\S+)$", text, re.MULTILINE)}
    return {library: next((owners[name] for name in names_of(library) if name in owners), None)
            for library in libraries}


class RuntimePackages(unittest.TestCase):
    def test_hold_every_library_the_program_loads(self):
        if not shutil.which("dpkg") or not shutil.which("apt-cache"):
            self.skipTest("not a Debian system")
        packages = with_dependencies(listed_packages())
        loaded = re.findall(r"=> (/\S+)", output_of("ldd", PARKADE))
        self.assertGreater(len(loaded), 10)
        missing = {library: owner for library, owner in owners_of(loaded).items() if owner not in packages}
        self.assertEqual({}, missing)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
