// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "inputs.hpp"

#include <algorithm>
#include <cstdio>
#include <set>

#include "adit/core/format.hpp"
#include "adit/io/mesh_files.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/routes_yaml.hpp"

namespace adit::app {
namespace {

bool is_routes_file(const std::string& input) {
  const std::string extension = std::filesystem::path(input).extension().string();
  return extension == ".yaml" || extension == ".yml";
}

}  // namespace

Result<World> load_world(const std::filesystem::path& world_file, const std::filesystem::path& routes_file) {
  Result<RoutesFile> routes = read_routes(routes_file);
  if (!routes) return tl::unexpected(routes.error());
  const std::filesystem::path mesh_file = world_file.empty() ? routes->world : world_file;
  if (mesh_file.empty()) {
    return fail(routes_file.string() + ": names no world; add 'world: FILE' to it or give --world FILE");
  }
  Result<TriangleMesh> mesh = read_mesh(mesh_file);
  if (!mesh) return tl::unexpected(mesh.error());
  World world;
  const std::filesystem::path folder = std::filesystem::absolute(mesh_file).parent_path();
  world.name = mesh_file.stem() == "world" ? folder.filename().string() : mesh_file.stem().string();
  world.mesh = std::move(*mesh);
  world.routes = std::move(routes->routes);
  return world;
}

void add_recording_options(CLI::App& command, RecordingConfig& config) {
  command
      .add_option(
          "--mount", config.mount,
          "Pose of the LiDAR on the robot, X,Y,Z[,ROLL,PITCH,YAW] in metres and degrees; overrides what "
          "recordings say")
      ->check([](const std::string& text) {
        const Result<Pose> mount = parse_mount(text);
        return mount ? std::string() : mount.error().message;
      });
  command.add_option("--points", config.points, "Topic of the clouds, for recordings with several");
}

Result<Recording> open_input(const std::string& input, const RecordingConfig& config) {
  return open_recording(input, config).map([&](Recording recording) {
    for (const std::string& assumption : recording.assumptions)
      std::fprintf(stderr, "adit: %s: assumed %s\n", input.c_str(), assumption.c_str());
    return recording;
  });
}

Result<std::vector<Recording>> open_inputs(const std::vector<std::string>& inputs,
                                           const ScenarioConfig& simulation, const RecordingConfig& config) {
  if (inputs.size() == 1 && is_routes_file(inputs.front())) {
    return load_world({}, inputs.front()).and_then([&](const World& world) {
      return simulate(world, simulation);
    });
  }
  std::vector<Recording> recordings;
  std::set<std::string> names;
  for (const std::string& input : inputs) {
    if (is_routes_file(input)) return fail(input + ": a routes file stands for all robots; give it alone");
    Result<Recording> recording = open_input(input, config);
    if (!recording) return tl::unexpected(recording.error());
    if (!names.insert(recording->name).second) {
      return fail(format("{}: a robot named '{}' was given before; rename the file or folder", input,
                         recording->name));
    }
    recordings.push_back(std::move(*recording));
  }
  return recordings;
}

Result<> choose_lidar(const std::string& name, ScenarioConfig& config) {
  return lidar_preset(name).map([&](LidarConfig lidar) {
    lidar.mount_forward = config.lidar.mount_forward;
    lidar.mount_height = config.lidar.mount_height;
    config.lidar = lidar;
  });
}

}  // namespace adit::app
