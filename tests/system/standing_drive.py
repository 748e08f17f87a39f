"""An EuRoC folder of a car that stands still, which is mapped within seconds."""

import csv
import math
import struct
import zlib


def write_png(path, width, height):
    """A gray image with some texture, written with the standard library alone."""
    rows = b"".join(b"\0" + bytes((x * 37 + y * 91 + (x * y) % 53) % 256 for x in range(width)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


SENSOR = """%YAML:1.0
sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: [0, 0, 1, 0,  -1, 0, 0, 0,  0, -1, 0, 0,  0, 0, 0, 1]
rate_hz: 10
resolution: [160, 120]
camera_model: pinhole
intrinsics: [100, 100, 80, 60]
distortion_model: radial-tangential
distortion_coefficients: [0, 0, 0, 0]
"""

IMU_SENSOR = """%YAML:1.0
sensor_type: imu
rate_hz: 100
gyroscope_noise_density: 0.001
gyroscope_random_walk: 0.00001
accelerometer_noise_density: 0.02
accelerometer_random_walk: 0.001
"""


CAMCHAIN = """cam0:
  camera_model: pinhole
  intrinsics: [100, 100, 80, 60]
  distortion_model: none
  distortion_coeffs: []
  resolution: [160, 120]
  rostopic: {topic}
  T_cam_imu: [[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]]
"""

IMU = """rostopic: /imu
update_rate: 100
accelerometer_noise_density: 0.02
accelerometer_random_walk: 0.001
gyroscope_noise_density: 0.001
gyroscope_random_walk: 0.00001
"""

VEHICLE = """T_imu_body: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
wheelbase: 2.7
track: 1.6
"""


# For a python that has the bag writer of ROS.
WRITE_BAG = """
import sys, rosbag, rospy
from sensor_msgs.msg import Image, Imu
with rosbag.Bag(sys.argv[1], "w") as bag:
    for i in range(100):
        time = rospy.Time(1, 10_000_000 * i)
        imu = Imu()
        imu.header.stamp = time
        imu.linear_acceleration.z = 9.81
        bag.write("/imu", imu, time)
        if i % 10 == 0:
            image = Image(height=120, width=160, step=160, encoding="mono8", data=bytes(160 * 120))
            image.header.stamp = time
            bag.write("/camera/rear", image, time)
"""


def write_drive(folder, seconds=2.0, imu=True, images=True, calibrated=True):
    """An EuRoC folder of a car that stands still."""
    if imu:
        (folder / "mav0/imu0").mkdir(parents=True)
        (folder / "mav0/imu0/sensor.yaml").write_text(IMU_SENSOR)
        with open(folder / "mav0/imu0/data.csv", "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["#timestamp [ns]", "wx", "wy", "wz", "ax", "ay", "az"])
            for i in range(int(seconds * 100)):
                writer.writerow([10**9 + i * 10**7, 1e-4 * math.sin(i), 0, 0, 0, 0, 9.81])
    if images:
        (folder / "mav0/cam0/data").mkdir(parents=True)
        if calibrated:
            (folder / "mav0/cam0/sensor.yaml").write_text(SENSOR)
        write_png(folder / "mav0/cam0/data/a.png", 160, 120)
        with open(folder / "mav0/cam0/data.csv", "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["#timestamp [ns]", "filename"])
            for i in range(int(seconds * 10)):
                writer.writerow([10**9 + i * 10**8, "a.png"])
    return folder
