// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/bag.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "adit/core/format.hpp"
#include "adit/io/bag_topics.hpp"
#include "adit/io/file_info.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/text.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"
#include "support/sqlite_bag.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

using test::a_bag;
using test::expect_same;
using test::write_db3;

std::string metadata_naming(const std::vector<std::string>& files) {
  std::string yaml = "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n";
  for (const std::string& file : files) yaml += "    - " + file + "\n";
  return yaml;
}

TEST(Bag, AFolderIsOneRecordingHoweverItWasSplit) {
  const test::TemporaryFolder folder;
  const Bag bag = a_bag();
  for (std::size_t at = 0; at <= bag.messages.size(); ++at) {
    const auto middle = bag.messages.begin() + static_cast<std::ptrdiff_t>(at);
    const fs::path split = folder / format("split_{}", at);
    fs::create_directory(split);
    write_db3(split / "a_0.db3", bag, {bag.messages.begin(), middle});
    write_db3(split / "b_1.db3", bag, {middle, bag.messages.end()});
    ASSERT_TRUE(is_bag_folder(split));
    expect_same(open_bag(split), bag);
    fs::rename(split / "a_0.db3", split / "c_0.db3");  // from here on the order is that of metadata.yaml
    test::put_file(split / "metadata.yaml", metadata_naming({"early/c_0.db3", "b_1.db3"}));
    ASSERT_TRUE(is_bag_folder(split));
    expect_same(open_bag(split), bag);
    EXPECT_EQ(open_recording(split.string())->num_scans(), 3U);
  }
}

TEST(Bag, AFileThatCannotBeReadCostsItselfAlone) {
  const Bag bag = a_bag();
  for (const char* content : {"", "SQLite format 3 ..."}) {
    const test::TemporaryFolder folder;
    write_db3(folder / "a_0.db3", bag, bag.messages);
    test::put_file(folder / "a_1.db3", content);
    const Result<Bag> whole = open_bag(folder.path());
    ASSERT_TRUE(whole) << whole.error().message;
    EXPECT_EQ(whole->messages.size(), bag.messages.size());
    ASSERT_EQ(whole->warnings.size(), 1U);
    EXPECT_NE(whole->warnings.front().find("a_1.db3"), std::string::npos) << whole->warnings.front();
    EXPECT_NE(whole->warnings.front().find("this one of 2 files is left out"), std::string::npos);
    EXPECT_TRUE(open_recording(folder.path().string()));
    fs::remove(folder / "a_0.db3");
    EXPECT_FALSE(open_bag(folder.path())) << "nothing is left";
  }
}

TEST(Bag, FilesThatLieTogetherByChanceAreToldOf) {
  const Bag bag = a_bag();
  const auto warnings_at = [&](Duration later, bool has_metadata) {
    const test::TemporaryFolder folder;
    std::vector<BagMessage> messages = bag.messages;
    write_db3(folder / "monday.db3", bag, messages);
    for (BagMessage& message : messages) message.log_time = message.log_time + later;
    write_db3(folder / "tuesday.db3", bag, messages);
    if (has_metadata)
      test::put_file(folder / "metadata.yaml", metadata_naming({"monday.db3", "tuesday.db3"}));
    return open_bag(folder.path()).value().warnings;
  };
  const std::vector<std::string> apart = warnings_at(std::chrono::hours(14), false);
  ASSERT_EQ(apart.size(), 1U);
  EXPECT_NE(apart[0].find("between them are 14.0 h"), std::string::npos) << apart[0];
  EXPECT_NE(apart[0].find("adit slam a="), std::string::npos) << apart[0];
  EXPECT_TRUE(warnings_at(std::chrono::hours(14), true).empty()) << "the recorder says that they are one";
  EXPECT_TRUE(warnings_at(std::chrono::seconds(1), false).empty()) << "as of a split bag of ROS 1";
}

TEST(Bag, WhatAFolderLacksIsNamed) {
  const test::TemporaryFolder folder;
  const fs::path metadata = folder / "metadata.yaml";
  test::put_file(metadata, metadata_naming({"a_0.db3"}));
  EXPECT_ERROR(
      open_bag(folder.path()),
      "metadata.yaml: names 'a_0.db3', which is not there; copy it beside that file, or let 'ros2 bag");
  const std::string no_name(300, 'a');  // longer than file systems have them
  test::put_file(metadata, metadata_naming({no_name + ".db3"}));
  EXPECT_ERROR(open_bag(folder.path()), "which is not there");
  EXPECT_ERROR(file_info(no_name, {}), no_name);
  test::put_file(metadata, metadata_naming({"a_0.db3.zstd"}));
  EXPECT_ERROR(open_bag(folder.path()), "unpack it: zstd -d");
  test::put_file(folder / "b.db3.zstd", "packed");
  EXPECT_ERROR(open_recording((folder / "b.db3.zstd").string()), "unpack it: zstd -d");
  const Bag bag = a_bag();
  write_db3(folder / "a_0.db3", bag, bag.messages);
  expect_same(open_bag(folder.path()), bag);  // unpacked since
  test::put_file(metadata, metadata_naming({}));
  EXPECT_ERROR(open_bag(folder.path()), "names no files");
  test::put_file(metadata, "rosbag2_bagfile_information: [");
  EXPECT_ERROR(open_bag(folder.path()), "metadata.yaml: line");
  test::put_file(folder / "b.db3", "no database at all");
  EXPECT_ERROR(open_bag(folder / "b.db3"), "b.db3: not a bag of rosbag2");
  EXPECT_ERROR(open_bag(folder / "none.db3"), "none.db3: cannot be opened");
}

TEST(Bag, OfItsMetadataItIsSaidWhichFolderToGive) {
  const test::TemporaryFolder folder;
  const fs::path metadata = folder / "metadata.yaml";
  const Bag bag = a_bag();
  write_db3(folder / "a_0.db3", bag, bag.messages);
  for (const std::string& content : {metadata_naming({"a_0.db3"}), std::string()}) {
    test::put_file(metadata, content);
    const std::string sentence =
        "metadata.yaml: belongs to a bag and is no recording by itself; give the "
        "folder of the bag: " +
        shell_quoted(folder.path().string());
    EXPECT_ERROR(open_recording(metadata.string()), sentence);
    EXPECT_ERROR(file_info(metadata.string(), {}), sentence);
  }
  fs::remove(folder / "a_0.db3");
  test::put_file(metadata, "robots: []\n");
  EXPECT_TRUE(check_not_metadata(metadata)) << "of something else";
  EXPECT_TRUE(check_not_metadata(folder / "none/metadata.yaml"));
  EXPECT_TRUE(check_not_metadata("metadata.yaml")) << "not there";
}

TEST(Bag, AFileOfAnotherKindThanItsEndingIsNamed) {
  const test::TemporaryFolder folder;
  const Bag bag = a_bag();
  write_db3(folder / "lite.mcap", bag, bag.messages);
  EXPECT_ERROR(open_bag(folder / "lite.mcap"),
               "lite.mcap: its content is that of an SQLite file; give it the");
  test::ForeignFile file;
  test::put_file(folder / "m.bag", file.clouds("/points").bytes());
  EXPECT_ERROR(open_bag(folder / "m.bag"), "m.bag: its content is that of an MCAP file");
  EXPECT_ERROR(open_bag(folder / "m.bag"), (folder / "m.mcap").string());
  test::put_file(folder / "r.db3", "#ROSBAG V2.0\n...");
  EXPECT_ERROR(open_bag(folder / "r.db3"), "r.db3: its content is that of a bag of ROS 1");
  test::put_file(folder / "g.mcap", "\x1F\x8B\x08 and so on");
  EXPECT_ERROR(open_bag(folder / "g.mcap"), "g.mcap: its content is compressed by gzip as a whole");
  EXPECT_ERROR(open_bag(folder / "g.mcap"), "> UNPACKED.mcap");
  test::put_file(folder / "g.bag.gz", "packed");
  EXPECT_ERROR(open_recording((folder / "g.bag.gz").string()), "unpack it: gzip -d ");
}

TEST(Bag, AFileOfNothingIsSaidToBeEmpty) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.mcap", "a.bag", "a.db3"}) {
    test::put_file(folder / name, "");
    EXPECT_ERROR(open_bag(folder / name), std::string(name) + ": is empty: nothing was recorded");
    test::put_file(folder / name, "abc");
    EXPECT_ERROR(open_bag(folder / name),
                 "has only 3 bytes: nothing was recorded, or it was not copied to its end");
  }
}

TEST(Bag, WithoutCloudsItIsSaidWhatToDoWithWhatIsThere) {
  const auto refused = [](const std::string& topic, const std::string& type) {
    Bag bag;
    bag.topics = {{"/tf", "tf2_msgs/msg/TFMessage", "cdr"}, {topic, type, "cdr"}};
    return choose_topics(bag, {});
  };
  for (const char* type : {"velodyne_msgs/msg/VelodyneScan", "ouster_sensor_msgs/msg/PacketMsg",
                           "hesai_ros_driver/msg/UdpFrame", "rslidar_msg/msg/RslidarPacket"})
    EXPECT_ERROR(refused("/packets", type), "play it through the driver of the sensor and record its points");
  EXPECT_ERROR(refused("/scan", "sensor_msgs/msg/LaserScan"), "/scan is of a scanner of one plane");
  EXPECT_ERROR(refused("/points/draco", "point_cloud_interfaces/msg/CompressedPointCloud2"),
               "with in_transport as its name ends (draco) and out_transport raw");
  EXPECT_ERROR(refused("/chat", "std_msgs/msg/String"), "there are no scans to read");
}

TEST(Bag, AnEmptyMetadataYamlIsLikeNone) {
  const Bag bag = a_bag();
  for (const std::string& content : {std::string(), std::string(300, '\0'), std::string("other: 3\n")}) {
    const test::TemporaryFolder folder;
    test::put_file(folder / "metadata.yaml", content);
    EXPECT_FALSE(is_bag_folder(folder.path()));
    EXPECT_ERROR(open_bag(folder.path()), "no files of a bag in this folder");
    write_db3(folder / "a_0.db3", bag, bag.messages);
    ASSERT_TRUE(is_bag_folder(folder.path()));
    const Result<Bag> read = open_bag(folder.path());
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->messages.size(), bag.messages.size());
    ASSERT_EQ(read->warnings.size(), 1U);
    EXPECT_NE(read->warnings[0].find("metadata.yaml: has no rosbag2_bagfile_information"), std::string::npos);
    test::put_file(folder / "cloud.pcd", "");
    EXPECT_FALSE(is_bag_folder(folder.path())) << "clouds beside it, and nothing says that it is a bag";
  }
}

TEST(Bag, WhatMetadataYamlNamesTwiceIsReadOnceAndWhatIsMissingCostsItselfAlone) {
  const test::TemporaryFolder folder;
  const Bag bag = a_bag();
  write_db3(folder / "a_0.db3", bag, bag.messages);
  test::put_file(folder / "metadata.yaml", metadata_naming({"a_0.db3", "./a_0.db3", "early/a_0.db3"}));
  expect_same(open_bag(folder.path()), bag);
  test::put_file(folder / "metadata.yaml", metadata_naming({"a_0.db3", "a_1.db3"}));
  const Result<Bag> rest = open_bag(folder.path());
  ASSERT_TRUE(rest) << rest.error().message;
  EXPECT_EQ(rest->messages.size(), bag.messages.size());
  ASSERT_EQ(rest->warnings.size(), 1U);
  EXPECT_NE(rest->warnings[0].find("names 'a_1.db3', which is not there"), std::string::npos)
      << rest->warnings[0];
  EXPECT_NE(rest->warnings[0].find("; this one of 2 files is left out"), std::string::npos);
}

}  // namespace
}  // namespace adit
