"""Where a disk can be full: each point fills it, looks at the answers, makes room and does the same again."""

import base64
import hashlib
import json
import pathlib
import random
import signal
import subprocess
import time

from full_disk import BLOCK
from power_cut_test import TUS

MIB = 1 << 20
COMMENTS = "/api/v1/sites/first/maps/1/comments"
RIG_FILES = ("camchain-imucam.yaml", "imu0.yaml", "vehicle.yaml")


def put_that_does_not_fit(world):
    world.disk.fill(leave=4 * MIB)
    log = b"log ok\nclean\n" + random.randbytes(20 * MIB)
    assert world.ask("PUT", "/api/v1/drives?site=put", log)[0] == 507
    world.make_room()
    world.job(world.upload(log, "put"))


def put_during_which_the_disk_fills(world):
    log = b"log ok\nclean\n" + random.randbytes(60 * MIB)

    def body():
        yield log[:10 * MIB]
        world.disk.fill()
        for at in range(10 * MIB, len(log), MIB):
            yield log[at:at + MIB]

    status, answer = world.ask("PUT", "/api/v1/drives?site=midway", body(), {"Content-Length": str(len(log))})
    assert status in (201, 507), answer
    if status == 201:
        world.drives[json.loads(answer)["drive"]["id"]] = hashlib.sha256(log).hexdigest()
    world.make_room()
    world.job(world.upload(log, "midway"))


def create_upload(world, length):
    name = base64.b64encode(b"a.bag").decode()
    return world.service.ask("POST", "/api/v1/uploads", b"", dict(
        TUS, **{"Upload-Length": str(length), "Upload-Metadata": f"filename {name}"}))


def tus_creation(world):
    world.disk.fill(leave=4 * MIB)
    status, fields, answer = create_upload(world, 20 * MIB)
    assert status == 507 and fields["Content-Type"] == "application/problem+json", answer
    world.make_room()
    assert create_upload(world, 20 * MIB)[0] == 201


def tus_part(world):
    log, part = b"log ok\nclean\n" + random.randbytes(3 * MIB), 1000
    address = create_upload(world, len(log))[1]["Location"]

    def patch_fields(offset):
        return dict(TUS, **{"Upload-Offset": str(offset), "Content-Type": "application/offset+octet-stream"})

    def patch(offset, content):
        return world.ask("PATCH", address, content, patch_fields(offset))

    def offset():
        return int(world.service.ask("HEAD", address, headers=TUS)[1]["Upload-Offset"])

    world.disk.fill()
    taken = world.take_until_refused(lambda count: patch(count * part, log[count * part:(count + 1) * part]), 2900)
    assert offset() >= taken * part, "an offset that was answered is gone"
    world.make_room()
    status, fields, answer = world.service.ask("PATCH", address, log[offset():], patch_fields(offset()))
    assert status == 204, answer
    world.drives[fields["Upload-Drive"]] = hashlib.sha256(log).hexdigest()
    assert world.job(fields["Upload-Job"])["state"] == "done"


def comments_of(world):
    texts, cursor = [], ""
    while cursor is not None:
        status, answer = world.ask("GET", f"{COMMENTS}?limit=200{cursor}")
        assert status == 200, answer
        page = json.loads(answer)
        texts += [one["text"] for one in page["items"]]
        cursor = f"&cursor={page['next_cursor']}" if page["next_cursor"] else None
    return texts


def kept_of(world, mark):
    return sorted(text for text in comments_of(world) if text.startswith(mark))


def comment_until_refused(world, mark, length):
    taken = []

    def comment(count):
        text = f"{mark} {count} " + "x" * length
        status, answer = world.ask("POST", COMMENTS, {"text": text})
        if status == 201:
            taken.append(text)
        return status, answer

    world.take_until_refused(comment)
    return taken


def comment_and_review(world):
    world.disk.fill()
    taken = comment_until_refused(world, "small", 10)
    review = {"action": "submit"}
    assert world.ask("POST", "/api/v1/sites/first/maps/1/review", review)[0] == 507
    assert json.loads(world.ask("GET", "/api/v1/sites/first/maps/1/review")[1])["state"] == "draft"
    world.make_room()
    assert world.ask("POST", "/api/v1/sites/first/maps/1/review", review)[0] == 200
    assert kept_of(world, "small") == sorted(taken)


def publication(world):
    """The disk fills between the worker's last byte and the version."""
    job = world.upload(b"log slow\nclean\n" + random.randbytes(9), "publication")
    world.job(job, ["running"])
    attempt = world.disk.mount_point / "data/jobs" / job / "worker/attempt-1"
    while not (attempt / "progress.ndjson").exists():
        time.sleep(0.02)
    world.service.freeze()
    while '"mesh"' not in (attempt / "progress.ndjson").read_text():
        time.sleep(0.02)
    time.sleep(0.5)
    assert (attempt / "out/report.json").stat().st_size > 0
    world.disk.fill()
    world.service.process.send_signal(signal.SIGCONT)
    time.sleep(3)
    assert world.ask("GET", "/api/v1/sites/publication/maps/latest")[0] == 404, "a version without a row"
    assert json.loads(world.ask("GET", f"/api/v1/jobs/{job}")[1])["state"] != "done"
    world.make_room()
    found = world.job(job)
    assert (found["state"], found["error_code"]) == ("failed", "disk_full"), found
    assert world.ask("POST", f"/api/v1/jobs/{job}/retry", b"")[0] == 202
    assert world.job(job)["map_version"] == 1
    assert world.ask("GET", "/api/v1/sites/publication/maps/1/map.glb")[0] == 200


def checkpoint_and_backup(world):
    """The database's log has grown long, so that it is copied into a database that cannot grow."""
    data, target = world.disk.mount_point / "data", world.disk.mount_point / "backup"
    before = (data / "db/main.db").stat().st_size
    target.mkdir()
    world.disk.fill(leave=5 * MIB)
    taken = comment_until_refused(world, "long", 9000)
    log, grown = (data / "db/main.db-wal").stat().st_size, (data / "db/main.db").stat().st_size - before
    assert log > 1000 * BLOCK, "the log was not long enough to be copied"
    assert grown < sum(map(len, taken)), "the disk had room for the whole copy"
    backup = [world.parkade, "backup", "--data", data, target]
    refused = subprocess.run(backup, capture_output=True, text=True, check=False)
    assert refused.returncode != 0 and "No space left" in refused.stderr, refused
    assert kept_of(world, "long") == sorted(taken)
    world.make_room()
    assert kept_of(world, "long") == sorted(taken)
    assert world.ask("POST", COMMENTS, {"text": "after"})[0] == 201
    for command in (backup, [world.parkade, "verify", "--data", target, "--deep"]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done


def rig_and_settings(world):
    parts = "".join(f'--edge\r\nContent-Disposition: form-data; name="{name}"; filename="{name}"\r\n\r\nrostopic: /imu\r\n'
                    for name in RIG_FILES) + "--edge--\r\n"

    def put_rig(count):
        return world.ask("PUT", f"/api/v1/rigs/rig{count}", parts.encode(),
                         {"Content-Type": "multipart/form-data; boundary=edge"})

    def settings(count):
        return world.ask("PUT", "/api/v1/sites/first", {"title": f"{count} " + "x" * 90})

    world.disk.fill()
    rigs, titles = world.take_until_refused(put_rig), world.take_until_refused(settings)
    listed = [one["name"] for one in json.loads(world.ask("GET", "/api/v1/rigs")[1])["items"]]
    assert len(listed) == rigs, listed
    world.make_room()
    assert put_rig(rigs)[0] in (200, 201) and settings(titles)[0] == 200


def worker_that_writes(world):
    """The real worker, of the real program, finds no room for what it makes."""
    status, answer = world.ask("POST", "/api/v1/sites/first/maps", b"{}")
    assert status == 202, answer
    job = json.loads(answer)["id"]
    world.job(job, ["running"])
    progress = world.disk.mount_point / "data/jobs" / job / "worker/attempt-1/progress.ndjson"
    while not progress.exists() or progress.stat().st_size == 0:
        time.sleep(0.002)
    world.disk.fill()
    end = time.monotonic() + 60
    while worker_of(world) and time.monotonic() < end:
        time.sleep(0.1)
    time.sleep(1)
    world.make_room()
    found = world.job(job)
    assert (found["state"], found["error_code"]) == ("failed", "disk_full"), found
    assert world.ask("POST", f"/api/v1/jobs/{job}/retry", b"")[0] == 202
    assert world.job(job)["state"] == "done"


def worker_of(world):
    children = pathlib.Path(f"/proc/{world.service.process.pid}/task")
    return [child for task in children.glob("*/children") for child in task.read_text().split()]


def picture(world):
    drive = next(iter(world.drives))

    def look(count):
        return world.ask("GET", f"/api/v1/drives/{drive}/images/cam0?time=1.5&width={64 + count}")

    assert look(0)[0] == 200
    world.disk.fill()
    comment_until_refused(world, "picture", 10)
    world.take_until_refused(lambda count: look(1 + count), 50)
    world.make_room()
    assert look(60)[0] == 200


POINTS = (put_that_does_not_fit, put_during_which_the_disk_fills, tus_creation, tus_part, comment_and_review, publication,
          checkpoint_and_backup, rig_and_settings)
REAL_POINTS = (worker_that_writes, picture)
