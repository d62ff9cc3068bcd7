// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The bytes of a message, written and read one after the other. Each type of the protocol has a `put` and a
/// `get` in this namespace (wire.cpp, wire_merge_checks.cpp), which `vector` finds by the Writer or Reader
/// that they take.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace adit::wire {

static_assert(std::endian::native == std::endian::little,
              "the wire is little-endian, as all machines that adit runs on");

/// Appends values, little-endian and without gaps.
class Writer {
 public:
  /// A number or an enumerator, in as many bytes as it has in memory.
  template <class T>
  void scalar(T value) {
    const auto* begin = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), begin, begin + sizeof(T));
  }
  /// How many items, in 32 bits, then each by its `put`.
  template <class T>
  void vector(const std::vector<T>& items) {
    scalar(static_cast<std::uint32_t>(items.size()));
    for (const T& item : items) put(*this, item);
  }
  /// All that was written. Ends the writer.
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads until the bytes end; from then on every value is zero and `ok` is false.
class Reader {
 public:
  /// `bytes` must outlive the reader. `version`: of the protocol that they follow.
  Reader(std::span<const std::byte> bytes, std::uint8_t version) : bytes_(bytes), version_(version) {}
  /// That of the protocol.
  [[nodiscard]] std::uint8_t version() const { return version_; }
  /// The next number or enumerator; enumerators are not checked.
  template <class T>
  T scalar() {
    T value{};
    if (bytes_.size() - at_ < sizeof(T)) {
      ok_ = false;
      at_ = bytes_.size();
      return value;
    }
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  /// Appends the items, each by its `get`. Refuses more than `max_items`, and more than there are bytes left.
  template <class T>
  void vector(std::vector<T>& items, std::size_t max_items = std::numeric_limits<std::size_t>::max()) {
    const auto size = scalar<std::uint32_t>();
    // Every item takes at least a byte: a damaged count must not make us allocate gigabytes.
    if (size > max_items || size > bytes_.size() - at_) return refuse();
    for (std::uint32_t i = 0; i < size && ok_; ++i) get(*this, items.emplace_back());
  }
  /// For a value that cannot be: `ok` is false from now on.
  void refuse() { ok_ = false; }
  /// Whether all values so far were whole and none was refused.
  [[nodiscard]] bool ok() const { return ok_; }
  /// How many bytes were read.
  [[nodiscard]] std::size_t at() const { return at_; }
  /// Whether all bytes were read: a whole message has none behind its last value.
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
  std::uint8_t version_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

/// As many bytes as the text has, behind their number.
///@{
inline void put(Writer& out, const std::string& text) {
  out.scalar(static_cast<std::uint32_t>(text.size()));
  for (const char c : text) out.scalar(c);
}
inline void get(Reader& in, std::string& text) {
  const auto size = in.scalar<std::uint32_t>();
  for (std::uint32_t i = 0; i < size && in.ok(); ++i) text.push_back(in.scalar<char>());
}
///@}

/// A share from 0 to 1, preceded by a flag byte; absent before version 12.
///@{
template <class Share>
void put_share(Writer& out, const std::optional<Share>& share) {
  out.scalar(static_cast<std::uint8_t>(share ? 1 : 0));
  if (share) out.scalar(*share);
}
template <class Share>
void get_share(Reader& in, std::optional<Share>& share) {
  constexpr std::uint8_t kFirstWithShares = 12;
  if (in.version() < kFirstWithShares || in.scalar<std::uint8_t>() == 0) return;
  share = in.scalar<Share>();
  if (!(*share >= Share{0} && *share <= Share{1})) in.refuse();
}
///@}

}  // namespace adit::wire
