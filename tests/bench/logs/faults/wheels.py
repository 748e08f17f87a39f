"""Wheels in other units, reversed, late, or silent."""

import math
import random

from drive_log import NS
from fault import FaultList

FAULTS = FaultList()
ABOUT = "wheel|odom"


def change(log, speed=lambda v, k: v, yaw_rate=lambda w, k: w, keeps_pose=False):
    """Twists are changed; poses go with them, or are left out (all zero)."""
    for k, r in enumerate(log.wheels):
        twist = r.message.twist.twist
        twist.linear.x = speed(twist.linear.x, k)
        twist.angular.z = yaw_rate(twist.angular.z, k)
        if not keeps_pose:
            position = r.message.pose.pose.position
            position.x = position.y = position.z = 0


UNITS = {"mm/s": 1000, "cm/s": 100, "km/h": 3.6, "mph": 2.236936, "ticks": 5234.0}


@FAULTS.each("speed in {}", UNITS, ABOUT)
def _(log, unit):
    change(log, lambda v, _: v * UNITS[unit])


@FAULTS.each("speed is {} times what it was", [0.25, 0.5, 0.8, 0.95, 1.05, 1.3, 2], ABOUT)
def _(log, factor):
    change(log, lambda v, _: v * factor)


@FAULTS.add("speed is reversed", ABOUT)
def _(log):
    change(log, lambda v, _: -v)


@FAULTS.add("speed has no sign", ABOUT)
def _(log):
    change(log, lambda v, _: abs(v))


@FAULTS.add("speed is along y", ABOUT)
def _(log):
    for r in log.wheels:
        linear = r.message.twist.twist.linear
        linear.x, linear.y = linear.y, linear.x
    change(log)


@FAULTS.each("the twist is in the odom frame, turned by {} rad", [0.0, 1.0, 2.5], ABOUT)
def _(log, turned):
    for r in log.wheels:
        q, linear = r.message.pose.pose.orientation, r.message.twist.twist.linear
        yaw = 2 * math.atan2(q.z, q.w) + turned
        linear.x, linear.y = linear.x * math.cos(yaw), linear.x * math.sin(yaw)
    change(log)


@FAULTS.add("all is zero", ABOUT, must_say=True)
def _(log):
    change(log, lambda v, _: 0.0, lambda w, _: 0.0)


@FAULTS.each("wheels die after {} of the drive: zero", [0.3, 0.7], ABOUT)
def _(log, share):
    last = share * len(log.wheels)
    change(log, lambda v, k: v if k < last else 0.0, lambda w, k: w if k < last else 0.0)


@FAULTS.each("wheels die after {} of the drive: silent", [0.0, 0.3, 0.7], ABOUT)
def _(log, share):
    end = log.at(share)
    log.drop(lambda r: r.topic == log.wheel_topic and r.stamp > end)


@FAULTS.each("wheels stick at their last value after {} of the drive", [0.3, 0.6], ABOUT)
def _(log, share):
    source = log.wheels[int(share * len(log.wheels))].message.twist.twist
    speed, yaw_rate, last = source.linear.x, source.angular.z, share * len(log.wheels)
    change(log, lambda v, k: v if k < last else speed, lambda w, k: w if k < last else yaw_rate)


@FAULTS.each("yaw rate: {}", ["zero", "deg/s", "reversed", "half"])
def _(log, what):
    factor = {"zero": 0, "deg/s": 180 / math.pi, "reversed": -1, "half": 0.5}[what]
    change(log, yaw_rate=lambda w, _: w * factor)


@FAULTS.add("all is NaN", ABOUT)
def _(log):
    change(log, lambda v, _: math.nan, lambda w, _: math.nan)


@FAULTS.each("late by {} s", [0.05, 0.1, 0.2, 0.35, 0.5])
def _(log, seconds):
    for r in log.wheels:
        r.stamp += int(seconds * NS)


@FAULTS.add("wheels slip for a second, twice as fast", ABOUT)
def _(log):
    rate = len(log.wheels) / ((log.end - log.begin) / NS)
    middle = len(log.wheels) / 2
    change(log, lambda v, k: 2 * v if middle <= k < middle + rate else v)


@FAULTS.each("every {}th speed is 60 m/s", [10, 100], ABOUT)
def _(log, step):
    change(log, lambda v, k: v if k % step else 60.0)


@FAULTS.each("steps of {} m/s", [0.1, 0.5], ABOUT)
def _(log, step):
    change(log, lambda v, _: round(v / step) * step)


@FAULTS.add("noise of 0.5 m/s", ABOUT)
def _(log):
    draw = random.Random(4)
    change(log, lambda v, _: v + draw.gauss(0, 0.5))


@FAULTS.add("only poses, no twist", ABOUT)
def _(log):
    change(log, lambda v, _: 0.0, lambda w, _: 0.0, keeps_pose=True)


@FAULTS.each("one of {} messages only", [5, 50])
def _(log, step):
    kept = set(map(id, log.wheels[::step]))
    log.drop(lambda r: r.topic == log.wheel_topic and id(r) not in kept)


@FAULTS.each("0 is said below {} m/s", [0.25, 0.5, 1.0, 2.0], ABOUT)
def _(log, least):
    change(log, lambda v, _: v if abs(v) > least else 0.0)


PLACES = {"the front axle": (2.5, 0), "the left rear wheel": (0, 0.74), "the right rear wheel": (0, -0.74)}  # [m]


@FAULTS.each("the speed is that of {}", PLACES, ABOUT)
def _(log, place):
    ahead, left = PLACES[place]
    for r in log.wheels:
        twist = r.message.twist.twist
        along = twist.linear.x - left * twist.angular.z
        twist.linear.x = math.copysign(math.hypot(along, ahead * twist.angular.z), along)
    change(log)


@FAULTS.each("speed is {} times what it was from the middle on", [0.92, 1.08, 1.5, 3.6], ABOUT)
def _(log, factor):
    change(log, lambda v, k: v if k < len(log.wheels) / 2 else factor * v)


@FAULTS.each("{} m/s are added to the speed", [0.3, 0.5], ABOUT)
def _(log, offset):
    change(log, lambda v, _: v + offset)
