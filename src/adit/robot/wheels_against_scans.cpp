// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>

#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"
#include "adit/geometry/deskew.hpp"
#include "adit/odometry/plane_icp.hpp"
#include "adit/odometry/preprocess.hpp"
#include "adit/robot/sensor_checks.hpp"
#include "adit/robot/wheel_comparison.hpp"

namespace adit {
namespace {

constexpr std::size_t kBatch = 12;       // stretches; a second batch follows where one tells too little
constexpr std::size_t kLength = 25;      // scans of a stretch
constexpr std::size_t kSettling = 4;     // of those, until the odometry knows how fast the robot is
constexpr std::size_t kPoints = 20'000;  // of a scan; more measure no better
constexpr Duration kLongestStep = std::chrono::milliseconds(300);  // three scans of a usual LiDAR
constexpr Duration kHalfWindow = std::chrono::milliseconds(100);   // of rates: a scan to either side
constexpr std::size_t kEnoughRates = 150;  // three seconds; the turning between scans has little noise
// Deviations of a step, as stated, up to which it counts as measured. Where the scene fixes all six
// directions they are a fifth of that; above, steps were seen that were off by far more than they stated.
constexpr double kTurnSigma = 0.0005;  // radians
constexpr double kAheadSigma = 0.005;  // metres
constexpr double kUnknown = 10.0;      // metres and radians, along directions that the scan leaves open
constexpr double kLeastDriven = 0.5;   // metres: shorter stretches say too little of the scale

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// Scans that the checks go by: about ten per second.
std::vector<std::size_t> used_scans(const Recording& recording) {
  constexpr double kInterval = 0.1;
  if (recording.num_scans() < 2) return {};
  std::vector<double> intervals;
  for (std::size_t i = 1; i < recording.num_scans(); ++i)
    intervals.push_back(to_seconds(recording.scan_stamps[i] - recording.scan_stamps[i - 1]));
  const double usual = median(std::move(intervals));
  const auto step = static_cast<std::size_t>(std::max(1.0, std::round(kInterval / usual)));
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < recording.num_scans(); i += step) used.push_back(i);
  return used;
}

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

// About kPoints of the points, spread evenly and without a period that could be that of the rings.
PointCloud thinned(const PointCloud& cloud) {
  if (cloud.size() <= kPoints) return cloud;
  const double share = static_cast<double>(kPoints) / static_cast<double>(cloud.size());
  constexpr double kGolden = 0.6180339887498949;
  PointCloud out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double position = static_cast<double>(i) * kGolden;
    if (position - std::floor(position) >= share) continue;
    out.points.push_back(cloud.points[i]);
    if (cloud.has_times()) out.time_offsets_ns.push_back(cloud.time_offsets_ns[i]);
  }
  return out;
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

// The odometry of clouds without times of their points.
std::vector<OdometryStep> registered(const std::vector<Scan>& scans, const Pose& T_base_lidar) {
  PlaneIcpConfig config;
  config.scan_to_map.deskew = false;
  PlaneIcp odometry(config, T_base_lidar);
  std::vector<OdometryStep> steps;
  for (const Scan& scan : scans) steps.push_back(odometry.register_scan(scan, {}));
  return steps;
}

// The clouds as if each had been taken at the scan's stamp, base frame. Deskewing within the odometry goes by
// the motion that is sought, and answers errors of one scan with others of the next. So sweeps are registered
// bent as they are first, which gives the motion at their middles, and straightened by that.
std::vector<Scan> straightened(const std::vector<Scan>& scans, const Pose& T_base_lidar) {
  const std::vector<OdometryStep> bent = registered(scans, T_base_lidar);
  std::vector<Scan> out;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const std::size_t before = k == 0 ? 0 : k - 1;
    const std::size_t after = std::min(k + 1, scans.size() - 1);
    const Pose motion = bent[before].T_odom_base.inverse() * bent[after].T_odom_base;
    PointCloud straight;
    preprocess(scans[k].cloud, {}, T_base_lidar, sweep_of({motion, bent[after].stamp - bent[before].stamp}),
               straight);
    out.push_back({scans[k].stamp, std::move(straight)});
  }
  return out;
}

// A scan that cannot be read ends the stretch: whoever makes the map says so.
Stretch measured(const Recording& recording, Indices indices) {
  Stretch stretch;
  std::vector<Scan> scans;
  for (const std::size_t i : indices) {
    const Result<Scan> scan = recording.read_scan(i);
    if (!scan) break;
    stretch.has_times = stretch.has_times && scan->cloud.has_times();
    scans.push_back({scan->stamp, thinned(scan->cloud)});
  }
  if (scans.size() < 2) return stretch;
  const std::vector<OdometryStep> steps = registered(straightened(scans, recording.T_base_lidar), Pose());
  for (std::size_t k = kSettling; k < steps.size(); ++k)
    stretch.steps.push_back(step_between(steps[k - 1], steps[k]));
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

}  // namespace

std::vector<SensorFinding> check_wheels_with_scans(Recording& recording) {
  if (recording.wheel.size() < 2 || !recording.imu.empty()) return {};
  constexpr WheelReference kReference{"the scans", "the scans", "--mount if the LiDAR's is wrong", "--mount"};
  const Growths wheels = growths_of(recording.wheel);
  const std::vector<std::size_t> scans = used_scans(recording);
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
  return judge_wheels(recording, comparison, kReference);
}

}  // namespace adit
