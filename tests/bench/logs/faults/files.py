"""Files that are cut off, damaged, packed, or something else."""

import gzip
import io
import os
import random
import tarfile
import zipfile

from fault import FaultList

FAULTS = FaultList()
ABOUT = "log|file|bag|damaged|cut|archive|entry|empty|recording|format|message"


def fault_of_bytes(name, edit, new_name=None, says=ABOUT):
    def make(log):
        log.edit_bytes = edit
        log.name = new_name or log.name

    FAULTS.add(name, says)(make)


for share in (0.02, 0.3, 0.9, 0.999):
    fault_of_bytes(f"the file ends after {share} of its bytes", lambda data, share=share: data[: int(share * len(data))])
for count in (1, 20, 1000):
    def flip(data, count=count):
        draw, data = random.Random(10), bytearray(data)
        for _ in range(count):
            data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
        return bytes(data)

    fault_of_bytes(f"{count} bits flip", flip)
fault_of_bytes("a block of 64 KiB is zero", lambda data: data[: len(data) // 2] + bytes(65536) + data[len(data) // 2 + 65536:])
fault_of_bytes("a block of 64 KiB is missing", lambda data: data[: len(data) // 2] + data[len(data) // 2 + 65536:])
fault_of_bytes("the first 100 bytes are missing", lambda data: data[100:])
fault_of_bytes("nothing but the first line", lambda data: data[:13])
fault_of_bytes("empty", lambda data: b"")
fault_of_bytes("random bytes", lambda data: os.urandom(50_000))
fault_of_bytes("a web page", lambda data: b"<!DOCTYPE html><html><body>Sign in</body></html>")
fault_of_bytes("twice the file, one behind the other", lambda data: data + data)
fault_of_bytes("bytes behind the end", lambda data: data + os.urandom(5000))
fault_of_bytes("named as an MCAP", lambda data: data, "drive.mcap")
fault_of_bytes("without an extension", lambda data: data, "drive")
fault_of_bytes("a name with blanks and umlauts", lambda data: data, "Fahrt 3 – Höhe (1).bag")
fault_of_bytes("gzip", gzip.compress, "drive.bag.gz")


def zipped(names, inside=lambda name, data: data):
    def pack(data):
        file = io.BytesIO()
        with zipfile.ZipFile(file, "w") as archive:
            for name in names:
                archive.writestr(name, inside(name, data))
        return file.getvalue()

    return pack


def tarred(mode):
    def pack(data):
        file = io.BytesIO()
        with tarfile.open(fileobj=file, mode=mode) as archive:
            entry = tarfile.TarInfo("session/drive.bag")
            entry.size = len(data)
            archive.addfile(entry, io.BytesIO(data))
        return file.getvalue()

    return pack


fault_of_bytes("zip", zipped(["drive.bag"]), "drive.zip")
fault_of_bytes("zip of a folder, with a Mac's files", zipped(
    ["day/drive.bag", "__MACOSX/day/._drive.bag", "day/.DS_Store"], lambda name, data: data if name == "day/drive.bag" else b"x"), "drive.zip")
fault_of_bytes("zip whose names climb", zipped(["../../drive.bag"]), "drive.zip")
fault_of_bytes("zip without a log", zipped(["readme.txt"], lambda name, data: b"hello"), "drive.zip")
fault_of_bytes("zip that is cut off", lambda data: zipped(["drive.bag"])(data)[:-3000], "drive.zip")
fault_of_bytes("tar", tarred("w"), "drive.tar")
fault_of_bytes("tar.gz", tarred("w:gz"), "drive.tar.gz")
fault_of_bytes("tar that is cut off", lambda data: tarred("w")(data)[: len(data) // 2], "drive.tar")


@FAULTS.add("topics below a namespace", "topic")
def _(log):
    for r in log.records:
        r.topic = "/car1" + r.topic


@FAULTS.add("a topic of an unknown kind beside")
def _(log):
    from std_msgs.msg import String

    from drive_log import Record

    log.records += [Record("/status", String("well"), r.recorded) for r in log.wheels[::10]]


@FAULTS.add("without an IMU", "IMU|imu", must_say=True)
def _(log):
    log.drop(lambda r: r.topic == log.imu_topic)


@FAULTS.add("without wheels and fixes")
def _(log):
    log.drop(lambda r: r.topic in (log.wheel_topic, log.gnss_topic))


@FAULTS.add("two IMUs", "IMU|imu")
def _(log):
    from drive_log import Record

    log.records += [Record("/other/imu", r.message, r.recorded) for r in log.imu[::2]]


@FAULTS.add("two seconds only", "short|start|initiali|IMU|image|drive")
def _(log):
    log.last = log.at(0) + 2 * 10**9
    log.drop(lambda r: r.stamp > log.last)
