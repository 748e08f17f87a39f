"""Fixes that are no places, or other places."""

import math
import random

from drive_log import NS
from fault import FaultList

FAULTS = FaultList()
ABOUT = "fix|GNSS|gnss|latitude|georef"


def change(log, edit):
    for k, r in enumerate(log.fixes):
        edit(r.message, k)


@FAULTS.each("the first {} are 0, 0", [1, 3, 20])
def _(log, count):
    change(log, lambda fix, k: k >= count or (setattr(fix, "latitude", 0.0), setattr(fix, "longitude", 0.0)))


@FAULTS.add("all are 0, 0", ABOUT, must_say=True)
def _(log):
    change(log, lambda fix, _: (setattr(fix, "latitude", 0.0), setattr(fix, "longitude", 0.0)))


@FAULTS.add("all are one spot", ABOUT, must_say=True)
def _(log):
    first = log.fixes[0].message
    change(log, lambda fix, _: (setattr(fix, "latitude", first.latitude), setattr(fix, "longitude", first.longitude)))


@FAULTS.add("one spot after a third", ABOUT)
def _(log):
    third = len(log.fixes) // 3
    spot = log.fixes[third].message
    place = spot.latitude, spot.longitude
    change(log, lambda fix, k: k < third or (setattr(fix, "latitude", place[0]), setattr(fix, "longitude", place[1])))


@FAULTS.add("radians", ABOUT, must_say=True)
def _(log):
    change(log, lambda fix, _: (setattr(fix, "latitude", math.radians(fix.latitude)),
                                setattr(fix, "longitude", math.radians(fix.longitude))))


@FAULTS.add("latitude and longitude in each other's place", ABOUT, must_say=True)
def _(log):
    def swap(fix, _):
        fix.latitude, fix.longitude = fix.longitude, fix.latitude

    change(log, swap)


@FAULTS.each("degrees times {}", [1e7, 1e5], ABOUT, must_say=True)
def _(log, factor):
    change(log, lambda fix, _: (setattr(fix, "latitude", fix.latitude * factor), setattr(fix, "longitude", fix.longitude * factor)))


@FAULTS.each("degrees and minutes as {}", ["DDMM.MM"], ABOUT, must_say=True)
def _(log, _):
    def nmea(x):
        degrees = math.floor(x)
        return degrees * 100 + (x - degrees) * 60

    change(log, lambda fix, _: (setattr(fix, "latitude", nmea(fix.latitude)), setattr(fix, "longitude", nmea(fix.longitude))))


@FAULTS.each("altitude is {}", ["nan", "inf", "0", "-1000", "1e9"])
def _(log, value):
    change(log, lambda fix, _: setattr(fix, "altitude", float(value)))


@FAULTS.each("covariance is all {}", ["nan", "0", "-1", "1e12"])
def _(log, value):
    change(log, lambda fix, _: (setattr(fix, "position_covariance", [float(value)] * 9),
                                setattr(fix, "position_covariance_type", 2)))


@FAULTS.add("the type of covariance is unknown")
def _(log):
    change(log, lambda fix, _: setattr(fix, "position_covariance_type", 0))


@FAULTS.each("the fix number {} is near the pole", [0, 7, 40])
def _(log, number):
    change(log, lambda fix, k: k != number or setattr(fix, "latitude", 89.9999))


@FAULTS.add("no fix is one, by status", ABOUT)
def _(log):
    change(log, lambda fix, _: setattr(fix.status, "status", -1))


@FAULTS.each("the second half jumps by {} m", [5, 50, 5000], ABOUT)
def _(log, meters):
    half = len(log.fixes) // 2
    change(log, lambda fix, k: k < half or setattr(fix, "latitude", fix.latitude + meters / 111_000))


@FAULTS.each("every {}th fix is 300 m off", [2, 10], ABOUT)
def _(log, step):
    change(log, lambda fix, k: k % step or setattr(fix, "longitude", fix.longitude + 0.004))


@FAULTS.each("noise of {} m that the covariance denies", [3, 30], ABOUT)
def _(log, sigma):
    draw = random.Random(5)
    change(log, lambda fix, _: (setattr(fix, "latitude", fix.latitude + draw.gauss(0, sigma) / 111_000),
                                setattr(fix, "longitude", fix.longitude + draw.gauss(0, sigma) / 80_000),
                                setattr(fix, "position_covariance", [1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4]),
                                setattr(fix, "position_covariance_type", 2)))


@FAULTS.add("longitudes beyond 180")
def _(log):
    change(log, lambda fix, _: setattr(fix, "longitude", fix.longitude + 360))


@FAULTS.add("all is NaN", ABOUT)
def _(log):
    change(log, lambda fix, _: (setattr(fix, "latitude", math.nan), setattr(fix, "longitude", math.nan)))


@FAULTS.add("one fix is left")
def _(log):
    only = log.fixes[0]
    log.drop(lambda r: r.topic == log.gnss_topic and r is not only)


@FAULTS.add("stamps are times of the GPS week", ABOUT + "|clock", must_say=True)
def _(log):
    for r in log.fixes:
        r.stamp = r.stamp % (7 * 86400 * NS)


@FAULTS.add("stamps are in GPS time, 18 s ahead", ABOUT + "|clock", must_say=True)
def _(log):
    for r in log.fixes:
        r.stamp += 18 * NS


@FAULTS.each("fixes come late by {} s", [0.3, 1, 5], ABOUT + "|clock")
def _(log, seconds):
    for r in log.fixes:
        r.stamp += int(seconds * NS)


@FAULTS.add("altitude leaps by -47 m in the middle", ABOUT, must_say=True)
def _(log):
    middle = log.at(0.5)
    for r in log.fixes:
        r.message.altitude -= 47 if r.stamp >= middle else 0
