// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/matching.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "adit/core/parallel.hpp"
#include "adit/registration/descriptor_index.hpp"

namespace adit {
namespace {

/// Matches of the smaller cloud's descriptors in the larger cloud; `a` is of the smaller.
std::vector<Correspondence> matches_from_smaller(const std::vector<Descriptor>& smaller,
                                                 const std::vector<Descriptor>& larger,
                                                 const RegistrationConfig& config) {
  const DescriptorIndex smaller_index(smaller);
  const DescriptorIndex larger_index(larger);
  const double max_squared = config.max_descriptor_distance * config.max_descriptor_distance;
  const double max_ratio = config.ratio_test ? config.max_ratio : 1.0;
  // a second neighbour beyond this cannot fail the ratio test of any match that is near enough
  const auto bound = static_cast<std::uint32_t>(std::ceil(max_squared / std::max(max_ratio, 0.1)));

  std::vector<Correspondence> found(smaller.size());  // ratio 1: no match
  parallel_for_each(
      smaller.size(),
      [&](std::size_t i) {
        const auto nearest = larger_index.nearest_two(smaller[i], bound);
        if (!nearest || nearest->squared_distance > max_squared) return;
        const double first = nearest->squared_distance;
        const double second = nearest->second_squared_distance;
        if (config.ratio_test && !(first < max_ratio * second)) return;
        const auto index = static_cast<std::uint32_t>(i);
        if (smaller_index.any_nearer(larger[nearest->index], nearest->squared_distance, index)) return;
        found[i] = {index, nearest->index, static_cast<float>(second > 0.0 ? first / second : 0.999)};
        found[i].ratio = std::min(found[i].ratio, 0.999F);
      },
      256);
  std::erase_if(found, [](const Correspondence& c) { return c.ratio >= 1.0F; });
  return found;
}

bool by_points(const Correspondence& x, const Correspondence& y) {
  return std::tie(x.a, x.b) < std::tie(y.a, y.b);
}

void keep_best_ratios(std::vector<Correspondence>& correspondences, std::size_t max_size) {
  if (correspondences.size() <= max_size) return;
  const auto by_ratio = [](const Correspondence& x, const Correspondence& y) {
    return std::tie(x.ratio, x.a, x.b) < std::tie(y.ratio, y.a, y.b);
  };
  std::nth_element(correspondences.begin(), correspondences.begin() + static_cast<std::ptrdiff_t>(max_size),
                   correspondences.end(), by_ratio);
  correspondences.resize(max_size);
}

}  // namespace

std::vector<Correspondence> match_descriptors(const std::vector<Descriptor>& a,
                                              const std::vector<Descriptor>& b,
                                              const RegistrationConfig& config) {
  if (a.empty() || b.empty()) return {};
  const bool a_is_smaller = a.size() <= b.size();
  std::vector<Correspondence> out =
      a_is_smaller ? matches_from_smaller(a, b, config) : matches_from_smaller(b, a, config);
  if (!a_is_smaller) {
    for (Correspondence& c : out) std::swap(c.a, c.b);
  }
  keep_best_ratios(out, static_cast<std::size_t>(config.max_correspondences));
  std::sort(out.begin(), out.end(), by_points);
  return out;
}

}  // namespace adit
