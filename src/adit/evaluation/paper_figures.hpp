// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The paper's own results (arXiv 2507.21553), for the columns beside ours.
#pragma once

#include <array>
#include <string_view>

namespace adit::paper {

/// A robot of table 1.
struct RobotRow {
  std::string_view robot;  ///< Its number.
  /// As printed.
  ///@{
  double path_length_m;
  double duration_s;
  double speed_mps;
  ///@}
};
/// Table 1.
inline constexpr std::array<RobotRow, 4> kRobots = {{{"0", 453.31, 238.65, 1.89},
                                                     {"1", 405.34, 219.85, 1.84},
                                                     {"2", 416.52, 222.59, 1.87},
                                                     {"3", 390.73, 210.45, 1.85}}};

/// Per cent of loops of a wrong place, and of a right place but a wrong registration.
struct OutlierShares {
  double wrong_place;         ///< PR.
  double wrong_registration;  ///< PCR.
};

/// Two robots in tables 2 to 5: with all keyframes, and with tunnel-filtered ones.
struct PairRow {
  std::string_view pair;  ///< As in the tables, "(0, 1)".
  /// Table 2, before PCM.
  ///@{
  OutlierShares all_before, filtered_before;
  ///@}
  /// Table 3, after PCM.
  ///@{
  OutlierShares all_after, filtered_after;
  ///@}
  /// Table 4.
  ///@{
  bool all_succeeds_without_pcm, filtered_succeeds_without_pcm, all_succeeds, filtered_succeeds;
  ///@}
  std::array<double, 2> max_ate_m;  ///< Table 5: tunnel-filtered keyframes, with PCM.
};
/// Tables 2 to 5, a row for each two of the four robots.
inline constexpr std::array<PairRow, 6> kPairs = {{
    {"(0, 1)",
     {46.08, 37.30},
     {33.33, 0.0},
     {9.09, 9.09},
     {0.0, 0.0},
     false,
     false,
     false,
     true,
     {0.291, 0.358}},
    {"(0, 2)",
     {32.34, 26.59},
     {16.66, 8.33},
     {3.31, 2.1},
     {0.0, 3.57},
     false,
     false,
     true,
     false,
     {88.106, 63.850}},
    {"(0, 3)", {72.16, 0.0}, {0.0, 0.0}, {14.29, 0.0}, {0.0, 0.0}, false, true, false, true, {0.159, 1.530}},
    {"(1, 2)",
     {46.70, 37.24},
     {28.57, 0.0},
     {13.16, 10.53},
     {0.0, 0.0},
     false,
     false,
     false,
     true,
     {0.741, 0.656}},
    {"(1, 3)",
     {46.17, 3.98},
     {50.00, 0.0},
     {2.84, 0.0},
     {0.0, 0.0},
     false,
     false,
     true,
     true,
     {1.073, 0.918}},
    {"(2, 3)",
     {77.22, 0.55},
     {0.0, 3.84},
     {23.08, 0.0},
     {0.0, 0.0},
     false,
     true,
     false,
     true,
     {0.445, 2.174}},
}};

}  // namespace adit::paper
