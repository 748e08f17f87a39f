"""A drive's bag in memory, for faults to be made in it; and the rig beside it."""

import copy
import io
import pathlib
import pickle
import shutil

import genpy
import numpy
import rosbag
import yaml
from PIL import Image

NS = 10**9


class Record:
    """One message, at the time when it was recorded [ns]. `stamp` is that of its header, `true_time`
    what it was before the fault [ns]."""

    def __init__(self, topic, message, recorded):
        self.topic, self.message, self.recorded = topic, message, recorded
        self.true_time = self.stamp if hasattr(message, "header") else recorded

    @property
    def stamp(self):
        return self.message.header.stamp.to_nsec()

    @stamp.setter
    def stamp(self, nanoseconds):
        seconds, rest = divmod(int(nanoseconds), NS)
        self.message.header.stamp = genpy.Time(seconds % 2**32, rest)


class NotRecorded(Exception):
    """The drive has no sensor of the kind."""


class DriveLog:
    """Records in the order of the log, and what was done to its clock.

    `leaps`: (true time [ns], all stamps from there on are ahead by [ns]), in order of time.
    `rig`: {file name: parsed YAML, text, or bytes}.
    """

    def __init__(self, records, rig):
        self.records, self.rig, self.leaps = records, rig, []
        self.edit_bytes = None  # what becomes of the finished file: bytes to bytes
        self.name = "drive.bag"
        self.split_at = None  # a true time [ns] from which on records go to a second file
        self.last = None  # the true time [ns] up to which there is a path to be found; None: the end
        topics = {r.message._type: r.topic for r in records}
        self.imu_topic = topics["sensor_msgs/Imu"]
        self.wheel_topic = topics.get("nav_msgs/Odometry")
        self.gnss_topic = topics.get("sensor_msgs/NavSatFix")
        self.cameras = sorted({r.topic for r in records if r.message._type == "sensor_msgs/CompressedImage"
                               and not r.topic.endswith("semantic")})
        self.begin = min(r.stamp for r in records)
        self.end = max(r.stamp for r in records)

    def of(self, *topics):
        if None in topics:
            raise NotRecorded
        return [r for r in self.records if r.topic in topics]

    @property
    def imu(self):
        return self.of(self.imu_topic)

    @property
    def wheels(self):
        return self.of(self.wheel_topic)

    @property
    def fixes(self):
        return self.of(self.gnss_topic)

    @property
    def images(self):
        return self.of(*self.cameras)

    def at(self, share):
        """The time [ns] when this share of the drive is over."""
        return self.begin + share * (self.end - self.begin)

    def drop(self, is_dropped):
        self.records = [r for r in self.records if not is_dropped(r)]

    def leap(self, share, seconds):
        """All clocks leap ahead by `seconds` when a share of the drive is over."""
        moment, by = self.at(share), int(seconds * NS)
        for r in self.records:
            if r.true_time >= moment:
                r.stamp += by
                r.recorded += by
        self.leaps.append((moment, by))

    def ahead_at(self, time):
        """What stamps are ahead by [ns] at a true time [ns]."""
        return sum(by for moment, by in self.leaps if time >= moment)

    @staticmethod
    def _write_bag(path, records):
        with rosbag.Bag(str(path), "w") as bag:
            for r in records:
                seconds, rest = divmod(max(r.recorded, NS), NS)
                bag.write(r.topic, r.message, genpy.Time(seconds, rest))

    def write(self, folder):
        path = pathlib.Path(folder) / self.name
        if self.split_at is None:
            self._write_bag(path, self.records)
        else:
            path = path.with_suffix("")
            path.mkdir()
            self._write_bag(path / "drive_0.bag", [r for r in self.records if r.true_time < self.split_at])
            self._write_bag(path / "drive_1.bag", [r for r in self.records if r.true_time >= self.split_at])
        if self.edit_bytes:
            path.write_bytes(self.edit_bytes(path.read_bytes()))
        shutil.rmtree(path.parent / "rig", ignore_errors=True)
        (path.parent / "rig").mkdir()
        for name, content in self.rig.items():
            file = path.parent / "rig" / name
            if isinstance(content, bytes):
                file.write_bytes(content)
            else:
                file.write_text(content if isinstance(content, str) else yaml.safe_dump(content, sort_keys=False))
        return path


class BaseDrive:
    """A sound drive as `parkade-simulate` writes it, of which altered copies are made."""

    def __init__(self, bag):
        bag = pathlib.Path(bag)
        truth = bag.with_suffix(".truth")
        with rosbag.Bag(str(bag)) as file:
            records = [Record(topic, message, time.to_nsec()) for topic, message, time in file.read_messages()]
        rig = {p.name: yaml.safe_load(p.read_text()) if p.suffix == ".yaml" else p.read_bytes() for p in (truth / "rig").iterdir()}
        self._copy = pickle.dumps((records, rig))
        self.truth = numpy.loadtxt(truth / "truth.tum")
        fixes = [r.message for r in records if r.message._type == "sensor_msgs/NavSatFix"]
        self.place = [numpy.median([getattr(fix, name) for fix in fixes] or [0]) for name in ("latitude", "longitude")]

    def log(self):
        return DriveLog(*pickle.loads(self._copy))


def pixels(record):
    """An image's pixels, height x width (x 3, RGB)."""
    return numpy.asarray(Image.open(io.BytesIO(record.message.data)))


def encoded(array, kind="JPEG", **options):
    file = io.BytesIO()
    if kind == "JPEG":
        options.setdefault("quality", 85)
    (array if isinstance(array, Image.Image) else Image.fromarray(array)).save(file, kind, **options)
    return file.getvalue()


def repaint(records, change, **options):
    """Encodes images again, with their pixels changed."""
    for k, r in enumerate(records):
        r.message = copy.copy(r.message)
        r.message.data = encoded(numpy.ascontiguousarray(change(pixels(r), k)), **options)


def vector(v, values=None):
    """x, y, z of a geometry_msgs/Vector3, set where values are given."""
    if values is not None:
        v.x, v.y, v.z = (float(x) for x in values)
    return numpy.array([v.x, v.y, v.z])
