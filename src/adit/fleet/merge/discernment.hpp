// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How well places can be told apart where a robot has been: measured on its own map, so that a merge is
/// judged by what this site and this sensor allow and by nothing that was tuned elsewhere.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "adit/fleet/merge/adaptive_config.hpp"
#include "adit/fleet/merge/keyframe_store.hpp"
#include "adit/fleet/merge/look_alikes.hpp"
#include "adit/registration/relief.hpp"

namespace adit {

/// Two keyframes of one map to be compared, and where odometry puts the second.
struct OwnComparison {
  std::uint32_t a = 0;  ///< Keyframe index.
  std::uint32_t b = 0;  ///< Keyframe index.
  Pose T_a_b;           ///< Where the fit starts. The identity asks whether another place looks the same.
};

/// Where it would show at a place that scans were displaced along the path: structures that differ, own
/// odometry frame, one list for each way that there is. Empty where one way does not show.
using DisplacementSigns = std::vector<std::vector<Vector3>>;

/// Each part is measured when it is first asked for; all together take some seconds of processor time.
class Discernment {
 public:
  /// Called once, when `measured` is first asked for.
  using FindLookAlikes = std::function<std::vector<LoopCandidate>()>;
  /// `chain`: the odometry of `map`. `find_look_alikes` names places of the map and others of it that look
  /// like them, all along the path.
  Discernment(const std::shared_ptr<const RobotMap>& map, OdometryChain chain,
              FindLookAlikes find_look_alikes, std::shared_ptr<FeatureStore> features,
              const AdaptiveConfig& config);

  /// Scans of one place do not differ by more than this (points of Agreement::largest_difference): the usual
  /// difference of neighbouring keyframes times an allowance, or `least_difference_m2`. 0 on a map too short
  /// to measure on: all differ.
  [[nodiscard]] double limit() const { return limit_; }
  /// Whether scans cannot be of one place; those with nothing in common differ.
  [[nodiscard]] bool differ(const Agreement& agreement) const {
    return !(agreement.largest_difference <= limit_);
  }
  /// Of each keyframe: whether scans displaced along the path, to either side, differ there.
  [[nodiscard]] std::vector<bool> distinctive(const std::vector<std::uint32_t>& keyframes);
  /// Of each keyframe: by what.
  [[nodiscard]] std::vector<DisplacementSigns> displacement_signs(
      const std::vector<std::uint32_t>& keyframes);
  /// The keyframes that stand displaced from this one along the path, to either side, by the distance that
  /// makes a place distinctive; fewer at the ends of the path.
  [[nodiscard]] std::vector<std::uint32_t> displaced_from(std::uint32_t keyframe) const;
  /// Metres of path after which the odometries of two robots are `reach_off_m` apart to the side, one
  /// standard deviation, by how the headings of the own one differ from those of scans. At least
  /// `shortest_reach_m`, also where too little could be measured; at most `longest_reach_m`
  /// (DiscernmentConfig).
  [[nodiscard]] double reach_m();
  /// How long look-alikes agree and how walls compare on the own map; valid as long as this.
  [[nodiscard]] const Measured& measured();

  /// Compares keyframes of the own map with one another.
  [[nodiscard]] std::vector<LocalFit> compare(const std::vector<OwnComparison>& asked, FitFrom from);
  /// The walls of such pairs that agree, by `found`, their fits.
  [[nodiscard]] std::vector<std::vector<PatchOffset>> walls_of(const std::vector<OwnComparison>& asked,
                                                               const std::vector<LocalFit>& found);
  /// Of the own keyframes; filled as comparisons need them.
  ///@{
  [[nodiscard]] ViewStore& views() { return views_; }
  [[nodiscard]] ScanStore& scans() { return scans_; }
  ///@}
  /// Of views and scans.
  [[nodiscard]] std::size_t num_cached_bytes() const { return views_.num_bytes() + scans_.num_bytes(); }
  /// What is needed later is computed again.
  void forget_cached() {
    views_.forget_all();
    scans_.forget_all();
  }

 private:
  [[nodiscard]] std::vector<LocalFit> compare(const std::vector<OwnComparison>& asked, FitFrom from,
                                              double good_enough);
  [[nodiscard]] std::vector<std::uint32_t> sampled() const;
  [[nodiscard]] std::vector<Vector3> differing(std::uint32_t keyframe, const Agreement& agreement) const;
  /// Of neighbouring keyframes; none where no two can be compared.
  [[nodiscard]] std::optional<double> usual_difference();
  [[nodiscard]] WallOffsets compare_own_walls();
  [[nodiscard]] WallOffsets compare_displaced_walls();
  [[nodiscard]] WallOffsets offsets_between(const std::vector<OwnComparison>& pairs);
  [[nodiscard]] double measure_reach();

  AdaptiveConfig config_;
  OdometryChain chain_;
  FindLookAlikes find_look_alikes_;
  std::shared_ptr<FeatureStore> features_;
  ViewStore views_;
  ScanStore scans_;
  double limit_ = 0.0;
  std::optional<Measured> measured_;
  std::optional<double> reach_m_;
  std::map<std::uint32_t, DisplacementSigns> signs_;
};

}  // namespace adit
