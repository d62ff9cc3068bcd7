// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Recorded ROS messages, whatever file or folder they lie in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/core/time.hpp"
#include "adit/io/byte_source.hpp"
#include "adit/io/cdr.hpp"

namespace adit {

/// A name under which messages of one type were recorded.
struct BagTopic {
  std::string name;      ///< As recorded, mostly with a slash at the front: "/husky1/points".
  std::string type;      ///< "sensor_msgs/msg/PointCloud2"; "" where the file does not say.
  std::string encoding;  ///< "cdr" or "ros1"
};

/// What the index knows of a message.
struct BagMessage {
  std::size_t topic = 0;    ///< Index into Bag::topics.
  Stamp log_time;           ///< When it was recorded.
  std::uint64_t where = 0;  ///< For `read` alone.
};

/// The index is in memory, messages are read when asked for.
struct Bag {
  std::string storage;               ///< "mcap", "sqlite3" or "ros1"
  std::size_t num_files = 1;         ///< More than one where a recording was split.
  std::uint64_t num_bytes = 0;       ///< Of the files.
  std::string profile;               ///< Of MCAP: "ros2"; else "".
  std::size_t num_chunks = 0;        ///< Of MCAP.
  std::vector<BagTopic> topics;      ///< No two of one name and type.
  std::vector<BagMessage> messages;  ///< By log time; equal times in the order of the file.
  /// What adit said of its own recording (mcap_output.hpp); nothing in files of others.
  std::optional<std::map<std::string, std::string>> own;
  std::vector<std::string> warnings;  ///< What could not be read, a sentence each with its remedy.
  /// The content of a message; may be called from any thread.
  std::function<Result<std::string>(const BagMessage&)> read;
};

/// The content of a message, decoded by a function of ros_messages.hpp.
template <class Decode>
[[nodiscard]] auto decoded(const Bag& bag, const BagMessage& message, Decode decode) {
  const bool is_ros1 = bag.topics[message.topic].encoding == "ros1";
  return bag.read(message).and_then([&](const std::string& content) {
    return decode(content, is_ros1 ? MessageEncoding::ros1 : MessageEncoding::cdr);
  });
}

/// Topics by name and type, each once. Files may have any number of connections.
class TopicIndex {
 public:
  /// That of the topic with this name and type in `topics`, which is added if it is missing. Always the same
  /// `topics`, which nothing else changes.
  [[nodiscard]] std::size_t of(const BagTopic& topic, std::vector<BagTopic>& topics);

 private:
  std::map<std::pair<std::string, std::string>, std::size_t> known_;
};

/// What to tell where the data of a bag were read without its index. `fault`: of the index; `tool`: the
/// command that writes a new one.
[[nodiscard]] std::string index_warning(std::string_view fault, std::size_t num_messages,
                                        std::string_view tool);

/// The time itself within kLargestStamp (tum.hpp); beyond it, where only damaged files have one, the nearest.
/// Differences then fit into 64 bits.
[[nodiscard]] Stamp usable_log_time(Stamp time);

/// Opens
///  - FILE.mcap, with or without chunks, index, lz4 and zstd;
///  - FILE.db3, the sqlite storage of rosbag2;
///  - FILE.bag, of ROS 1: chunks plain, bz2 or lz4, with or without index (ros1_bag.hpp);
///  - FOLDER: a bag folder of rosbag2, its files in the order of metadata.yaml, or by name where there is
///    none, or one that says nothing; where there is none, a warning says so of files that are more than a
///    minute apart, or overlap. Files that were compressed as a whole (.db3.zstd) are an error with
///    the remedy; one that is missing or cannot be read is left out with a warning, as long as another one
///    can be.
/// Messages that were compressed one by one (zstd, compression mode MESSAGE of rosbag2) are expanded.
[[nodiscard]] Result<Bag> open_bag(const std::filesystem::path& path);
/// Of an MCAP file, wherever its bytes come from. Errors name the byte, not the file.
[[nodiscard]] Result<Bag> open_mcap_bag(ByteSource source);

/// Whether the name is that of a file of a bag.
[[nodiscard]] bool is_bag_file(const std::filesystem::path& path);

/// Fails, with the remedy, on a file that was compressed as a whole (.db3.zstd, .bag.gz).
[[nodiscard]] Result<> check_not_packed(const std::filesystem::path& path);

/// Fails, naming the folder to give, on the metadata.yaml of a bag folder, which is no recording by itself.
[[nodiscard]] Result<> check_not_metadata(const std::filesystem::path& path);

/// Whether `folder` is a bag folder: it has the metadata.yaml of rosbag2, or no files of clouds but of bags.
[[nodiscard]] bool is_bag_folder(const std::filesystem::path& folder);

/// The messages of the first so many seconds, the first three of each topic, and all of topics whose name
/// ends in "_static".
[[nodiscard]] Bag beginning_of(Bag bag, double seconds);

/// Several files of one recording as one bag; messages of all are put in order. `parts`: at least one.
[[nodiscard]] Bag joined(std::vector<Bag> parts);

}  // namespace adit
