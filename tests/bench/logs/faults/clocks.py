"""Clocks that leap, differ, or stamp wrongly."""

import random

from drive_log import NS
from fault import FaultList

FAULTS = FaultList()
YEARS = 1_700_000_000  # [s] from 1970 to a drive of today


@FAULTS.each("all clocks leap by {} s at a third", [3, 10, 600, 3600, 86400, -10, -600, -3600], "clock|leap|stretch|back")
def _(log, seconds):
    log.leap(1 / 3, seconds)


@FAULTS.each("all clocks leap by {} s at two thirds", [3, 600, -600], "clock|leap|stretch|back")
def _(log, seconds):
    log.leap(2 / 3, seconds)


@FAULTS.add("1970 until the clock is set", "clock|leap|stretch")
def _(log):
    log.leap(0, -log.begin / NS + 5)
    log.leap(0.4, YEARS)


@FAULTS.add("all clocks leap ahead and back again", "clock|leap|stretch|back")
def _(log):
    log.leap(0.35, 3600)
    log.leap(0.7, -3600)


@FAULTS.each("all clocks leap by {} s from one file of a split recording to the next", [0, -3, -600, 600], "clock|leap|stretch|back")
def _(log, seconds):
    log.leap(0.4, seconds)
    log.split_at = log.at(0.4)


def shift(records, by, since=0):
    for r in records:
        if r.stamp >= since:
            r.stamp = max(r.stamp + int(by * NS), 0)


@FAULTS.each("the IMU's clock steps by {} s", [-0.19, -5, -3600, 5, 3600], "IMU|imu|clock")
def _(log, by):
    shift(log.imu, by, log.at(0.4))


@FAULTS.each("one camera's clock steps by {} s", [-5, -3600, 5, 3600], "cam|clock")
def _(log, by):
    shift(log.of(log.cameras[1]), by, log.at(0.4))


@FAULTS.each("one camera's clock is ahead by {} s", [77, 3600, -20, -YEARS], "cam|clock", must_say=True)
def _(log, by):
    shift(log.of(log.cameras[1]), by)


@FAULTS.each("one camera's clock is ahead by {} s", [0.08, -0.08], "cam|clock|time|delay")
def _(log, by):
    shift(log.of(log.cameras[1]), by)


@FAULTS.each("all cameras' clock is ahead by {} s", [0.05, -0.05, 3600, -YEARS], "camera|clock|image|IMU")
def _(log, by):
    shift(log.images, by)


@FAULTS.each("the IMU's clock is ahead by {} s", [3600, -YEARS], "camera|clock|image|IMU")
def _(log, by):
    shift(log.imu, by)


@FAULTS.each("the wheels' clock is ahead by {} s", [0.2, 0.5, -0.5, 30, 3600, -YEARS], "wheel|odom|clock")
def _(log, by):
    shift(log.wheels, by)


@FAULTS.each("the fixes' clock is ahead by {} s", [0.3, 18, 3600, -YEARS], "fix|GNSS|gnss|clock")
def _(log, by):
    shift(log.fixes, by)


@FAULTS.add("fixes have the time of the week", "fix|GNSS|gnss|clock", must_say=True)
def _(log):
    for r in log.fixes:
        r.stamp = r.stamp % (7 * 86400 * NS) // 1000 * 1000


@FAULTS.each("one sample of the IMU is ahead by {} s", [2, 3600, 10**7])
def _(log, by):
    log.imu[len(log.imu) // 2].stamp += int(by * NS)


@FAULTS.each("one image is ahead by {} s", [2, 3600, 10**7])
def _(log, by):
    log.images[len(log.images) // 2].stamp += int(by * NS)


@FAULTS.add("every fiftieth stamp is zero")
def _(log):
    for r in log.records[::50]:
        r.stamp = 0


@FAULTS.add("all stamps are zero")
def _(log):
    for r in log.records:
        r.stamp = 0


@FAULTS.add("images' stamps are zero")
def _(log):
    for r in log.images:
        r.stamp = 0


@FAULTS.add("images' stamps count milliseconds as seconds", "clock|cam|stamp|image")
def _(log):
    for r in log.images:
        r.stamp = r.stamp // 10**6 % 2**32 * NS


@FAULTS.add("the IMU's stamps are rounded to 10 ms", "IMU|imu|stamp|repeat")
def _(log):
    for r in log.imu:
        r.stamp = r.stamp // 10**7 * 10**7


@FAULTS.each("the IMU comes in packets of {}, stamped on arrival", [5, 20], "IMU|imu|stamp|packet|burst")
def _(log, size):
    samples = log.imu
    for first in range(0, len(samples) - size, size):
        for k in range(size):
            samples[first + k].stamp = samples[first + size - 1].stamp + k * 20_000


@FAULTS.add("the IMU's stamps have 3 ms of noise", "IMU|imu|stamp|jitter")
def _(log):
    draw = random.Random(1)
    for r in log.imu:
        r.stamp += int(draw.gauss(0, 0.003) * NS)


@FAULTS.each("images' stamps have {} ms of noise", [2, 10], "cam|stamp|jitter|image")
def _(log, sigma):
    draw = random.Random(2)
    for r in log.images:
        r.stamp += int(draw.gauss(0, sigma * 1e-3) * NS)


@FAULTS.add("samples of the IMU change places and repeat")
def _(log):
    samples = log.imu
    for a, b in zip(samples[25::25], samples[26::25]):
        a.message, b.message = b.message, a.message
    doubled = set(map(id, samples[::10]))
    log.records = [r for one in log.records for r in ([one, one] if id(one) in doubled else [one])]


@FAULTS.add("the log is late by up to 5.08 s, and disordered")
def _(log):
    draw = random.Random(3)
    for r in log.records:
        r.recorded += 5 * NS + int(draw.random() * 8e7)
    log.records.sort(key=lambda r: r.recorded)


@FAULTS.each("topic after topic, {}", ["images first", "images last"], "late|order")
def _(log, order):
    images = log.images
    others = [r for r in log.records if r.topic not in log.cameras]
    log.records = images + others if order == "images first" else others + images
    for r in log.records:
        r.recorded = r.stamp


@FAULTS.each("the recorder pauses for {} s while the car drives", [0.5, 1.5, 4], "gap|record|stretch|nothing|clock")
def _(log, seconds):
    begin = log.at(0.5)
    log.drop(lambda r: begin <= r.stamp < begin + seconds * NS)


@FAULTS.each("seconds and nanoseconds have changed places: {}", ["all", "the IMU"], "clock|stamp")
def _(log, which):
    for r in log.records if which == "all" else log.imu:
        stamp = r.message.header.stamp
        stamp.secs, stamp.nsecs = stamp.nsecs, stamp.secs
