// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <tuple>

#include "adit/fleet/merge/evidence_model.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"
#include "adit/fleet/sync/protocol.hpp"
#include "adit/registration/relief.hpp"

namespace adit {

/// How long tunnels agree that only look alike. The longer they have agreed, the likelier they go on: chance
/// resemblance ends soon, tunnels that were built alike do not. So the chance that they end is a hazard rate
/// that never rises, over phases that double in length (Grenander, "On the theory of mortality measurement",
/// 1956, with the pooling of neighbours replaced by a prior from the phase before).
class LookAlikes {
 public:
  /// Before anything is measured look-alikes agree at one more place with `prior_chance`, a belief that is
  /// worth `prior_steps` measured places.
  explicit LookAlikes(const EvidenceModel& model = {})
      : prior_chance_(model.prior_chance), prior_steps_(model.prior_steps) {}

  /// Look-alikes that had agreed at `passed` distinctive places agreed at the next one, or differed.
  ///@{
  void add_agreed(std::size_t passed) { add(passed, 0); }
  void add_differed(std::size_t passed) { add(passed, 1); }
  ///@}
  /// By all that was added and the prior; they never fall from one phase to the next.
  [[nodiscard]] ChancesToGoOn chances() const;

 private:
  struct Phase {
    std::size_t num_steps = 0;
    std::size_t num_ended = 0;
  };
  void add(std::size_t passed, std::size_t num_ended);

  double prior_chance_;
  double prior_steps_;
  std::array<Phase, std::tuple_size_v<ChancesToGoOn>> phases_{};
};

/// What a robot has measured on its own map, to judge what it shares with others.
struct Measured {
  LookAlikes look_alikes;  ///< What became of places that only look alike, followed along the path.
  EqualSignShares walls;   ///< Measured on its own walls seen twice, and on walls of places that look alike.
};
/// The same each time it is called; the first call measures, which takes seconds.
using MeasuredWhenAsked = std::function<const Measured&()>;

}  // namespace adit
