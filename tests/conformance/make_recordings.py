#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
"""Writes one small recording in several storages, from the descriptions of the formats and without adit's own code:
    make_recordings.py [FOLDER]    tube.mcap (ROS 2, CDR), tube_lz4.mcap and tube_zstd.mcap (in a chunk, compressed by the programs lz4
                             and zstd), tube_split (a folder of two such files, as rosbag2 splits a recording), tube.db3 (ROS 2,
                             SQLite), tube.bag (ROS 1), tube_bz2.bag and tube_lz4.bag (in a chunk that bzip2 and lz4 compress),
                             tube_kitti (a sequence as KITTI lays it out: no times of points, truth of the camera), tube_pcd (a
                             folder of PCD files, binary, with a mount and the odometry beside them)
Three scans of a tube, the robot driving 0.5 m between them; wheel odometry at 20 Hz; the LiDAR 0.9 m above the base. Points
carry their times as Velodyne's driver (seconds, float32, with padding behind each point) in ROS 2, as Ouster's (nanoseconds,
uint32, fields in another order) in ROS 1."""
import math
import sqlite3
import struct
import subprocess
import sys
from pathlib import Path

BEGIN_NS = 1_700_000_000_000_000_000
NUM_SCANS, NUM_POINTS, SCAN_NS = 3, 48, 100_000_000
FLOAT32, UINT32, UINT16 = 7, 6, 4  # datatypes of sensor_msgs/PointField


class Cdr:
    """Little-endian CDR, aligned to the size of each number."""

    def __init__(self):
        self.data = b""

    def number(self, kind, *values):
        for value in values:
            size = struct.calcsize(kind)
            self.data += b"\0" * (-len(self.data) % size) + struct.pack("<" + kind, value)

    def text(self, text):
        self.number("I", len(text) + 1)
        self.data += text.encode() + b"\0"

    def header(self, stamp_ns, frame):
        self.number("i", stamp_ns // 10**9)
        self.number("I", stamp_ns % 10**9)
        self.text(frame)

    def bytes(self):
        return b"\0\1\0\0" + self.data


class Ros1(Cdr):
    """The serialization of ROS 1: no alignment, no terminating zeros, a sequence number in each header."""

    def number(self, kind, *values):
        for value in values:
            self.data += struct.pack("<" + kind, value)

    def text(self, text):
        self.number("I", len(text))
        self.data += text.encode()

    def header(self, stamp_ns, frame):
        self.number("I", 0)
        super().header(stamp_ns, frame)

    def bytes(self):
        return self.data


def points_of(scan):
    """(x, y, z, intensity, seconds since the scan began): rings of a tube of radius 2 m along x."""
    for i in range(NUM_POINTS):
        angle = 2.0 * math.pi * i / NUM_POINTS
        yield 4.0 * (i % 3) - 0.5 * scan, 2.0 * math.cos(angle), 2.0 * math.sin(angle), float(i), 0.1 * i / NUM_POINTS


def cloud(out, scan, ouster):
    out.header(BEGIN_NS + scan * SCAN_NS, "lidar")
    out.number("I", 1, NUM_POINTS)
    if ouster:
        fields, step = [("t", 0, UINT32), ("x", 4, FLOAT32), ("y", 8, FLOAT32), ("z", 12, FLOAT32), ("intensity", 16, FLOAT32)], 20
    else:
        fields, step = [("x", 0, FLOAT32), ("y", 4, FLOAT32), ("z", 8, FLOAT32), ("intensity", 16, FLOAT32), ("ring", 20, UINT16),
                        ("time", 24, FLOAT32)], 32
    out.number("I", len(fields))
    for name, offset, datatype in fields:
        out.text(name)
        out.number("I", offset)
        out.number("B", datatype)
        out.number("I", 1)
    out.number("B", 0)  # little-endian points
    out.number("I", step, step * NUM_POINTS)
    out.number("I", step * NUM_POINTS)
    for i, (x, y, z, intensity, seconds) in enumerate(points_of(scan)):
        if ouster:
            out.data += struct.pack("<Iffff", round(seconds * 1e9), x, y, z, intensity)
        else:
            out.data += struct.pack("<fff4xfHxxf4x", x, y, z, intensity, i % 3, seconds)
    out.number("B", 1)
    return out.bytes()


def odometry(out, index):
    out.header(BEGIN_NS + index * 50_000_000, "odom")
    out.text("base_link")
    out.number("d", 0.25 * index, 0, 0, 0, 0, 0, 1, *[0.0] * 36)
    out.number("d", 5.0, 0, 0, 0, 0, 0, *[0.0] * 36)
    return out.bytes()


def mount(out):
    out.number("I", 1)
    out.header(BEGIN_NS, "base_link")
    out.text("lidar")
    out.number("d", 0, 0, 0.9, 0, 0, 0, 1)
    return out.bytes()


TOPICS = [("/tf_static", "tf2_msgs", "TFMessage"), ("/odom", "nav_msgs", "Odometry"), ("/points", "sensor_msgs", "PointCloud2")]


def messages(serialization, ouster):
    """(stamp, topic, bytes) in the order of the stamps."""
    out = [(BEGIN_NS, 0, mount(serialization()))]
    out += [(BEGIN_NS + i * 50_000_000, 1, odometry(serialization(), i)) for i in range(2 * NUM_SCANS + 1)]
    out += [(BEGIN_NS + s * SCAN_NS, 2, cloud(serialization(), s, ouster)) for s in range(NUM_SCANS)]
    return sorted(out, key=lambda message: message[:2])


def write_db3(path):
    path.unlink(missing_ok=True)
    db = sqlite3.connect(path)
    db.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
               "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
    db.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    for i, (name, package, kind) in enumerate(TOPICS):
        db.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", (i + 1, name, f"{package}/msg/{kind}"))
    for stamp, topic, data in messages(Cdr, False):
        db.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", (topic + 1, stamp, data))
    db.commit()
    db.execute("VACUUM")
    db.close()


def compress(program, data):
    return subprocess.run([program, "-9", "-c", "-q"], input=data, capture_output=True, check=True).stdout


def write_mcap(path, compression=None, part=slice(None)):
    """`compression`: None for messages without chunks, else the program that compresses the only chunk, lz4 or zstd. `part`:
    which of the messages."""
    chosen = messages(Cdr, False)[part]

    def text(value):
        return struct.pack("<I", len(value)) + value.encode()

    def record(op, content):
        return struct.pack("<BQ", op, len(content)) + content

    def chunk(records, stamps):
        packed = compress(compression, records)
        head = struct.pack("<QQQI", min(stamps), max(stamps), len(records), 0)
        return record(6, head + text(compression) + struct.pack("<Q", len(packed)) + packed)

    magic = b"\x89MCAP0\r\n"
    out = b""
    for i, (name, package, kind) in enumerate(TOPICS):
        out += record(3, struct.pack("<H", i + 1) + text(f"{package}/msg/{kind}") + text("ros2msg") + struct.pack("<I", 0))
        out += record(4, struct.pack("<HH", i, i + 1) + text(name) + text("cdr") + struct.pack("<I", 0))
    for n, (stamp, topic, data) in enumerate(chosen):
        out += record(5, struct.pack("<HIQQ", topic, n, stamp, stamp) + data)
    if compression:
        out = chunk(out, [stamp for stamp, _, _ in chosen])
    head = magic + record(1, text("ros2") + text("conformance"))
    end = record(15, struct.pack("<I", 0)) + record(2, struct.pack("<QQI", 0, 0, 0)) + magic
    path.write_bytes(head + out + end)


def write_split(folder):
    """Cut between the second scan and the third."""
    folder.mkdir(exist_ok=True)
    names = [f"tube_split_{i}.mcap" for i in range(2)]
    for name, part in zip(names, (slice(0, 7), slice(7, None))):
        write_mcap(folder / name, "zstd", part)
    counts = [sum(topic == i for _, topic, _ in messages(Cdr, False)) for i in range(len(TOPICS))]
    lines = ["rosbag2_bagfile_information:", "  version: 5", "  storage_identifier: mcap", "  duration:", "    nanoseconds: 300000000",
             "  starting_time:", f"    nanoseconds_since_epoch: {BEGIN_NS}", f"  message_count: {sum(counts)}",
             "  topics_with_message_count:"]
    for (name, package, kind), count in zip(TOPICS, counts):
        lines += ["    - topic_metadata:", f"        name: {name}", f"        type: {package}/msg/{kind}",
                  "        serialization_format: cdr", "        offered_qos_profiles: ''", f"      message_count: {count}"]
    lines += ["  compression_format: ''", "  compression_mode: ''", "  relative_file_paths:"] + [f"    - {name}" for name in names]
    (folder / "metadata.yaml").write_text("\n".join(lines) + "\n")


def write_bag(path, program=None):
    """`program`: compresses the only chunk, bzip2 or lz4."""
    def record(fields, data):
        header = b""
        for name, value in fields:
            entry = name.encode() + b"=" + value
            header += struct.pack("<I", len(entry)) + entry
        return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data

    def time(ns):
        return struct.pack("<II", ns // 10**9, ns % 10**9)

    def connection(i):
        name, package, kind = TOPICS[i]
        about = b""
        for key, value in (("topic", name), ("type", f"{package}/{kind}"), ("md5sum", "*"), ("message_definition", "")):
            entry = f"{key}={value}".encode()
            about += struct.pack("<I", len(entry)) + entry
        return record([("op", b"\x07"), ("conn", struct.pack("<I", i)), ("topic", name.encode())], about)

    chunk, index = b"", {i: [] for i in range(len(TOPICS))}
    for i in index:
        chunk += connection(i)
    all_messages = messages(Ros1, True)
    for stamp, topic, data in all_messages:
        index[topic].append((stamp, len(chunk)))
        chunk += record([("op", b"\x02"), ("conn", struct.pack("<I", topic)), ("time", time(stamp))], data)
    def start(index_pos):
        fields = [("op", b"\x03"), ("index_pos", struct.pack("<Q", index_pos)), ("conn_count", struct.pack("<I", len(TOPICS))),
                  ("chunk_count", struct.pack("<I", 1))]
        return b"#ROSBAG V2.0\n" + record(fields, b" " * (4096 - len(record(fields, b""))))
    compression = {None: b"none", "bzip2": b"bz2", "lz4": b"lz4"}[program]
    body = record([("op", b"\x05"), ("compression", compression), ("size", struct.pack("<I", len(chunk)))],
                  compress(program, chunk) if program else chunk)
    for i, entries in index.items():
        body += record([("op", b"\x04"), ("ver", struct.pack("<I", 1)), ("conn", struct.pack("<I", i)),
                        ("count", struct.pack("<I", len(entries)))],
                       b"".join(time(stamp) + struct.pack("<I", offset) for stamp, offset in entries))
    chunk_pos = len(start(0))
    end = b"".join(connection(i) for i in index)
    end += record([("op", b"\x06"), ("ver", struct.pack("<I", 1)), ("chunk_pos", struct.pack("<Q", chunk_pos)),
                   ("start_time", time(all_messages[0][0])), ("end_time", time(all_messages[-1][0])),
                   ("count", struct.pack("<I", len(index)))],
                  b"".join(struct.pack("<II", i, len(entries)) for i, entries in index.items()))
    path.write_bytes(start(chunk_pos + len(body)) + body + end)


def write_kitti(folder):
    """The camera looks along x of the LiDAR: its x is -y there, its y -z."""
    (folder / "velodyne").mkdir(parents=True, exist_ok=True)
    for scan in range(NUM_SCANS):
        points = b"".join(struct.pack("<ffff", x, y, z, intensity) for x, y, z, intensity, _ in points_of(scan))
        (folder / "velodyne" / f"{scan:06}.bin").write_bytes(points)
    (folder / "times.txt").write_text("".join(f"{scan * SCAN_NS / 1e9:e}\n" for scan in range(NUM_SCANS)))
    (folder / "calib.txt").write_text("Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n")
    (folder / "poses.txt").write_text("".join(f"1 0 0 0 0 1 0 0 0 0 1 {0.5 * scan}\n" for scan in range(NUM_SCANS)))


def write_pcd(folder):
    folder.mkdir(exist_ok=True)
    for scan in range(NUM_SCANS):
        head = ["# .PCD v0.7 - Point Cloud Data file format", "VERSION 0.7", "FIELDS x y z intensity t", "SIZE 4 4 4 4 4",
                "TYPE F F F F U", "COUNT 1 1 1 1 1", f"WIDTH {NUM_POINTS}", "HEIGHT 1", "VIEWPOINT 0 0 0 1 0 0 0",
                f"POINTS {NUM_POINTS}", "DATA binary"]
        points = b"".join(struct.pack("<ffffI", x, y, z, intensity, round(seconds * 1e9))
                          for x, y, z, intensity, seconds in points_of(scan))
        (folder / f"{scan:06}.pcd").write_bytes("\n".join(head).encode() + b"\n" + points)
    (folder / "stamps.txt").write_text("".join(f"{(BEGIN_NS + scan * SCAN_NS) / 1e9:.1f}\n" for scan in range(NUM_SCANS)))
    (folder / "odometry.tum").write_text("".join(f"{(BEGIN_NS + i * 50_000_000) / 1e9:.2f} {0.25 * i} 0 0 0 0 0 1\n"
                                                 for i in range(2 * NUM_SCANS + 1)))
    (folder / "recording.toml").write_text('robot = "tube"\nmount = "0 0 0.9"\n')


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent)
    write_mcap(folder / "tube.mcap")
    for program in ("lz4", "zstd"):
        write_mcap(folder / f"tube_{program}.mcap", program)
    write_split(folder / "tube_split")
    write_db3(folder / "tube.db3")
    write_bag(folder / "tube.bag")
    write_bag(folder / "tube_bz2.bag", "bzip2")
    write_bag(folder / "tube_lz4.bag", "lz4")
    write_kitti(folder / "tube_kitti")
    write_pcd(folder / "tube_pcd")
