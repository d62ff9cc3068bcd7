// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/bag_recording.hpp"
#include "adit/io/bag_topics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <thread>

#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "adit/io/mcap_reader.hpp"
#include "adit/io/mcap_writer.hpp"
#include "adit/io/ros_messages.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

using test::ForeignFile;
using test::make_scan;
using test::plain_file;

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
    recording.imu.push_back({stamp + Duration(3), Vector3(0.1 * i, -0.2, 0.3), Vector3(0.5, i, 9.8)});
  }
  recording.T_base_imu = Pose::planar(-0.1, 0.05, 1.5, 0.4);
  recording.imu_name = "icm-20948";
  recording.imu_covariance.angular_velocity = Vector3(1e-4, 2e-4, 3e-4).asDiagonal();
  recording.imu_covariance.specific_force = Vector3(1e-2, 2e-2, 3e-2).asDiagonal();
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

void expect_same_imu(const Recording& a, const Recording& b) {
  ASSERT_EQ(a.imu.size(), b.imu.size());
  for (std::size_t i = 0; i < a.imu.size(); ++i) {
    EXPECT_EQ(a.imu[i].stamp, b.imu[i].stamp);
    EXPECT_EQ(a.imu[i].angular_velocity, b.imu[i].angular_velocity);
    EXPECT_EQ(a.imu[i].specific_force, b.imu[i].specific_force);
  }
  EXPECT_LT((a.T_base_imu.inverse() * b.T_base_imu).log().norm(), 1e-12);
  EXPECT_EQ(a.imu_name, b.imu_name);
  EXPECT_EQ(a.imu_covariance.angular_velocity, b.imu_covariance.angular_velocity);
  EXPECT_EQ(a.imu_covariance.specific_force, b.imu_covariance.specific_force);
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
  expect_same_imu(*back, recording);
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

TEST(Mcap, WithoutWheelsTruthImuIntensityOrTimes) {
  Recording recording = make_recording(3);
  recording.imu.clear();
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
  EXPECT_TRUE(back->imu.empty());
  EXPECT_EQ(back->imu_mount_source, "");
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

TEST(Mcap, OfEveryTruncationWhatIsWholeIsReadOrAnErrorSaysWhere) {
  const std::string bytes = bytes_of(make_recording(2, 3));
  std::size_t num_read = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Result<Bag> bag = open_mcap_bag(memory_source(bytes.substr(0, size)));
    if (!bag) {
      ASSERT_NE(bag.error().message.find("byte"), std::string::npos) << bag.error().message;
      continue;
    }
    ASSERT_GE(bag->messages.size(), num_read) << "cut at " << size;
    num_read = bag->messages.size();
    ASSERT_EQ(bag->warnings.size(), 1U);
    EXPECT_NE(bag->warnings[0].find("byte"), std::string::npos) << bag->warnings[0];
    EXPECT_NE(bag->warnings[0].find(format("{} messages", num_read)), std::string::npos) << bag->warnings[0];
    for (const BagMessage& message : bag->messages) ASSERT_TRUE(bag->read(message)) << "cut at " << size;
  }
  EXPECT_EQ(num_read, 33U);
  const Result<Recording> cut = read_recording(memory_source(bytes.substr(0, bytes.size() - 1)));
  ASSERT_TRUE(cut) << cut.error().message;
  EXPECT_EQ(cut->num_scans(), 2U);
  EXPECT_EQ(cut->warnings.size(), 1U);
  EXPECT_ERROR(read_recording(memory_source("garbage!")), "byte 0: not an MCAP file, or truncated");
}

TEST(Mcap, DamagedBytesAreAnErrorOrHarmless) {
  const std::string bytes = bytes_of(make_recording(2, 3));
  const Recording original = make_recording(2, 3);
  int num_refused = 0;
  int num_read = 0;
  Rng rng(9);
  for (int i = 0; i < 1000; ++i) {
    std::string damaged = bytes;
    for (int k = 0; k < 2; ++k) damaged[rng.below(damaged.size())] = static_cast<char>(rng.below(256));
    const Result<Recording> read = read_recording(memory_source(std::move(damaged)));
    num_refused += read ? 0 : 1;
    for (std::size_t s = 0; read && s < read->num_scans(); ++s) {
      const Result<Scan> scan = read->read_scan(s);
      num_refused += scan ? 0 : 1;
      if (!scan) continue;
      // A scan that is handed on is the one that was recorded at that time: checksums cover it.
      ++num_read;
      const auto same = std::ranges::find(original.scan_stamps, scan->stamp);
      ASSERT_NE(same, original.scan_stamps.end()) << i;
      const auto index = static_cast<std::size_t>(same - original.scan_stamps.begin());
      EXPECT_EQ(scan->cloud.points, make_scan(index, 3).cloud.points) << i;
    }
  }
  EXPECT_GT(num_refused, 200);  // damage of the summary alone costs nothing
  EXPECT_GT(num_read, 100);
}

TEST(Mcap, ADamagedScanIsFoundByItsChecksum) {
  std::string bytes = bytes_of(make_recording(3));
  const auto reader = mcap::Reader::open(memory_source(bytes));
  ASSERT_TRUE(reader) << reader.error().message;
  // Near the end of the last scan's chunk; the first scan, which also opens the recording, stays whole.
  const mcap::Contents& contents = reader->contents();
  const auto is_scan = [&](const mcap::MessageRef& ref) {
    return contents.channels.at(ref.channel_id).topic == "/robot_0/points";
  };
  const auto last = std::find_if(contents.messages.rbegin(), contents.messages.rend(), is_scan);
  const mcap::ChunkIndex& chunk = contents.chunks.at(last->chunk.value());
  char& byte = bytes[chunk.chunk_start + chunk.chunk_length - 20];
  byte = static_cast<char>(~byte);
  const Result<Recording> back = read_recording(memory_source(bytes));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_TRUE(back->read_scan(0));
  EXPECT_TRUE(back->read_scan(1));
  const Result<Scan> damaged = back->read_scan(2);
  ASSERT_FALSE(damaged);
  EXPECT_TRUE(damaged.error().message.starts_with("scan 2: chunk at byte ")) << damaged.error().message;
}

TEST(Mcap, ForeignFilesWithoutChunksOrIndex) {
  const Result<Recording> recording = ForeignFile()
                                          .clouds("/ouster/points")
                                          .links({test::link("base_link", "os_lidar", test::T_base_ouster)})
                                          .read();
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->name, "ouster");
  EXPECT_EQ(recording->num_scans(), 3U);
  EXPECT_EQ(recording->scan_stamps[1], make_scan(1, 0).stamp);  // the sensor's stamp, not the recorder's
  EXPECT_TRUE(recording->read_scan(2));
}

TEST(Mcap, TheMountFollowsTheWholeTreeOfStaticTransforms) {
  // Two publishers, one of them with leading slashes; a frame above the body.
  const Result<Recording> recording =
      ForeignFile()
          .clouds("/os/points", "/os_lidar")
          .odometry("/wheels/odom", "base_link")
          .links({test::link("os_sensor", "os_lidar", test::T_ouster_lidar)})
          .links({test::link("/base_footprint", "/base_link", Pose::planar(0, 0, 0, 0.3)),
                  test::link("/base_link", "/os_sensor", test::T_base_ouster)})
          .read();
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_LT((recording->T_base_lidar.inverse() * test::T_base_ouster * test::T_ouster_lidar).log().norm(),
            1e-12);
  EXPECT_EQ(recording->mount_source, "/tf_static: base_link -> os_sensor -> os_lidar");
  EXPECT_TRUE(recording->assumptions.empty());
}

TEST(Mcap, LinksAreFollowedAgainstTheirDirectionToo) {
  const Result<Recording> recording =
      ForeignFile()
          .clouds("/os/points")
          .odometry("/odom", "base_link")
          .links({test::link("os_lidar", "base_link", test::T_base_ouster.inverse())})
          .read();
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_LT((recording->T_base_lidar.inverse() * test::T_base_ouster).log().norm(), 1e-12);
}

TEST(Mcap, AnUnknownMountIsAnErrorWithARemedy) {
  const ForeignFile bare = ForeignFile().clouds("/os/points");
  EXPECT_ERROR(bare.read(), "no /tf_static links its frame 'os_lidar'; give --mount X,Y,Z[,ROLL,PITCH,YAW]");
  const Result<Recording> given = bare.read({.mount = "0.1 0 0.5"});
  ASSERT_TRUE(given) << given.error().message;
  EXPECT_EQ(given->T_base_lidar.translation(), Vector3(0.1, 0, 0.5));
  EXPECT_EQ(given->mount_source, "given by the user");
  EXPECT_ERROR(
      ForeignFile()
          .clouds("/os/points")
          .odometry("/odom", "base_link")
          .links({test::link("base", "camera", Pose())})
          .read(),
      "no links connect 'base_link' and 'os_lidar' (frames that it links: base, camera); give --mount");
  EXPECT_ERROR(bare.read({.mount = "1 2"}), "2 numbers");
}

TEST(Mcap, OdometryOfTheLidarsOwnFrameNeedsNoMount) {
  const Result<Recording> recording =
      ForeignFile().clouds("/os/points").odometry("/odom", "/os_lidar").read();
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->T_base_lidar.log().norm(), 0.0);
  EXPECT_EQ(recording->mount_source, "the wheel odometry is of the LiDAR's own frame os_lidar");
}

TEST(Mcap, GroundTruthIsNamedByAWholeWord) {
  const auto tracks = [](const std::string& topic) {
    const Result<Recording> read =
        ForeignFile().clouds("/p", "base_link").odometry(topic).read({.mount = "0 0 1"});
    EXPECT_TRUE(read) << read.error().message;
    return std::pair(read->wheel.size(), read->truth.size());
  };
  for (const char* topic : {"/length/odom", "/yogt", "/truthful_odom", "/strength"})
    EXPECT_EQ(tracks(topic), std::pair(std::size_t{3}, std::size_t{0})) << topic;
  for (const char* topic : {"/gt", "/robot_0/ground_truth", "/Odom-GT", "/groundtruth/odom"})
    EXPECT_EQ(tracks(topic), std::pair(std::size_t{0}, std::size_t{3})) << topic;
}

TEST(Mcap, OneOfSeveralTopicsOfCloudsCanBeChosen) {
  const ForeignFile file = ForeignFile().clouds("/front").clouds("/rear").links(
      {test::link("base", "os_lidar", test::T_base_ouster)});
  EXPECT_ERROR(file.read(),
               "several topics of clouds; give one of them, the likeliest first: --points /front (3 "
               "messages) or --points /rear (3 messages)");
  EXPECT_ERROR(file.read({.points = "/left"}), "no topic of clouds '/left'; there are: /front, /rear");
  const Result<Recording> rear = file.read({.points = "/rear"});
  ASSERT_TRUE(rear) << rear.error().message;
  EXPECT_EQ(rear->num_scans(), 3U);
  EXPECT_EQ(rear->name, "rear");
}

TEST(Mcap, AScanThatWasSentTwiceCountsOnce) {
  const auto cloud = [](std::size_t i) {
    const Scan scan = test::make_scan(i, 4);
    return std::pair(scan.stamp, ros::encode_cloud(scan, "os_lidar"));
  };
  const auto read = [](const std::vector<std::pair<Stamp, std::string>>& clouds) {
    return ForeignFile()
        .cloud_messages("/points", clouds, Duration(5'000'000))
        .links({test::link("base", "os_lidar", test::T_base_ouster)})
        .read();
  };
  const Result<Recording> recording = read({cloud(0), cloud(1), cloud(1), cloud(2)});
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->num_scans(), 3U);
  EXPECT_EQ(recording->read_scan(2)->cloud.points, test::make_scan(2, 4).cloud.points);
  ASSERT_EQ(recording->warnings.size(), 1U);
  EXPECT_TRUE(recording->warnings.front().starts_with("/points: 1 of 4 scans are left out"))
      << recording->warnings.front();
  EXPECT_ERROR(read({cloud(1), cloud(1), cloud(1)}), "/points: 2 of 3 scans are left out");
}

TEST(Mcap, OfASplitBagAWarningNamesTheFile) {
  const test::TemporaryFolder folder;
  const std::string bytes = bytes_of(make_recording(2, 3));
  test::put_file(folder / "a_0.mcap", bytes);
  test::put_file(folder / "a_1.mcap", bytes.substr(0, bytes.size() - 1));
  const Result<Bag> bag = open_bag(folder.path());
  ASSERT_TRUE(bag) << bag.error().message;
  ASSERT_EQ(bag->warnings.size(), 1U);
  EXPECT_TRUE(bag->warnings.front().starts_with("a_1.mcap: ")) << bag->warnings.front();
}

TEST(Mcap, RobotsOfOneBagAreTakenByTheirNamespaces) {
  ForeignFile file;
  file.clouds("/fleet/husky2/points", "husky2/lidar")
      .clouds("/fleet/husky1/front/points", "husky1/lidar")
      .odometry("/fleet/husky1/odom", "husky1/base_link")
      .odometry("/fleet/husky2/odom", "husky2/base_link")
      .links({test::link("husky1/base_link", "husky1/lidar", test::T_base_ouster),
              test::link("husky2/base_link", "husky2/lidar", test::T_ouster_lidar)});
  EXPECT_EQ(namespaces_of(open_mcap_bag(memory_source(file.bytes())).value()),
            std::vector<std::string>({"/fleet/husky1", "/fleet/husky2"}));
  EXPECT_ERROR(file.read(),
               "if each namespace is another robot, adit slam --namespaces takes them all, and --set "
               "recording.topics_under=/fleet/husky2 that one");
  for (const auto& [robot, mount] :
       {std::pair("husky1", test::T_base_ouster), {"husky2", test::T_ouster_lidar}}) {
    const Result<Recording> recording = file.read({.topics_under = std::string("/fleet/") + robot});
    ASSERT_TRUE(recording) << recording.error().message;
    EXPECT_EQ(recording->name, robot);
    EXPECT_EQ(recording->wheel.size(), 3U);
    EXPECT_EQ(recording->T_base_lidar.translation(), mount.translation());
  }
  EXPECT_ERROR(file.read({.topics_under = "/fleet/husky"}), "under /fleet/husky; there are no scans");
  EXPECT_TRUE(
      namespaces_of(open_mcap_bag(memory_source(ForeignFile().clouds("/points").bytes())).value()).empty());
}

// As of `adit convert SESSION session.mcap`.
TEST(Mcap, WhereRobotsHaveSeveralCloudsTheHintNamesThoseToTakeToo) {
  ForeignFile file;
  for (const std::string robot : {"/a", "/b"}) file.clouds(robot + "/points").clouds(robot + "/map");
  file.clouds("/b/points");
  EXPECT_ERROR(file.read(), "adit slam --namespaces --points points takes them all");
  EXPECT_ERROR(file.read({.topics_under = "/a"}), "several topics of clouds");
  EXPECT_ERROR(file.read({.points = "points", .topics_under = "/a"}),
               "give --mount");  // the hint is followed
}

TEST(Mcap, TheLikeliestTopicIsNamedFirst) {
  EXPECT_ERROR(
      ForeignFile().clouds("/camera/depth/points").clouds("/os_cloud").clouds("/velodyne_points").read(),
      "--points /velodyne_points (3 messages) or --points /os_cloud (3 messages) or --points "
      "/camera/depth/points (3 messages)");
}

TEST(Mcap, GroundTruthCanBeChosenOrLeftOut) {
  ForeignFile file;
  file.clouds("/points")
      .odometry("/wheel/odom")
      .odometry("/total_station")
      .odometry("/gt")
      .links({test::link("base_link", "os_lidar", test::T_base_ouster)});
  const Result<Recording> chosen = file.read({.wheel = "/wheel/odom", .truth = "/total_station"});
  ASSERT_TRUE(chosen) << chosen.error().message;
  EXPECT_EQ(chosen->truth.size(), 3U);
  EXPECT_ERROR(file.read({.truth = "/gt"}), "several topics of wheel odometry");
  const Result<Recording> only = file.read({.truth = "/total_station"});
  ASSERT_TRUE(only) << "what is ground truth is no choice for the wheels: " << only.error().message;
  EXPECT_TRUE(file.read({.wheel = "/wheel/odom", .truth = "none"})->truth.empty());
  EXPECT_ERROR(file.read({.wheel = "/wheel/odom", .truth = "/left"}),
               "no topic of ground truth '/left'; there are: /gt");
}

TEST(Mcap, WhatWasAssumedIsKept) {
  Recording recording = make_recording(2);
  recording.assumptions = {"mount: nobody knows", "stamps: counted"};
  const ByteSource bytes = memory_source(bytes_of(recording));
  EXPECT_EQ(read_recording(bytes)->assumptions, recording.assumptions);
  EXPECT_EQ(read_recording(bytes, {.mount = "0 0 1"})->assumptions,
            std::vector<std::string>{"stamps: counted"});
}

TEST(Mcap, FilesThatAreNotARecording) {
  EXPECT_ERROR(ForeignFile().read(), "no topic of sensor_msgs/msg/PointCloud2");
  EXPECT_ERROR(read_recording(memory_source(plain_file(
                   {mcap::framed(mcap::Opcode::message, mcap::encode(mcap::Message{1, 0, {5}, {5}, "x"}))}))),
               "channel 1, which is not defined");
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
