// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Prints what @mcap/core or @foxglove/rosbag read of a bag, one message a line, as dump_bag.cpp does. With --written each
// message is also decoded by the definition in the file and encoded again, which has to give the same bytes: for files
// that adit wrote.
import { open, readFile } from "node:fs/promises";
import { crc32 } from "node:zlib";

import { parse } from "@foxglove/rosmsg";
import { MessageReader, MessageWriter } from "@foxglove/rosmsg2-serialization";
import { McapStreamReader } from "@mcap/core";
import rosbag from "@foxglove/rosbag";
import * as fzstd from "fzstd";
import lz4 from "lz4js";
import Bunzip from "seek-bzip";

const written = process.argv.includes("--written");
const path = process.argv.at(-1);
const lines = [];

// Of node before 22, which has none.
const crcTable = Int32Array.from({ length: 256 }, (_, i) => {
  for (let k = 0; k < 8; ++k) i = i & 1 ? (i >>> 1) ^ 0xedb88320 : i >>> 1;
  return i;
});
function crcOf(bytes) {
  if (crc32) return crc32(bytes);
  let crc = -1;
  for (const byte of bytes) crc = crcTable[(crc ^ byte) & 255] ^ (crc >>> 8);
  return ~crc >>> 0;
}
function add(topic, time, bytes) {
  lines.push(`${topic} ${time} ${bytes.byteLength} ${crcOf(bytes).toString(16).padStart(8, "0")}`);
}

function codecOf(schema) {
  const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
  return { reader: new MessageReader(definitions), writer: new MessageWriter(definitions) };
}
function checkDecoding(topic, codec, bytes) {
  const again = codec.writer.writeMessage(codec.reader.readMessage(bytes));
  if (Buffer.compare(Buffer.from(again), Buffer.from(bytes)) !== 0) {
    throw new Error(`${topic}: a message of ${bytes.byteLength} bytes, decoded and encoded, is another one`);
  }
}

async function dumpMcap() {
  const reader = new McapStreamReader({
    validateCrcs: true,
    decompressHandlers: {
      zstd: (bytes, size) => fzstd.decompress(bytes, new Uint8Array(Number(size))),
      lz4: (bytes) => lz4.decompress(bytes),
    },
  });
  const schemas = new Map();
  const channels = new Map();
  reader.append(await readFile(path));
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Schema") schemas.set(record.id, written ? codecOf(record) : undefined);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type !== "Message") continue;
    const channel = channels.get(record.channelId);
    if (written) checkDecoding(channel.topic, schemas.get(channel.schemaId), record.data);
    add(channel.topic, record.logTime, record.data);
  }
  if (!reader.done()) throw new Error(`${path} breaks off`);
}

async function dumpRosBag() {
  const file = await open(path);
  const { size } = await file.stat();
  const source = {
    size: () => size,
    read: async (offset, length) => {
      const bytes = new Uint8Array(length);
      await file.read(bytes, 0, length, offset);
      return bytes;
    },
  };
  const decompress = {
    bz2: (bytes) => Bunzip.decode(bytes),
    lz4: (bytes) => lz4.decompress(bytes),
  };
  const bag = new rosbag.Bag(source, { parse: false, decompress });
  await bag.open();
  for await (const message of bag.messageIterator()) {
    const { sec, nsec } = message.timestamp;
    add(message.topic, BigInt(sec) * 1000000000n + BigInt(nsec), message.data);
  }
}

await (path.endsWith(".bag") ? dumpRosBag() : dumpMcap());
// By bytes, as std::sort does.
lines.sort((a, b) => Buffer.compare(Buffer.from(a), Buffer.from(b)));
process.stdout.write(lines.map((line) => line + "\n").join(""));
