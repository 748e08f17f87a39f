"""Rigs that do not fit the log."""

import numpy

from fault import FaultList

FAULTS = FaultList()
ABOUT = r"\bcam\d|rig\b|lens|calibration|\.yaml|mount"


def chains(log):
    """The cameras of the rig, by name."""
    chain = next(content for name, content in log.rig.items() if "camchain" in name)
    return {name: camera for name, camera in chain.items() if name.startswith("cam")}


def imu(log):
    return next(content for name, content in log.rig.items() if "imu" in name and "camchain" not in name)


def turned(camera, axis, degrees):
    c, s = numpy.cos(numpy.radians(degrees)), numpy.sin(numpy.radians(degrees))
    a, b = [(1, 2), (2, 0), (0, 1)]["xyz".index(axis)]
    turn = numpy.eye(4)
    turn[a, a] = turn[b, b] = c
    turn[a, b], turn[b, a] = -s, s
    camera["T_cam_imu"] = (turn @ numpy.array(camera["T_cam_imu"])).tolist()


@FAULTS.each("one camera is turned by {} degrees", [1, 5, 20, 90, 180], ABOUT)
def _(log, degrees):
    turned(chains(log)["cam1"], "y", degrees)


@FAULTS.each("all cameras are turned by {} degrees", [2, 10, 90], ABOUT)
def _(log, degrees):
    for camera in chains(log).values():
        turned(camera, "z", degrees)


@FAULTS.add("mounts are written the other way round", ABOUT)
def _(log):
    for camera in chains(log).values():
        camera["T_cam_imu"] = numpy.linalg.inv(numpy.array(camera["T_cam_imu"])).tolist()


@FAULTS.each("all mounts are off by {} m", [0.1, 1], ABOUT)
def _(log, meters):
    for camera in chains(log).values():
        mount = numpy.array(camera["T_cam_imu"])
        mount[:3, 3] += meters / 3**0.5
        camera["T_cam_imu"] = mount.tolist()


@FAULTS.add("mounts are in millimeters", ABOUT)
def _(log):
    for camera in chains(log).values():
        mount = numpy.array(camera["T_cam_imu"])
        mount[:3, 3] *= 1000
        camera["T_cam_imu"] = mount.tolist()


@FAULTS.each("focal lengths are {} times what they are", [0.8, 0.95, 1.05, 1.25], ABOUT)
def _(log, factor):
    for camera in chains(log).values():
        camera["intrinsics"][-4:-2] = [factor * f for f in camera["intrinsics"][-4:-2]]


@FAULTS.add("the center of images is in the corner", ABOUT)
def _(log):
    for camera in chains(log).values():
        camera["intrinsics"][-2:] = [0, 0]


@FAULTS.add("the lens counts as undistorted", ABOUT)
def _(log):
    for camera in chains(log).values():
        camera["distortion_model"], camera["distortion_coeffs"] = "none", []


@FAULTS.add("the lens counts as radtan", ABOUT)
def _(log):
    for camera in chains(log).values():
        camera["distortion_model"] = "radtan"


@FAULTS.each("the resolution is {}", ["swapped", "doubled"], ABOUT + "|size|resolution")
def _(log, what):
    for camera in chains(log).values():
        width, height = camera["resolution"]
        camera["resolution"] = [height, width] if what == "swapped" else [2 * width, 2 * height]


@FAULTS.each("cameras' time shift is {} s", [0.1, -0.1, 5], ABOUT + "|time|shift|clock")
def _(log, seconds):
    for camera in chains(log).values():
        camera["timeshift_cam_imu"] = seconds


@FAULTS.add("T_cam_imu is missing", ABOUT, must_say=True)
def _(log):
    for camera in chains(log).values():
        del camera["T_cam_imu"]


@FAULTS.add("T_cam_imu is not a rotation", ABOUT, must_say=True)
def _(log):
    for camera in chains(log).values():
        camera["T_cam_imu"] = (numpy.array(camera["T_cam_imu"]) * 1.2).tolist()


@FAULTS.add("T_cam_imu is left-handed", ABOUT, must_say=True)
def _(log):
    for camera in chains(log).values():
        mount = numpy.array(camera["T_cam_imu"])
        mount[0] *= -1
        camera["T_cam_imu"] = mount.tolist()


@FAULTS.each("camera topics are {}", ["missing", "below a namespace", "of another car"], ABOUT + "|topic")
def _(log, what):
    for camera in chains(log).values():
        if what == "missing":
            camera.pop("rostopic")
        else:
            camera["rostopic"] = ("/car1" + camera["rostopic"]) if what == "below a namespace" else "/fleet/" + camera["rostopic"].strip("/")[-4:] + "x"


@FAULTS.add("the IMU's topic is missing")
def _(log):
    imu(log).pop("rostopic", None)


NOISES = ["gyroscope_noise_density", "accelerometer_noise_density", "gyroscope_random_walk", "accelerometer_random_walk"]


@FAULTS.each("the IMU's noises are {}", ["0", "-0.001", "1e-9", "missing", "nan", "ten times", "a hundredth"], ABOUT + "|noise")
def _(log, what):
    for name in NOISES:
        if what == "missing":
            imu(log).pop(name)
        elif what in ("ten times", "a hundredth"):
            imu(log)[name] = float(imu(log)[name]) * (10 if what == "ten times" else 0.01)
        else:
            imu(log)[name] = float(what)


@FAULTS.add("the rig has two cameras more", ABOUT)
def _(log):
    name, chain = next((name, content) for name, content in log.rig.items() if "camchain" in name)
    for k in (4, 5):
        chain[f"cam{k}"] = dict(chain["cam0"], rostopic=f"/cam{k}/image")
    log.rig[name] = chain


@FAULTS.add("the rig has half of the cameras")
def _(log):
    chain = next(content for name, content in log.rig.items() if "camchain" in name)
    for name in ("cam2", "cam3"):
        chain.pop(name, None)


@FAULTS.add("cameras in another order")
def _(log):
    name, chain = next((name, content) for name, content in log.rig.items() if "camchain" in name)
    log.rig[name] = {f"cam{k}": chain[f"cam{3 - k}"] for k in range(4)}


@FAULTS.add("no vehicle.yaml")
def _(log):
    log.rig.pop("vehicle.yaml", None)


@FAULTS.each("a file of the rig is {}", ["empty", "no YAML", "HTML"], ABOUT)
def _(log, what):
    name = next(name for name in log.rig if "camchain" in name)
    log.rig[name] = {"empty": "", "no YAML": "cam0: [1, 2\n  x: {", "HTML": "<html><body>404</body></html>"}[what]


@FAULTS.add("the IMU's place is in millimeters", ABOUT + "|IMU", must_say=True)
def _(log):
    matrix = log.rig["vehicle.yaml"]["T_imu_body"]
    for row in matrix[:3]:
        row[3] *= 1000


@FAULTS.each("lenses are calibrated for images {} times as large", [2, 4], ABOUT + "|gyroscope", must_say=True)
def _(log, size):
    for camera in chains(log).values():
        camera["intrinsics"][-4:] = [size * number for number in camera["intrinsics"][-4:]]


@FAULTS.add("the IMU's place is written the other way round", ABOUT + "|IMU", must_say=True)
def _(log):
    vehicle = log.rig["vehicle.yaml"]
    vehicle["T_imu_body"] = numpy.linalg.inv(numpy.array(vehicle["T_imu_body"])).tolist()
