// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Runs the sides of a case alternately.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/registry.hpp"

namespace adit::bench {

struct CompareConfig {
  int rounds = 9;                  ///< Timed runs of each side, at most ...
  double seconds_per_case = 45.0;  ///< ... and no more once this is used up, but three at least.
  std::string program;             ///< This program, started anew for each side.
  std::filesystem::path peers;     ///< Folder of programs that speak the protocol of serve.hpp; may be empty.
  std::filesystem::path inputs;    ///< Folder that `export` has filled, handed to them.
  std::filesystem::path base;  ///< An older adit_bench, which takes part as side "previous"; may be empty.
  std::string version;         ///< Of adit, as the repository names its state.
};

/// Smallest, middle and largest.
struct Spread {
  double min = 0.0;
  double median = 0.0;
  double max = 0.0;
};
[[nodiscard]] Spread spread_of(std::vector<double> values);

struct SideResult {
  std::string side;
  About about;
  std::string skipped;  ///< Why, or empty.
  Spread seconds;       ///< Of one unit.
  Spread ratio;         ///< This side's time over adit's, run by run; 1 for adit itself.
  double peak_mb = 0.0;
  Figures figures;
};
/// What was measured, where and when. A page may hold rows of several.
struct Measured {
  std::string version;
  std::string machine;
  std::string date;
};

struct CaseResult {
  CaseInfo info;
  Measured measured;
  std::vector<SideResult> sides;  ///< adit first, then the info's peer, then the others.
  [[nodiscard]] const SideResult* side(const std::string& name) const;
};
/// `measured` stays empty: the caller knows.
[[nodiscard]] CaseResult compare(const CaseInfo& info, const CompareConfig& config);

struct GrowthPoint {
  double size = 0.0;
  SideResult result;
};
struct GrowthResult {
  Measured measured;
  std::string name;
  std::string title;
  std::string size_label;
  std::vector<GrowthPoint> points;
};
[[nodiscard]] GrowthResult grow(const GrowthInfo& info, const CompareConfig& config);

}  // namespace adit::bench
