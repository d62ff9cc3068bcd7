// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/progress.hpp"

namespace adit {

/// The phases that run at one moment, as a tree. Not synchronised; times are the caller's, on any clock.
class PhaseTree {
 public:
  /// A time on the caller's clock.
  using Seconds = std::chrono::duration<double>;

  /// A phase that has begun and not ended.
  struct Running {
    PhaseId id = 0;         ///< Given out by `begin`: from 1 on, none twice.
    PhaseId parent = 0;     ///< The phase around it; 0: none.
    std::string name;       ///< As progress_line() shows it.
    std::size_t total = 0;  ///< Steps; 0: unknown.
    std::size_t done = 0;   ///< Steps so far; may exceed `total`.
    Seconds begin{};        ///< When the phase began.
  };

  /// A phase of `total` steps (0: unknown) begins inside `parent` (0: inside none). Returns its id.
  PhaseId begin(std::string_view name, std::size_t total, PhaseId parent, Seconds now);
  /// Does nothing where the phase has ended already.
  ///@{
  void advance(PhaseId phase, std::size_t steps);
  void end(PhaseId phase);
  ///@}

  /// From an outermost phase inwards, as long as one phase alone runs inside the last. Robots that are mapped
  /// in parallel are thus one phase; of pairs that meet one after the other the current one is shown.
  [[nodiscard]] std::vector<Running> chain() const;

 private:
  std::vector<Running> running_;  ///< In the order in which they began.
  PhaseId last_ = 0;
};

/// Seconds that the rest of a phase takes at its pace so far; none before its first step is done or if its
/// number of steps is unknown.
[[nodiscard]] std::optional<double> seconds_left(const PhaseTree::Running& phase, PhaseTree::Seconds now);

/// "40 s", "3 min 20 s", "2 h 05 min": rounded to what a person needs.
[[nodiscard]] std::string rough_time(double seconds);

/// One line of at most `width` columns: "meetings 2/6, registering [######    ] 60 %, 12 s left (all: 3 min
/// 20 s)". Empty when nothing runs.
[[nodiscard]] std::string progress_line(const std::vector<PhaseTree::Running>& chain, PhaseTree::Seconds now,
                                        std::size_t width);

}  // namespace adit
