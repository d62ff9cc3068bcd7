// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mcap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <thread>

#include "adit/core/rng.hpp"
#include "adit/io/cdr.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/crc32.hpp"
#include "adit/io/mcap_reader.hpp"
#include "adit/io/mcap_writer.hpp"
#include "adit/io/ros_messages.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

Scan make_scan(std::size_t index, std::size_t num_points) {
  Rng rng(index + 1);
  Scan scan{{1'700'000'000'123'456'789 + static_cast<std::int64_t>(index) * 100'000'000}, {}};
  for (std::size_t i = 0; i < num_points; ++i) {
    scan.cloud.points.emplace_back(static_cast<float>(rng.uniform(-50, 50)), static_cast<float>(rng.normal()),
                                   1.5F);
    scan.cloud.intensities.push_back(static_cast<float>(rng.uniform(0, 255)));
    scan.cloud.time_offsets_ns.push_back(-static_cast<std::int32_t>(rng.below(100'000'000)));
  }
  return scan;
}

Recording make_recording(std::size_t num_scans, std::size_t num_points = 40) {
  Recording recording;
  recording.name = "robot_0";
  recording.lidar = "os2-128";
  recording.T_base_lidar = Pose::planar(0.1, 0.2, 0.3, 0.9);
  for (std::size_t i = 0; i < num_scans; ++i) recording.scan_stamps.push_back(make_scan(i, 0).stamp);
  recording.read_scan = [num_points](std::size_t i) -> Result<Scan> { return make_scan(i, num_points); };
  const Stamp start = recording.scan_stamps.front() - Duration(7);
  for (int i = 0; i < static_cast<int>(num_scans) * 5; ++i) {
    const Stamp stamp = start + Duration(i * 20'000'001LL);
    recording.wheel.push_back({stamp, Pose::planar(0.04 * i, 0.01 * i, 0.002 * i)});
    recording.truth.push_back({stamp, Pose::planar(0.04 * i, 0.011 * i, 0.003 * i, 0.1)});
  }
  return recording;
}

std::string bytes_of(const Recording& recording) {
  std::ostringstream out;
  const Result<> written = write_recording(out, recording);
  EXPECT_TRUE(written) << written.error().message;
  return out.str();
}

void expect_same(const Trajectory& a, const Trajectory& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].stamp, b[i].stamp);
    EXPECT_LT((a[i].T_world_body.inverse() * b[i].T_world_body).log().norm(), 1e-12);
  }
}

TEST(Crc32, KnownValues) {
  // The check value of the CRC catalogue, and the property that makes it continue.
  EXPECT_EQ(crc32("123456789"), 0xCBF43926U);
  EXPECT_EQ(crc32(""), 0U);
  const std::string text(1000, 'q');
  for (std::size_t cut : {0U, 1U, 7U, 8U, 333U})
    EXPECT_EQ(crc32(text.substr(cut), crc32(text.substr(0, cut))), crc32(text));
}

TEST(Compression, RoundTripAndDamage) {
  const std::string text = "abcabcabc" + std::string(5000, 'x');
  const std::string packed = compress_zstd(text);
  EXPECT_LT(packed.size(), text.size());
  EXPECT_EQ(decompress(packed, "zstd", text.size()), text);
  EXPECT_FALSE(decompress(packed, "zstd", text.size() - 1));
  EXPECT_FALSE(decompress(packed, "zstd", text.size() + 1));
  EXPECT_FALSE(decompress(packed.substr(0, packed.size() / 2), "zstd", text.size()));
  EXPECT_FALSE(decompress(packed, "lz4", text.size()));
  EXPECT_FALSE(decompress("", "lz4", 0U));
  EXPECT_FALSE(decompress(text, "", 3));
  EXPECT_ERROR(decompress(text, "bz2", 3), "lz4 and zstd are known");
  EXPECT_ERROR(decompress(packed, "zstd", std::size_t{1} << 50U), "1 GiB is the most");
}

TEST(Compression, Lz4Frames) {
  // By hand: 6 literals, a match of 7 bytes 6 back, 5 literals; frame head and end mark around the one block.
  const std::string frame = std::string("\x04\x22\x4d\x18\x60\x40\x82\x0f\0\0\0", 11) +
                            "\x63"
                            "hello " +
                            std::string("\x06\0", 2) +
                            "\x50"
                            "ello\n" +
                            std::string(4, '\0');
  EXPECT_EQ(decompress(frame, "lz4", 18), "hello hello hello\n");
  EXPECT_FALSE(decompress(frame, "lz4", 17));
  EXPECT_FALSE(decompress(frame, "lz4", 19));
  for (std::size_t size = 0; size < frame.size(); ++size)
    EXPECT_FALSE(decompress(frame.substr(0, size), "lz4", 18));
}

TEST(Cdr, AlignsToTheSizeOfTheNumber) {
  CdrWriter writer;
  writer.number(std::uint8_t{7}).number(std::uint32_t{1}).text("ab").number(2.5);
  const std::string bytes = writer.take();
  // 4 of head; byte at 0, number at 4, text at 8 (4 + "ab\0" = 7), double at 16.
  EXPECT_EQ(bytes.size(), 4U + 24U);
  CdrReader reader(bytes);
  EXPECT_EQ(reader.number<std::uint8_t>(), 7);
  EXPECT_EQ(reader.number<std::uint32_t>(), 1U);
  EXPECT_EQ(reader.text(), "ab");
  EXPECT_EQ(reader.number<double>(), 2.5);
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.number<std::uint8_t>(), 0);
  EXPECT_FALSE(reader.ok());
}

TEST(Cdr, BigEndian) {
  CdrReader reader(std::string_view("\0\0\0\0\0\0\1\2", 8));
  EXPECT_EQ(reader.number<std::uint32_t>(), 0x102U);
  EXPECT_FALSE(CdrReader("\x07\x07").ok());
}

TEST(RosMessages, EveryTruncationIsAnError) {
  const std::string cloud = ros::encode_cloud(make_scan(0, 5), "lidar");
  // The last byte is is_dense, which is not needed.
  for (std::size_t size = 0; size + 1 < cloud.size(); ++size)
    EXPECT_FALSE(ros::decode_cloud(cloud.substr(0, size)));
  const std::string transforms = ros::encode_transforms({{"a", "b", {{5}, Pose::planar(1, 2, 3)}}});
  for (std::size_t size = 0; size < transforms.size(); ++size) {
    EXPECT_FALSE(ros::decode_transforms(transforms.substr(0, size)));
  }
  const std::string odometry = ros::encode_odometry({"a", "b", {{5}, Pose::planar(1, 2, 3)}});
  EXPECT_FALSE(ros::decode_odometry(odometry.substr(0, 60)));
  EXPECT_FALSE(ros::decode_odometry(""));
}

TEST(RosMessages, PaddedRowsOfAnOrganisedCloud) {
  CdrWriter writer;
  writer.number(std::int32_t{1}).number(std::uint32_t{500}).text("f");
  writer.number(std::uint32_t{2}).number(std::uint32_t{1}).number(std::uint32_t{3});
  for (const auto& [name, offset] : {std::pair{"x", 0U}, std::pair{"y", 4U}, std::pair{"z", 8U}}) {
    writer.text(name).number(std::uint32_t{offset}).number(std::uint8_t{7}).number(std::uint32_t{1});
  }
  std::string data;
  for (const float row : {1.0F, 2.0F}) {
    for (int axis = 0; axis < 3; ++axis) append_little_endian(data, row);
    data += "pad!";
  }
  writer.number(std::uint8_t{0})
      .number(std::uint32_t{12})
      .number(std::uint32_t{16})
      .blob(data)
      .number(std::uint8_t{1});
  const Result<ros::CloudMessage> cloud = ros::decode_cloud(writer.take());
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->scan.stamp.ns, 1'000'000'500);
  ASSERT_EQ(cloud->scan.cloud.size(), 2U);
  EXPECT_EQ(cloud->scan.cloud.points[1], Eigen::Vector3f(2, 2, 2));
}

TEST(Mcap, RecordingRoundTripIsExact) {
  const Recording recording = make_recording(12);
  const Result<Recording> back = read_recording(memory_source(bytes_of(recording)));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->name, "robot_0");
  EXPECT_EQ(back->lidar, "os2-128");
  EXPECT_LT((back->T_base_lidar.inverse() * recording.T_base_lidar).log().norm(), 1e-12);
  EXPECT_EQ(back->scan_stamps, recording.scan_stamps);
  expect_same(back->wheel, recording.wheel);
  expect_same(back->truth, recording.truth);
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    const Result<Scan> scan = back->read_scan(i);
    ASSERT_TRUE(scan) << scan.error().message;
    const Scan expected = make_scan(i, 40);
    EXPECT_EQ(scan->stamp, expected.stamp);
    EXPECT_EQ(scan->cloud.points, expected.cloud.points);
    EXPECT_EQ(scan->cloud.intensities, expected.cloud.intensities);
    EXPECT_EQ(scan->cloud.time_offsets_ns, expected.cloud.time_offsets_ns);
  }
}

TEST(Mcap, SameRecordingSameBytes) { EXPECT_EQ(bytes_of(make_recording(3)), bytes_of(make_recording(3))); }

TEST(Mcap, WithoutWheelsTruthIntensityOrTimes) {
  Recording recording = make_recording(3);
  recording.wheel.clear();
  recording.truth.clear();
  recording.read_scan = [](std::size_t i) -> Result<Scan> {
    Scan scan = make_scan(i, 4);
    scan.cloud.intensities.clear();
    scan.cloud.time_offsets_ns.clear();
    return scan;
  };
  const Result<Recording> back = read_recording(memory_source(bytes_of(recording)));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_TRUE(back->wheel.empty());
  EXPECT_TRUE(back->truth.empty());
  const Result<Scan> scan = back->read_scan(1);
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_TRUE(scan->cloud.intensities.empty());
  EXPECT_FALSE(scan->cloud.has_times());
}

TEST(Mcap, ScansAreReadFromManyThreads) {
  const Result<Recording> back = read_recording(memory_source(bytes_of(make_recording(8))));
  ASSERT_TRUE(back) << back.error().message;
  std::vector<std::thread> threads;
  std::vector<int> num_right(4, 0);
  for (std::size_t t = 0; t < num_right.size(); ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t k = 0; k < 40; ++k) {
        const std::size_t i = (k * 3 + t) % back->num_scans();
        const Result<Scan> scan = back->read_scan(i);
        if (scan && scan->cloud.points == make_scan(i, 40).cloud.points) ++num_right[t];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(num_right, std::vector<int>(4, 40));
}

TEST(Mcap, BadRecordingsAreNotWritten) {
  const test::TemporaryFolder folder;
  Recording single = make_recording(1);
  EXPECT_ERROR(write_recording(folder / "a.mcap", single), "two scans or more");
  Recording unordered = make_recording(3);
  std::swap(unordered.scan_stamps[1], unordered.scan_stamps[2]);
  EXPECT_ERROR(write_recording(folder / "a.mcap", unordered), "scan 2: stamp");
  Recording early = make_recording(3);
  early.scan_stamps.front().ns = -1;
  EXPECT_ERROR(write_recording(folder / "a.mcap", early), "scan 0: stamp -0.000000001");
  Recording broken = make_recording(3);
  broken.read_scan = [](std::size_t) -> Result<Scan> { return fail("no ray"); };
  test::put_file(folder / "a.mcap", "old");
  EXPECT_ERROR(write_recording(folder / "a.mcap", broken), "a.mcap: scan 0: no ray");
  EXPECT_EQ(test::get_file(folder / "a.mcap"), "old");
  EXPECT_EQ(test::num_entries(folder.path()), 1U);
}

TEST(Mcap, EveryTruncationIsAnErrorThatSaysWhere) {
  const std::string bytes = bytes_of(make_recording(2, 3));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Result<Recording> read = read_recording(memory_source(bytes.substr(0, size)));
    ASSERT_FALSE(read) << "cut at " << size;
    ASSERT_NE(read.error().message.find("byte"), std::string::npos) << read.error().message;
  }
  EXPECT_ERROR(read_recording(memory_source(bytes.substr(0, bytes.size() - 1))), "23 messages are readable");
  EXPECT_ERROR(read_recording(memory_source("garbage!")), "does not start as an MCAP file");
}

TEST(Mcap, DamagedBytesNeverCrash) {
  const std::string bytes = bytes_of(make_recording(2, 3));
  Rng rng(9);
  for (int i = 0; i < 1000; ++i) {
    std::string damaged = bytes;
    for (int k = 0; k < 2; ++k) damaged[rng.below(damaged.size())] = static_cast<char>(rng.below(256));
    const Result<Recording> read = read_recording(memory_source(std::move(damaged)));
    if (!read) continue;
    for (std::size_t s = 0; s < read->num_scans(); ++s) static_cast<void>(read->read_scan(s));
  }
}

TEST(Mcap, ADamagedScanIsFoundByItsChecksum) {
  std::string bytes = bytes_of(make_recording(3));
  const auto reader = mcap::Reader::open(memory_source(bytes));
  ASSERT_TRUE(reader) << reader.error().message;
  // The middle of the last scan's chunk.
  const mcap::ChunkIndex& chunk =
      *std::ranges::max_element(reader->contents().chunks, {}, &mcap::ChunkIndex::compressed_size);
  bytes[chunk.chunk_start + chunk.chunk_length - 20] =
      static_cast<char>(~bytes[chunk.chunk_start + chunk.chunk_length - 20]);
  const Result<Recording> back = read_recording(memory_source(bytes));
  int num_damaged = 0;
  for (std::size_t i = 0; back && i < 3; ++i) num_damaged += back->read_scan(i) ? 0 : 1;
  EXPECT_TRUE(!back || num_damaged == 1);
}

/// The records in front of the summary, put together by hand: no chunks, no index.
std::string plain_file(const std::vector<std::string>& records) {
  std::string bytes(mcap::kMagic);
  bytes += mcap::framed(mcap::Opcode::header, mcap::encode(mcap::Header{"ros2", "hand"}));
  for (const std::string& record : records) bytes += record;
  bytes += mcap::framed(mcap::Opcode::data_end, std::string(4, '\0'));
  bytes += mcap::framed(mcap::Opcode::footer, mcap::encode(mcap::Footer{}));
  return bytes + std::string(mcap::kMagic);
}

std::vector<std::string> foreign_records(std::initializer_list<std::string> topics) {
  std::vector<std::string> records = {mcap::framed(
      mcap::Opcode::schema, mcap::encode(mcap::Schema{4, "sensor_msgs/msg/PointCloud2", "ros2msg", "..."}))};
  std::uint16_t id = 0;
  for (const std::string& topic : topics) {
    records.push_back(
        mcap::framed(mcap::Opcode::channel, mcap::encode(mcap::Channel{++id, 4, topic, "cdr", {}})));
    for (std::size_t i = 0; i < 3; ++i) {
      // Recorded 5 ms after the scan's own stamp.
      const Scan scan = make_scan(i, 4);
      records.push_back(mcap::framed(mcap::Opcode::message,
                                     mcap::encode(mcap::Message{id, 0, scan.stamp + Duration(5'000'000),
                                                                scan.stamp, ros::encode_cloud(scan, "os")})));
    }
  }
  return records;
}

TEST(Mcap, ForeignFilesWithoutChunksOrIndex) {
  const Result<Recording> recording =
      read_recording(memory_source(plain_file(foreign_records({"/ouster/points"}))));
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->name, "ouster");
  EXPECT_EQ(recording->num_scans(), 3U);
  EXPECT_EQ(recording->scan_stamps[1], make_scan(1, 0).stamp);  // the sensor's stamp, not the recorder's
  EXPECT_TRUE(recording->read_scan(2));
}

TEST(Mcap, FilesThatAreNoRecording) {
  EXPECT_ERROR(read_recording(memory_source(plain_file({}))), "no topic of sensor_msgs/msg/PointCloud2");
  EXPECT_ERROR(read_recording(memory_source(plain_file(foreign_records({"/a", "/b"})))),
               "several topics of PointCloud2: /a, /b");
  std::vector<std::string> undefined = foreign_records({"/a"});
  undefined.erase(undefined.begin() + 1);
  EXPECT_ERROR(read_recording(memory_source(plain_file(undefined))), "channel 1, which is not defined");
}

TEST(Mcap, RealRosbag2File) {
  ADIT_NEED_DATA("recordings/mcap_small/wbag_0.mcap");
  const Result<ByteSource> source = open_source(test::shared_data("recordings/mcap_small/wbag_0.mcap"));
  ASSERT_TRUE(source) << source.error().message;
  const Result<mcap::Reader> reader = mcap::Reader::open(*source);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(reader->contents().header.profile, "ros2");
  EXPECT_FALSE(reader->contents().channels.empty());
  EXPECT_FALSE(reader->contents().messages.empty());
  for (const mcap::MessageRef& ref : reader->contents().messages) EXPECT_TRUE(reader->read(ref));
}

}  // namespace
}  // namespace adit
