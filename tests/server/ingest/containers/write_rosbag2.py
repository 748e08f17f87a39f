"""Writes the sample drive in the layout of rosbag2's sqlite3 storage.

    write_rosbag2.py OUT.db3 [messages=zstd] [index=no] [wal=all|half] [set_back=SECONDS]

With wal= the files are left as by a recorder that was killed: everything, or the messages from the middle on, in
OUT.db3-wal. With set_back= the recorder's clock was set back so far before the messages from the middle on.
"""
import ctypes
import os
import shutil
import sqlite3
import sys

from sample import TOPICS, messages

out, *settings = sys.argv[1:]


def compress(data):
    zstd = ctypes.CDLL("libzstd.so.1")
    zstd.ZSTD_compress.restype = ctypes.c_size_t
    packed = ctypes.create_string_buffer(len(data) + 1024)
    size = zstd.ZSTD_compress(packed, ctypes.c_size_t(len(packed)), data, ctypes.c_size_t(len(data)), 1)
    return packed.raw[:size]


if os.path.exists(out):
    os.remove(out)
database = sqlite3.connect(out)
wal = next((setting[4:] for setting in settings if setting.startswith("wal=")), None)
if wal:
    database.execute("PRAGMA journal_mode = wal")
    database.execute("PRAGMA wal_autocheckpoint = 0")
database.executescript(
    """
    CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
    CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
    CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
      serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);
    CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
      encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
    CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
      data BLOB NOT NULL);
    """
)
if "index=no" not in settings:
    database.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
database.execute("INSERT INTO schema VALUES(4, 'jazzy')")
for index, (topic, type_name, _, _, _) in enumerate(TOPICS):
    ros2_type = type_name.replace("/", "/msg/")
    database.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '', 'RIHS01_0')", (index + 1, topic, ros2_type))
    database.execute("INSERT INTO message_definitions VALUES(?, ?, 'ros2msg', 'uint8[] data', 'RIHS01_0')",
                     (index + 1, ros2_type))
set_back = next((int(setting[9:]) for setting in settings if setting.startswith("set_back=")), 0)
for number, (topic, _, time, data) in enumerate(messages()):
    if number >= 355:
        time -= set_back * 10**9
    if number == 355 and wal == "half":
        database.commit()
        database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    if "messages=zstd" in settings:
        data = compress(data)
    database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", (topic + 1, time, data))
database.commit()
if wal:
    for suffix in ("", "-wal"):
        shutil.copy(out + suffix, out + ".killed" + suffix)
database.close()
if wal:
    for suffix in ("", "-wal"):
        os.replace(out + ".killed" + suffix, out + suffix)
