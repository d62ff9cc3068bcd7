#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
"""Writes seeds/joints.mcap, .db3 and .bag: the recording of tests/conformance/make_recordings.py with its LiDAR on a mast that turns (/tf)
and with the joints of its wheels (/joint_states)."""
import math
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "conformance"))
import make_recordings as bags  # noqa: E402

plain_messages = bags.messages
bags.TOPICS += [("/tf", "tf2_msgs", "TFMessage"), ("/joint_states", "sensor_msgs", "JointState")]


def turning(out, index):
    out.number("I", 2)
    for parent, child, angle in (("odom", "base_link", 0.0), ("base_link", "lidar", 0.1 * index)):
        out.header(bags.BEGIN_NS + index * 50_000_000, parent)
        out.text(child)
        out.number("d", 0, 0, 0.9, 0, 0, math.sin(angle / 2), math.cos(angle / 2))
    return out.bytes()


def joints(out, index):
    out.header(bags.BEGIN_NS + index * 50_000_000, "")
    out.number("I", 2)
    out.text("left_wheel")
    out.text("right_wheel")
    for values in ((0.5 * index, 0.6 * index), (10.0, 12.0), ()):
        out.number("I", len(values))
        out.number("d", *values)
    return out.bytes()


def messages(serialization, ouster):
    out = [m for m in plain_messages(serialization, ouster) if m[1] != 0]  # without /tf_static
    for i in range(2 * bags.NUM_SCANS + 1):
        out += [(bags.BEGIN_NS + i * 50_000_000, topic, make(serialization(), i)) for topic, make in ((3, turning), (4, joints))]
    return sorted(out, key=lambda message: message[:2])


bags.messages = messages
for write, ending in ((bags.write_mcap, "mcap"), (bags.write_db3, "db3"), (bags.write_bag, "bag")):
    write(HERE / "seeds" / f"joints.{ending}")
