// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/ros1_bag.hpp"

#include <gtest/gtest.h>

#include <set>

#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "adit/io/bag_recording.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/ros_messages.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"
#include "support/ros1_records.hpp"

namespace adit {
namespace {

using test::ros1::bag_header;
using test::ros1::chunk_info_record;
using test::ros1::chunk_record;
using test::ros1::connection_record;
using test::ros1::index_record;
using test::ros1::message_record;
using test::ros1::Ros1Writer;

std::string cloud(const Scan& scan) {
  Ros1Writer w;
  w.header(scan.stamp, "os_lidar").number(std::uint32_t{1});
  w.number(static_cast<std::uint32_t>(scan.cloud.size())).number(std::uint32_t{3});
  for (std::uint32_t i = 0; i < 3; ++i)
    w.text(std::string(1, "xyz"[i])).number(4 * i).number(std::uint8_t{7}).number(std::uint32_t{1});
  w.number(std::uint8_t{0})
      .number(std::uint32_t{12})
      .number(static_cast<std::uint32_t>(12 * scan.cloud.size()));
  std::string points;
  for (const Eigen::Vector3f& point : scan.cloud.points)
    for (const float value : point) append_little_endian(points, value);
  return w.text(points).number(std::uint8_t{1}).bytes();
}

std::string odometry(Stamp stamp, const Pose& pose) {
  Ros1Writer w;
  w.header(stamp, "odom").text("base_link").pose(pose);
  for (int i = 0; i < 36 + 6 + 36; ++i) w.number(0.0);
  return w.bytes();
}

std::string transform(const std::string& frame, const std::string& child, const Pose& pose) {
  return Ros1Writer().number(std::uint32_t{1}).header({5}, frame).text(child).pose(pose).bytes();
}

/// A bag as a recorder leaves it that was killed: one plain chunk, no index.
std::string recording_bytes() {
  std::string chunk;
  chunk += connection_record(0, "/robot_0/points", "sensor_msgs/PointCloud2");
  chunk += connection_record(1, "/robot_0/odom", "nav_msgs/Odometry");
  chunk += connection_record(2, "/tf_static", "tf2_msgs/TFMessage");
  chunk += message_record({2, {7}, transform("base_link", "os_lidar", test::T_base_ouster)});
  for (std::size_t i = 0; i < 3; ++i) {
    const Scan scan = test::make_scan(i, 5);
    chunk += message_record({0, scan.stamp + Duration(3'000'000), cloud(scan)});
    chunk += message_record(
        {1, scan.stamp, odometry(scan.stamp, Pose::planar(0.5 * static_cast<double>(i), 0, 0))});
  }
  std::string bytes = "#ROSBAG V2.0\n";
  return bytes + bag_header(0, 0, 0) + chunk_record(chunk);
}

/// Two chunks, each with three messages of one connection, behind each its index, and the lists at the end.
struct IndexedBag {
  std::string bytes;
  std::size_t index_at = 0;
};

IndexedBag indexed_bag(std::uint32_t times_each_chunk_is_named = 1) {
  const std::string magic = "#ROSBAG V2.0\n";
  const std::size_t first = magic.size() + bag_header(0, 0, 0).size();
  std::string body;
  std::string connections;
  std::string chunks;
  for (std::uint32_t c = 0; c < 2; ++c) {
    const std::string connection = connection_record(c, format("/odom_{}", c), "nav_msgs/Odometry");
    std::string records = connection;
    std::string entries;
    for (std::uint32_t m = 0; m < 3; ++m) {
      append_little_endian(entries, std::uint64_t{10 * c + m});  // in seconds
      append_little_endian(entries, static_cast<std::uint32_t>(records.size()));
      records += message_record({c, {(10 * c + m) * 1'000'000'000LL}, format("message {} {}", c, m)});
    }
    for (std::uint32_t i = 0; i < times_each_chunk_is_named; ++i)
      chunks += chunk_info_record(first + body.size(), c, 3);
    connections += connection;
    body += chunk_record(records);
    body += index_record(c, 3, entries);
  }
  const std::size_t index_at = first + body.size();
  return {magic + bag_header(index_at, 2, 2 * times_each_chunk_is_named) + body + connections + chunks,
          index_at};
}

void expect_six_messages(const Result<Bag>& bag) {
  ASSERT_TRUE(bag) << bag.error().message;
  ASSERT_EQ(bag->messages.size(), 6U);
  for (std::size_t m = 0; m < 6; ++m) {
    EXPECT_EQ(bag->topics.at(bag->messages[m].topic).name, format("/odom_{}", m / 3));
    EXPECT_EQ(bag->read(bag->messages[m]).value(), format("message {} {}", m / 3, m % 3));
  }
}

TEST(Ros1Bag, IsARecordingLikeAnyOther) {
  const Result<Bag> bag = open_ros1_bag(memory_source(recording_bytes()));
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_EQ(bag->messages.size(), 7U);
  EXPECT_TRUE(bag->warnings.empty());
  const Result<Recording> recording = read_recording(*bag);
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->name, "robot_0");
  ASSERT_EQ(recording->num_scans(), 3U);
  EXPECT_EQ(recording->scan_stamps[2], test::make_scan(2, 5).stamp);
  EXPECT_EQ(recording->read_scan(1)->cloud.points, test::make_scan(1, 5).cloud.points);
  ASSERT_EQ(recording->wheel.size(), 3U);
  EXPECT_EQ(recording->wheel[2].T_world_body.translation().x(), 1.0);
  EXPECT_LT((recording->T_base_lidar.inverse() * test::T_base_ouster).log().norm(), 1e-9);
}

TEST(Ros1Bag, EveryTruncationIsReadSoFarOrAnError) {
  const std::string bytes = recording_bytes();
  const Bag whole = open_ros1_bag(memory_source(bytes)).value();
  std::size_t num_read = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Result<Bag> bag = open_ros1_bag(memory_source(bytes.substr(0, size)));
    if (!bag) {
      ASSERT_EQ(num_read, 0U) << "fewer messages than of a shorter file, cut at " << size;
      EXPECT_NE(bag.error().message.find("byte"), std::string::npos) << bag.error().message;
      continue;
    }
    ASSERT_GE(bag->messages.size(), num_read) << "cut at " << size;
    num_read = bag->messages.size();
    ASSERT_EQ(bag->warnings.size(), 1U) << "cut at " << size;
    EXPECT_TRUE(bag->warnings[0].starts_with("the file breaks off: ")) << bag->warnings[0];
    for (const BagMessage& message : bag->messages) ASSERT_TRUE(bag->read(message)) << "cut at " << size;
  }
  EXPECT_EQ(num_read, whole.messages.size() - 1) << "the last message reaches to the end";
}

TEST(Ros1Bag, WithoutAWholeMessageTheErrorSaysWhatToDo) {
  const std::string bytes = recording_bytes();
  EXPECT_ERROR(open_ros1_bag(memory_source(bytes.substr(0, 300))), "copy it again");
  EXPECT_ERROR(
      open_ros1_bag(memory_source(bytes.substr(0, 100))),
      "the file breaks off in its header: byte 13: a record reaches past the end of the file; copy it again");
}

TEST(Ros1Bag, ACutInTheListsAtItsEndCostsNoMessage) {
  const IndexedBag whole = indexed_bag();
  const Result<Bag> indexed = open_ros1_bag(memory_source(whole.bytes));
  expect_six_messages(indexed);
  EXPECT_TRUE(indexed->warnings.empty());
  for (std::size_t size = whole.index_at; size < whole.bytes.size(); ++size) {
    const Result<Bag> cut = open_ros1_bag(memory_source(whole.bytes.substr(0, size)));
    ASSERT_NO_FATAL_FAILURE(expect_six_messages(cut)) << "cut at " << size;
    ASSERT_EQ(cut->warnings.size(), 1U) << "cut at " << size;
    EXPECT_NE(cut->warnings[0].find("6 messages"), std::string::npos) << cut->warnings[0];
  }
}

TEST(Ros1Bag, AnIndexThatNamesAChunkTwiceIsNotTrusted) {
  for (const std::uint32_t times : {2U, 1000U}) {
    const Result<Bag> bag = open_ros1_bag(memory_source(indexed_bag(times).bytes));
    expect_six_messages(bag);
    ASSERT_EQ(bag->warnings.size(), 1U);
    EXPECT_NE(bag->warnings[0].find("the index names a chunk twice"), std::string::npos) << bag->warnings[0];
  }
}

TEST(Ros1Bag, MayHaveAnyNumberOfConnections) {
  constexpr std::uint32_t kNum = 20'000;
  std::string chunk;
  for (std::uint32_t c = 0; c < kNum; ++c)
    chunk += connection_record(c, format("/odom_{}", c % (kNum / 2)), "nav_msgs/Odometry");
  for (const std::uint32_t c : {kNum - 1, kNum / 2 - 1, 7U}) chunk += message_record({c, {5}, "x"});
  const Result<Bag> bag =
      open_ros1_bag(memory_source("#ROSBAG V2.0\n" + bag_header(0, 0, 0) + chunk_record(chunk)));
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_EQ(bag->topics.size(), kNum / 2) << "several connections have one topic";
  ASSERT_EQ(bag->messages.size(), 3U);
  EXPECT_EQ(bag->messages[0].topic, bag->messages[1].topic);
  EXPECT_EQ(bag->topics[bag->messages[0].topic].name, format("/odom_{}", kNum / 2 - 1));
  EXPECT_EQ(bag->topics[bag->messages[2].topic].name, "/odom_7");
}

TEST(Ros1Bag, DamagedBytesAreAnErrorOrHarmless) {
  const std::string bytes = recording_bytes();
  Rng rng(3);
  int num_read = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string damaged = bytes;
    for (int k = 0; k < 2; ++k) damaged[rng.below(damaged.size())] = static_cast<char>(rng.below(256));
    const Result<Bag> bag = open_ros1_bag(memory_source(std::move(damaged)));
    if (!bag) continue;
    const Result<Recording> recording = read_recording(*bag);
    for (std::size_t s = 0; recording && s < recording->num_scans(); ++s) (void)recording->read_scan(s);
    ++num_read;
  }
  EXPECT_GT(num_read, 100);
}

std::string example(const std::string& name) { return test::shared_data("recordings/" + name).string(); }

TEST(Ros1Bag, HoldsTheSameHoweverItsChunksAreCompressed) {
  ADIT_NEED_DATA("recordings/example.bag");
  const Result<Bag> plain = open_bag(example("example.bag"));
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(plain->messages.size(), 8647U);
  for (const char* name : {"example-bz2.bag", "example-lz4.bag"}) {
    const Result<Bag> packed = open_bag(example(name));
    ASSERT_TRUE(packed) << packed.error().message;
    ASSERT_EQ(packed->messages.size(), plain->messages.size());
    for (std::size_t m = 0; m < plain->messages.size(); ++m) {
      const BagMessage& one = plain->messages[m];
      const BagMessage& other = packed->messages[m];
      ASSERT_EQ(other.log_time, one.log_time);
      ASSERT_EQ(packed->topics[other.topic].name, plain->topics[one.topic].name);
      ASSERT_EQ(packed->read(other).value(), plain->read(one).value());
    }
  }
}

TEST(Ros1Bag, WhatIsWholeOfATornFileIsReadWithAWarning) {
  ADIT_NEED_DATA("recordings/example-lz4.bag");
  const std::string whole = test::get_file(example("example-lz4.bag"));
  std::set<std::size_t> numbers;
  for (std::size_t size = whole.size() / 4; size < whole.size(); size += whole.size() / 16) {
    const Result<Bag> torn = open_ros1_bag(memory_source(whole.substr(0, size)));
    if (!torn) continue;
    ASSERT_EQ(torn->warnings.size(), 1U) << "cut at " << size;
    EXPECT_NE(torn->warnings[0].find(format("{} messages", torn->messages.size())), std::string::npos);
    EXPECT_TRUE(torn->read(torn->messages.back()));
    numbers.insert(torn->messages.size());
  }
  EXPECT_GE(numbers.size(), 8U) << "seven cuts are in its only chunk";
  EXPECT_LE(*numbers.rbegin(), 8647U);
}

TEST(Ros1Bag, ReadsWheelsAndImuOfARealRobot) {
  ADIT_NEED_DATA("recordings/ros1_odometry_bz2.bag");
  const Result<Bag> bag = open_bag(example("ros1_odometry_bz2.bag"));
  ASSERT_TRUE(bag) << bag.error().message;
  std::size_t num_odometry = 0;
  std::size_t num_imu = 0;
  Stamp last{0};
  double sum = 0.0;
  for (const BagMessage& message : bag->messages) {
    const std::string& type = bag->topics[message.topic].type;
    if (type == ros::kOdometry) {
      const Result<ros::OdometryMessage> pose = decoded(*bag, message, ros::decode_odometry);
      ASSERT_TRUE(pose) << pose.error().message;
      EXPECT_GT(pose->pose.stamp, last);
      EXPECT_NEAR(to_seconds(pose->pose.stamp - message.log_time), 0.0, 0.5);
      last = pose->pose.stamp;
      ++num_odometry;
    }
    if (type == ros::kImu) {
      const Result<ros::ImuMessage> imu = decoded(*bag, message, ros::decode_imu);
      ASSERT_TRUE(imu) << imu.error().message;
      sum += imu->sample.specific_force.norm();
      ++num_imu;
    }
  }
  EXPECT_EQ(num_odometry, 3952U);
  ASSERT_EQ(num_imu, 11865U);
  EXPECT_NEAR(sum / static_cast<double>(num_imu), 9.8, 0.5) << "gravity, in the mean";
}

}  // namespace
}  // namespace adit
