"""The sample drive of sample_log.h: which messages there are, and their bytes."""
import struct
import zlib

# topic, type, period, begin, size
TOPICS = [
    ("/imu", "sensor_msgs/Imu", 1, 0, 320),
    ("/cam0/image_raw", "sensor_msgs/Image", 5, 0, 6000),
    ("/odom", "nav_msgs/Odometry", 2, 0, 700),
    ("/fix", "sensor_msgs/NavSatFix", 10, 100, 120),
]
NUM_TICKS = 400


def payload(topic, tick):
    size = TOPICS[topic][4]
    head = struct.pack("<II", topic * 65536, tick)
    body = bytearray()
    random = topic * 65536 + tick + 1
    for i in range(8, size - 4):
        random = (random * 1664525 + 1013904223) & 0xFFFFFFFF
        body.append((i >> 4) & 255 if i & 15 else random >> 24)  # most of it can be packed
    return head + bytes(body) + struct.pack("<I", zlib.crc32(head + body))


def messages():
    for tick in range(NUM_TICKS):
        for topic, (_, _, period, begin, _) in enumerate(TOPICS):
            if tick >= begin and tick % period == 0:
                yield topic, tick, 1_700_000_000_000_000_000 + tick * 10_000_000 + topic * 1000, payload(topic, tick)
