// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Turns candidates into loops: global registration of two keyframe clouds, accepted or rejected with a
/// reason.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "adit/fleet/merge/keyframe_store.hpp"
#include "adit/fleet/merge/loop_noise.hpp"
#include "adit/fleet/sync/peer_session.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// How candidates are registered, and which of those that fit are loops.
struct LoopRegistrationConfig {
  RegistrationConfig registration;  ///< The same that the FeatureStore computes features by.
  /// Farther apart, in metres, two scans may show the same walls, but it is not one place.
  double one_place_m = std::numeric_limits<double>::infinity();
  bool upright = false;  ///< Both robots stand on floors: no loop tilts one by more than 60 degrees.
  std::optional<LoopNoise> noise = {};        ///< Instead of what each registration says of itself.
  std::optional<LoopNoise> added_noise = {};  ///< Besides what it says.
};

/// Registers own keyframes with those of peers and with one another.
class LoopRegistration {
 public:
  /// `features` of the own map, which others may use as well.
  LoopRegistration(std::shared_ptr<FeatureStore> features, const LoopRegistrationConfig& config)
      : features_(std::move(features)), config_(config) {}

  /// Candidates whose clouds have come, in their order.
  [[nodiscard]] std::vector<LoopClosure> with_clouds(const std::vector<PeerSession::Arrived>& arrived,
                                                     const Clouds& clouds);
  /// Candidates within the own map, in their order.
  [[nodiscard]] std::vector<LoopClosure> within_own_map(const std::vector<LoopCandidate>& candidates);

 private:
  [[nodiscard]] LoopClosure registered(const LoopCandidate& candidate, const Features& match) const;

  std::shared_ptr<FeatureStore> features_;
  LoopRegistrationConfig config_;
};

}  // namespace adit
