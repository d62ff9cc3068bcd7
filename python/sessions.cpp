// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/robot_map_file.hpp"
#include "adit/slam/session_evaluation.hpp"
#include "adit/slam/session_job.hpp"
#include "adit/slam/session_pages.hpp"
#include "bindings.hpp"

namespace adit::python {
namespace {

py::object json(const std::string& text) { return py::module_::import("json").attr("loads")(text); }

std::size_t index_of(const std::vector<std::string>& robots, const std::string& robot) {
  const auto found = std::ranges::find(robots, robot);
  if (found == robots.end()) throw py::key_error("no robot of the session is called " + robot);
  return static_cast<std::size_t>(found - robots.begin());
}

// ---- a session that ran ----------------------------------------------------------------------------------

struct RunSession {
  SlamRun run;
  Job job;

  [[nodiscard]] const Session& session() const { return run.session; }
};

std::vector<std::string> names_of(const RunSession& s) {
  std::vector<std::string> names;
  for (const auto& map : s.session().maps) names.push_back(map->name);
  return names;
}

const RobotMap& map_of(const RunSession& s, const std::string& robot) {
  return *s.session().maps[index_of(names_of(s), robot)];
}

std::vector<std::vector<std::string>> components_of(const RunSession& s) {
  std::vector<std::vector<std::string>> components;
  for (const Component& component : s.session().solution.components) {
    components.emplace_back();
    for (const RobotId robot : component.robots) components.back().push_back(s.session().name_of(robot));
  }
  return components;
}

Path trajectory_of(const RunSession& s, const std::string& robot) {
  const RobotMap& map = map_of(s, robot);
  const auto poses = s.session().solution.T_world_keyframe.find(map.id);
  Path path;
  if (poses == s.session().solution.T_world_keyframe.end()) return path;
  for (std::size_t k = 0; k < map.keyframes.size(); ++k)
    path.poses.push_back({map.keyframes[k].stamp, poses->second.at(k)});
  return path;
}

PointArray points_of(const RunSession& s, const std::string& robot, double voxel) {
  const RobotMap& map = map_of(s, robot);
  const auto& poses = s.session().solution.T_world_keyframe;
  const auto found = poses.find(map.id);
  const PointCloud cloud = without_gil(
      [&] { return found == poses.end() ? PointCloud() : merged_cloud(map, found->second, voxel); });
  return array_of(cloud.points);
}

struct Pair {
  std::string a, b;
  bool merged = false;
  std::string reason;
  std::size_t num_loops = 0;
};

std::vector<Pair> pairs_of(const RunSession& s) {
  std::vector<Pair> pairs;
  for (const PairOutcome& pair : s.session().solution.pairs)
    pairs.push_back({s.session().name_of(pair.a), s.session().name_of(pair.b), pair.merged,
                     pair.refused_reason, pair.num_loops});
  return pairs;
}

struct Loop {
  std::string from_robot, to_robot;
  Stamp from_stamp, to_stamp;
  LoopOutcome outcome;
};

std::vector<Loop> loops_of_session(const RunSession& s) {
  std::vector<Loop> loops;
  const auto keyframe = [&](KeyframeId id) -> const Keyframe& {
    return map_of(s, s.session().name_of(id.robot)).keyframes.at(id.index);
  };
  for (const LoopOutcome& outcome : s.session().solution.loops)
    loops.push_back({s.session().name_of(outcome.loop.from.robot), s.session().name_of(outcome.loop.to.robot),
                     keyframe(outcome.loop.from).stamp, keyframe(outcome.loop.to).stamp, outcome});
  return loops;
}

void save(const RunSession& s, const std::filesystem::path& path) {
  without_gil([&] {
    SlamRun run = s.run;  // writing completes its provenance, while other threads read the session
    OutputDir out = value_of(OutputDir::create(path));
    value_of(write_slam(out.path(), run, s.job));
    value_of(out.commit());
  });
}

std::vector<std::string> failures_of(const RunSession& s) {
  std::vector<std::string> reasons;
  for (const FailedRobot& robot : s.run.failed) reasons.push_back(robot.reason);
  return reasons;
}

RunSession slam_of(const std::vector<Recording>& recordings, const py::object& config,
                   const std::string& profile) {
  Job job;
  job.config = run_config(config, profile);
  job.provenance.command = "adit.slam of Python";
  job.provenance.profile = profile;
  for (const Recording& recording : recordings) job.provenance.inputs.push_back(recording.name);
  return without_gil([&] { return RunSession{value_of(slam(recordings, job.config.slam)), job}; });
}

using RobotPairs = std::vector<std::pair<std::string, std::string>>;

/// In the order of the command: the last one counts.
std::vector<Ruling> rulings_of(const RobotPairs& veto, const RobotPairs& confirm,
                               const RobotPairs& withdraw) {
  std::vector<Ruling> rulings;
  for (const auto& [a, b] : withdraw) rulings.push_back({Ruling::Kind::withdraw, a, b});
  for (const auto& [a, b] : confirm) rulings.push_back({Ruling::Kind::confirm, a, b});
  for (const auto& [a, b] : veto) rulings.push_back({Ruling::Kind::veto, a, b});
  return rulings;
}

RunSession merge(const std::vector<std::filesystem::path>& sessions, const std::vector<Recording>& recordings,
                 const RobotPairs& veto, const RobotPairs& confirm, const RobotPairs& withdraw) {
  if (sessions.empty()) throw py::value_error("give one session or more to go on from");
  std::vector<std::string> paths;
  for (const std::filesystem::path& session : sessions) paths.push_back(session.string());
  const std::vector<Ruling> rulings = rulings_of(veto, confirm, withdraw);
  return without_gil([&] {
    SavedSessions saved = value_of(open_sessions(paths));
    saved.job.provenance.command = "adit.merge of Python";
    for (const Recording& recording : recordings) saved.job.provenance.inputs.push_back(recording.name);
    SlamRun run = value_of(slam_on(std::move(saved.fleets), recordings, saved.job.config.slam, rulings));
    return RunSession{std::move(run), std::move(saved.job)};
  });
}

void add_loops_and_pairs(py::module_& m) {
  py::class_<Pair>(m, "Pair")
      .def_readonly("a", &Pair::a)
      .def_readonly("b", &Pair::b)
      .def_readonly("merged", &Pair::merged)
      .def_readonly("reason", &Pair::reason)
      .def_readonly("num_loops", &Pair::num_loops);
  py::class_<Loop>(m, "Loop")
      .def_readonly("from_robot", &Loop::from_robot)
      .def_readonly("to_robot", &Loop::to_robot)
      .def_property_readonly("from_stamp", [](const Loop& l) { return l.from_stamp.ns; })
      .def_property_readonly("to_stamp", [](const Loop& l) { return l.to_stamp.ns; })
      .def_property_readonly("T_from_to", [](const Loop& l) { return l.outcome.loop.T_from_to.matrix(); })
      .def_property_readonly("information", [](const Loop& l) { return l.outcome.loop.information; })
      .def_property_readonly("in_use", [](const Loop& l) { return l.outcome.in_use(); });
}

void add_run_session(py::module_& m) {
  py::class_<RunSession>(m, "Session")
      .def_property_readonly("robots", &names_of)
      .def_property_readonly("components", &components_of)
      .def_property_readonly("pairs", &pairs_of)
      .def_property_readonly("loops", &loops_of_session)
      .def_property_readonly("notes", [](const RunSession& s) { return s.run.notes; })
      .def_property_readonly("failures", &failures_of)
      .def_property_readonly("metrics", [](const RunSession& s) { return json(session_metrics(s.run)); })
      .def("trajectory", &trajectory_of, py::arg("robot"))
      .def(
          "odometry",
          [](const RunSession& s, const std::string& robot) { return Path{map_of(s, robot).odometry}; },
          py::arg("robot"))
      .def("points", &points_of, py::arg("robot"), py::arg("voxel") = 0.1)
      .def("save", &save, py::arg("path"));
}

// ---- a session that was saved ----------------------------------------------------------------------------

struct OpenedSession {
  std::filesystem::path path;
  SavedSession saved;
};

PointArray saved_points(const OpenedSession& s, const std::string& robot, double voxel) {
  const Trajectory& optimized = s.saved.optimized[index_of(s.saved.robots, robot)];
  const std::filesystem::path file = s.path / robot / "map.adit";
  const PointCloud cloud = without_gil([&] {
    if (optimized.empty()) return PointCloud();  // a robot without keyframes has no map
    const RobotMap map = value_of(read_robot_map(file));
    std::vector<Pose> T_world_keyframe;
    for (const StampedPose& pose : optimized) T_world_keyframe.push_back(pose.T_world_body);
    if (T_world_keyframe.size() != map.keyframes.size())
      throw DataError(
          fail(file.string() + ": is not of the session that was read; call read_session again").value());
    return merged_cloud(map, T_world_keyframe, voxel);
  });
  return array_of(cloud.points);
}

py::object evaluated(const OpenedSession& s, const std::map<std::string, Path>& truths) {
  std::vector<std::optional<Trajectory>> given(s.saved.robots.size());
  for (const auto& [robot, truth] : truths) given[index_of(s.saved.robots, robot)] = truth.poses;
  return json(without_gil([&] { return json_of(value_of(evaluate(s.saved, given))); }));
}

void add_saved_session(py::module_& m) {
  py::class_<OpenedSession>(m, "SavedSession")
      .def_property_readonly("robots", [](const OpenedSession& s) { return s.saved.robots; })
      .def_property_readonly("components", [](const OpenedSession& s) { return s.saved.components; })
      .def(
          "trajectory",
          [](const OpenedSession& s, const std::string& robot) {
            return Path{s.saved.optimized[index_of(s.saved.robots, robot)]};
          },
          py::arg("robot"))
      .def(
          "odometry",
          [](const OpenedSession& s, const std::string& robot) {
            return Path{s.saved.odometry[index_of(s.saved.robots, robot)]};
          },
          py::arg("robot"))
      .def("points", &saved_points, py::arg("robot"), py::arg("voxel") = 0.1)
      .def("evaluate", &evaluated, py::arg("truths"));
  m.def(
      "read_session",
      [](const std::filesystem::path& path) {
        return without_gil([&] { return OpenedSession{path, value_of(read_session(path))}; });
      },
      py::arg("path"), "A session directory.");
}

}  // namespace

void add_sessions(py::module_& m) {
  add_loops_and_pairs(m);
  add_run_session(m);
  add_saved_session(m);
  m.def("slam", &slam_of, py::arg("recordings"), py::arg("config") = py::none(),
        py::arg("profile") = "default",
        "Maps every robot, lets each meet every other, and merges what tested evidence joins.");
  m.def("merge", &merge, py::arg("sessions"), py::arg("recordings") = std::vector<Recording>{}, py::kw_only(),
        py::arg("veto") = RobotPairs{}, py::arg("confirm") = RobotPairs{}, py::arg("withdraw") = RobotPairs{},
        "Goes on from saved sessions: joins them, and adds robots or later visits.");
}

}  // namespace adit::python
