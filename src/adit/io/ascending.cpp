// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/ascending.hpp"

#include <algorithm>

#include "adit/core/format.hpp"
#include "adit/io/tum.hpp"

namespace adit {

std::vector<std::size_t> longest_ascending(std::span<const Stamp> stamps) {
  constexpr auto kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> ends;  // of the part of length k + 1 that ends earliest
  std::vector<std::size_t> before(stamps.size(), kNone);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto place =
        std::ranges::lower_bound(ends, stamps[i], {}, [&](std::size_t end) { return stamps[end]; });
    if (place != ends.begin()) before[i] = *(place - 1);
    if (place == ends.end())
      ends.push_back(i);
    else if (stamps[i] < stamps[*place])  // of equal ones the first stays
      *place = i;
  }
  std::vector<std::size_t> kept;
  for (std::size_t i = ends.empty() ? kNone : ends.back(); i != kNone; i = before[i]) kept.push_back(i);
  std::ranges::reverse(kept);
  return kept;
}

std::optional<std::string> note_of_left_out(std::string_view things, std::span<const Stamp> stamps,
                                            std::span<const std::size_t> kept) {
  if (kept.size() == stamps.size()) return std::nullopt;
  std::size_t first = 0;
  while (first < kept.size() && kept[first] == first) ++first;
  return format(
      "{} of {} {} are left out, whose stamps do not ascend with the others' (check the driver's clock); "
      "the first is at {} s",
      stamps.size() - kept.size(), stamps.size(), things, stamp_text(stamps[first]));
}

}  // namespace adit
