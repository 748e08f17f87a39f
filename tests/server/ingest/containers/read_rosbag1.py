"""Reads the sample drive back with the official reader: prints the number of messages, fails when one is wrong."""
import sys

import rosbag

from sample import TOPICS, payload

names = [topic for topic, _, _, _, _ in TOPICS]
count = 0
with rosbag.Bag(sys.argv[1]) as bag:
    for topic, (type_name, data, md5sum, _, _), stamp in bag.read_messages(raw=True):
        tick = (stamp.to_nsec() - 1_700_000_000_000_000_000) // 10_000_000
        assert data == payload(names.index(topic), tick), f"message {count} is wrong"
        assert type_name == TOPICS[names.index(topic)][1] and len(md5sum) == 32
        count += 1
print(count)
