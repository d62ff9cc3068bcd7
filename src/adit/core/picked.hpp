// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

namespace adit {

/// The values at these positions, in their order; each position is within `values`.
template <class T>
[[nodiscard]] std::vector<T> picked(const std::vector<T>& values, const std::vector<std::size_t>& positions) {
  std::vector<T> out;
  out.reserve(positions.size());
  for (const std::size_t i : positions) out.push_back(values[i]);
  return out;
}

}  // namespace adit
