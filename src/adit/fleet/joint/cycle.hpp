// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Going from robot to robot along the loops that join their maps and their odometries, and back to the
/// first.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/ids.hpp"
#include "adit/posegraph/pcm.hpp"

namespace adit {

/// When a cycle of merges contradicts them.
struct CycleConfig {
  double freedom = 24.0;
  double detour = 1.5;
  double detour_m = 10.0;
  int refuted_pairs = 2;
};
/// The keys are the names of the fields.
inline Fields fields_of(CycleConfig& c) {
  return {
      {"freedom", &c.freedom, "", 1.0, 1e6,
       "degrees of freedom of Student's t: the configured odometry noise counts as so many measurements of "
       "it, so that one slip by ten sigmas still counts as drift"},
      {"detour", &c.detour, "", 1.0, 100.0,
       "paths around a cycle are compared if at most this many times as long as the shortest one"},
      {"detour_m", &c.detour_m, "m", 0.0, 10000.0,
       "plus this; of these paths the one that closes best counts"},
      {"refuted_pairs", &c.refuted_pairs, "", 1, 10000,
       "pairs whose scans refute what merges together claim, before one of these is taken back"}};
}

/// The loops that join the maps of two robots; PcmLoop::a is a keyframe of robot a, b one of robot b.
struct Merge {
  /// Two different robots.
  ///@{
  RobotId a, b;
  ///@}
  double evidence = 0.0;       ///< As MergeCheck's.
  std::vector<PcmLoop> loops;  ///< At least one; their information is positive definite.
};

/// The odometry of each robot.
using Chains = std::map<RobotId, OdometryChain>;
/// Robots in the order in which a path or a cycle passes them, each once.
using Robots = std::vector<RobotId>;

/// The variance of the drift over the configured one, by what the first and the last loop of each merge leave
/// between them.
[[nodiscard]] double drift_scale(const std::vector<Merge>& merges, const Chains& chains,
                                 const CycleConfig& config);

/// Going around a cycle once.
struct Round {
  double miss_m = 0.0;     ///< From its beginning to its end.
  double driven_m = 0.0;   ///< Odometry in between.
  double log_ratio = 0.0;  ///< Logarithm of P(miss | drift) / P(miss | a wrong merge).
  /// Whether a wrong merge explains the miss better than drift does.
  [[nodiscard]] bool contradicts() const { return log_ratio < 0.0; }
};

/// Robots, and the merges that lead from each to the next and from the last to the first.
class Cycle {
 public:
  /// `scale`: drift_scale. `chains` must outlive the cycle.
  Cycle(const Robots& robots, const std::vector<const Merge*>& merges, const Chains& chains, double scale,
        const CycleConfig& config);

  /// Of the paths that drive little, the one that closes best: one bad loop condemns no merge.
  [[nodiscard]] Round best() const;

 private:
  /// A loop as it is passed on the way around.
  struct Passage {
    std::size_t from = 0;
    std::size_t to = 0;
    Pose T_from_to;
    Matrix6 covariance;
  };
  /// A passage of each leg.
  struct Path {
    std::vector<std::size_t> passages;
    double driven_m = 0.0;
  };
  /// Shortest ways to the passages of a leg.
  struct Reached {
    std::vector<double> driven_m;
    std::vector<std::size_t> from;  ///< The passage of the leg before.
  };
  [[nodiscard]] static std::vector<Passage> passages(const Merge& merge, RobotId from);
  /// Between arriving by passage p of a leg and leaving by passage q of the next.
  [[nodiscard]] double driven_m(std::size_t leg, std::size_t p, std::size_t q) const;
  [[nodiscard]] Reached step(const Reached& before, std::size_t leg) const;
  /// From passage p of leg `first` back to it.
  [[nodiscard]] Path shortest_through(std::size_t first, std::size_t p) const;
  [[nodiscard]] Round around(const Path& path) const;
  [[nodiscard]] double log_drift(const Vector6& miss, const Matrix6& covariance) const;
  [[nodiscard]] double log_elsewhere() const;

  double scale_;  ///< Of the covariances.
  CycleConfig config_;
  std::vector<std::vector<Passage>> legs_;     ///< From robot i to robot i + 1.
  std::vector<const OdometryChain*> arrives_;  ///< Odometry of robot i + 1.
};

}  // namespace adit
