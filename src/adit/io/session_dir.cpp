// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/session_dir.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "adit/core/format.hpp"
#include "adit/core/version.hpp"
#include "adit/fleet/loop_account.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/g2o.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

constexpr double kMapVoxel = 0.2;
/// All files begin with these columns; how many later ones follow, each file says itself.
constexpr std::string_view kLoopHeader =
    "from_robot,from_keyframe,from_stamp,to_robot,to_keyframe,to_stamp,place_distance,inliers,overlap,weak_"
    "axis,"
    "verdict,pcm,gnc_weight,class,x,y,z,qx,qy,qz,qw,reason";
constexpr std::string_view kLaterLoopColumns = ",hypothesis,merge_check,registration";

std::string name_of(const FleetGraph& fleet, RobotId id) { return fleet.robots.at(id).name; }

double rounded(double value) { return std::round(100.0 * value) / 100.0; }

/// A merge that was tested, joined or not, with the hypotheses about it, the best one first.
toml::table merge_table(const FleetGraph& fleet, const MergeCheck& check) {
  toml::array hypotheses;
  for (const MergeHypothesis& h : check.hypotheses) {
    toml::array loops;
    for (const auto& [a, b] : h.loops)
      loops.push_back(toml::array{static_cast<std::int64_t>(a), static_cast<std::int64_t>(b)});
    hypotheses.push_back(toml::table{{"outcome", std::string(to_string(h.outcome))},
                                     {"evidence", rounded(h.evidence)},
                                     {"places_compared", static_cast<std::int64_t>(h.num_checked)},
                                     {"places_differing", static_cast<std::int64_t>(h.num_differing())},
                                     {"from_best_m", rounded(h.from_best_m)},
                                     {"loops", loops}});
  }
  return toml::table{{"robots", toml::array{name_of(fleet, check.a), name_of(fleet, check.b)}},
                     {"accepted", check.accepted},
                     {"evidence_needed", rounded(check.needed)},
                     {"reason", check.reason},
                     {"hypotheses", hypotheses}};
}

std::string session_toml(const Session& session) {
  toml::table table;
  table.insert("version", std::string(version()));
  table.insert("command", session.provenance.command);
  table.insert("seed", static_cast<std::int64_t>(session.provenance.seed));
  toml::array inputs;
  for (const std::string& input : session.provenance.inputs) inputs.push_back(input);
  table.insert("inputs", inputs);
  toml::array robots;
  for (const auto& map : session.maps) robots.push_back(map->name);
  table.insert("robots", robots);
  toml::array components;
  for (const Component& component : session.solution.components) {
    toml::array names;
    for (const RobotId id : component.robots) names.push_back(name_of(session.fleet, id));
    components.push_back(names);
  }
  table.insert("components", components);
  toml::array refusals;
  for (const PairOutcome& pair : session.solution.pairs) {
    if (pair.merged) continue;
    refusals.push_back(format("{} and {}: {}", name_of(session.fleet, pair.a), name_of(session.fleet, pair.b),
                              pair.refused_reason));
  }
  table.insert("refusals", refusals);
  const auto outcome_of = [&](const MergeCheck& check) {
    return std::ranges::find_if(session.solution.pairs, [&](const PairOutcome& pair) {
      return pair.a == check.a && pair.b == check.b;
    });
  };
  toml::array merges;
  toml::array revisits;
  for (const auto& [pair, check] : session.fleet.checks) {
    toml::table tested = merge_table(session.fleet, check);
    if (const auto outcome = outcome_of(check); outcome != session.solution.pairs.end()) {
      tested.insert("merged", outcome->merged);  // an accepted one may be taken back
      if (!outcome->joined_reason.empty()) tested.insert("joined", outcome->joined_reason);
    }
    (check.a == check.b ? revisits : merges).push_back(std::move(tested));
  }
  table.insert("merges", merges);
  table.insert("revisits", revisits);
  std::ostringstream text;
  text << table << "\n";
  const toml::parse_result configuration = toml::parse(session.provenance.configuration);
  toml::table nested;
  nested.insert("configuration", configuration);
  text << nested << "\n";
  return text.str();
}

/// Text for one CSV cell: no separators, quotes or line breaks.
std::string cell(std::string text) {
  std::ranges::replace(text, ',', ';');
  std::ranges::replace(text, '\n', ' ');
  return text;
}

std::string loop_line(const Session& session, const LoopOutcome& outcome, std::string_view loop_class) {
  const LoopClosure& loop = outcome.loop;
  const bool accepted = loop.verdict == LoopVerdict::accepted;
  const auto stamp = [&](KeyframeId id) {
    return stamp_text(session.fleet.robots.at(id.robot).nodes.at(id.index).stamp);
  };
  const Vector3& t = loop.T_from_to.translation();
  const Eigen::Quaterniond& q = loop.T_from_to.rotation();
  const LoopAccount account = account_of(outcome, session.fleet, session.solution);
  return format("{},{},{},{},{},{},{:.4f},{},{:.4f},{:.5f},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                name_of(session.fleet, loop.from.robot), loop.from.index, stamp(loop.from),
                name_of(session.fleet, loop.to.robot), loop.to.index, stamp(loop.to), loop.place_distance,
                loop.num_inliers, loop.overlap, loop.weak_axis, to_string(loop.verdict),
                accepted ? (outcome.in_clique ? "kept" : "dropped") : "",
                accepted ? format("{:.4f}", outcome.weight) : "", loop_class, t.x(), t.y(), t.z(), q.x(),
                q.y(), q.z(), q.w(), cell(account.reason),
                account.hypothesis ? format("{}", *account.hypothesis + 1) : "", account.merge_check,
                cell(loop.reason));
}

std::string loops_csv(const Session& session) {
  std::map<std::pair<KeyframeId, KeyframeId>, std::size_t> accepted;
  for (std::size_t l = 0; l < session.solution.loops.size(); ++l) {
    const LoopClosure& loop = session.solution.loops[l].loop;
    accepted[{loop.from, loop.to}] = l;
  }
  std::string text = std::string(kLoopHeader) + std::string(kLaterLoopColumns) + "\n";
  for (const auto& [ends, loop] : session.fleet.loops) {
    const auto found = accepted.find(ends);
    if (found == accepted.end()) {
      text += loop_line(session, {loop, false, 0.0}, "");
      continue;
    }
    const bool judged = !session.loop_classes.empty();
    text += loop_line(session, session.solution.loops[found->second],
                      judged ? to_string(session.loop_classes[found->second]) : "");
  }
  return text;
}

Trajectory optimized_trajectory(const RobotMap& map, const std::vector<Pose>& T_world_keyframe) {
  Trajectory trajectory;
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    trajectory.push_back({map.keyframes[k].stamp, T_world_keyframe.at(k)});
  }
  return trajectory;
}

Result<> write_robot(const std::filesystem::path& dir, const RobotMap& map, const FleetSolution& solution,
                     MapFiles map_files) {
  if (map.keyframes.empty()) return {};  // all of them left under the policy: nothing to write
  const std::filesystem::path folder = dir / map.name;
  std::filesystem::create_directories(folder);
  const std::vector<Pose>& T_world_keyframe = solution.T_world_keyframe.at(map.id);
  Result<> done = write_tum(folder / "trajectory.tum", optimized_trajectory(map, T_world_keyframe));
  if (done) done = write_tum(folder / "odometry.tum", map.odometry);
  if (done && map_files == MapFiles::write) {
    done = write_cloud(folder / "map.ply", merged_cloud(map, T_world_keyframe, kMapVoxel));
  }
  return done;
}

Result<> write_graph(const std::filesystem::path& path, const PoseGraph& graph) {
  std::ostringstream text;
  write_g2o(text, graph);
  return write_bytes(path, text.str());
}

Result<> write_graphs(const std::filesystem::path& dir, const FleetSolution& solution) {
  Result<> done = write_graph(dir / "graph_initial.g2o", solution.initial);
  if (done) done = write_graph(dir / "graph_pcm.g2o", solution.after_pcm);
  if (done) done = write_graph(dir / "graph_optimized.g2o", solution.optimized);
  return done;
}

Result<> write_merged_map(const std::filesystem::path& dir, const Session& session) {
  PointCloud all;
  for (const auto& map : session.maps) {
    const PointCloud cloud = merged_cloud(*map, session.solution.T_world_keyframe.at(map->id), kMapVoxel);
    all.points.insert(all.points.end(), cloud.points.begin(), cloud.points.end());
  }
  return all.empty() ? Result<>{} : write_cloud(dir / "map.ply", voxel_downsample(all, kMapVoxel));
}

std::vector<std::string> strings_of(const toml::array* array) {
  std::vector<std::string> out;
  if (array == nullptr) return out;
  for (const toml::node& node : *array) out.push_back(node.value_or(std::string()));
  return out;
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t end = line.find(separator);
    cells.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

template <class T>
T number(std::string_view text, T otherwise = {}) {
  T value = otherwise;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

Result<SavedLoop> parse_loop(std::string_view line, std::size_t num_columns) {
  const std::vector<std::string_view> cells = split(line, ',');
  if (cells.size() != num_columns) return fail(format("{} cells instead of {}", cells.size(), num_columns));
  SavedLoop saved;
  const std::optional<Stamp> from = parse_stamp(cells[2]);
  const std::optional<Stamp> to = parse_stamp(cells[5]);
  if (!from || !to) return fail("a stamp is no number");
  saved.from_robot = cells[0];
  saved.to_robot = cells[3];
  saved.from_stamp = *from;
  saved.to_stamp = *to;
  LoopClosure& loop = saved.loop;
  loop.from.index = number<std::uint32_t>(cells[1]);
  loop.to.index = number<std::uint32_t>(cells[4]);
  loop.place_distance = number<double>(cells[6]);
  loop.num_inliers = number<int>(cells[7]);
  loop.overlap = number<double>(cells[8]);
  loop.weak_axis = number<double>(cells[9]);
  loop.verdict = cells[10] == "accepted" ? LoopVerdict::accepted : LoopVerdict::rejected;
  saved.in_clique = cells[11] == "kept";
  saved.weight = number<double>(cells[12]);
  const Eigen::Quaterniond q(number<double>(cells[20]), number<double>(cells[17]), number<double>(cells[18]),
                             number<double>(cells[19]));
  const Vector3 t(number<double>(cells[14]), number<double>(cells[15]), number<double>(cells[16]));
  if (!t.allFinite() || std::abs(q.norm() - 1.0) > 1e-3) return fail("x to qw are no pose");
  loop.T_from_to = Pose(q, t);
  loop.reason = cells[21];
  return saved;
}

Result<std::vector<SavedLoop>> read_loops(const std::filesystem::path& path) {
  const Result<std::string> text = read_bytes(path);
  if (!text) return tl::unexpected(text.error());
  std::vector<SavedLoop> loops;
  std::size_t line_number = 0;
  std::size_t num_columns = 0;
  for (const std::string_view line : split(*text, '\n')) {
    if (++line_number == 1) {
      num_columns = split(line, ',').size();
      if (!line.starts_with(kLoopHeader) || !split(line.substr(kLoopHeader.size()), ',').front().empty())
        return fail(path.string() + ": line 1: not the header of a loops.csv");
      continue;
    }
    if (line.empty()) continue;
    Result<SavedLoop> loop = parse_loop(line, num_columns);
    if (!loop) return fail(format("{}: line {}", path.string(), line_number), loop.error());
    loops.push_back(std::move(*loop));
  }
  return loops;
}

}  // namespace

PointCloud merged_cloud(const RobotMap& map, const std::vector<Pose>& T_world_keyframe, double voxel) {
  // Thinned every so many keyframes: neighbours see the same walls, and the sum of all clouds need not fit
  // memory.
  constexpr std::size_t kKeyframesAtOnce = 32;
  PointCloud merged;
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    PointCloud cloud;
    cloud.points = map.keyframes[k].cloud->points;
    cloud = transformed(T_world_keyframe.at(k), std::move(cloud));
    merged.points.insert(merged.points.end(), cloud.points.begin(), cloud.points.end());
    if (k % kKeyframesAtOnce == kKeyframesAtOnce - 1) merged = voxel_downsample(merged, voxel);
  }
  return voxel_downsample(merged, voxel);
}

Result<> write_session(const std::filesystem::path& dir, const Session& session, MapFiles map_files) {
  Result<> done = write_bytes(dir / "session.toml", session_toml(session));
  for (const auto& map : session.maps) {
    if (done) done = write_robot(dir, *map, session.solution, map_files);
  }
  if (done) done = write_graphs(dir, session.solution);
  if (done) done = write_bytes(dir / "loops.csv", loops_csv(session));
  if (done && map_files == MapFiles::write) done = write_merged_map(dir, session);
  return done;
}

Result<SavedSession> read_session(const std::filesystem::path& dir) {
  const std::filesystem::path toml_path = dir / "session.toml";
  const Result<std::string> text = read_bytes(toml_path);
  if (!text) return fail(dir.string() + ": no session directory", text.error());
  SavedSession session;
  try {
    const toml::table table = toml::parse(*text);
    session.version = table["version"].value_or(std::string());
    session.seed = static_cast<std::uint64_t>(table["seed"].value_or(std::int64_t{0}));
    session.robots = strings_of(table["robots"].as_array());
    if (const toml::array* components = table["components"].as_array()) {
      for (const toml::node& node : *components) session.components.push_back(strings_of(node.as_array()));
    }
  } catch (const toml::parse_error& error) {
    return fail(
        format("{}: line {}: {}", toml_path.string(), error.source().begin.line, error.description()));
  }
  for (const std::string& robot : session.robots) {
    Result<Trajectory> optimized = read_tum(dir / robot / "trajectory.tum");
    if (!optimized) return tl::unexpected(optimized.error());
    Result<Trajectory> odometry = read_tum(dir / robot / "odometry.tum");
    if (!odometry) return tl::unexpected(odometry.error());
    session.optimized.push_back(std::move(*optimized));
    session.odometry.push_back(std::move(*odometry));
  }
  Result<std::vector<SavedLoop>> loops = read_loops(dir / "loops.csv");
  if (!loops) return tl::unexpected(loops.error());
  session.loops = std::move(*loops);
  return session;
}

}  // namespace adit
