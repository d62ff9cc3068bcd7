// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/sqlite_bag.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"

namespace adit {
namespace {

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

Result<Database> open_database(const std::filesystem::path& path) {
  sqlite3* opened = nullptr;
  const int code =
      sqlite3_open_v2(path.c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, nullptr);
  Database database(opened);
  if (code != SQLITE_OK) return fail(format("cannot be opened: {}", sqlite3_errstr(code)));
  // Without this, sqlite refuses a file that was cut short as a whole. Nothing is written either way.
  sqlite3_exec(opened, "PRAGMA writable_schema = ON", nullptr, nullptr, nullptr);
  return database;
}

Result<Statement> prepare(sqlite3* database, const char* query) {
  sqlite3_stmt* prepared = nullptr;
  if (sqlite3_prepare_v2(database, query, -1, &prepared, nullptr) != SQLITE_OK)
    return fail(format("not a bag of rosbag2: {}", sqlite3_errmsg(database)));
  return Statement(prepared);
}

std::string text_of(sqlite3_stmt* row, int column) {
  const auto* text = sqlite3_column_text(row, column);
  return text == nullptr ? std::string() : reinterpret_cast<const char*>(text);
}

/// Topics by their id in the file.
Result<std::map<std::int64_t, BagTopic>> read_topics(sqlite3* database) {
  const Result<Statement> rows = prepare(database, "SELECT id, name, type, serialization_format FROM topics");
  if (!rows) return tl::unexpected(rows.error());
  std::map<std::int64_t, BagTopic> topics;
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(rows->get())) == SQLITE_ROW)
    topics[sqlite3_column_int64(rows->get(), 0)] = {text_of(rows->get(), 1), text_of(rows->get(), 2),
                                                    text_of(rows->get(), 3)};
  if (code != SQLITE_DONE) return fail(format("the table of topics: {}", sqlite3_errmsg(database)));
  return topics;
}

/// Notes the messages in the order in which they were written, which a torn file can be read in.
Result<> index_messages(sqlite3* database, const std::filesystem::path& path,
                        const std::map<std::int64_t, std::size_t>& topic_of_id, Bag& bag) {
  const Result<Statement> rows =
      prepare(database, "SELECT id, topic_id, timestamp FROM messages ORDER BY id");
  if (!rows) return tl::unexpected(rows.error());
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(rows->get())) == SQLITE_ROW) {
    throw_if_cancelled();
    const std::int64_t id = sqlite3_column_int64(rows->get(), 0);
    const std::int64_t topic = sqlite3_column_int64(rows->get(), 1);
    const auto known = topic_of_id.find(topic);
    if (known == topic_of_id.end())
      return fail(format("message {} is of topic {}, which the table of topics does not have", id, topic));
    bag.messages.push_back(
        {known->second, {sqlite3_column_int64(rows->get(), 2)}, static_cast<std::uint64_t>(id)});
  }
  if (code != SQLITE_DONE && bag.messages.empty())
    return fail(format("no message can be read: {}", sqlite3_errmsg(database)));
  if (code != SQLITE_DONE)
    bag.warnings.push_back(
        format("{}: only the first {} messages can be read ({}); 'sqlite3 {} .recover' may save more",
               path.string(), bag.messages.size(), sqlite3_errmsg(database), path.filename().string()));
  std::ranges::stable_sort(bag.messages, {}, &BagMessage::log_time);
  return {};
}

/// One query at a time.
class Messages {
 public:
  Messages(Database database, Statement by_id) : database_(std::move(database)), by_id_(std::move(by_id)) {}

  Result<std::string> read(std::uint64_t id) {
    const std::scoped_lock lock(mutex_);
    sqlite3_bind_int64(by_id_.get(), 1, static_cast<std::int64_t>(id));
    Result<std::string> data = std::string();
    if (sqlite3_step(by_id_.get()) == SQLITE_ROW) {
      const void* bytes = sqlite3_column_blob(by_id_.get(), 0);
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(by_id_.get(), 0));
      if (size > 0) data->assign(static_cast<const char*>(bytes), size);
    } else {
      data = fail(format("message {} of the table: {}", id, sqlite3_errmsg(database_.get())));
    }
    sqlite3_reset(by_id_.get());
    return data;
  }

 private:
  std::mutex mutex_;
  Database database_;
  Statement by_id_;  ///< Before the database in destruction.
};

}  // namespace

Result<Bag> open_sqlite_bag(const std::filesystem::path& path) {
  Result<Database> database = open_database(path);
  if (!database) return fail(path.string(), database.error());
  Bag bag;
  bag.storage = "sqlite3";
  std::error_code ignored;
  bag.num_bytes = std::filesystem::file_size(path, ignored);
  const Result<std::map<std::int64_t, BagTopic>> topics = read_topics(database->get());
  if (!topics) return fail(path.string(), topics.error());
  std::map<std::int64_t, std::size_t> topic_of_id;
  for (const auto& [id, topic] : *topics) {
    topic_of_id[id] = bag.topics.size();
    bag.topics.push_back(topic);
  }
  if (Result<> indexed = index_messages(database->get(), path, topic_of_id, bag); !indexed)
    return fail(path.string(), indexed.error());
  Result<Statement> by_id = prepare(database->get(), "SELECT data FROM messages WHERE id = ?");
  if (!by_id) return fail(path.string(), by_id.error());
  const auto messages = std::make_shared<Messages>(std::move(*database), std::move(*by_id));
  bag.read = [messages](const BagMessage& message) { return messages->read(message.where); };
  return bag;
}

}  // namespace adit
