// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>

#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"
#include "adit/evaluation/statistics.hpp"
#include "adit/robot/scan_motion.hpp"
#include "adit/robot/sensor_checks.hpp"
#include "adit/robot/wheel_comparison.hpp"

namespace adit {
namespace {

constexpr std::size_t kBatch = 12;   // stretches; a second batch follows where one tells too little
constexpr std::size_t kLength = 25;  // scans of a stretch
constexpr Duration kLongestStep = std::chrono::milliseconds(300);  // three scans of a usual LiDAR
constexpr Duration kHalfWindow = std::chrono::milliseconds(100);   // of rates: a scan to either side
constexpr std::size_t kEnoughRates = 150;  // three seconds; the turning between scans has little noise
// Deviations of a step, as stated, up to which it counts as measured. Where the scene fixes all six
// directions they are a fifth of that; above, steps were seen that were off by far more than they stated.
constexpr double kTurnSigma = 0.0005;  // radians
constexpr double kAheadSigma = 0.005;  // metres
constexpr double kUnknown = 10.0;      // metres and radians, along directions that the scan leaves open
constexpr double kLeastDriven = 0.5;   // metres: shorter stretches say too little of the scale

using Indices = std::span<const std::size_t>;

// How unevenly the robot turns during these scans, by the wheels: the variance of its rate. None where wheels
// or scans were silent.
std::optional<double> unevenness(const Recording& recording, const Growth& turn, Indices scans) {
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t k = 1; k < scans.size(); ++k) {
    const Stamp begin = recording.scan_stamps[scans[k - 1]];
    const Stamp end = recording.scan_stamps[scans[k]];
    const double rate = (turn.at(end) - turn.at(begin)) / to_seconds(end - begin);
    if (end - begin > kLongestStep || !std::isfinite(rate)) return std::nullopt;
    sum += rate;
    squares += rate * rate;
  }
  const auto n = static_cast<double>(scans.size() - 1);
  return squares / n - sum * sum / (n * n);
}

// Stretches of `scans` that do not overlap, the best first.
std::vector<Indices> choose_stretches(const Recording& recording, const Growth& turn, Indices scans) {
  struct Candidate {
    std::size_t first;
    double unevenness;
  };
  std::vector<Candidate> candidates;
  for (std::size_t first = 0; first + kLength <= scans.size(); first += kLength / 5)
    if (const auto value = unevenness(recording, turn, scans.subspan(first, kLength)))
      candidates.push_back({first, *value});
  std::ranges::stable_sort(candidates, std::ranges::greater{}, &Candidate::unevenness);
  std::vector<std::size_t> chosen;
  for (const Candidate& candidate : candidates) {
    const bool is_free = std::ranges::all_of(chosen, [&](std::size_t other) {
      return candidate.first + kLength <= other || other + kLength <= candidate.first;
    });
    if (is_free && chosen.size() < 2 * kBatch) chosen.push_back(candidate.first);
  }
  std::vector<Indices> stretches;
  for (const std::size_t first : chosen) stretches.push_back(scans.subspan(first, kLength));
  return stretches;
}

// The motion from one scan to the next, as the scans measured it.
struct ScanStep {
  Stamp begin;
  Stamp end;
  std::optional<double> turn;
  std::optional<double> ahead;
};

ScanStep step_between(const OdometryStep& before, const OdometryStep& after) {
  ScanStep step{before.stamp, after.stamp, {}, {}};
  if (after.status != StepStatus::ok && after.status != StepStatus::degenerate) return step;
  const Matrix6 covariance =
      inverse(Matrix6(after.information + Matrix6::Identity() / (kUnknown * kUnknown)));
  const Pose motion = before.T_odom_base.inverse() * after.T_odom_base;
  if (std::sqrt(covariance(5, 5)) < kTurnSigma) step.turn = motion.yaw();
  if (after.status == StepStatus::ok && std::sqrt(covariance(0, 0)) < kAheadSigma)
    step.ahead = motion.translation().x();
  return step;
}

struct Stretch {
  std::vector<ScanStep> steps;
  bool has_times = true;
};

Stretch measured(const Recording& recording, Indices indices) {
  const ScanMotion motion = motion_of_scans(recording, indices);
  Stretch stretch;
  stretch.has_times = motion.has_times;
  for (std::size_t k = kSettlingScans; k < motion.steps.size(); ++k)
    stretch.steps.push_back(step_between(motion.steps[k - 1], motion.steps[k]));
  return stretch;
}

Growth turns_of(const std::vector<Stretch>& stretches) {
  Growth turn(kLongestStep);
  for (const Stretch& stretch : stretches) {
    double angle = Growth::kNothing;
    for (const ScanStep& step : stretch.steps) {
      if (std::isnan(angle)) {
        angle = 0.0;
        turn.add(step.begin - Duration(1), Growth::kNothing);
        turn.add(step.begin, angle);
      }
      angle = step.turn ? angle + *step.turn : Growth::kNothing;
      if (step.turn) turn.add(step.end, angle);
    }
  }
  return turn;
}

// Metres driven and counted in the steps of a stretch whose motion ahead was measured.
struct Ahead {
  double driven = 0.0;
  double counted = 0.0;
};
Ahead ahead_of(const Stretch& stretch, const Growth& wheels, Duration late) {
  Ahead sum;
  for (const ScanStep& step : stretch.steps) {
    const double counted = wheels.at(step.end + late) - wheels.at(step.begin + late);
    if (!step.ahead || !std::isfinite(counted)) continue;
    sum.driven += *step.ahead;
    sum.counted += counted;
  }
  return sum;
}

// Metres driven per metre counted, over the stretches; none where they do not agree or are too few.
std::optional<double> scale_ahead(const std::vector<Stretch>& stretches, const Growth& wheels,
                                  Duration late) {
  constexpr std::size_t kFew = 4;
  constexpr double kAgree = 0.03;  // median of the stretches' differences
  std::vector<double> ratios;
  for (const Stretch& stretch : stretches) {
    const Ahead ahead = ahead_of(stretch, wheels, late);
    if (std::abs(ahead.counted) >= kLeastDriven) ratios.push_back(ahead.driven / ahead.counted);
  }
  if (ratios.size() < kFew) return std::nullopt;
  const double middle = median(ratios);
  std::vector<double> off;
  for (const double ratio : ratios) off.push_back(std::abs(ratio - middle));
  if (median(off) > kAgree) return std::nullopt;
  return middle;
}

// Compares the wheels with stretches of scans; these are by time.
WheelComparison compare(const Growths& wheels, const std::vector<Stretch>& stretches) {
  constexpr double kSweep = 0.1;
  WheelComparison comparison;
  const Growth turn = turns_of(stretches);
  if (!turn.empty()) comparison.turns = compare_turns(wheels.turn, turn, kHalfWindow);
  comparison.turns.num_enough = kEnoughRates;
  const Duration late = comparison.turns.agrees() ? from_seconds(comparison.turns.late_s) : Duration(0);
  comparison.ahead = scale_ahead(stretches, wheels.forward, late);
  comparison.is_backward = comparison.ahead && *comparison.ahead < 0.0;
  // Without times of the points it is not known where in a sweep its stamp lies.
  if (!std::ranges::all_of(stretches, &Stretch::has_times)) comparison.clock_tolerance_s += kSweep;
  return comparison;
}

// By as many batches of stretches as it takes to tell, or as there are.
WheelComparison compared_with_scans(const Recording& recording) {
  const Growths wheels = growths_of(recording.wheel);
  const std::vector<std::size_t> scans = scans_to_check(recording);
  const std::vector<Indices> chosen = choose_stretches(recording, wheels.turn, scans);
  std::vector<Stretch> stretches;
  WheelComparison comparison;
  for (std::size_t first = 0; first < chosen.size(); first += kBatch) {
    std::vector<Stretch> batch(std::min(kBatch, chosen.size() - first));
    parallel_for_each(batch.size(),
                      [&](std::size_t i) { batch[i] = measured(recording, chosen[first + i]); });
    std::ranges::move(batch, std::back_inserter(stretches));
    std::erase_if(stretches, [](const Stretch& stretch) { return stretch.steps.empty(); });
    std::ranges::sort(stretches, {}, [](const Stretch& stretch) { return stretch.steps.front().begin; });
    comparison = compare(wheels, stretches);
    if (comparison.turns.has_curves() && comparison.ahead) break;
  }
  return comparison;
}

}  // namespace

WheelsCompared check_wheels_with_scans(Recording& recording) {
  if (recording.wheel.size() < 2 || !recording.imu.empty()) return {};
  constexpr WheelReference kReference{"the scans", "the scans", "--mount if the LiDAR's is wrong", "--mount"};
  const WheelComparison comparison = compared_with_scans(recording);
  return {judge_wheels(recording, comparison, kReference),
          comparison.turns.has_curves() || comparison.ahead.has_value()};
}

std::optional<double> wheels_late_by_scans(const Recording& recording) {
  if (recording.wheel.size() < 2) return std::nullopt;
  const WheelComparison comparison = compared_with_scans(recording);
  if (!comparison.turns.agrees()) return std::nullopt;
  return comparison.late_s();
}

}  // namespace adit
