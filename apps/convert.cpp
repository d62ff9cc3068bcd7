// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <utility>
#include <variant>

#include "adit/core/format.hpp"
#include "adit/core/json_text.hpp"
#include "adit/core/robot_name.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/bag_recording.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/g2o.hpp"
#include "adit/io/jrl.hpp"
#include "adit/io/mesh_files.hpp"
#include "adit/io/scan_folder.hpp"
#include "adit/io/text.hpp"
#include "adit/io/trajectory_files.hpp"
#include "adit/io/tum.hpp"
#include "adit/robot/full_rate.hpp"
#include "adit/robot/scan_loop.hpp"
#include "adit/slam/georeference.hpp"
#include "adit/slam/joint_map.hpp"
#include "adit/slam/map_covariance.hpp"
#include "adit/slam/session_mcap.hpp"
#include "command_line.hpp"
#include "inputs.hpp"
#include "outputs.hpp"

namespace adit::app {
namespace {

namespace fs = std::filesystem;

enum class Kind { session, recording, cloud, mesh, trajectory, graph, unknown };

std::string extension_of(const fs::path& path) { return lower_case(path.extension().string()); }

bool is_any_of(const std::string& text, std::initializer_list<const char*> list) {
  return std::find(list.begin(), list.end(), text) != list.end();
}

Kind kind_of(const std::string& name) {
  if (fs::exists(fs::path(name) / "session.toml")) return Kind::session;
  const std::string extension = extension_of(name);
  if (is_any_of(extension, {".pcd", ".bin", ".ply"})) return Kind::cloud;
  if (is_any_of(extension, {".obj", ".stl", ".dae", ".glb", ".gltf"})) return Kind::mesh;
  if (is_any_of(extension, {".tum", ".csv", ".kitti", ".txt"})) return Kind::trajectory;
  if (is_any_of(extension, {".g2o", ".jrl", ".cbor"})) return Kind::graph;
  const bool is_folder = extension.empty() || fs::is_directory(name) || name.find('@') != std::string::npos;
  return is_folder || extension == ".mcap" || extension == ".db3" || extension == ".bag" ? Kind::recording
                                                                                         : Kind::unknown;
}

Result<> convert_trajectory(const fs::path& in, const fs::path& out) {
  return read_trajectory(in).and_then(
      [&](const Trajectory& trajectory) { return write_trajectory(out, trajectory); });
}

Result<> convert_mesh(const fs::path& in, const fs::path& out) {
  return read_mesh(in).and_then([&](const TriangleMesh& mesh) { return write_mesh(out, mesh); });
}

/// A PLY with faces is a mesh and stays one where the output can hold it; elsewhere its vertices are the
/// cloud.
Result<> convert_cloud(const fs::path& in, const fs::path& out, const RecordingConfig& how) {
  if (is_ply_mesh(in) && extension_of(out) == ".ply") return convert_mesh(in, out);
  return stated_reading(how)
      .and_then([&](const CloudReading& stated) { return read_cloud_file(in, stated); })
      .and_then([&](const CloudFile& file) {
        return write_cloud(out, file.cloud, file.viewpoint.value_or(Pose()));
      });
}

Result<> write_graph(const fs::path& out, const std::variant<PoseGraph, PoseGraph2>& graph) {
  std::ostringstream text;
  std::visit([&](const auto& of_any_dimension) { write_g2o(text, of_any_dimension); }, graph);
  return write_bytes(out, text.str());
}

/// .g2o or .jrl to .g2o or .jrl; `name` is that of the log. A g2o file has no priors: several become edges
/// from one more node.
Result<> convert_graph(const fs::path& in, const std::string& name, const fs::path& out) {
  const bool to_jrl = extension_of(out) == ".jrl";
  if (!to_jrl && extension_of(out) != ".g2o")
    return fail(out.string() + ": graphs are written as .g2o or .jrl");
  const auto write_jrl = [&](const JrlFile& log) {
    return jrl_text(log).and_then([&](const std::string& text) { return write_bytes(out, text); });
  };
  if (extension_of(in) == ".g2o") {
    return read_g2o(in).and_then([&](const G2oFile& file) {
      return to_jrl ? jrl_of(name, file.graph).and_then(write_jrl) : write_graph(out, file.graph);
    });
  }
  return read_jrl(in).and_then([&](const JrlFile& log) {
    if (to_jrl) return write_jrl(log);
    return std::visit([&](const auto& content) { return write_graph(out, with_priors_as_edges(content)); },
                      log.content);
  });
}

/// The ground truth, which nothing else can compute; without one the wheel odometry.
Result<> convert_poses(const Recording& recording, const std::string& in, const fs::path& out) {
  const Trajectory& poses = recording.truth.empty() ? recording.wheel : recording.truth;
  if (!poses.empty()) return write_trajectory(out, poses);
  return fail(in + ": neither ground truth nor wheel odometry in it; 'adit odometry' computes poses");
}

struct ConvertOptions {
  std::string in;
  std::string out;
  std::string clouds = "pcd";
  std::string frame;
  bool covariance = false;
  bool mesh = false;
  std::string robot;  // whose map, of several; "": that of the most robots
  RecordingConfig recording;
};

const std::map<std::string, CloudFormat> kCloudFormats = {
    {"pcd", CloudFormat::pcd}, {"ply", CloudFormat::ply}, {"bin", CloudFormat::kitti}};

/// Says what a folder of clouds lacks.
Result<> write_folder(const fs::path& out, const Recording& recording, CloudFormat format) {
  return write_scan_folder(out, recording, format).map([&](std::size_t num_empty) {
    if (!recording.imu.empty()) print_notes("convert", {"folders hold no IMU; .mcap keeps it"});
    if (num_empty > 0)
      print_notes("convert", {adit::format("{} of {} scans have no points, and no file", num_empty,
                                           recording.num_scans())});
  });
}

Result<> convert_recording(const ConvertOptions& options, const RecordingConfig& config) {
  const fs::path out = options.out;
  if (is_bag_file(out) && extension_of(out) != ".mcap")
    return fail(options.out + ": recordings are written as .mcap, or as a folder of clouds");
  return open_input(options.in, config).and_then([&](const Recording& recording) -> Result<> {
    if (kind_of(options.out) == Kind::trajectory) return convert_poses(recording, options.in, out);
    LeftOut left_out("scans");
    const Recording readable = with_damaged_scans_empty(recording, left_out);
    const bool to_folder = extension_of(out) != ".mcap";
    const Result<> written = to_folder ? write_folder(out, readable, kCloudFormats.at(options.clouds))
                                       : write_recording(out, readable);
    if (const auto sentence = left_out.sentence(); written && sentence)
      print_notes("convert", {*sentence + (to_folder ? "" : "; they are written without points")});
    return written;
  });
}

/// What poses and clouds of that robot's map are written in: the target frame, where it has one and nothing
/// else is asked for.
Result<OutputFrame> frame_for(const PlacedSession& session, const std::string& robot,
                              const std::string& asked_for) {
  const Georeference* map = georeference_of(session.saved.georeferences, robot);
  if (map != nullptr && asked_for != "map") return target_frame(*map);
  if (asked_for == "target")
    return fail(robot + ": its map has no target frame; adit georeference sets one by control points");
  return OutputFrame{};
}

Trajectory seen_from(const Pose& T_frame_map, Trajectory trajectory) {
  for (StampedPose& pose : trajectory) pose.T_world_body = T_frame_map * pose.T_world_body;
  return trajectory;
}

/// A line for each pose: its stamp and the upper triangle of its covariance, right
/// perturbation, [translation; rotation]; between keyframes that of the nearest in time.
std::string covariance_csv(const Trajectory& poses, const std::vector<Keyframe>& keyframes,
                           const std::vector<Matrix6>& covariances) {
  std::string text = "stamp_s";
  constexpr std::array kNames = {"x", "y", "z", "rx", "ry", "rz"};
  for (std::size_t i = 0; i < kNames.size(); ++i)
    for (std::size_t j = i; j < kNames.size(); ++j) text += format(",{}_{}", kNames.at(i), kNames.at(j));
  text += '\n';
  std::size_t k = 0;
  for (const StampedPose& pose : poses) {
    const auto off = [&](std::size_t i) { return std::chrono::abs(keyframes[i].stamp - pose.stamp); };
    while (k + 1 < keyframes.size() && off(k + 1) <= off(k)) ++k;
    text += stamp_text(pose.stamp);
    for (Eigen::Index i = 0; i < 6; ++i)
      for (Eigen::Index j = i; j < 6; ++j) text += format(",{}", covariances[k](i, j));
    text += '\n';
  }
  return text;
}

/// Of T_frame_base at a robot's keyframes, in the target frame where `frame` is that.
Result<std::vector<Matrix6>> covariances_in(const OutputFrame& frame, const PlacedSession& session,
                                            std::size_t robot, const MapCovariance& covariance) {
  const RobotMap& map = *session.robots[robot].map;
  std::vector<Place> places;
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) places.push_back({robot, k});
  if (!frame.name.empty())
    return target_covariances(session, covariance, *georeference_of(session.saved.georeferences, map.name),
                              places);
  std::vector<Matrix6> in_map;
  for (const Place& place : places) in_map.push_back(covariance.at(place));
  return in_map;
}

/// Paths that a conversion wrote.
using Written = std::vector<fs::path>;

/// Every robot's poses at every scan, in OUT with the robot's name before the extension.
Result<Written> convert_poses(const PlacedSession& session, const ConvertOptions& options) {
  Written files;
  std::optional<MapCovariance> covariance;
  if (options.covariance) {
    Result<MapCovariance> found = MapCovariance::of(session, options.in);
    if (!found) return tl::unexpected(found.error());
    covariance.emplace(std::move(*found));
  }
  for (std::size_t r = 0; r < session.robots.size(); ++r) {
    const PlacedRobot& robot = session.robots[r];
    const Result<OutputFrame> frame = frame_for(session, robot.map->name, options.frame);
    if (!frame) return tl::unexpected(frame.error());
    if (robot.shared_map != 0)
      print_notes("convert", {format("{} is in another map: its poses are in {}", robot.map->name,
                                     frame->name.empty() ? "the frame of that one" : frame->name)});
    const Trajectory poses = seen_from(frame->T_frame_map, at_every_scan(*robot.map, robot.T_world_keyframe));
    files.push_back(path_beside(options.out, "_" + robot.map->name));
    Result<> done = write_trajectory(files.back(), poses);
    if (done && covariance)
      done = covariances_in(*frame, session, r, *covariance).and_then([&](const auto& covariances) {
        files.push_back(
            path_beside(options.out, "_" + robot.map->name + "_covariance").replace_extension(".csv"));
        return write_bytes(files.back(), covariance_csv(poses, robot.map->keyframes, covariances));
      });
    if (!done) return tl::unexpected(done.error());
  }
  return files;
}

/// The number of the map that the robot is in; without a name that of the most robots.
Result<std::size_t> shared_map_of(const PlacedSession& session, const std::string& robot) {
  if (robot.empty()) return 0;
  std::vector<std::string> names;
  for (const PlacedRobot& placed : session.robots) {
    if (placed.map->name == robot) return placed.shared_map;
    names.push_back(placed.map->name);
  }
  return fail(format("no robot of the session is called {}; there are: {}", printable(robot),
                     fmt::join(names, ", ")));
}

/// Whose points are which, in files that number the robots; none where there is one.
std::vector<std::string> numbers_of_robots(const JointMap& map) {
  if (map.maps.size() < 2) return {};
  std::vector<std::string> numbers;
  for (const auto& robot : map.maps) numbers.push_back(format("{} {}", number_in_files(*robot), robot->name));
  return {format("points are numbered by robot: {}", fmt::join(numbers, ", "))};
}

Result<Written> convert_map(const PlacedSession& session, const ConvertOptions& options,
                            const MapsConfig& config) {
  const fs::path out = options.out;
  const Result<std::size_t> number = shared_map_of(session, options.robot);
  if (!number) return tl::unexpected(number.error());
  const JointMap map = joint_map_of(session, *number);
  OutputFrame frame;
  if (!map.maps.empty() && !is_for_robots(out)) {
    const Result<OutputFrame> found = frame_for(session, map.maps.front()->name, options.frame);
    if (!found) return tl::unexpected(found.error());
    frame = *found;
  }
  std::vector<std::string> notes;
  const Vector3 offset = float_offset(frame);
  if (kind_of(out.string()) == Kind::cloud && !offset.isZero())
    notes.push_back(format("{} holds coordinates of {} less {:.0f} {:.0f} {:.0f}, as its numbers are short",
                           out.string(), frame.name, offset.x(), offset.y(), offset.z()));
  for (const std::string& robot : map.left_out)
    notes.push_back(format("{0} is in another map and left out; --robot {0} writes that one", robot));
  print_notes("convert", notes);
  const Result<> written =
      options.mesh ? write_joint_mesh(out, map, config, frame) : write_joint_map(out, map, config, frame);
  if (!written) return tl::unexpected(written.error());
  if (!options.mesh && !is_for_robots(out)) print_notes("convert", numbers_of_robots(map));
  Written files{out};
  if (extension_of(out) == ".pgm") files.push_back(fs::path(out).replace_extension(".yaml"));
  return files;
}

/// Where it is not the one file that was named: which there are now.
void print_written(const Written& files, const std::string& out, bool json) {
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.string());
  if (json)
    std::printf("%s\n", json_text(nlohmann::ordered_json{{"written", names}}).c_str());
  else if (names != std::vector<std::string>{out})
    std::printf("written: %s\n", format("{}", fmt::join(names, ", ")).c_str());
}

Result<Written> convert_session(const ConvertOptions& options, const MapsConfig& config) {
  const bool keeps_frame = kind_of(options.out) == Kind::graph || extension_of(options.out) == ".mcap" ||
                           is_for_robots(options.out);
  if (options.covariance && kind_of(options.out) != Kind::trajectory)
    usage_error("--covariance is for poses: .tum, .kitti or .csv");
  if (options.mesh && extension_of(options.out) != ".ply") usage_error("--mesh is for a .ply");
  if (keeps_frame && options.frame == "target")
    usage_error("graphs and what robots and viewers load (.mcap, .pgm, .bt) are in the map's own frame");
  const bool is_of_all = kind_of(options.out) == Kind::graph || kind_of(options.out) == Kind::trajectory ||
                         extension_of(options.out) == ".mcap";
  if (!options.robot.empty() && is_of_all)
    usage_error("--robot chooses among joint maps; graphs, poses and .mcap have all robots");
  const fs::path out = options.out;
  if (kind_of(options.out) == Kind::graph)
    return convert_graph(fs::path(options.in) / "graph_initial.g2o", fs::path(options.in).filename().string(),
                         out)
        .map([&] { return Written{out}; });
  return read_placed_session(options.in).and_then([&](const PlacedSession& session) -> Result<Written> {
    if (kind_of(options.out) == Kind::trajectory) return convert_poses(session, options);
    if (extension_of(out) != ".mcap") return convert_map(session, options, config);
    return write_session_mcap(out, session, config.voxel_m, config.start_together).map([&] {
      return Written{out, fs::path(out).replace_extension(".layout.json")};
    });
  });
}

/// What a kind of input can become, for people.
std::string_view outputs_of(Kind kind) {
  switch (kind) {
    case Kind::recording:
      return "a recording becomes .mcap, a folder of clouds, or its poses (.tum, .csv, .kitti); maps (.las, "
             ".ply, .pgm, .bt) are of sessions, which adit slam makes of it";
    case Kind::cloud:
      return "a cloud becomes .pcd, .ply or .bin";
    case Kind::mesh:
      return "a mesh becomes .ply";
    case Kind::trajectory:
      return "a trajectory becomes .tum, .csv or .kitti";
    case Kind::graph:
      return "a graph becomes .g2o or .jrl";
    case Kind::session:
    case Kind::unknown:
      break;
  }
  return "adit converts sessions, recordings (.mcap, .db3, .bag, folders), clouds (.pcd, .ply, .bin), meshes "
         "(.obj, .stl, .dae, .glb), trajectories (.tum, .csv) and graphs (.g2o, .jrl, .cbor)";
}

Result<> convert(const ConvertOptions& options, const Common& common) {
  const std::string& in = options.in;
  const std::string& out = options.out;
  const Kind from = kind_of(in);
  const Kind to = kind_of(out);
  refuse_to_replace_input(in, out);
  if (from == Kind::session)
    return configured(common)
        .and_then([&](const RunConfig& config) { return convert_session(options, config.maps); })
        .map([&](const Written& files) { print_written(files, out, common.json); });
  if (!options.frame.empty() || options.covariance || options.mesh || !options.robot.empty())
    usage_error("--frame, --covariance, --mesh and --robot are for what is written of a session, and " + in +
                " is none");
  const Result<RunConfig> config = configured(common);
  if (!config) return tl::unexpected(config.error());
  const RecordingConfig how = recording_config(config->recording, options.recording);
  if (from == Kind::recording && (to == Kind::recording || to == Kind::trajectory))
    return convert_recording(options, how);
  if (from == Kind::mesh && extension_of(out) == ".ply") return convert_mesh(in, out);
  if (from == Kind::cloud && to == Kind::cloud) return convert_cloud(in, out, how);
  if (from == Kind::trajectory && to == Kind::trajectory) return convert_trajectory(in, out);
  if (from == Kind::graph && to == Kind::graph) return convert_graph(in, fs::path(in).stem().string(), out);
  if (Result<> whole = check_not_metadata(in); !whole) return whole;
  usage_error(format("{} cannot become {}: {}", in, out, outputs_of(from)));
}

}  // namespace

void add_convert(Program& program) {
  const auto options = std::make_shared<ConvertOptions>();
  const Command command =
      program.add_command("convert",
                          "Convert between recording, cloud, mesh, trajectory and graph formats, and the map "
                          "of a session to others",
                          [options](const Common& common) { return convert(*options, common); });
  command.add_option("IN", options->in, "What to read").required();
  command.add_option("OUT", options->out, "What to write; its extension sets the format").required();
  command.add_option("--clouds", options->clouds, "Format of the clouds in a folder: pcd, ply or bin (KITTI)")
      .one_of({"pcd", "ply", "bin"})
      .default_shown();
  command
      .add_option("--frame", options->frame,
                  "Of clouds and poses of a session: map, or target (the default once it is georeferenced)")
      .one_of({"map", "target"});
  command.add_flag("--covariance", options->covariance,
                   "Beside the poses of a session their covariances: NAME_ROBOT_covariance.csv");
  command.add_option("--robot", options->robot,
                     "Of the maps of a session the one that this robot is in (default: that of the most "
                     "robots)");
  command.add_flag("--mesh", options->mesh, "The map of a session as a surface of triangles (.ply)");
  add_recording_options(command, options->recording);
  add_truth_topic(command, options->recording);
  command.footer(
      "session -> its joint map: .las, .pcd, .ply, .bt (OctoMap), or .pgm with .yaml (occupancy grid); .mcap "
      "with a layout "
      "for "
      "Foxglove; poses at every scan: NAME_ROBOT.tum (.csv .kitti); all its loops: .jrl, .g2o; fields "
      "maps.*\n"
      "recording (.mcap, .db3, .bag, bag folder, folder of clouds, FOLDER@even) -> .mcap, folder, or its "
      "poses (.tum .csv .kitti)\n"
      "cloud (.pcd .ply .bin) -> cloud; mesh (.obj .stl .dae .glb .ply) -> .ply, and of a .ply the vertices "
      "-> cloud\n"
      "trajectory (.tum .csv) -> .tum .csv .kitti; graph (.g2o .jrl .cbor) -> .g2o .jrl");
}

}  // namespace adit::app
