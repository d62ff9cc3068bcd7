// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether merges are wrong as rarely as stated: over many worlds, every hypothesis that a merge check tested
/// is judged by ground truth, and how often false ones reached some evidence is compared with what that
/// evidence claims. Robots of different worlds never met: all that aligns their maps is false.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/evaluation/tables.hpp"
#include "adit/study/merge_worlds.hpp"

namespace adit {

/// Whether a hypothesis puts the other robot where it was, by the median of its loops.
enum class HypothesisTruth {
  right,  ///< Within the tolerance under which two hypotheses count as one, 3 m and 15 degrees.
  near,   ///< Within 10 m, where evaluation begins to call a place wrong: neither true nor false.
  wrong,
};

/// A hypothesis that a merge check has tested.
struct JudgedHypothesis {
  HypothesisTruth truth = HypothesisTruth::wrong;  ///< Always wrong where the robots never met.
  bool refuted = false;                            ///< Then its evidence does not count.
  bool accepted = false;                           ///< The check joined the maps by it.
  double evidence = 0.0;                           ///< As in MergeHypothesis.
  double needed = 0.0;                             ///< As in MergeCheck.
  HypothesisCounts counts{};                       ///< What the evidence comes from.
  double walls = 0.0;    ///< The part of the evidence that comes from the relief of walls.
  std::string robots{};  ///< As in "zab-1/robot_0, zab-1/robot_2".
};

/// How robots are driven and maps are checked.
struct CalibrationStudy {
  RunConfig config;              ///< Used under the policy `adaptive`.
  std::filesystem::path folder;  ///< Keeps the robots' maps (maps/, which exists).
};

/// Those of the pairs of robots of one world. Fails on a world that cannot be driven.
[[nodiscard]] Result<std::vector<JudgedHypothesis>> hypotheses_within(const CalibrationStudy& study,
                                                                      const ListedWorld& world);
/// Those between each robot of one world and each of the other, all of them wrong.
[[nodiscard]] Result<std::vector<JudgedHypothesis>> hypotheses_between(const CalibrationStudy& study,
                                                                       const ListedWorld& one,
                                                                       const ListedWorld& other);

/// For each evidence: the rate of false hypotheses that it claims at most to let through, exp(-evidence);
/// those that reached it, with the upper limit of their rate (95 %); the true ones that reached it. Then a
/// row of what the checks accepted. The second table has the share of false ones among those of about one
/// evidence.
[[nodiscard]] std::vector<Table> calibration_tables(const std::vector<JudgedHypothesis>& hypotheses);
/// The hypotheses for programs.
[[nodiscard]] std::string calibration_json(const std::vector<JudgedHypothesis>& hypotheses);

}  // namespace adit
