#!/usr/bin/env python3
"""The Debian package holds what it should, depends on what the program loads, and lintian, where it is, finds no error.

    package_contents_test.py BUILD_FOLDER

Exits with 77 where packages cannot be made.
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv[1])


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        subprocess.run(["cpack", "--config", BUILD / "CPackConfig.cmake", "-B", cls.folder.name], check=True,
                       stdout=subprocess.DEVNULL)
        cls.package, = pathlib.Path(cls.folder.name).glob("parkade_*_amd64.deb")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_holds_program_viewer_models_unit_and_documents(self):
        files = {line.split()[-1].lstrip(".") for line in output_of("dpkg-deb", "-c", self.package).splitlines()}
        for wanted in ("/usr/bin/parkade", "/usr/share/parkade/web/index.html", "/usr/share/parkade/models/freespace.onnx",
                       "/usr/share/parkade/models/level.onnx", "/usr/share/parkade/models/outlines.onnx",
                       "/usr/lib/systemd/system/parkade.service", "/etc/default/parkade",
                       "/usr/share/doc/parkade/examples/nginx.conf", "/usr/share/doc/parkade/operate.md",
                       "/usr/share/doc/parkade/copyright", "/usr/share/doc/parkade/changelog.gz"):
            self.assertIn(wanted, files)

    def test_depends_on_what_the_program_loads(self):
        depends = output_of("dpkg-deb", "-f", self.package, "Depends")
        for library in ("libc6", "libsqlite3-0", "libcpp-httplib0.11", "libopencv-core406", "libopenblas0-pthread", "adduser"):
            self.assertIn(library, depends)

    def test_lintian_finds_no_error(self):
        if not shutil.which("lintian"):
            self.skipTest("there is no lintian")
        found = subprocess.run(["lintian", "--allow-root", "--fail-on", "error", self.package], capture_output=True, text=True)
        self.assertEqual(found.returncode, 0, found.stdout)


if __name__ == "__main__":
    if not shutil.which("dpkg-shlibdeps") or not shutil.which("cpack"):
        print("skipped: there is no dpkg-shlibdeps or no cpack")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
