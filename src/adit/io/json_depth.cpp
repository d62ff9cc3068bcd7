// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/json_depth.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"

namespace adit {
namespace {

/// Far above what a JSON Robot Log has, six, and far below what the stack holds.
constexpr std::size_t kMaxJsonDepth = 100;

tl::unexpected<Error> too_deep(std::size_t at) {
  return fail(
      format("byte {}: lists and objects more than {} deep inside one another: this is not a JSON Robot Log",
             at, kMaxJsonDepth));
}

/// Steps through the items of CBOR without recursion. What is cut off or wrong ends it, as it ends the
/// parser.
class CborScanner {
 public:
  explicit CborScanner(std::string_view bytes) : bytes_(bytes) {}

  Result<> scan() {
    for (bool goes_on = true; goes_on && at_ < bytes_.size();) {
      throw_if_cancelled();
      const std::size_t begin = at_;
      goes_on = item();
      if (left_.size() > kMaxJsonDepth) return too_deep(begin);
    }
    return {};
  }

 private:
  /// False after the last one and where nothing can follow.
  bool item() {
    const auto head = static_cast<std::uint8_t>(bytes_[at_++]);
    const int kind = head >> 5U;
    const int length = head & 0x1FU;
    if (head == kBreak) {
      if (left_.empty() || left_.back() != kUntilBreak) return false;
      left_.pop_back();
      return close();
    }
    const bool has_no_end = length == 31;
    std::uint64_t argument = 0;
    if (!has_no_end && !read_argument(length, argument)) return false;
    if (kind == kBytes || kind == kText || kind == kList || kind == kMap || kind == kTag) {
      if (has_no_end) {
        left_.push_back(kUntilBreak);
        return true;
      }
      if (kind == kBytes || kind == kText) {
        if (argument > bytes_.size() - at_) return false;
        at_ += argument;
        return close();
      }
      // Each item takes a byte: with more of them than bytes the file is cut off, but it may nest before.
      const std::uint64_t count = kind == kTag ? 1 : std::min<std::uint64_t>(argument, bytes_.size());
      if (count == 0) return close();
      left_.push_back(kind == kMap ? 2 * count : count);
      return true;
    }
    return close();
  }

  bool read_argument(int length, std::uint64_t& argument) {
    argument = static_cast<std::uint64_t>(length);
    if (length < 24) return true;
    if (length > 27) return false;
    const std::size_t size = std::size_t{1} << static_cast<unsigned>(length - 24);
    if (size > bytes_.size() - at_) return false;
    argument = 0;
    for (std::size_t i = 0; i < size; ++i)
      argument = argument << 8U | static_cast<std::uint8_t>(bytes_[at_++]);
    return true;
  }

  /// An item has ended, and with it those of which it was the last.
  bool close() {
    while (!left_.empty() && left_.back() != kUntilBreak && --left_.back() == 0) left_.pop_back();
    return !left_.empty();
  }

  static constexpr std::uint8_t kBreak = 0xFF;
  static constexpr int kBytes = 2;
  static constexpr int kText = 3;
  static constexpr int kList = 4;
  static constexpr int kMap = 5;
  static constexpr int kTag = 6;
  static constexpr std::uint64_t kUntilBreak = ~std::uint64_t{0};

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::vector<std::uint64_t> left_;  ///< Items still to come, of each that is open.
};

}  // namespace

Result<> check_json_depth(std::string_view text) {
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string && c == '\\')
      ++i;  // what follows may be a quote
    else if (c == '"')
      in_string = !in_string;
    else if (!in_string && (c == '[' || c == '{') && ++depth > kMaxJsonDepth)
      return too_deep(i);
    else if (!in_string && (c == ']' || c == '}') && depth > 0)
      --depth;
  }
  return {};
}

Result<> check_cbor_depth(std::string_view bytes) { return CborScanner(bytes).scan(); }

}  // namespace adit
