// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/format.hpp"
#include "adit/robot/scan_loop.hpp"
#include "adit/robot/sensor_checks.hpp"

namespace adit {
namespace {

/// Of the motions from scan to scan, how many a sensor measured.
struct Coverage {
  std::size_t motions = 0;
  std::size_t by_wheels = 0;
  std::size_t by_imu = 0;
};

Coverage coverage_of(const Recording& recording) {
  Coverage coverage;
  for (std::size_t i = 1; i < recording.num_scans(); ++i) {
    const SensedMotion motion = sensed_before(recording, i);
    ++coverage.motions;
    coverage.by_wheels += motion.wheel ? 1U : 0U;
    coverage.by_imu += motion.imu.empty() ? 0U : 1U;
  }
  return coverage;
}

std::string span_text(Stamp first, Stamp last) {
  return format("{:.3f} to {:.3f} s", first.seconds(), last.seconds());
}

/// Clears a sensor that measured nothing between scans; says so where it measured less than half.
template <class Samples>
void check(Samples& samples, std::size_t measured, const Coverage& coverage, const Recording& recording,
           const char* name, Finding finding, std::vector<SensorFinding>& findings) {
  if (samples.empty() || 2 * measured >= coverage.motions) return;
  const std::string sentence =
      format("{}: measured {} of the {} motions from scan to scan (theirs {}, scans {})", name,
             measured == 0 ? "none" : format("{}", measured), coverage.motions,
             span_text(samples.front().stamp, samples.back().stamp),
             span_text(recording.scan_stamps.front(), recording.scan_stamps.back()));
  if (measured > 0) {
    findings.push_back({finding, Consequence::noted, sentence + "; scans alone say the others"});
    return;
  }
  samples.clear();
  findings.push_back({finding, Consequence::left_out,
                      sentence + "; let both drivers stamp by one clock, and look for lost messages"});
}

}  // namespace

std::vector<SensorFinding> check_coverage(Recording& recording) {
  std::vector<SensorFinding> findings;
  if (recording.num_scans() < 2 || (recording.wheel.empty() && recording.imu.empty())) return findings;
  const Coverage coverage = coverage_of(recording);
  check(recording.imu, coverage.by_imu, coverage, recording, "IMU", Finding::imu_silent, findings);
  check(recording.wheel, coverage.by_wheels, coverage, recording, "wheels", Finding::wheels_silent, findings);
  return findings;
}

}  // namespace adit
