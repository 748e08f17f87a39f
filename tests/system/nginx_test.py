#!/usr/bin/env python3
"""The service behind the real nginx with the site that is shipped (packaging/nginx.conf).

    nginx_test.py PARKADE_SERVE_PROGRAM

Exits with 77 where there is no nginx.
"""

import base64
import hashlib
import http.client
import json
import pathlib
import random
import ssl
import sys
import tempfile
import time
import unittest
import warnings

import nginx_site
from nginx_site import HOST

PROGRAM = sys.argv[1]
TUS = {"Tus-Resumable": "1.0.0"}
MESH = "/api/v1/sites/lot/maps/1/map.glb"


def status_of(answer):
    return int(answer.split(b" ", 2)[1]) if answer.startswith(b"HTTP/1.1 ") else 0


class BehindNginx(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        folder = pathlib.Path(cls.temporary.name)
        cls.service = nginx_site.Service([PROGRAM, "serve", "{data}"], folder, LOG_FORMAT="json", PROXY_HOST=HOST,
                                         ACCEL_REDIRECT="/parkade-files/")
        cls.nginx = nginx_site.Nginx(folder, cls.service)
        status, _, body = cls.nginx.ask("PUT", "/api/v1/drives?filename=a.bag&site=lot", b"log ok\nclean\n")
        assert status == 201, body
        cls.wait_for(lambda: cls.nginx.ask("HEAD", MESH)[0] == 200)

    @classmethod
    def tearDownClass(cls):
        cls.nginx.stop()
        cls.service.stop()
        cls.temporary.cleanup()

    @staticmethod
    def wait_for(probe, seconds=60):
        end = time.monotonic() + seconds
        while not probe():
            if time.monotonic() > end:
                raise AssertionError("waited in vain")
            time.sleep(0.05)

    def log_lines(self):
        return [json.loads(line) for line in self.service.log.read_text().splitlines()]

    def get(self, path, **headers):
        return self.nginx.ask("GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()})

    def test_a_log_of_many_megabytes_arrives_whole_by_put(self):
        log = b"log ok\nclean\n" + random.Random(1).randbytes(40 << 20)
        status, _, body = self.nginx.ask("PUT", "/api/v1/drives?filename=b.bag&site=other", log)
        self.assertEqual(status, 201, body)
        self.assertEqual(json.loads(body)["drive"]["sha256"], hashlib.sha256(log).hexdigest())

    def test_and_in_parts(self):
        log = b"log ok\nclean\n" + random.Random(2).randbytes(20 << 20)
        name = base64.b64encode(b"c.bag").decode()
        status, fields, body = self.nginx.ask("POST", "/api/v1/uploads", b"", {
            **TUS, "Upload-Length": str(len(log)), "Upload-Metadata": f"filename {name}"})
        self.assertEqual(status, 201, body)
        self.assertTrue(fields["Location"].startswith("/api/v1/uploads/"), fields["Location"])
        address, offset = fields["Location"], 0
        while offset < len(log):
            part = log[offset:offset + (8 << 20)]
            status, fields, body = self.nginx.ask("PATCH", address, part, {
                **TUS, "Upload-Offset": str(offset), "Content-Type": "application/offset+octet-stream"})
            self.assertEqual(status, 204, body)
            offset = int(fields["Upload-Offset"])
        drive = json.loads(self.get(f"/api/v1/drives/{fields['Upload-Drive']}")[2])
        self.assertEqual(drive["sha256"], hashlib.sha256(log).hexdigest())

    def test_files_come_from_nginx_as_the_service_would_send_them(self):
        direct_status, direct, content = self.service.ask("GET", MESH)
        status, fields, body = self.get(MESH)
        self.assertEqual((direct_status, status), (200, 200))
        self.assertEqual(body, content)
        self.assertIsNone(fields["X-Accel-Redirect"])
        self.assertTrue(fields["Last-Modified"], "the service sends none: nginx did")
        for name in ("ETag", "Content-Type", "Cache-Control", "X-Content-Type-Options", "Content-Security-Policy",
                     "Referrer-Policy", "Cross-Origin-Resource-Policy"):
            self.assertEqual(fields.get_all(name), direct.get_all(name), name)
        self.assertTrue(fields["X-Request-ID"] and fields["Strict-Transport-Security"])

        etag = fields["ETag"]
        self.assertEqual(etag, '"' + hashlib.sha256(content).hexdigest() + '"')
        self.assertEqual(self.get(MESH, If_None_Match=etag)[0], 304)
        status, fields, body = self.get(MESH, Range="bytes=2-4", If_Range=etag)
        self.assertEqual((status, body), (206, content[2:5]))
        self.assertEqual(fields["Content-Range"], f"bytes 2-4/{len(content)}")
        self.assertEqual(self.get(MESH, Range="bytes=2-4", If_Range='"other"')[2], content)
        self.assertEqual(self.get(MESH, Range="bytes=999-")[0], 416)
        self.assertEqual(self.get(MESH, Range="bytes=0-1,3-4")[0], 416)

    def test_nothing_else_of_the_data_is_reachable(self):
        for path in ("/parkade-files/maps/", "/parkade-files/db/main.db", "/parkade-files/maps/../db/main.db",
                     "/parkade-files/maps..%2fdb/main.db", "/metrics"):
            self.assertEqual(self.get(path)[0], 404, path)

    def test_events_come_at_once(self):
        with self.nginx.connect() as client:
            authorization = "Authorization: " + self.service.fields["Authorization"]
            client.sendall(f"GET /api/v1/events HTTP/1.1\r\nHost: {HOST}\r\n{authorization}\r\n\r\n".encode())
            received = b""
            while b"retry:" not in received:
                received += client.recv(65536)
            began = time.monotonic()
            status, _, body = self.service.ask("PUT", "/api/v1/drives?filename=e.bag&site=events", b"log slow\nclean\n")
            self.assertEqual(status, 201)
            drive = json.loads(body)["drive"]["id"].encode()
            while drive not in received:
                received += client.recv(65536)
            self.assertLess(time.monotonic() - began, 1.5, "the job takes 2 s")

    def test_clients_cannot_say_who_they_are(self):
        forged = {"X-Real-IP": "203.0.113.66", "X-Forwarded-For": "203.0.113.66", "X-Forwarded-Proto": "gopher",
                  "X-Request-ID": "forged", "Forwarded": "for=203.0.113.66"}
        status, fields, _ = self.nginx.ask("GET", "/healthz", headers=forged)
        self.assertEqual(status, 200)
        identity = fields["X-Request-ID"]
        self.assertRegex(identity, r"^[0-9a-f]{32}$")
        lines = []
        self.wait_for(lambda: lines.extend(line for line in self.log_lines() if line.get("request") == identity) or lines)
        self.assertEqual(lines[0]["client"], "127.0.0.1")
        answer = self.nginx.say(f"GET /healthz HTTP/1.1\r\nHost: {HOST}\r\nX-Real-IP: 1.2.3.4\r\nConnection: close\r\n\r\n",
                                source="127.0.0.9")
        self.assertEqual(status_of(answer), 200)
        self.wait_for(lambda: any(line.get("client") == "127.0.0.9" for line in self.log_lines()))
        self.assertFalse(any(line.get("client") == "1.2.3.4" for line in self.log_lines()))
        self.assertEqual(self.nginx.ask("GET", "/healthz", headers={"REMOTE_ADDR": "1.2.3.4"})[0], 200)
        self.assertFalse(any(line.get("client") == "1.2.3.4" for line in self.log_lines()))

    def test_requests_that_read_in_two_ways_are_refused(self):
        head = f"POST /api/v1/sites/lot/maps HTTP/1.1\r\nHost: {HOST}\r\n"
        hidden = "GET /api/v1/drives?hidden HTTP/1.1\r\nHost: x\r\n\r\n"
        length = f"Content-Length: {len(hidden)}\r\n"
        for title, text in {
                "both lengths": head + length + "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n" + hidden,
                "two lengths": head + "Content-Length: 0\r\n" + length + "\r\n" + hidden,
                "a space before the colon": head + "Content-Length : 0\r\n\r\n" + hidden,
                "an encoding of its own": head + "Transfer-Encoding: xchunked\r\n\r\n0\r\n\r\n" + hidden,
                "a body of a GET": f"GET /healthz HTTP/1.1\r\nHost: {HOST}\r\n{length}\r\n{hidden}",
                "two hosts": f"GET /healthz HTTP/1.1\r\nHost: {HOST}\r\nHost: x\r\n\r\n",
                "a foreign host": "GET /healthz HTTP/1.1\r\nHost: elsewhere.example\r\nConnection: close\r\n\r\n",
                "a line break in a target": f"GET /healthz%0d%0aX: HTTP/1.1\r\nHost: {HOST}\r\nConnection: close\r\n\r\n",
        }.items():
            answer = self.nginx.say(text)
            self.assertIn(status_of(answer), (400, 403, 411, 501), f"{title}: {answer[:300]}")
        self.assertFalse(any("hidden" in json.dumps(line) or line.get("path") == "/api/v1/drives" and line["status"] == 403
                             for line in self.log_lines()))
        self.assertEqual(self.get("/healthz")[0], 200)

    def test_nobody_gets_in_without_a_token(self):
        for path in ("/api/v1/drives", MESH, "/api/v1/events"):
            self.assertEqual(self.nginx.ask("GET", path, headers={"Authorization": ""})[0], 401, path)
        status, fields, _ = self.nginx.ask("POST", "/api/v1/session", json.dumps(
            {"token": self.service.fields["Authorization"].removeprefix("Bearer ")}), {"Authorization": ""})
        self.assertEqual(status, 201)
        self.assertRegex(fields["Set-Cookie"], "^__Host-parkade=.*; HttpOnly; SameSite=Strict.*; Secure$")

    def test_large_heads_and_bodies_are_refused(self):
        line = f"GET /healthz HTTP/1.1\r\nHost: {HOST}\r\nX-Long: {'a' * 20_000}\r\n\r\n"
        self.assertEqual(status_of(self.nginx.say(line)), 400)
        many = f"GET /healthz HTTP/1.1\r\nHost: {HOST}\r\n" + "".join(f"X-{i}: {'a' * 500}\r\n" for i in range(200)) + "\r\n"
        self.assertEqual(status_of(self.nginx.say(many)), 400)
        long_target = f"GET /{'a' * 20_000} HTTP/1.1\r\nHost: {HOST}\r\n\r\n"
        self.assertEqual(status_of(self.nginx.say(long_target)), 414)
        body = f"POST /api/v1/sites/lot/maps HTTP/1.1\r\nHost: {HOST}\r\nContent-Length: 999999999\r\n\r\n"
        self.assertEqual(status_of(self.nginx.say(body)), 413)
        part = f"PATCH /api/v1/uploads/0123456789abcdef HTTP/1.1\r\nHost: {HOST}\r\nContent-Length: 999999999\r\n\r\n"
        self.assertEqual(status_of(self.nginx.say(part)), 413)

    def test_a_page_elsewhere_changes_nothing(self):
        self.assertEqual(self.nginx.ask("POST", "/api/v1/sites/lot/maps", b"{}", {"Origin": "https://elsewhere.example"})[0],
                         403)
        own = f"https://{HOST}:{self.nginx.port}"
        self.assertNotEqual(self.nginx.ask("POST", "/api/v1/sites/nowhere/maps", b"{}", {"Origin": own})[0], 403)

    def test_a_file_that_rots_is_not_sent(self):
        log = b"log ok\nclean\nrots"
        self.assertEqual(self.nginx.ask("PUT", "/api/v1/drives?filename=r.bag&site=rots", log)[0], 201)
        address = MESH.replace("lot", "rots")
        self.wait_for(lambda: self.get(address)[0] == 200)
        content = self.get(address)[2]
        found = [file for file in self.service.data.glob("maps/*/map.glb") if file.read_bytes() == content]
        for file in found:
            file.chmod(0o644)
            file.write_bytes(b"X" + content[1:])
        try:
            self.assertEqual(self.get(address)[0], 500)
        finally:
            for file in found:
                file.write_bytes(content)

    def test_old_tls_is_refused_and_plain_http_led_on(self):
        old = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        old.check_hostname, old.verify_mode = False, ssl.CERT_NONE
        old.set_ciphers("ALL:@SECLEVEL=0")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            old.minimum_version, old.maximum_version = ssl.TLSVersion.TLSv1, ssl.TLSVersion.TLSv1_1
        with self.assertRaises((ssl.SSLError, OSError)):
            self.nginx.connect(tls=old)
        connection = http.client.HTTPConnection("127.0.0.1", self.nginx.plain_port, timeout=20)
        connection.request("GET", "/a", headers={"Host": HOST})
        answer = connection.getresponse()
        self.assertEqual((answer.status, answer.headers["Location"]), (301, f"https://{HOST}/a"))
        connection.close()


if __name__ == "__main__":
    if nginx_site.missing():
        print("skipped: there is no " + " and no ".join(nginx_site.missing()))
        sys.exit(nginx_site.SKIPPED)
    unittest.main(argv=sys.argv[:1])
