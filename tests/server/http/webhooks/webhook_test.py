#!/usr/bin/env python3
"""Webhooks of the real service, at a real receiver that checks signatures by itself.

usage: webhook_test.py PARKADE_SERVE_PROGRAM WORK_FOLDER [KILLS]

Deliveries are signed, sent again after errors and silence, and none is lost when the service is
killed (-9) between and during them.
"""

import hashlib
import hmac
import http.server
import json
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request

PROGRAM, WORK = sys.argv[1:3]
KILLS = int(sys.argv[3]) if len(sys.argv) > 3 else 6
DATA = os.path.join(WORK, "data")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def until(what, probe, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = probe()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"{what}: not within {seconds} s")


class Receiver(http.server.ThreadingHTTPServer):
    """Keeps every delivery whose signature is right; `answer` decides what it says to it."""

    daemon_threads = True

    def __init__(self, secrets, answer=lambda count: 204):
        super().__init__(("127.0.0.1", free_port()), Handler)
        self.secrets, self.answer = secrets, answer
        self.deliveries, self.wrong, self.lock = [], [], threading.Lock()
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def url(self):
        return f"http://127.0.0.1:{self.server_port}/hook?a=b"

    def ids(self):
        with self.lock:
            return [delivery["id"] for delivery in self.deliveries]

    def taken(self):
        """Bodies of what was answered with 2xx, each id once, in the order of their coming."""
        with self.lock:
            return list({d["id"]: d["body"] for d in self.deliveries if d["status"] < 300}.values())


class Handler(http.server.BaseHTTPRequestHandler):
    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        timestamp = self.headers["X-Parkade-Timestamp"]
        signature = self.headers["X-Parkade-Signature"]
        message = timestamp.encode() + b"." + body
        right = any(
            hmac.compare_digest(
                "sha256=" + hmac.new(secret.encode(), message, hashlib.sha256).hexdigest(), signature)
            for secret in self.server.secrets)
        is_fresh = abs(time.time() - int(timestamp)) < 60
        with self.server.lock:
            if not right or not is_fresh or json.loads(body)["event"] != self.headers["X-Parkade-Event"]:
                self.server.wrong.append(body)
            status = self.server.answer(len(self.server.deliveries))
            self.server.deliveries.append({"id": self.headers["X-Parkade-Delivery"],
                                           "body": json.loads(body), "status": status or 599})
        if status is None:  # silence, until the sender gives up
            time.sleep(3)
            return
        self.send_response(status)
        self.send_header("Content-Length", "0")
        self.end_headers()

    def log_message(self, *_):
        pass


class Service:
    def __init__(self, allow_private=True):
        self.port = free_port()
        environment = dict(os.environ, LISTEN=f"127.0.0.1:{self.port}", WEBHOOK_PAUSE="150",
                           WEBHOOK_TIMEOUT="1000")
        if allow_private:
            environment["WEBHOOK_PRIVATE"] = "1"
        with open(os.path.join(WORK, "service.log"), "ab") as log:
            self.process = subprocess.Popen([PROGRAM, "serve", DATA], env=environment, stdout=log,
                                            stderr=log)
        until("the service starts", lambda: self.ask("GET", "/healthz")[0] == 200)

    def ask(self, method, path, body=None, content_type="application/json"):
        data = body if isinstance(body, (bytes, type(None))) else json.dumps(body).encode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", data, method=method,
                                         headers={"Content-Type": content_type})
        try:
            with urllib.request.urlopen(request, timeout=30) as answer:
                return answer.status, json.loads(answer.read() or b"null")
        except urllib.error.HTTPError as error:
            return error.code, json.loads(error.read())
        except (urllib.error.URLError, ConnectionError, socket.timeout):
            return 0, None

    def end(self, with_signal=signal.SIGKILL):
        self.process.send_signal(with_signal)
        self.process.wait()


def add_webhook(service, url):
    status, webhook = service.ask("POST", "/api/v1/webhooks",
                                  {"url": url, "events": ["job", "published", "reviewed"]})
    assert status == 201, webhook
    return webhook


def test_events_arrive_signed(service, secrets):
    receiver = Receiver(secrets)
    webhook = add_webhook(service, receiver.url())
    secrets.append(webhook["secret"])
    _, listed = service.ask("GET", "/api/v1/webhooks")
    assert "secret" not in listed["items"][0], "it is shown once"

    status, _ = service.ask("PUT", "/api/v1/drives?filename=a.bag&site=lot", b"log ok\n",
                            "application/octet-stream")
    assert status == 201
    until("job and map are told of", lambda: len(receiver.taken()) == 2)
    service.ask("POST", "/api/v1/sites/lot/maps/1/review", {"action": "submit"})
    until("the decision is told of", lambda: len(receiver.taken()) == 3)
    events = {body["event"]: body for body in receiver.taken()}
    assert events["job"]["job"]["state"] == "done"
    assert events["published"]["version"] == 1 and events["published"]["site"] == "lot"
    assert events["reviewed"]["to"] == "in_review"
    status, delivery = service.ask("POST", f"/api/v1/webhooks/{webhook['id']}/test")
    assert status == 202 and delivery["event"] == "test"
    until("the test is told of", lambda: len(receiver.taken()) == 4)
    assert not receiver.wrong, receiver.wrong
    return webhook, receiver


def test_errors_and_silence_are_sent_again(service, secrets):
    receiver = Receiver(secrets, lambda count: [500, None, 429][count] if count < 3 else 200)
    webhook = add_webhook(service, receiver.url())
    secrets.append(webhook["secret"])
    service.ask("POST", f"/api/v1/webhooks/{webhook['id']}/test")
    until("it is taken in the end", receiver.taken)
    assert len(set(receiver.ids())) == 1 and len(receiver.ids()) == 4, receiver.ids()
    address = f"/api/v1/webhooks/{webhook['id']}/deliveries"
    until("the log says so", lambda: service.ask("GET", address)[1]["items"][0]["state"] == "delivered")
    _, log = service.ask("GET", address)
    assert log["items"][0]["attempts"] == 4 and log["items"][0]["status"] == 200, log
    assert not receiver.wrong
    assert service.ask("DELETE", f"/api/v1/webhooks/{webhook['id']}")[0] == 204


def test_kills_lose_none(secrets, webhook, receiver):
    """Decisions that were answered are told of, however often the service is killed."""
    draw = random.Random(7)
    receiver.answer = lambda count: 503 if draw.random() < 0.3 else 204
    told_before = len(receiver.taken())
    acknowledged = []
    for kill in range(KILLS):
        service = Service()
        deadline = time.monotonic() + draw.uniform(0.05, 0.6)
        while time.monotonic() < deadline:
            action = ["reject", "reopen"][len(acknowledged) % 2]
            status, review = service.ask("POST", "/api/v1/sites/lot/maps/1/review",
                                         {"action": action, "comment": f"number {len(acknowledged)}"})
            assert status == 200, review
            acknowledged.append(f"number {len(acknowledged)}")
        service.end()
    service = Service()
    told = lambda: [body["comment"] for body in receiver.taken()[told_before:]]
    until("all decisions are told of", lambda: set(acknowledged) <= set(told()), 120)
    assert sorted(told()) == sorted(acknowledged), "and none that was not taken"
    assert not receiver.wrong
    print(f"{KILLS} kills, {len(acknowledged)} decisions, {len(receiver.ids())} attempts")
    service.end(signal.SIGTERM)


def test_private_addresses_need_the_option():
    service = Service(allow_private=False)
    status, problem = service.ask("POST", "/api/v1/webhooks",
                                  {"url": "http://127.0.0.1:1/", "events": ["job"]})
    assert status == 400 and "--webhook-private" in problem["detail"], problem
    service.end(signal.SIGTERM)


def main():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    secrets = []
    service = Service()
    webhook, receiver = test_events_arrive_signed(service, secrets)
    test_errors_and_silence_are_sent_again(service, secrets)
    service.end(signal.SIGTERM)
    test_kills_lose_none(secrets, webhook, receiver)
    test_private_addresses_need_the_option()


if __name__ == "__main__":
    main()
