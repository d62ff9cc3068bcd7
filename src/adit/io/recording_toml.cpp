// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/recording_toml.hpp"

#include "adit/io/atomic_file.hpp"
#include "adit/io/config_toml.hpp"

namespace adit {

std::string_view to_string(CloudFrame frame) { return frame == CloudFrame::base ? "base" : "lidar"; }

Fields fields_of(RecordingToml& file) {
  return {{"robot", &file.robot, "", 0, 0, "the robot's name"},
          {"lidar", &file.lidar, "", 0, 0, "the sensor's name"},
          {"mount", &file.mount, "m, deg", 0, 0,
           "pose of the LiDAR on the robot, 'x y z' or 'x y z roll pitch yaw'"},
          enum_field("frame", &file.frame, std::array{CloudFrame::lidar, CloudFrame::base},
                     "frame of the clouds"),
          {"assumed", &file.assumed, "", 0, 0, "what had to be assumed, a sentence per line"}};
}

Result<RecordingToml> read_recording_toml(const std::filesystem::path& path) {
  RecordingToml file;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return file;
  return load_config(path, fields_of(file)).map([&] { return file; });
}

Result<> write_recording_toml(const std::filesystem::path& path, RecordingToml content) {
  return write_bytes(path, to_toml(fields_of(content)));
}

}  // namespace adit
