// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

namespace adit {

/// The items of `all` from number `first` on, at most `size` at a time: `visit(number of the first, items)`.
template <class T, class Visit>
void for_parts(const std::vector<T>& all, std::size_t first, std::size_t size, const Visit& visit) {
  for (std::size_t begin = std::min(first, all.size()); begin < all.size(); begin += size) {
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto to = all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), begin + size));
    visit(static_cast<std::uint32_t>(begin), std::vector<T>(from, to));
  }
}

/// Moves `more` to the end of `to`.
template <class T>
void append(std::vector<T>& to, std::vector<T> more) {
  std::ranges::move(more, std::back_inserter(to));
}

}  // namespace adit
