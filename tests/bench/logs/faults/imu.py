"""IMUs in other units, mounted otherwise, or with something missing."""

import itertools
import math

import numpy

from drive_log import NS, vector
from fault import FaultList

FAULTS = FaultList()
ABOUT = r"\bIMU|/imu|acceleration|accelerometer|gyroscope|\brates\b"
G = 9.80665


def change(log, rates=lambda w, k: w, accelerations=lambda a, k: a):
    for k, r in enumerate(log.imu):
        w, a = r.message.angular_velocity, r.message.linear_acceleration
        vector(w, rates(vector(w), k))
        vector(a, accelerations(vector(a), k))


def turn(log, matrix):
    change(log, lambda w, _: matrix @ w, lambda a, _: matrix @ a)


UNITS = {"g": 1 / G, "mg": 1000 / G, "cm/s2": 100, "mm/s2": 1000, "1/1000": 1e-3, "ft/s2": 3.28084, "16384 per g": 16384 / G}


@FAULTS.each("accelerations in {}", UNITS, ABOUT)
def _(log, unit):
    change(log, accelerations=lambda a, _: a * UNITS[unit])


RATES = {"deg/s": 180 / math.pi, "mrad/s": 1000, "rev/min": 60 / (2 * math.pi), "1/131 deg/s": 131 * 180 / math.pi}


@FAULTS.each("rates in {}", RATES, ABOUT)
def _(log, unit):
    change(log, rates=lambda w, _: w * RATES[unit])


@FAULTS.add("rates in deg/s and accelerations in g", ABOUT)
def _(log):
    change(log, lambda w, _: w * 180 / math.pi, lambda a, _: a / G)


def mountings():
    """The 23 ways to turn a box by quarters, by the sources of x, y and z with their signs."""
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            matrix = numpy.zeros((3, 3))
            for row, (axis, sign) in enumerate(zip(order, signs)):
                matrix[row, axis] = sign
            if numpy.linalg.det(matrix) > 0 and not numpy.allclose(matrix, numpy.eye(3)):
                yield "".join("+-"[s < 0] + "xyz"[a] for a, s in zip(order, signs)), matrix


MOUNTINGS = dict(mountings())


@FAULTS.each("axes are {}", MOUNTINGS, ABOUT)
def _(log, name):
    turn(log, MOUNTINGS[name])


@FAULTS.each("left-handed: {} is reversed", "xyz", ABOUT)
def _(log, axis):
    signs = numpy.ones(3)
    signs["xyz".index(axis)] = -1
    change(log, lambda w, _: w * signs, lambda a, _: a * signs)


@FAULTS.each("only the gyroscope's {} is reversed", "xyz", ABOUT)
def _(log, axis):
    signs = numpy.ones(3)
    signs["xyz".index(axis)] = -1
    change(log, rates=lambda w, _: w * signs)


@FAULTS.add("only the gyroscope is reversed", ABOUT)
def _(log):
    change(log, rates=lambda w, _: -w)


@FAULTS.add("only the accelerometer is reversed", ABOUT)
def _(log):
    change(log, accelerations=lambda a, _: -a)


@FAULTS.each("the mount is aslant by {} degrees about x", [3, 10, 40], ABOUT)
def _(log, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    turn(log, numpy.array([[1, 0, 0], [0, c, -s], [0, s, c]]))


@FAULTS.add("rates are all zero", ABOUT)
def _(log):
    change(log, rates=lambda w, _: 0 * w)


@FAULTS.add("accelerations are all zero", ABOUT)
def _(log):
    change(log, accelerations=lambda a, _: 0 * a)


@FAULTS.each("the gyroscope's {} is dead", "xyz", ABOUT)
def _(log, axis):
    kept = numpy.array([x != axis for x in "xyz"], float)
    change(log, rates=lambda w, _: w * kept)


@FAULTS.each("the accelerometer's {} is dead", "xyz", ABOUT)
def _(log, axis):
    kept = numpy.array([x != axis for x in "xyz"], float)
    change(log, accelerations=lambda a, _: a * kept)


@FAULTS.add("halves come in messages of their own", ABOUT)
def _(log):
    change(log, lambda w, k: w * (k % 2), lambda a, k: a * ((k + 1) % 2))


@FAULTS.add("readings repeat until new ones come, four times", ABOUT)
def _(log):
    samples = log.imu
    for k, r in enumerate(samples):
        source = samples[k // 4 * 4].message
        vector(r.message.angular_velocity, vector(source.angular_velocity))
        vector(r.message.linear_acceleration, vector(source.linear_acceleration))


@FAULTS.each("every {}th sample only", [2, 4, 8, 20], ABOUT)
def _(log, step):
    kept = set(map(id, log.imu[::step]))
    log.drop(lambda r: r.topic == log.imu_topic and id(r) not in kept)


@FAULTS.each("the IMU is silent for {} s", [0.1, 0.5, 1.5], ABOUT + "|gap|stretch|nothing")
def _(log, seconds):
    begin = log.at(0.5)
    log.drop(lambda r: r.topic == log.imu_topic and begin <= r.stamp < begin + seconds * NS)


@FAULTS.each("the IMU ends after {} of the drive", [0.3, 0.7], ABOUT + "|end|part|cover")
def _(log, share):
    end = log.at(share)
    log.drop(lambda r: r.topic == log.imu_topic and r.stamp > end)


@FAULTS.add("gravity is taken out", ABOUT)
def _(log):
    mean = numpy.mean([vector(r.message.linear_acceleration) for r in log.imu[:100]], axis=0)
    change(log, accelerations=lambda a, _: a - mean)


@FAULTS.each("accelerations are {} times what they were", [0.9, 0.95, 1.05, 1.1], ABOUT)
def _(log, gain):
    change(log, accelerations=lambda a, _: a * gain)


@FAULTS.each("rates are {} times what they were", [0.9, 0.97, 1.03, 1.1], ABOUT)
def _(log, gain):
    change(log, rates=lambda w, _: w * gain)


@FAULTS.each("rates stop at {} rad/s", [0.1, 0.25], ABOUT)
def _(log, limit):
    change(log, rates=lambda w, _: numpy.clip(w, -limit, limit))


@FAULTS.each("accelerations stop at {} m/s2", [9, 9.9], ABOUT)
def _(log, limit):
    change(log, accelerations=lambda a, _: numpy.clip(a, -limit, limit))


@FAULTS.each("steps of {} rad/s", [0.001, 0.02, 0.1], ABOUT)
def _(log, step):
    change(log, rates=lambda w, _: numpy.round(w / step) * step)


@FAULTS.each("steps of {} m/s2", [0.02, 0.3, 1], ABOUT)
def _(log, step):
    change(log, accelerations=lambda a, _: numpy.round(a / step) * step)


@FAULTS.each("rates are off by {} rad/s", [0.02, 0.1, 0.3], ABOUT)
def _(log, bias):
    change(log, rates=lambda w, _: w + numpy.array([bias, -bias, bias]) / math.sqrt(3))


@FAULTS.each("accelerations are off by {} m/s2", [0.2, 0.5], ABOUT)
def _(log, bias):
    change(log, accelerations=lambda a, _: a + numpy.array([bias, -bias, bias]) / math.sqrt(3))


@FAULTS.each("the IMU is late by {} ms", [10, 40, 100], ABOUT)
def _(log, milliseconds):
    for r in log.imu:
        r.stamp += milliseconds * 10**6


@FAULTS.add("a low-pass of 20 samples", ABOUT)
def _(log):
    state = {}

    def smooth(name):
        def step(v, _):
            state[name] = v if name not in state else state[name] + (v - state[name]) / 20
            return state[name]

        return step

    change(log, smooth("rates"), smooth("accelerations"))


@FAULTS.each("every seventh acceleration is {}", ["nan", "inf"])
def _(log, value):
    change(log, accelerations=lambda a, k: a if k % 7 else a * float(value))


@FAULTS.add("all rates are NaN", ABOUT)
def _(log):
    change(log, rates=lambda w, _: w * math.nan)


@FAULTS.each("every {}th sample is a spike", [50, 500], ABOUT)
def _(log, step):
    change(log, lambda w, k: w if k % step else w + 30, lambda a, k: a if k % step else a - 150)


@FAULTS.add("the last reading is repeated to the end", ABOUT)
def _(log):
    samples = log.imu
    middle = len(samples) // 2
    for r in samples[middle:]:
        vector(r.message.angular_velocity, vector(samples[middle].message.angular_velocity))
        vector(r.message.linear_acceleration, vector(samples[middle].message.linear_acceleration))


@FAULTS.each("all is yawed by {} degrees", [15, 30], ABOUT)
def _(log, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    turn(log, numpy.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]))


@FAULTS.each("accelerations are in g from {} of the drive on", [0.25, 0.5, 0.75], ABOUT)
def _(log, share):
    first = share * len(log.imu)
    change(log, accelerations=lambda a, k: a if k < first else a / G)


@FAULTS.add("gravity is taken out from the middle on", ABOUT)
def _(log):
    still = numpy.mean([vector(r.message.linear_acceleration) for r in log.imu[:100]], axis=0)
    change(log, accelerations=lambda a, k: a if k < len(log.imu) / 2 else a - still)


def about_axis(axis, degrees):
    vector_of_axis = numpy.eye(3)["xyz".index(axis)]
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    cross = numpy.cross(vector_of_axis, numpy.eye(3)).T
    return numpy.eye(3) + s * cross + (1 - c) * cross @ cross


SHIFTS = [("x", 3), ("x", 10), ("y", 2), ("y", 5), ("z", 15)]


@FAULTS.each("the IMU turns about {0[0]} by {0[1]} degrees in the middle", SHIFTS, ABOUT)
def _(log, shift):
    middle, matrix = len(log.imu) / 2, about_axis(*shift)
    change(log, lambda w, k: w if k < middle else matrix @ w, lambda a, k: a if k < middle else matrix @ a)


@FAULTS.each("the accelerometer's {} is off by 0.5 m/s2 from the middle on", "xyz", ABOUT)
def _(log, axis):
    middle, step = len(log.imu) / 2, 0.5 * numpy.eye(3)["xyz".index(axis)]
    change(log, accelerations=lambda a, k: a if k < middle else a + step)
