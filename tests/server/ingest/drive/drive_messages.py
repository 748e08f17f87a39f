"""Writes a ROS 1 bag of a made-up drive with the official writer (python3-rosbag).

usage: drive_messages.py OUT.bag none|bz2|lz4

3 s: Imu at 200 Hz, Odometry at 50 Hz, NavSatFix at 5 Hz, /cam_front as raw bgr8 and /cam_left as PNG at 20 Hz with
CameraInfo, static transforms. The gray value of an image is its number; stamps are 1700000000 s + i * period.
"""

import struct
import sys
import zlib

import genpy
import rosbag
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, Imu, NavSatFix
from tf2_msgs.msg import TFMessage

BEGIN_NS = 1700000000 * 10**9
WIDTH, HEIGHT = 64, 48


def stamp(ms):
    total = BEGIN_NS + ms * 10**6
    return genpy.Time(total // 10**9, total % 10**9)


def stamped(message, ms, frame):
    message.header.stamp = stamp(ms)
    message.header.frame_id = frame
    return message


def png(value):
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0)
    rows = (b"\0" + bytes([value]) * WIDTH) * HEIGHT
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def transform(parent, child, translation, rotation=(0, 0, 0, 1)):
    message = TransformStamped()
    message.header.frame_id = parent
    message.child_frame_id = child
    t, r = message.transform.translation, message.transform.rotation
    t.x, t.y, t.z = translation
    r.x, r.y, r.z, r.w = rotation
    return message


def camera_info(ms, frame):
    info = stamped(CameraInfo(), ms, frame)
    info.width, info.height = WIDTH, HEIGHT
    info.distortion_model = "equidistant"
    info.D = [0.01, -0.002, 0.0003, 0.0]
    info.K = [40, 0, 31.5, 0, 41, 23.5, 0, 0, 1]
    return info


def front_image(ms, value):
    image = stamped(Image(), ms, "cam_front")
    image.width, image.height, image.step = WIDTH, HEIGHT, 3 * WIDTH
    image.encoding = "bgr8"
    image.data = bytes([value]) * (3 * WIDTH * HEIGHT)
    return image


def left_image(ms, value):
    image = stamped(CompressedImage(), ms, "cam_left")
    image.format = "png"
    image.data = png(value)
    return image


def main(path, compression):
    optical = (-0.5, 0.5, -0.5, 0.5)
    static = TFMessage([transform("base_link", "imu_link", (0.5, 0, 0.4)),
                        transform("base_link", "mast", (2, 0, 1)),
                        transform("mast", "cam_front", (0, 0, 0.25), optical),
                        transform("mast", "cam_left", (0, 0.5, 0), optical)])
    with rosbag.Bag(path, "w", compression=compression, chunk_threshold=65536) as bag:
        bag.write("/tf_static", static, stamp(0))
        for ms in range(3001):
            now = stamp(ms)
            if ms % 5 == 0:
                imu = stamped(Imu(), ms, "imu_link")
                imu.angular_velocity.z = 0.25
                imu.linear_acceleration.z = 9.81
                bag.write("/imu", imu, now)
            if ms % 20 == 0:
                odometry = stamped(Odometry(), ms, "odom")
                odometry.twist.twist.linear.x = 1.5
                odometry.twist.twist.angular.z = 0.25
                odometry.pose.pose.orientation.w = 1
                bag.write("/odom", odometry, now)
            if ms % 200 == 0:
                fix = stamped(NavSatFix(), ms, "gnss")
                fix.latitude, fix.longitude, fix.altitude = 48.1, 11.5, 512.25
                fix.position_covariance = [1, 0, 0, 0, 4, 0, 0, 0, 9]
                fix.position_covariance_type = NavSatFix.COVARIANCE_TYPE_KNOWN
                bag.write("/fix", fix, now)
            if ms % 50 == 0:
                bag.write("/cam_front/camera_info", camera_info(ms, "cam_front"), now)
                bag.write("/cam_front/image_raw", front_image(ms, ms // 50), now)
                bag.write("/cam_left/camera_info", camera_info(ms, "cam_left"), now)
                bag.write("/cam_left/image_raw/compressed", left_image(ms, 100 + ms // 50), now)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
