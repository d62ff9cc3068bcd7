// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/map_covariance.hpp"

#include <utility>
#include <variant>

#include "adit/core/format.hpp"
#include "adit/io/g2o.hpp"

namespace adit {

Result<MapCovariance> MapCovariance::of(const PlacedSession& session, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "graph_optimized.g2o";
  const Result<G2oFile> file = read_g2o(path);
  if (!file) return tl::unexpected(file.error());
  const auto* graph = std::get_if<PoseGraph>(&file->graph);
  if (graph == nullptr) return fail(path.string() + ": not the graph of a session");
  Result<Marginals<Pose>> marginals = Marginals<Pose>::compute(*graph);
  if (!marginals) return fail(path.string(), marginals.error());
  MapCovariance out(session, std::move(*marginals));
  for (std::size_t i = 0; i < graph->nodes.size(); ++i) out.nodes_[graph->nodes[i].key] = i;
  for (const PlacedRobot& robot : session.robots)
    for (const Keyframe& keyframe : robot.map->keyframes)
      if (!out.nodes_.contains(graph_key(keyframe.id)))
        return fail(format("{}: keyframe {} of {} is missing; make the session again", path.string(),
                           keyframe.id.index, robot.map->name));
  return out;
}

Eigen::MatrixXd MapCovariance::cross(const std::vector<Place>& rows,
                                     const std::vector<Place>& columns) const {
  Eigen::MatrixXd out = marginals_.cross(nodes_of(rows), nodes_of(columns));
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (rows[r] == columns[c])
        out.block<6, 6>(6 * static_cast<Eigen::Index>(r), 6 * static_cast<Eigen::Index>(c)) +=
            session_.robots[rows[r].robot].map->pose_noise[rows[r].keyframe];
  return out;
}

Matrix6 MapCovariance::at(const Place& place) const { return cross({place}, {place}); }

std::vector<std::size_t> MapCovariance::nodes_of(const std::vector<Place>& places) const {
  std::vector<std::size_t> out;
  for (const Place& place : places)
    out.push_back(nodes_.at(graph_key(session_.robots[place.robot].map->keyframes[place.keyframe].id)));
  return out;
}

}  // namespace adit
