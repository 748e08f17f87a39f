"""Writes the sample drive with the official writer of ROS 1 bags.

    write_rosbag1.py OUT.bag none|bz2|lz4

and OUT.bag.json: the chunks as [begin, end, messages], in the order of the file.
"""
import json
import sys

import genpy
import rosbag
import roslib.message

from sample import TOPICS, messages

out, compression = sys.argv[1:3]
classes = [roslib.message.get_message_class(type_name) for _, type_name, _, _, _ in TOPICS]
with rosbag.Bag(out, "w", compression=compression, chunk_threshold=65536) as bag:
    for topic, _, time, data in messages():
        stamp = genpy.Time(time // 10**9, time % 10**9)
        cls = classes[topic]
        bag.write(TOPICS[topic][0], (cls._type, data, cls._md5sum, cls), stamp, raw=True)

with rosbag.Bag(out) as bag:
    chunks = []
    for info in bag._chunks:
        header = bag._chunk_headers[info.pos]
        chunks.append([info.pos, header.data_pos + header.compressed_size, sum(info.connection_counts.values())])
with open(out + ".json", "w") as file:
    json.dump({"chunks": chunks}, file)
