// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The records of bags of ROS 1, put together by hand.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "adit/core/format.hpp"
#include "adit/core/pose.hpp"
#include "adit/core/time.hpp"
#include "adit/io/packed_cloud.hpp"

namespace adit::test::ros1 {

inline constexpr std::string_view kMagic = "#ROSBAG V2.0\n";

/// Numbers without alignment, texts behind their length.
class Ros1Writer {
 public:
  template <class T>
  Ros1Writer& number(T value) {
    append_little_endian(bytes_, value);
    return *this;
  }
  Ros1Writer& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_.append(value);
    return *this;
  }
  Ros1Writer& header(Stamp stamp, std::string_view frame) {
    number(std::uint32_t{42}).number(static_cast<std::uint32_t>(stamp.ns / 1'000'000'000));
    return number(static_cast<std::uint32_t>(stamp.ns % 1'000'000'000)).text(frame);
  }
  Ros1Writer& pose(const Pose& pose) {
    for (const double value : pose.translation()) number(value);
    for (const double value : pose.rotation().coeffs()) number(value);
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

inline std::string field(std::string_view name, std::string_view value) {
  return Ros1Writer().text(format("{}={}", name, value)).bytes();
}
template <class T>
std::string field_of(std::string_view name, T value) {
  return field(name, Ros1Writer().number(value).bytes());
}
inline std::string record(const std::string& header, std::string_view data) {
  return Ros1Writer().text(header).text(data).bytes();
}

struct Ros1Message {
  std::uint32_t connection = 0;
  Stamp time;
  std::string data;
};

inline std::string message_record(const Ros1Message& message) {
  const std::uint64_t time = static_cast<std::uint64_t>(message.time.ns / 1'000'000'000) |
                             static_cast<std::uint64_t>(message.time.ns % 1'000'000'000) << 32U;
  return record(
      field_of("op", std::uint8_t{2}) + field_of("conn", message.connection) + field_of("time", time),
      message.data);
}

inline std::string connection_record(std::uint32_t id, const std::string& topic, const std::string& type) {
  return record(field_of("op", std::uint8_t{7}) + field_of("conn", id) + field("topic", topic),
                field("topic", topic) + field("type", type));
}

inline std::string bag_header(std::uint64_t index_at, std::uint32_t num_connections,
                              std::uint32_t num_chunks) {
  return record(field_of("op", std::uint8_t{3}) + field_of("index_pos", index_at) +
                    field_of("conn_count", num_connections) + field_of("chunk_count", num_chunks),
                std::string(100, ' '));
}

/// `size`: of the records in `data`, expanded.
inline std::string chunk_record(std::string_view compression, std::size_t size, std::string_view data) {
  return record(field_of("op", std::uint8_t{5}) + field("compression", compression) +
                    field_of("size", static_cast<std::uint32_t>(size)),
                data);
}
inline std::string chunk_record(const std::string& records) {
  return chunk_record("none", records.size(), records);
}

/// What the index says of a chunk at this byte with `num` messages of one connection.
inline std::string chunk_info_record(std::size_t at, std::uint32_t connection, std::uint32_t num) {
  return record(field_of("op", std::uint8_t{6}) + field_of("ver", std::uint32_t{1}) +
                    field_of("chunk_pos", std::uint64_t{at}) + field_of("count", std::uint32_t{1}),
                Ros1Writer().number(connection).number(num).bytes());
}
/// What stands behind a chunk: `entries` are times and offsets of `num` messages of one connection.
inline std::string index_record(std::uint32_t connection, std::uint32_t num, std::string_view entries) {
  return record(field_of("op", std::uint8_t{4}) + field_of("ver", std::uint32_t{1}) +
                    field_of("conn", connection) + field_of("count", num),
                entries);
}

}  // namespace adit::test::ros1
