// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "adit/core/json_text.hpp"
#include "adit/io/tum.hpp"
#include "command_line.hpp"
#include "sessions.hpp"

namespace adit::app {
namespace {

struct GeoreferenceOptions {
  std::string session;
  ControlOptions control;
};

nlohmann::ordered_json point_json(const JudgedControl& judged) {
  nlohmann::ordered_json json{{"name", judged.point.name},
                              {"use", std::string(to_string(judged.use))},
                              {"residual_m", {judged.residual.x(), judged.residual.y(), judged.residual.z()}},
                              {"misfit", nullptr}};
  if (judged.misfit) json["misfit"] = *judged.misfit;
  return json;
}

nlohmann::ordered_json map_json(const Georeference& map) {
  const Eigen::Matrix4d T = map.T_target_map.matrix();
  nlohmann::ordered_json json{{"robots", map.robots}, {"crs", map.crs}};
  for (Eigen::Index i = 0; i < 16; ++i) json["T_target_map"].push_back(T(i / 4, i % 4));
  for (const double value : map.covariance.reshaped()) json["covariance"].push_back(value);
  json["chi2"] = map.chi2;
  json["redundancy"] = map.redundancy;
  json["scale_ppm"] = map.scale_ppm;
  json["scale_sigma_ppm"] = map.scale_sigma_ppm;
  json["far_end"] = {{"robot", map.far_end.robot},
                     {"stamp_s", stamp_text(map.far_end.stamp)},
                     {"sigma_xy_m", map.far_end.sigma_xy},
                     {"sigma_z_m", map.far_end.sigma_z}};
  for (const JudgedControl& point : map.points) json["points"].push_back(point_json(point));
  return json;
}

Result<> georeference_command(const GeoreferenceOptions& options, const Common& common) {
  return read_control(options.control)
      .and_then([&](const Control& control) {
        return georeference_session(options.session, control, "georeference");
      })
      .map([&](const std::vector<Georeference>& maps) {
        if (!common.json) return print_georeferences(maps);
        nlohmann::ordered_json json{{"maps", nlohmann::ordered_json::array()}};
        for (const Georeference& map : maps) json["maps"].push_back(map_json(map));
        std::printf("%s\n", json_text(json, 2).c_str());
      });
}

}  // namespace

void add_georeference(Program& program) {
  const auto options = std::make_shared<GeoreferenceOptions>();
  const Command command = program.add_command(
      "georeference", "Place the maps of a session in the coordinates of surveyors, by control points",
      [options](const Common& common) { return georeference_command(*options, common); });
  command.add_option("session", options->session, "Session directory; the result is kept in it").required();
  add_control_options(command, options->control).required();
  command.footer(
      "Columns of the CSV: name, x, y, z (target frame, metres), sigma; where needed sigma_z, role (control "
      "or "
      "check), mark_x mark_y mark_z (in map.ply, or with robot and stamp in the frame of that robot's base), "
      "mark_frame (base, or lidar where such a mark is in the LiDAR's own frame, as in the recorded scan), "
      "mark_sigma. With robot and stamp alone the robot itself was there. adit convert then writes clouds "
      "and "
      "poses in the target frame.");
}

}  // namespace adit::app
