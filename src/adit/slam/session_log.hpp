// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The graph of a session as a JSON Robot Log that says what is true, so that other solvers can be judged by
/// it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/io/jrl.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/slam/session_evaluation.hpp"

namespace adit {

/// `graph`, of all keyframes and registered loops of `session` (graph_initial.g2o), with the truth at the
/// stamp of each keyframe and the label of each loop: an inlier if `evaluation` calls it correct, else an
/// outlier. Loops that could not be judged are left out, as readers take what is not listed as an outlier for
/// true. The letters of robots are those of the graph. Fails where the graph is not of that session.
[[nodiscard]] Result<JrlFile> labelled_log(std::string name, const PoseGraph& graph,
                                           const SavedSession& session, const SessionEvaluation& evaluation,
                                           const std::vector<std::optional<Trajectory>>& truths);

/// The same of the graph in the folder of the session, written to `path`.
Result<> write_labelled_log(const std::filesystem::path& path, const std::filesystem::path& folder,
                            const SavedSession& session, const SessionEvaluation& evaluation,
                            const std::vector<std::optional<Trajectory>>& truths);

}  // namespace adit
