// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/path.hpp"

#include <algorithm>
#include <cmath>

namespace adit {

std::optional<std::uint32_t> keyframe_at(const std::vector<double>& path_m, double metres) {
  if (path_m.empty() || metres < 0.0 || metres > path_m.back()) return {};
  return static_cast<std::uint32_t>(std::ranges::lower_bound(path_m, metres) - path_m.begin());
}

std::vector<std::uint32_t> evenly_spread(std::size_t size, std::size_t num) {
  std::vector<std::uint32_t> out;
  const std::size_t taken = std::min(size, num);
  for (std::size_t i = 0; i < taken; ++i)
    out.push_back(static_cast<std::uint32_t>((2 * i + 1) * size / (2 * taken)));
  return out;
}

const PcmLoop& nearest_loop(const std::vector<PcmLoop>& loops, const std::vector<double>& their_path_m,
                            std::size_t b) {
  return *std::ranges::min_element(
      loops, {}, [&](const PcmLoop& loop) { return std::abs(their_path_m[loop.b] - their_path_m[b]); });
}

}  // namespace adit
