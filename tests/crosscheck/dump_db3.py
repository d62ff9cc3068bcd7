#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
"""Prints what sqlite reads of a .db3 bag, one message a line, as dump_bag.cpp does."""
import sqlite3
import sys
import zlib

bag = sqlite3.connect(f"file:{sys.argv[1]}?mode=ro&immutable=1", uri=True)
rows = bag.execute(
    "SELECT topics.name, messages.timestamp, messages.data FROM messages JOIN topics ON topics.id = messages.topic_id"
)
for line in sorted(f"{topic} {time} {len(data)} {zlib.crc32(data):08x}" for topic, time, data in rows):
    print(line)
