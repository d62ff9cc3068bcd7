// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/trajectory_files.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/kitti.hpp"
#include "adit/io/text.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

std::string extension_of(const std::filesystem::path& path) { return lower_case(path.extension().string()); }

std::string csv_text(const Trajectory& trajectory) {
  std::string text = "stamp_s,x,y,z,qx,qy,qz,qw\n" + tum_text(trajectory);
  std::ranges::replace(text, ' ', ',');
  return text;
}

/// What a file is that begins with this line and is no trajectory; "" where that is not known.
std::string_view other_kind(std::string_view heading) {
  const auto has = [&](std::string_view columns) { return heading.find(columns) != std::string_view::npos; };
  if (has("from_robot,from_keyframe"))
    return "is the loops.csv of a session, not a trajectory; 'adit info SESSION' says what the session holds";
  if (has("stamp_s,x_x,x_y"))
    return "has the covariances of poses (adit convert --covariance), not the poses; these are in the file "
           "beside it";
  if (has("sigma"))
    return "has control points, not a trajectory; 'adit georeference SESSION --control FILE' takes them";
  return "";
}

Result<Trajectory> read_csv(const std::filesystem::path& path) {
  return read_bytes(path).and_then([&](std::string text) -> Result<Trajectory> {
    const std::string heading = text.substr(0, text.find('\n'));
    // The heading becomes a comment, the rest is TUM with commas.
    if (!text.empty() && (text[0] < '0' || text[0] > '9') && text[0] != '-') text[0] = '#';
    std::ranges::replace(text, ',', ' ');
    Result<Trajectory> trajectory = parse_tum(text);
    if (trajectory) return trajectory;
    if (const std::string_view kind = other_kind(heading); !kind.empty())
      return fail(format("{}: {}", path.string(), kind));
    return fail(path.string(), trajectory.error());
  });
}

}  // namespace

Result<Trajectory> read_trajectory(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".kitti")
    return fail(path.string() + ": KITTI poses have no stamps, so they can be written but not read");
  return extension == ".csv" ? read_csv(path) : read_tum(path);
}

Result<> write_trajectory(const std::filesystem::path& path, const Trajectory& trajectory) {
  const std::string extension = extension_of(path);
  if (extension == ".csv") return write_bytes(path, csv_text(trajectory));
  if (extension == ".kitti") return write_bytes(path, write_kitti_poses(trajectory));
  return write_tum(path, trajectory);
}

}  // namespace adit
