// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A recording of rosbag2 as a file of SQLite.
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <string>
#include <vector>

#include "adit/io/bag.hpp"
#include "adit/io/compression.hpp"
#include "support/foreign_mcap.hpp"

namespace adit::test {

/// What a robot records: clouds, wheels, frames.
inline Bag a_bag() {
  ForeignFile file;
  file.clouds("/robot_0/points")
      .odometry("/robot_0/odom")
      .links({link("base_link", "os_lidar", T_base_ouster)});
  return open_mcap_bag(memory_source(file.bytes())).value();
}

/// As rosbag2 stores them: a row for each topic, and one for each message in the order of arrival.
inline void write_db3(const std::filesystem::path& path, const Bag& bag,
                      const std::vector<BagMessage>& messages, bool compressed = false) {
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

/// Whether the same messages were read, without a warning.
inline void expect_same(const Result<Bag>& read, const Bag& bag) {
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

}  // namespace adit::test
