// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "adit/core/records.hpp"

namespace adit {

/// What the ground truth says about a loop.
enum class LoopClass {
  correct,
  wrong_place,         ///< The two keyframes are more than 10 m apart.
  wrong_registration,  ///< The place is right, but T_from_to errs by more than 1 m or more than 15 degrees.
};
[[nodiscard]] std::string_view to_string(LoopClass loop_class);  ///< As the values are spelled.

/// The thresholds of the definition; those of the paper, section 3.2, where it states them.
struct LoopTolerance {
  double place_m = 10.0;       ///< True distance of the two keyframes.
  double translation_m = 1.0;  ///< Error of T_from_to.
  double rotation_deg = 15.0;  ///< Error of T_from_to, angle of the whole rotation.
};

/// `T_world_from` and `T_world_to` are the true poses of the loop's two keyframes. On a threshold a loop
/// still counts as correct.
[[nodiscard]] LoopClass classify(const LoopClosure& loop, const Pose& T_world_from, const Pose& T_world_to,
                                 const LoopTolerance& tolerance = {});

/// Loops by class.
struct LoopCounts {
  int total = 0;               ///< Correct ones included.
  int wrong_place = 0;         ///< As in `LoopClass`.
  int wrong_registration = 0;  ///< As in `LoopClass`.

  /// Counts one loop.
  void add(LoopClass loop_class);
  /// Of either wrong class, and the others.
  ///@{
  [[nodiscard]] int wrong() const { return wrong_place + wrong_registration; }
  [[nodiscard]] int correct() const { return total - wrong(); }
  ///@}
  /// Per cent of all loops; 0 when there are none.
  ///@{
  [[nodiscard]] double wrong_place_pct() const;
  [[nodiscard]] double wrong_registration_pct() const;
  ///@}
  /// Counts the loops of the other too.
  LoopCounts& operator+=(const LoopCounts& other);
  bool operator==(const LoopCounts&) const = default;
};

}  // namespace adit
