"""packaging/nginx.conf with the real nginx, on free ports of this machine's loopback device, in a folder of its own."""

import http.client
import os
import pathlib
import re
import shutil
import socket
import ssl
import subprocess
import time

SITE = pathlib.Path(__file__).resolve().parents[2] / "packaging/nginx.conf"
HOST = "maps.example.org"
SKIPPED = 77

MAIN = """
daemon off;
{user}
pid {folder}/nginx.pid;
error_log {folder}/error.log warn;
worker_processes {workers};
worker_rlimit_nofile 16384;
events {{ worker_connections 8192; }}
http {{
  include /etc/nginx/mime.types;
  access_log off;
  sendfile on;
  client_body_temp_path {folder}/body;
  proxy_temp_path {folder}/proxy;
  fastcgi_temp_path {folder}/fastcgi;
  uwsgi_temp_path {folder}/uwsgi;
  scgi_temp_path {folder}/scgi;
  include {folder}/site.conf;
  {more}
}}
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def missing():
    """What this needs and is not here."""
    return [name for name in ("nginx", "openssl") if not shutil.which(name)]


class Service:
    """`command` is the service's, with "{data}" for its folder; it says where it listens. Behind a proxy it needs a
    token; `fields` are those of a request that shows it."""

    def __init__(self, command, folder, **environment):
        self.data, self.log, self.fields = folder / "data", folder / "service.log", {}
        token = folder / "token"
        if "PROXY_HOST" in environment:
            environment["ADMIN_TOKEN"] = str(token)
        command = [word.format(data=self.data) for word in command]
        with self.log.open("w") as log:
            self.process = subprocess.Popen(command, env=dict(os.environ, **environment), stdout=subprocess.DEVNULL,
                                            stderr=log)
        for _ in range(1200):
            found = re.search(r"listening on http://[^:]+:(\d+)", self.log.read_text())
            if found:
                self.port = int(found[1])
                if token.exists():
                    self.fields = {"Authorization": "Bearer " + token.read_text()}
                return
            if self.process.poll() is not None:
                break
            time.sleep(0.05)
        self.process.kill()
        raise RuntimeError("the service does not listen: " + self.log.read_text())

    def ask(self, method, path, body=None, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        try:
            connection.request(method, path, body, {**self.fields, **(headers or {})})
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read()
        finally:
            connection.close()

    def stop(self):
        self.process.terminate()
        try:
            self.process.wait(30)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


class Nginx:
    """`more` goes into its http block, with "{free_port}" for a port that becomes `extra_port`."""

    def __init__(self, folder, service, more="", workers=1):
        self.folder, self.fields = folder / "nginx", service.fields
        self.folder.mkdir()
        self.port, self.plain_port, self.extra_port = free_port(), free_port(), free_port()
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj", f"/CN={HOST}",
                        "-addext", f"subjectAltName=DNS:{HOST}", "-keyout", self.folder / "key.pem", "-out",
                        self.folder / "cert.pem"], check=True, capture_output=True)
        (self.folder / "site.conf").write_text(self.adapted(SITE.read_text(), service.port, service.data))
        (self.folder / "nginx.conf").write_text(MAIN.format(
            folder=self.folder, workers=workers, user="user root;" if os.geteuid() == 0 else "",
            more=more.replace("{free_port}", str(self.extra_port))))
        command = ["nginx", "-p", self.folder, "-c", self.folder / "nginx.conf", "-e", self.folder / "error.log"]
        checked = subprocess.run([*command, "-t"], capture_output=True, text=True)
        if checked.returncode != 0:
            raise RuntimeError(checked.stderr)
        self.process = subprocess.Popen(command)
        self.context = ssl.create_default_context(cafile=self.folder / "cert.pem")
        for _ in range(100):
            try:
                socket.create_connection(("127.0.0.1", self.port), timeout=5).close()
                return
            except OSError:
                time.sleep(0.05)
        self.stop()
        raise RuntimeError("nginx does not listen: " + (self.folder / "error.log").read_text())

    def adapted(self, text, service_port, data):
        """The site on other ports, with other files; whatever the shipped one lacks fails here."""
        for old, new in (
                ("server 127.0.0.1:8080;", f"server 127.0.0.1:{service_port};"),
                ("  listen 80;\n  listen [::]:80;\n", f"  listen 127.0.0.1:{self.plain_port};\n"),
                ("  listen 443 ssl http2;\n  listen [::]:443 ssl http2;\n", f"  listen 127.0.0.1:{self.port} ssl http2;\n"),
                ("/etc/ssl/certs/maps.example.org.pem", str(self.folder / "cert.pem")),
                ("/etc/ssl/private/maps.example.org.key", str(self.folder / "key.pem")),
                ("alias /var/lib/parkade/maps/", f"alias {data}/maps/")):
            assert text.count(old) == 1, f"{SITE} has {text.count(old)} times: {old}"
            text = text.replace(old, new)
        return text

    def connect(self, source="127.0.0.1", tls=None):
        """A TLS connection from an address of the loopback device."""
        raw = socket.create_connection(("127.0.0.1", self.port), timeout=60, source_address=(source, 0))
        raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return (tls or self.context).wrap_socket(raw, server_hostname=HOST)

    def say(self, text, source="127.0.0.1"):
        """What comes for these bytes until the connection ends, or for three seconds."""
        with self.connect(source) as client:
            client.settimeout(3)
            client.sendall(text if isinstance(text, bytes) else text.encode())
            answer = b""
            try:
                while piece := client.recv(65536):
                    answer += piece
            except (ConnectionResetError, ssl.SSLError, TimeoutError):
                pass
            return answer

    def ask(self, method, path, body=None, headers=None):
        connection = http.client.HTTPSConnection("127.0.0.1", self.port, timeout=60)
        connection.sock = self.connect()
        try:
            connection.request(method, path, body, {"Host": f"{HOST}:{self.port}", **self.fields, **(headers or {})})
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read()
        finally:
            connection.close()

    def stop(self):
        self.process.terminate()
        self.process.wait(30)
