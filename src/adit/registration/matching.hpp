// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "adit/registration/features.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// Point `a` of one cloud and point `b` of the other, whose surroundings look alike.
struct Correspondence {
  std::uint32_t a = 0;  ///< Index of its descriptor.
  std::uint32_t b = 0;  ///< Index of its descriptor.
  float ratio = 1.0F;   ///< Squared descriptor distances, nearest to second nearest: small is distinctive.
  bool operator==(const Correspondence&) const = default;
};

/// Mutual nearest neighbours among the descriptors that pass the ratio test and the largest distance
/// (KISS-Matcher, section III-C). The ratio is tested from the smaller cloud into the larger. Of more than
/// `max_correspondences`, those with the best ratios are kept. In ascending order of (a, b).
[[nodiscard]] std::vector<Correspondence> match_descriptors(const std::vector<Descriptor>& a,
                                                            const std::vector<Descriptor>& b,
                                                            const RegistrationConfig& config);

}  // namespace adit
