// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/sqlite_bag.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <bit>
#include <map>
#include <memory>
#include <mutex>
#include <string_view>
#include <system_error>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/byte_source.hpp"

namespace adit {
namespace {

/// Shows sqlite the whole pages of a file that was cut inside a page. It would fill up the last one with
/// zeros, and rows on it would have other content than was recorded.
struct WholePages : sqlite3_io_methods {
  WholePages(const sqlite3_io_methods& of_file, std::uint64_t bytes_per_page)
      : sqlite3_io_methods(of_file),
        original(&of_file),
        page_size(static_cast<sqlite3_int64>(bytes_per_page)) {
    xFileSize = [](sqlite3_file* file, sqlite3_int64* size) {
      const auto* self = static_cast<const WholePages*>(file->pMethods);
      const int code = self->original->xFileSize(file, size);
      if (code == SQLITE_OK) *size -= *size % self->page_size;
      return code;
    };
  }
  const sqlite3_io_methods* original;
  sqlite3_int64 page_size;
};

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
struct ResetStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_reset(statement); }
};
struct Database {
  std::unique_ptr<WholePages> whole_pages;  ///< None where all are whole. Outlives what uses it.
  std::unique_ptr<sqlite3, CloseDatabase> handle;
  [[nodiscard]] sqlite3* get() const { return handle.get(); }
};
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

/// What the head of the file says of its pages, and what is there of them. Source:
/// https://sqlite.org/fileformat2.html#the_database_header
struct Pages {
  std::uint64_t size = 0;  ///< Of one; 0 where the head does not tell.
  bool are_missing = false;
  bool is_last_cut = false;
  bool have_log = false;  ///< The file is in WAL mode: what was written last may lie in a log beside it.
};

Pages pages_of(const std::filesystem::path& path) {
  constexpr std::uint64_t kHead = 100;
  const Result<ByteSource> source = open_source(path);
  const Result<std::string> head = source ? source->read(0, kHead) : fail(source.error().message);
  if (!head) return {};
  const auto big_endian = [&](std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = at; i < at + size; ++i) value = value << 8U | static_cast<std::uint8_t>((*head)[i]);
    return value;
  };
  const std::uint64_t stated = big_endian(16, 2);
  const std::uint64_t page_size = stated == 1 ? 65536 : stated;  // which two bytes cannot hold
  if (page_size < 512 || !std::has_single_bit(page_size)) return {};
  return {page_size, big_endian(28, 4) * page_size > source->size, source->size % page_size != 0,
          big_endian(18, 1) == 2 && big_endian(19, 1) == 2};
}

/// How a file is to be opened so that nothing is written, neither into it nor beside it.
enum class Access : std::uint8_t {
  plain,      ///< As files without a log are, and those that another program has open or did not close.
  immutable,  ///< There is no log, and none shall be made.
  log_alone,  ///< There is a log without its index, which sqlite would write beside it and here keeps in
              ///< memory.
};

std::filesystem::path with_suffix(std::filesystem::path path, const char* suffix) { return path += suffix; }

Access access_to(const std::filesystem::path& path, const Pages& pages) {
  if (!pages.have_log) return Access::plain;
  std::error_code absent;
  const std::uintmax_t log = std::filesystem::file_size(with_suffix(path, "-wal"), absent);
  if (absent || log == 0) return Access::immutable;
  const bool has_index = std::filesystem::exists(with_suffix(path, "-shm"), absent);
  return has_index ? Access::plain : Access::log_alone;
}

/// The path as https://sqlite.org/uri.html has it, with what tells sqlite of the access.
std::string uri_of(const std::filesystem::path& path, Access access) {
  std::error_code ignored;
  std::string uri = "file://";
  for (const char c : std::filesystem::absolute(path, ignored).string()) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          std::string_view("/._-").find(c) != std::string_view::npos;
    uri +=
        is_plain ? std::string(1, c) : format("%{:02X}", static_cast<unsigned>(static_cast<std::uint8_t>(c)));
  }
  if (access == Access::immutable) return uri + "?immutable=1";
  return access == Access::log_alone ? uri + "?vfs=unix-none" : uri;
}

/// Ends a query whose caller wants to stop, however long it goes without a row.
int is_cancelled(void* /*unused*/) noexcept {
  const ProgressObserver* observer = progress_context().observer;
  return observer != nullptr && observer->cancelled() ? 1 : 0;
}

/// Why the last call failed. Does not return where the caller wanted that.
std::string fault_of(sqlite3* database) {
  throw_if_cancelled();
  return sqlite3_errmsg(database);
}

Result<Database> open_database(const std::filesystem::path& path, const Pages& pages, Access access) {
  Database database;
  sqlite3* opened = nullptr;
  const int code = sqlite3_open_v2(uri_of(path, access).c_str(), &opened,
                                   SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_URI, nullptr);
  database.handle.reset(opened);
  if (code != SQLITE_OK) return fail(format("cannot be opened: {}", sqlite3_errstr(code)));
  // Nobody else has the file open, or there would be an index: locks can be done without, and in exclusive
  // mode the index of the log needs no file. The log stays where it is.
  if (access == Access::log_alone)
    sqlite3_exec(opened, "PRAGMA locking_mode = EXCLUSIVE", nullptr, nullptr, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  sqlite3_file* file = nullptr;
  if (pages.is_last_cut && sqlite3_file_control(opened, "main", SQLITE_FCNTL_FILE_POINTER,
                                                static_cast<void*>(&file)) == SQLITE_OK) {
    database.whole_pages = std::make_unique<WholePages>(*file->pMethods, pages.size);
    file->pMethods = database.whole_pages.get();
  }
  constexpr int kStepsBetweenPolls = 100'000;  // of sqlite's machine: about a millisecond
  sqlite3_progress_handler(opened, kStepsBetweenPolls, is_cancelled, nullptr);
  // Without the first, sqlite refuses a file that was cut short as a whole. Nothing is written either way.
  // The second keeps what the file brings along from calling functions with effects outside of it.
  sqlite3_exec(opened, "PRAGMA writable_schema = ON; PRAGMA trusted_schema = OFF", nullptr, nullptr, nullptr);
  return database;
}

Result<Statement> prepare(sqlite3* database, const char* query) {
  sqlite3_stmt* prepared = nullptr;
  if (sqlite3_prepare_v2(database, query, -1, &prepared, nullptr) != SQLITE_OK)
    return fail(format("not a bag of rosbag2: {}", fault_of(database)));
  return Statement(prepared);
}

std::string text_of(sqlite3_stmt* row, int column) {
  const auto* text = sqlite3_column_text(row, column);
  return text == nullptr ? std::string() : reinterpret_cast<const char*>(text);
}

/// A view or a virtual table of the name would run a program that the file brings along, which may never end.
/// What sqlite has made of the schema is asked, as the table that holds it may say anything.
Result<> check_tables(sqlite3* database) {
  const Result<Statement> others =
      prepare(database,
              "SELECT name FROM pragma_table_list WHERE lower(name) IN ('topics', 'messages') "
              "AND type <> 'table'");
  if (!others) return tl::unexpected(others.error());
  const int code = sqlite3_step(others->get());
  if (code == SQLITE_ROW)
    return fail(
        format("not a bag of rosbag2: its '{}' is no table but a view or a virtual table; if you trust "
               "the file, copy what it gives into a table of that name",
               text_of(others->get(), 0)));
  if (code != SQLITE_DONE) return fail(format("not a bag of rosbag2: {}", fault_of(database)));
  return {};
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
  if (code != SQLITE_DONE) return fail(format("the table of topics: {}", fault_of(database)));
  return topics;
}

/// Notes the messages in the order in which they were written, which a torn file can be read in.
/// @returns why the list ends early; "" where it does not.
Result<std::string> list_messages(sqlite3* database, const std::map<std::int64_t, std::size_t>& topic_of_id,
                                  Bag& bag) {
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
    bag.messages.push_back({known->second, usable_log_time({sqlite3_column_int64(rows->get(), 2)}),
                            static_cast<std::uint64_t>(id)});
  }
  return code == SQLITE_DONE ? std::string() : fault_of(database);
}

/// One query at a time.
class Messages {
 public:
  Messages(Database database, Statement by_id) : database_(std::move(database)), by_id_(std::move(by_id)) {}

  Result<std::string> read(std::uint64_t id) {
    const std::scoped_lock lock(mutex_);
    sqlite3_bind_int64(by_id_.get(), 1, static_cast<std::int64_t>(id));
    const std::unique_ptr<sqlite3_stmt, ResetStatement> row(by_id_.get());
    if (sqlite3_step(row.get()) != SQLITE_ROW)
      return fail(format("message {} of the table: {}", id, fault_of(database_.get())));
    const void* bytes = sqlite3_column_blob(row.get(), 0);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row.get(), 0));
    if (size == 0) return std::string();
    if (bytes == nullptr) return fail(format("message {} of the table: {}", id, fault_of(database_.get())));
    return std::string(static_cast<const char*>(bytes), size);
  }

 private:
  std::mutex mutex_;
  Database database_;
  Statement by_id_;  ///< Before the database in destruction.
};

/// Leaves out the messages from the first on whose bytes lie behind the cut. The list has it all the same
/// where its row, but not all of its bytes, lies on the last page of rows. What rows of earlier pages need
/// was written before that page.
/// @returns why messages were left out; else `fault`, why the list ended.
std::string drop_unreadable(Bag& bag, Messages& messages, const Pages& pages, std::string fault) {
  constexpr std::uint64_t kLeastRow = 16;  // bytes, without the message itself
  std::size_t num_whole = bag.messages.size();
  std::uint64_t seen = 0;  // bytes that these rows take on a page, at least
  for (std::size_t m = bag.messages.size(); m > 0 && seen <= pages.size; --m) {
    throw_if_cancelled();
    const Result<std::string> data = messages.read(bag.messages[m - 1].where);
    if (!data) {
      num_whole = m - 1;
      fault = data.error().message;
    }
    if (fault.empty() && !pages.are_missing) break;  // one is enough of a file that looks whole
    // Of longer messages a page holds about an eighth of its size, the rest lies on pages of its own.
    seen += kLeastRow + std::min<std::uint64_t>(data ? data->size() : pages.size, pages.size / 16);
  }
  bag.messages.resize(num_whole);
  return fault;
}

/// What may be wrong with the log beside a file whose tables cannot be read; "" where it is not that.
std::string log_hint(const std::filesystem::path& path, const Pages& pages, Access access,
                     const std::string& fault) {
  const auto says = [&](const char* text) { return fault.find(text) != std::string::npos; };
  const std::string name = path.filename().string();
  if (access == Access::immutable && says("no such table"))
    return format("; is {}-wal missing? What was recorded last lies there: copy it with the file", name);
  if (pages.have_log && (says("unable to open") || says("readonly")))
    return format("; copy {0} and {0}-wal to a folder you can write to", name);
  return "";
}

}  // namespace

Result<Bag> open_sqlite_bag(const std::filesystem::path& path) {
  const Pages pages = pages_of(path);
  const Access access = access_to(path, pages);
  Result<Database> database = open_database(path, pages, access);
  if (!database) return fail(path.string(), database.error());
  Bag bag;
  bag.storage = "sqlite3";
  std::error_code ignored;
  bag.num_bytes = std::filesystem::file_size(path, ignored);
  const auto failed = [&](const Error& error) {
    return fail(path.string(), {error.message + log_hint(path, pages, access, error.message)});
  };
  if (const Result<> tables = check_tables(database->get()); !tables) return failed(tables.error());
  const Result<std::map<std::int64_t, BagTopic>> topics = read_topics(database->get());
  if (!topics) return failed(topics.error());
  std::map<std::int64_t, std::size_t> topic_of_id;
  for (const auto& [id, topic] : *topics) {
    topic_of_id[id] = bag.topics.size();
    bag.topics.push_back(topic);
  }
  const Result<std::string> listed = list_messages(database->get(), topic_of_id, bag);
  if (!listed) return fail(path.string(), listed.error());
  Result<Statement> by_id = prepare(database->get(), "SELECT data FROM messages WHERE id = ?");
  if (!by_id) return fail(path.string(), by_id.error());
  const auto messages = std::make_shared<Messages>(std::move(*database), std::move(*by_id));
  const std::string fault = drop_unreadable(bag, *messages, pages, *listed);
  if (!fault.empty() && bag.messages.empty())
    return fail(format("{}: no message can be read: {}; 'sqlite3 {} .recover' may save some", path.string(),
                       fault, path.filename().string()));
  if (!fault.empty())
    bag.warnings.push_back(
        format("{}: only the first {} messages can be read ({}); 'sqlite3 {} .recover' may save more",
               path.string(), bag.messages.size(), fault, path.filename().string()));
  std::ranges::stable_sort(bag.messages, {}, &BagMessage::log_time);
  bag.read = [messages](const BagMessage& message) { return messages->read(message.where); };
  return bag;
}

}  // namespace adit
