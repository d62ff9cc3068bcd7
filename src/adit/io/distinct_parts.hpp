// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The parts of a file that its index names.
#pragma once

#include <cstdint>
#include <iterator>
#include <limits>
#include <map>

namespace adit {

/// No two parts of a whole index overlap. Without this check a small file could name one part a million
/// times, and its messages would fill the memory.
class DistinctParts {
 public:
  /// Takes `size` bytes from `begin` on. False where they overlap a part taken before, or wrap around.
  [[nodiscard]] bool add(std::uint64_t begin, std::uint64_t size) {
    if (size > std::numeric_limits<std::uint64_t>::max() - begin) return false;
    if (size == 0) return true;
    const auto next = end_of_.upper_bound(begin);
    if (next != end_of_.end() && next->first < begin + size) return false;
    if (next != end_of_.begin() && std::prev(next)->second > begin) return false;
    end_of_.emplace_hint(next, begin, begin + size);
    return true;
  }

 private:
  std::map<std::uint64_t, std::uint64_t> end_of_;  ///< By where the part begins.
};

}  // namespace adit
