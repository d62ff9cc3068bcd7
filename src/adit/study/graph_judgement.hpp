// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Judges the solution of a multi-robot graph by the labels and the ground truth of its file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adit/evaluation/false_loop_result.hpp"
#include "adit/io/jrl.hpp"
#include "adit/posegraph/optimizer.hpp"

namespace adit {

/// Distances of estimated from true positions, after an alignment (Umeyama, no scale).
struct PositionError {
  double rmse_m = 0.0;  ///< Over all positions with a truth.
  double max_m = 0.0;   ///< Of the worst position.
};

/// How good a solution of a graph is, by the truth and the labels that its file has.
struct GraphJudgement {
  /// One robot by itself.
  struct Robot {
    std::string name;                    ///< As it was given.
    std::size_t num_poses = 0;           ///< Its nodes, with truth or without.
    std::optional<PositionError> error;  ///< After the robot's own alignment; none without truth.
  };
  /// Robots that the measurements kept join, in one map.
  struct Map {
    std::vector<std::string> robots;     ///< Names, in the order of the file.
    std::optional<PositionError> error;  ///< After one alignment of all its robots together.
  };
  std::optional<LoopScore> loops;  ///< None where the file labels no outliers.
  std::vector<Robot> robots;       ///< In the order of the file.
  std::vector<Map> maps;           ///< Each robot is in one.
};

/// `solution`: of the graph of `jrl`, with or without its priors as edges. A loop counts as kept from weight
/// 0.5 on, and is true where the file does not list it as an outlier.
template <class P>
[[nodiscard]] GraphJudgement judged(const JrlGraph<P>& jrl, const std::vector<std::string>& robots,
                                    const Solution<P>& solution);

/// One sentence per line, for people.
[[nodiscard]] std::vector<std::string> sentences(const GraphJudgement& judgement);

}  // namespace adit
