// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether the loops between two robots may join their maps: a test with a stated error rate, calibrated by
/// what the robot has seen itself, so that nothing is tuned to a site.
///
/// Loops that agree with one another lay one map over the other. Where that is true, the scans of both agree
/// all along the stretch that both drove; where one tube only looks like another, they agree for a while and
/// then one has a niche, a bend or a side passage that the other has not. How long they agree by chance
/// differs from site to site, and each robot can measure it: two of its own places that odometry keeps apart,
/// but that look alike, are a wrong merge whose outcome is known.
///
/// The decision is Wald's sequential probability ratio test ("Sequential tests of statistical hypotheses",
/// 1945): the logarithms of likelihood ratios add up, and maps are joined above log(1 / error_rate).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/fleet/protocol.hpp"
#include "adit/place/place_index.hpp"
#include "adit/posegraph/pcm.hpp"
#include "adit/registration/agreement.hpp"
#include "adit/registration/registration.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

class FeatureStore;

struct MergeCheckConfig {
  double error_rate = 1e-4;
  double spacing_m = 3.0;
  int max_checks = 80;
};
inline Fields fields_of(MergeCheckConfig& c) {
  return {{"error_rate", &c.error_rate, "", 1e-12, 0.5, "chance that a wrong merge passes"},
          {"spacing_m", &c.spacing_m, "m", 0.1, 1000.0, "way between two places where maps are compared"},
          {"max_checks", &c.max_checks, "", 1, 10000, "places that are compared at most, for two robots"}};
}

/// How well one robot can tell the places of its own map apart. Scans that were taken farther from one
/// another see less of the same, whatever else is true: each distance has numbers of its own.
struct Discernment {
  struct Range {
    double threshold = 1.0;  ///< Agreement that nine of ten pairs of keyframes of one place reach.
    int num_checked = 0;     ///< Places next to accepted look-alikes, by the same alignment,
    int num_passed = 0;      ///< and of these, in agreement.

    /// Of a false alignment: the chance that a place near by agrees as well.
    [[nodiscard]] double false_check() const { return (num_passed + 1.0) / (num_checked + 2.0); }
  };
  static constexpr std::array<double, 3> kDistances = {0.5, 1.0, 2.0};  ///< Metres, of the ranges.
  std::array<Range, 3> ranges;

  [[nodiscard]] const Range& at(double distance_m) const;
};
[[nodiscard]] Discernment discernment(const RobotMap& map, FeatureStore& features,
                                      const PlaceIndexConfig& place, const RegistrationConfig& registration,
                                      const MergeCheckConfig& config);

/// Of each keyframe the descriptor distance of the most similar one that odometry puts elsewhere; 1 where
/// there is none.
[[nodiscard]] std::vector<double> likeness_of_other_places(const RobotMap& map,
                                                           const PlaceIndexConfig& place);

/// Two keyframes that stand next to one another if the loops are true.
struct PlannedCheck {
  std::uint32_t own = 0;
  std::uint32_t theirs = 0;
  Pose T_own_theirs;
};
/// Along the whole stretch that both drove, as far as `loops` (which agree with one another) say.
[[nodiscard]] std::vector<PlannedCheck> plan_checks(const OdometryChain& own, const OdometryChain& theirs,
                                                    const std::vector<PcmLoop>& loops,
                                                    const MergeCheckConfig& config);

/// Agreement at the best alignment near `T_a_b`; of nothing when there is none within two metres.
[[nodiscard]] Agreement agreement_near(const OrientedPoints& a, const OrientedPoints& b, const Pose& T_a_b,
                                       const RegistrationConfig& config);

/// One place where two maps were compared.
struct CheckedPlace {
  double distance_m = 0.0;  ///< Between the two keyframes.
  double confirmed = 0.0;   ///< Their agreement.
};

/// The test. `num_rivals`: loops that registration accepted and that do not agree with the others.
[[nodiscard]] MergeCheck judge_merge(RobotId a, RobotId b, const Discernment& known, std::size_t num_rivals,
                                     const std::vector<CheckedPlace>& places, const MergeCheckConfig& config);

}  // namespace adit
