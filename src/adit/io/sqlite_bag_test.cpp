// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/sqlite_bag.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/tum.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"
#include "support/sqlite_bag.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

using test::a_bag;
using test::expect_same;
using test::write_db3;

TEST(SqliteBag, SqliteHoldsWhatMcapDoes) {
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

TEST(SqliteBag, ASqliteFileInWalModeIsReadWithItsLogAndNothingIsWritten) {
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

TEST(SqliteBag, ASqliteFileThatLacksItsLogIsToldOf) {
  const test::TemporaryFolder folder;
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "a.db3").c_str(), &database), SQLITE_OK);
  sqlite3_exec(database, "PRAGMA journal_mode = WAL; CREATE TABLE topics(id)", nullptr, nullptr, nullptr);
  fs::copy_file(folder / "a.db3", folder / "copied.db3");
  sqlite3_close(database);
  EXPECT_ERROR(open_bag(folder / "copied.db3"), "no such table: topics; is copied.db3-wal missing?");
}

TEST(SqliteBag, OfASqliteFileWithoutAWholeMessageTheErrorSaysWhatMayHelp) {
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

TEST(SqliteBag, OfASqliteFileThatBreaksOffTheFirstMessagesAreRead) {
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

TEST(SqliteBag, OfATornSqliteFileEveryMessageOfTheListCanBeRead) {
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

constexpr const char* kTopics =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);";
constexpr const char* kMessages =
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);";
constexpr const char* kCounting =
    "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i, 7, i, 'x' FROM n";

/// A file that these statements make.
fs::path made_by(const fs::path& path, const std::string& statements) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
  return path;
}

TEST(SqliteBag, AViewIsNoTableOfMessages) {
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

TEST(SqliteBag, AQueryThatTakesLongCanBeCancelled) {
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

TEST(SqliteBag, LogTimesOfDamagedRowsStayWithinWhatDifferencesCanHold) {
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

TEST(SqliteBag, ReadsAFileOfRosbag2) {
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
