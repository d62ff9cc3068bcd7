// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/routes_yaml.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "adit/core/config.hpp"
#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

std::string place(const YAML::Mark& mark) {
  return format("line {}, column {}", mark.line + 1, mark.column + 1);
}

tl::unexpected<Error> fail_at(const YAML::Node& node, const std::string& message) {
  return fail(place(node.Mark()) + ": " + message);
}

/// Only these keys, each once.
Result<> check_keys(const YAML::Node& map, const std::vector<std::string>& known) {
  std::vector<std::string> seen;
  for (const auto& entry : map) {
    if (!entry.first.IsScalar()) return fail_at(entry.first, "a key is a plain word");
    const std::string& key = entry.first.Scalar();
    if (std::ranges::find(known, key) == known.end()) {
      const std::string nearest = nearest_key(known, key);
      return fail_at(entry.first, format("unknown key '{}'{}", key,
                                         nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    if (std::ranges::find(seen, key) != seen.end())
      return fail_at(entry.first, format("key '{}' appears twice", key));
    seen.push_back(key);
  }
  return {};
}

Result<double> read_number(const YAML::Node& node) {
  const std::optional<double> value = node.IsScalar() ? parse_double(node.Scalar()) : std::nullopt;
  if (!value || !std::isfinite(*value)) return fail_at(node, "a finite number is needed");
  return *value;
}

Result<Vector3> read_waypoint(const YAML::Node& node) {
  if (!node.IsSequence() || node.size() != 3) return fail_at(node, "a waypoint is [x, y, z], in metres");
  Vector3 point;
  for (std::size_t i = 0; i < 3; ++i) {
    const Result<double> value = read_number(node[i]);
    if (!value) return tl::unexpected(value.error());
    point[static_cast<Eigen::Index>(i)] = *value;
  }
  return point;
}

Result<std::string> read_name(const YAML::Node& robot) {
  const YAML::Node name = robot["name"];
  if (!name || !name.IsScalar() || name.Scalar().empty()) return fail_at(robot, "the robot has no name");
  const std::string& text = name.Scalar();
  // Names become folders of a session.
  const bool is_plain = text != "." && text != ".." && text.find_first_of("/\\ \t\n") == std::string::npos;
  if (!is_plain) return fail_at(name, format("'{}' cannot name a file; leave out blanks and slashes", text));
  return text;
}

Result<double> read_speed(const YAML::Node& robot) {
  const YAML::Node node = robot["speed"];
  if (!node) return Route{}.speed_mps;
  return read_number(node).and_then([&](double speed) -> Result<double> {
    if (speed > 0.0) return speed;
    return fail_at(node, "speed is more than 0 m/s");
  });
}

Result<std::vector<Vector3>> read_waypoints(const YAML::Node& robot, const std::string& name) {
  const YAML::Node nodes = robot["waypoints"];
  if (!nodes || !nodes.IsSequence())
    return fail_at(robot, format("robot '{}' has no list of waypoints", name));
  if (nodes.size() < 2) return fail_at(nodes, format("robot '{}' needs at least two waypoints", name));
  std::vector<Vector3> waypoints;
  for (const YAML::Node& node : nodes) {
    const Result<Vector3> waypoint = read_waypoint(node);
    if (!waypoint) return tl::unexpected(waypoint.error());
    waypoints.push_back(*waypoint);
  }
  return waypoints;
}

Result<Route> read_route(const YAML::Node& robot) {
  if (!robot.IsMap()) return fail_at(robot, "a robot is a map of name, speed and waypoints");
  if (Result<> keys = check_keys(robot, {"name", "speed", "waypoints"}); !keys)
    return tl::unexpected(keys.error());
  const Result<std::string> name = read_name(robot);
  if (!name) return tl::unexpected(name.error());
  const Result<double> speed = read_speed(robot);
  if (!speed) return tl::unexpected(speed.error());
  return read_waypoints(robot, *name).map([&](std::vector<Vector3> waypoints) {
    return Route{*name, *speed, std::move(waypoints)};
  });
}

Result<RoutesFile> read_document(const YAML::Node& document) {
  if (!document.IsMap()) return fail("a routes file is a map of world and robots");
  if (Result<> keys = check_keys(document, {"world", "robots"}); !keys) return tl::unexpected(keys.error());
  RoutesFile file;
  if (const YAML::Node world = document["world"]) {
    if (!world.IsScalar()) return fail_at(world, "world is a file name");
    file.world = world.Scalar();
  }
  const YAML::Node robots = document["robots"];
  if (!robots || !robots.IsSequence() || robots.size() == 0)
    return fail("no robots; 'robots:' is a list of them");
  for (const YAML::Node& robot : robots) {
    Result<Route> route = read_route(robot);
    if (!route) return tl::unexpected(route.error());
    if (std::ranges::find(file.routes, route->name, &Route::name) != file.routes.end()) {
      return fail_at(robot, format("a second robot named '{}'", route->name));
    }
    file.routes.push_back(std::move(*route));
  }
  return file;
}

/// Quoted, so that no name is mistaken for YAML syntax.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

}  // namespace

Result<RoutesFile> parse_routes(const std::string& yaml) {
  try {
    return read_document(YAML::Load(yaml));
  } catch (const YAML::Exception& error) {
    return fail((error.mark.is_null() ? "" : place(error.mark) + ": ") + error.msg);
  }
}

Result<RoutesFile> read_routes(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<RoutesFile> file = parse_routes(*bytes);
  if (!file) return fail(path.string(), file.error());
  if (!file->world.empty() && file->world.is_relative()) file->world = path.parent_path() / file->world;
  return file;
}

std::string routes_text(const RoutesFile& routes) {
  std::string text = routes.world.empty() ? "" : format("world: {}\n", quoted(routes.world.string()));
  text += "robots:\n";
  for (const Route& route : routes.routes) {
    text += format("  - name: {}\n    speed: {}\n    waypoints:\n", quoted(route.name), route.speed_mps);
    for (const Vector3& p : route.waypoints) text += format("      - [{}, {}, {}]\n", p.x(), p.y(), p.z());
  }
  return text;
}

Result<> write_routes(const std::filesystem::path& path, const RoutesFile& routes) {
  return write_bytes(path, routes_text(routes));
}

}  // namespace adit
