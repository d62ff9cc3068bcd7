// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/bag.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/bag_recording.hpp"
#include "adit/io/bag_topics.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/file_info.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/tum.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// What a robot records: clouds, wheels, frames.
Bag a_bag() {
  test::ForeignFile file;
  file.clouds("/robot_0/points")
      .odometry("/robot_0/odom")
      .links({test::link("base_link", "os_lidar", test::T_base_ouster)});
  return open_mcap_bag(memory_source(file.bytes())).value();
}

/// As rosbag2 stores them: a row for each topic, and one for each message in the order of arrival.
void write_db3(const fs::path& path, const Bag& bag, const std::vector<BagMessage>& messages,
               bool compressed = false) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  const auto run = [&](const char* query) {
    ASSERT_EQ(sqlite3_exec(database, query, nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
  };
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
      "data BLOB NOT NULL)");
  run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO topics VALUES(?, ?, ?, ?, '')", -1, &insert, nullptr);
  for (std::size_t t = 0; t < bag.topics.size(); ++t) {
    sqlite3_bind_int64(insert, 1, static_cast<std::int64_t>(10 * t + 7));
    sqlite3_bind_text(insert, 2, bag.topics[t].name.c_str(), -1, SQLITE_TRANSIENT);
    sqlite3_bind_text(insert, 3, bag.topics[t].type.c_str(), -1, SQLITE_TRANSIENT);
    sqlite3_bind_text(insert, 4, bag.topics[t].encoding.c_str(), -1, SQLITE_TRANSIENT);
    ASSERT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", -1, &insert,
                     nullptr);
  for (const BagMessage& message : messages) {
    const std::string data = bag.read(message).value();
    const std::string stored = compressed ? compress_zstd(data) : data;
    sqlite3_bind_int64(insert, 1, static_cast<std::int64_t>(10 * message.topic + 7));
    sqlite3_bind_int64(insert, 2, message.log_time.ns);
    sqlite3_bind_blob(insert, 3, stored.data(), static_cast<int>(stored.size()), SQLITE_TRANSIENT);
    ASSERT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  sqlite3_close(database);
}

void expect_same(const Result<Bag>& read, const Bag& bag) {
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->messages.size(), bag.messages.size());
  for (std::size_t m = 0; m < bag.messages.size(); ++m) {
    const BagMessage& mine = read->messages[m];
    EXPECT_EQ(mine.log_time, bag.messages[m].log_time);
    EXPECT_EQ(read->topics.at(mine.topic).name, bag.topics[bag.messages[m].topic].name);
    EXPECT_EQ(read->topics.at(mine.topic).type, bag.topics[bag.messages[m].topic].type);
    EXPECT_EQ(read->read(mine).value(), bag.read(bag.messages[m]).value());
  }
  EXPECT_TRUE(read->warnings.empty());
}

std::string metadata_naming(const std::vector<std::string>& files) {
  std::string yaml = "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n";
  for (const std::string& file : files) yaml += "    - " + file + "\n";
  return yaml;
}

TEST(Bag, SqliteHoldsWhatMcapDoes) {
  const test::TemporaryFolder folder;
  const Bag bag = a_bag();
  write_db3(folder / "a.db3", bag, bag.messages);
  expect_same(open_bag(folder / "a.db3"), bag);
  write_db3(folder / "packed.db3", bag, bag.messages, true);
  expect_same(open_bag(folder / "packed.db3"), bag);

  const Result<Recording> recording = open_recording((folder / "a.db3").string());
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->name, "robot_0");
  EXPECT_EQ(recording->num_scans(), 3U);
  EXPECT_EQ(recording->wheel.size(), 3U);
  EXPECT_EQ(recording->scan_stamps[1], test::make_scan(1, 0).stamp);
  EXPECT_EQ(recording->read_scan(2)->cloud.points, test::make_scan(2, 4).cloud.points);
  EXPECT_LT((recording->T_base_lidar.inverse() * test::T_base_ouster).log().norm(), 1e-9);
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

enum class WalLog { taken_in, left };

/// Turns it into a file of WAL mode, as rosbag2's preset "resilient" writes them. `left`: every message a
/// second time, in the log alone.
void put_in_wal_mode(const fs::path& path, WalLog log) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database, "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr), SQLITE_OK);
  if (log == WalLog::left) {
    sqlite3_db_config(database, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    constexpr const char* kAgain =
        "INSERT INTO messages(topic_id, timestamp, data) SELECT topic_id, timestamp, data FROM messages";
    ASSERT_EQ(sqlite3_exec(database, kAgain, nullptr, nullptr, nullptr), SQLITE_OK);
  }
  sqlite3_close(database);
}

TEST(Bag, ASqliteFileInWalModeIsReadWithItsLogAndNothingIsWritten) {
  const test::TemporaryFolder folder;
  const Bag bag = a_bag();
  const std::string name = "a b?#%41.db3";  // has to be spelled in a URI
  const auto expect_read = [&](std::size_t num_messages, std::size_t num_files) {
    fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);  // does not bind root
    {
      const Result<Bag> read = open_bag(folder / name);
      fs::permissions(folder.path(), fs::perms::owner_all);
      ASSERT_TRUE(read) << read.error().message;
      EXPECT_EQ(read->messages.size(), num_messages);
      EXPECT_TRUE(read->warnings.empty());
      EXPECT_EQ(read->read(read->messages.back()).value(), bag.read(bag.messages.back()).value());
    }
    EXPECT_EQ(test::num_entries(folder.path()), num_files);
  };
  write_db3(folder / name, bag, bag.messages);
  put_in_wal_mode(folder / name, WalLog::taken_in);
  expect_read(bag.messages.size(), 1);
  put_in_wal_mode(folder / name, WalLog::left);
  const std::string log = test::get_file(folder / (name + "-wal"));
  expect_read(2 * bag.messages.size(), 3);  // with the index of a recorder that was ended
  fs::remove(folder / (name + "-shm"));
  expect_read(2 * bag.messages.size(), 2);
  EXPECT_TRUE(test::get_file(folder / (name + "-wal")) == log);
}

TEST(Bag, ASqliteFileThatLacksItsLogIsToldOf) {
  const test::TemporaryFolder folder;
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "a.db3").c_str(), &database), SQLITE_OK);
  sqlite3_exec(database, "PRAGMA journal_mode = WAL; CREATE TABLE topics(id)", nullptr, nullptr, nullptr);
  fs::copy_file(folder / "a.db3", folder / "copied.db3");
  sqlite3_close(database);
  EXPECT_ERROR(open_bag(folder / "copied.db3"), "no such table: topics; is copied.db3-wal missing?");
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

TEST(Bag, OfASqliteFileWithoutAWholeMessageTheErrorSaysWhatMayHelp) {
  const test::TemporaryFolder folder;
  Bag bag;
  bag.topics = {{"/points", "sensor_msgs/msg/PointCloud2", "cdr"}};
  bag.messages = {{0, {1}, 1}};
  bag.read = [](const BagMessage&) -> Result<std::string> { return std::string(100'000, 'x'); };
  write_db3(folder / "whole.db3", bag, bag.messages);
  const std::string whole = test::get_file(folder / "whole.db3");
  test::put_file(folder / "cut.db3", whole.substr(0, whole.size() - 50'000));
  EXPECT_ERROR(open_bag(folder / "cut.db3"), "cut.db3: no message can be read: ");
  EXPECT_ERROR(open_bag(folder / "cut.db3"), "'sqlite3 cut.db3 .recover' may save some");
}

TEST(Bag, OfASqliteFileThatBreaksOffTheFirstMessagesAreRead) {
  const test::TemporaryFolder folder;
  Bag bag = a_bag();
  std::vector<BagMessage> many;  // over several pages
  for (int i = 0; i < 50; ++i) many.insert(many.end(), bag.messages.begin(), bag.messages.end());
  write_db3(folder / "whole.db3", bag, many);
  const std::string whole = test::get_file(folder / "whole.db3");
  std::size_t most = 0;
  int num_warned = 0;
  for (std::size_t size = 0; size < whole.size(); size += 1100) {
    test::put_file(folder / "cut.db3", whole.substr(0, size));
    const Result<Bag> cut = open_bag(folder / "cut.db3");
    if (!cut) continue;
    ASSERT_LE(cut->messages.size(), many.size());
    most = std::max(most, cut->messages.size());
    if (cut->messages.size() < many.size()) {
      ASSERT_EQ(cut->warnings.size(), 1U) << "cut at " << size;
      EXPECT_NE(cut->warnings[0].find(format("the first {} messages", cut->messages.size())),
                std::string::npos);
      ++num_warned;
    }
    for (const BagMessage& message : cut->messages) {
      const BagMessage& original = many[message.where - 1];  // ids count from 1
      EXPECT_EQ(cut->read(message).value(), bag.read(original).value()) << "cut at " << size;
    }
  }
  EXPECT_GT(most, many.size() / 2);
  EXPECT_GT(num_warned, 3);
}

/// Clouds, of which the most lies on pages of its own, and short messages between them.
Bag bag_of_long_messages() {
  Bag bag;
  bag.topics = {{"/points", "sensor_msgs/msg/PointCloud2", "cdr"}, {"/odom", "nav_msgs/msg/Odometry", "cdr"}};
  for (std::size_t m = 0; m < 90; ++m)
    bag.messages.push_back({m % 3 == 0 ? 0U : 1U, {static_cast<std::int64_t>(m)}, m + 1});
  bag.read = [](const BagMessage& message) -> Result<std::string> {
    return std::string(message.topic == 0 ? 33'000 : 200, static_cast<char>('a' + message.where % 26));
  };
  return bag;
}

TEST(Bag, OfATornSqliteFileEveryMessageOfTheListCanBeRead) {
  const test::TemporaryFolder folder;
  const Bag bag = bag_of_long_messages();
  write_db3(folder / "whole.db3", bag, bag.messages);
  expect_same(open_bag(folder / "whole.db3"), bag);
  const std::string whole = test::get_file(folder / "whole.db3");
  for (std::size_t size = whole.size() / 5; size < whole.size(); size += 3001) {
    test::put_file(folder / "cut.db3", whole.substr(0, size));
    const Result<Bag> cut = open_bag(folder / "cut.db3");
    ASSERT_TRUE(cut) << cut.error().message;
    const std::size_t num = cut->messages.size();
    for (const BagMessage& message : cut->messages) {
      const Result<std::string> data = cut->read(message);
      ASSERT_TRUE(data) << "cut at " << size << ": " << data.error().message;
      EXPECT_EQ(*data, bag.read(message).value()) << "cut at " << size;
    }
    ASSERT_EQ(cut->warnings.size(), 1U) << "cut at " << size;
    EXPECT_NE(cut->warnings[0].find(format("the first {} messages", num)), std::string::npos);
    EXPECT_GT(num + 5, bag.messages.size() * size / whole.size()) << "cut at " << size;
  }
}

/// A file that these statements make.
fs::path made_by(const fs::path& path, const std::string& statements) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
  return path;
}

constexpr const char* kTopics =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);";
constexpr const char* kMessages =
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);";
constexpr const char* kCounting =
    "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i, 7, i, 'x' FROM n";

TEST(Bag, AViewIsNoTableOfMessages) {
  const test::TemporaryFolder folder;
  EXPECT_ERROR(
      open_bag(made_by(folder / "a.db3", format("{}INSERT INTO topics VALUES(7, '/a', 'b', 'cdr');"
                                                "CREATE VIEW messages(id, topic_id, timestamp, data) AS {};",
                                                kTopics, kCounting))),
      "a.db3: not a bag of rosbag2: its 'messages' is no table but a view");
  EXPECT_ERROR(open_bag(made_by(folder / "b.db3",
                                format("{}CREATE VIEW Topics(id, name, type, serialization_format) AS {};",
                                       kMessages, kCounting))),
               "b.db3: not a bag of rosbag2: its 'Topics' is no table but a view");
  // The table of the schema may call it anything.
  EXPECT_ERROR(
      open_bag(made_by(folder / "c.db3",
                       format("{}CREATE VIEW messages(id, topic_id, timestamp, data) AS {};"
                              "PRAGMA writable_schema = ON;"
                              "UPDATE sqlite_master SET type = 'index', name = 'x' WHERE name = 'messages';",
                              kTopics, kCounting))),
      "c.db3: not a bag of rosbag2: its 'messages' is no table but a view");
}

TEST(Bag, AQueryThatTakesLongCanBeCancelled) {
  class Cancelling : public ProgressObserver {
   public:
    PhaseId begin(std::string_view /*name*/, std::size_t /*total*/, PhaseId /*parent*/) override { return 1; }
    void advance(PhaseId /*phase*/, std::size_t /*steps*/) override {}
    void end(PhaseId /*phase*/) noexcept override {}
    [[nodiscard]] bool cancelled() const noexcept override { return true; }
  };
  const test::TemporaryFolder folder;
  const fs::path path = made_by(
      folder / "a.db3", format("{}{}INSERT INTO topics {} LIMIT 100000;", kTopics, kMessages, kCounting));
  EXPECT_EQ(open_bag(path)->topics.size(), 100'000U);
  Cancelling observer;
  const ObserverScope scope(observer);
  EXPECT_THROW((void)open_bag(path), Cancelled);
}

TEST(Bag, LogTimesOfDamagedRowsStayWithinWhatDifferencesCanHold) {
  const test::TemporaryFolder folder;
  Bag bag = a_bag();
  bag.messages.front().log_time.ns = INT64_MIN;
  bag.messages.back().log_time.ns = INT64_MAX;
  write_db3(folder / "a.db3", bag, bag.messages);
  const Result<Bag> read = open_bag(folder / "a.db3");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->messages.front().log_time.ns, -kLargestStamp.ns);
  EXPECT_EQ(read->messages.back().log_time.ns, kLargestStamp.ns);
  EXPECT_GT(read->messages.back().log_time - read->messages.front().log_time, Duration(0));
  EXPECT_EQ(read->messages[1].log_time, bag.messages[1].log_time);
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

TEST(Bag, ReadsAFileOfRosbag2) {
  ADIT_NEED_DATA("recordings/cdr_test_0.db3");
  const Result<Bag> bag = open_bag(test::shared_data("recordings/cdr_test_0.db3"));
  ASSERT_TRUE(bag) << bag.error().message;
  ASSERT_EQ(bag->topics.size(), 2U);
  EXPECT_EQ(bag->topics[1].type, "test_msgs/msg/Arrays");
  ASSERT_EQ(bag->messages.size(), 7U);  // as sqlite3 counts them
  EXPECT_EQ(bag->messages.front().log_time.ns, 1586406456763032325);
  EXPECT_EQ(bag->messages.back().log_time.ns, 1586406456914169506);
  for (const BagMessage& message : bag->messages)
    EXPECT_EQ(bag->read(message)->size(), message.topic == 0 ? 52U : 696U);
}

}  // namespace
}  // namespace adit
