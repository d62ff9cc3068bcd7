// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether merges are wrong as rarely as stated: over many worlds, every hypothesis that a merge check tested
/// is judged by ground truth, and how often false ones reached some evidence is compared with what that
/// evidence claims. Robots of different worlds never met: all that aligns their maps is false.
#pragma once

#include <cstddef>
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
/// Reads what `calibration_json` wrote. Fails on content of another version, and on damaged content, naming
/// the file, the hypothesis (counted from 0) and the fault.
[[nodiscard]] Result<std::vector<JudgedHypothesis>> read_calibration(const std::filesystem::path& file);
/// Those of several such files, in the order of the files. Fails, naming the file, where it has hypotheses
/// about two robots that one before it has, too, in either order, which would count twice, or needed other
/// evidence.
[[nodiscard]] Result<std::vector<JudgedHypothesis>> joined_calibrations(
    const std::vector<std::string>& files);

/// Between two claimed rates the same hypotheses reach the evidence, -log(claimed rate).
struct CalibrationStep {
  double from = 1.0;            ///< Claimed rate at which the step begins; only the first one includes it.
  double to = 1.0;              ///< Claimed rate at which it ends, and which it includes; at most `from`.
  std::size_t num_reached = 0;  ///< Hypotheses, not refuted, with the evidence or more.
  std::size_t num = 1;          ///< All of them; at least one.

  /// Observed, 0 to 1.
  [[nodiscard]] double share() const;
  /// Of the share, as `share_upper_limit` has it at 95 %: above it but where all reach the evidence.
  [[nodiscard]] double upper_limit() const;
};
/// How many hypotheses of that truth reach an evidence, from a claimed rate of 1 down to 1e-5, where figures
/// of rates end (kLeastRate). None without such hypotheses.
[[nodiscard]] std::vector<CalibrationStep> calibration_steps(const std::vector<JudgedHypothesis>& hypotheses,
                                                             HypothesisTruth truth);
/// Claimed against observed wrong acceptance, an SVG document: the share of false hypotheses that reach an
/// evidence, which ends where none does, its upper limit (95 %) and the share of true ones, over the rate
/// that the evidence claims. Without false hypotheses it says so.
[[nodiscard]] std::string calibration_plot(const std::vector<JudgedHypothesis>& hypotheses);

}  // namespace adit
