// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <variant>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// What a file holds.
struct G2oFile {
  std::variant<PoseGraph, PoseGraph2> graph;  ///< In space or in the plane.
  std::vector<std::size_t> edge_lines;        ///< Line of each edge in its file, from 1.
  std::vector<std::size_t> edge_files = {};   ///< Of a merged graph: the file of each edge, from 0.
  /// What was skipped or added: tags with counts, vertices without a line of their own.
  std::vector<std::string> notes;
};

/// Reads VERTEX_SE3:QUAT and EDGE_SE3:QUAT, or VERTEX_SE2 and EDGE_SE2 (not both kinds in one file). Vertices
/// may come after the edges that use them; those that never come are composed along edges
/// (`spanning_tree_poses`). Lines that start with # and the tags FIX and PARAMS_* are skipped and counted.
/// Any other tag, a repeated vertex, an edge from a vertex to itself, a number that is missing, surplus or
/// not finite, and a position more than 1e9 m out is an error that names the line.
///
/// Edge kinds are decided here, as the format has no word for them: an edge whose `to` key is its `from` key
/// plus one is odometry (GTSAM keys hold the robot in the top byte, so that means the next keyframe of the
/// same robot); every other edge is a loop. The information matrix is read as written, 21 (6) numbers of its
/// upper triangle row by row, and not checked: `indefinite_edges` does that.
[[nodiscard]] Result<G2oFile> read_g2o(std::istream& stream, const std::string& name);
/// The same of a file.
[[nodiscard]] Result<G2oFile> read_g2o(const std::filesystem::path& path);

/// Vertices, then edges, numbers as short as can be read back exactly. Edge kinds follow from the keys when
/// read back.
void write_g2o(std::ostream& stream, const PoseGraph& graph);
/// The same in the plane.
void write_g2o(std::ostream& stream, const PoseGraph2& graph);

/// Several graphs in one, e.g. one file per robot: nodes with equal keys become one (the first file's pose
/// counts, as separators between robots appear in both), edges that two files repeat exactly are kept once.
[[nodiscard]] Result<G2oFile> merge_g2o(const std::vector<G2oFile>& files);

}  // namespace adit
