// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/loop_stats.hpp"

#include <numbers>

namespace adit {
namespace {

double percent(int part, int total) { return total == 0 ? 0.0 : 100.0 * part / total; }

}  // namespace

std::string_view to_string(LoopClass loop_class) {
  switch (loop_class) {
    case LoopClass::correct:
      return "correct";
    case LoopClass::wrong_place:
      return "wrong_place";
    case LoopClass::wrong_registration:
      return "wrong_registration";
  }
  return "unknown";
}

LoopClass classify(const LoopClosure& loop, const Pose& T_world_from, const Pose& T_world_to,
                   const LoopTolerance& tolerance) {
  const Pose T_from_to = T_world_from.inverse() * T_world_to;
  if (T_from_to.translation().norm() > tolerance.place_m) return LoopClass::wrong_place;
  const Pose error = T_from_to.inverse() * loop.T_from_to;
  const double rotation_deg = error.angle() * 180.0 / std::numbers::pi;
  if (error.translation().norm() > tolerance.translation_m || rotation_deg > tolerance.rotation_deg) {
    return LoopClass::wrong_registration;
  }
  return LoopClass::correct;
}

void LoopCounts::add(LoopClass loop_class) {
  ++total;
  wrong_place += loop_class == LoopClass::wrong_place ? 1 : 0;
  wrong_registration += loop_class == LoopClass::wrong_registration ? 1 : 0;
}

double LoopCounts::wrong_place_pct() const { return percent(wrong_place, total); }
double LoopCounts::wrong_registration_pct() const { return percent(wrong_registration, total); }

LoopCounts& LoopCounts::operator+=(const LoopCounts& other) {
  total += other.total;
  wrong_place += other.wrong_place;
  wrong_registration += other.wrong_registration;
  return *this;
}

}  // namespace adit
