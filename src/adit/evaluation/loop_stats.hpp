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
[[nodiscard]] std::string_view to_string(LoopClass loop_class);

/// The thresholds of the definition; those of the paper, section 3.2, where it states them.
struct LoopTolerance {
  double place_m = 10.0;
  double translation_m = 1.0;
  double rotation_deg = 15.0;
};

/// `T_world_from` and `T_world_to` are the true poses of the loop's two keyframes. On a threshold a loop
/// still counts as correct.
[[nodiscard]] LoopClass classify(const LoopClosure& loop, const Pose& T_world_from, const Pose& T_world_to,
                                 const LoopTolerance& tolerance = {});

struct LoopCounts {
  int total = 0;
  int wrong_place = 0;
  int wrong_registration = 0;

  void add(LoopClass loop_class);
  [[nodiscard]] int wrong() const { return wrong_place + wrong_registration; }
  [[nodiscard]] int correct() const { return total - wrong(); }
  /// Per cent of all loops; 0 when there are none.
  [[nodiscard]] double wrong_place_pct() const;
  [[nodiscard]] double wrong_registration_pct() const;
  LoopCounts& operator+=(const LoopCounts& other);
  bool operator==(const LoopCounts&) const = default;
};

}  // namespace adit
