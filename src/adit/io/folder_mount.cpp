// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/folder_mount.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/format.hpp"
#include "adit/geometry/sensor_origin.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/mount.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNumSamples = 5;  // clouds looked into
constexpr double kSamePlace = 0.02;     // metres: nearer than this the sensor is the clouds' origin
constexpr double kCentred = 0.002;      // metres: a mean nearer to 0 was made so

FolderMount stated(const Pose& T_base_lidar, CloudFrame frame, std::string source) {
  FolderMount mount{T_base_lidar, {}, std::move(source), ""};
  if (frame == CloudFrame::base) mount.T_lidar_cloud = T_base_lidar.inverse();
  return mount;
}

/// The first cloud, the last, and some between, without those that cannot be read; fails where none can.
Result<std::vector<CloudFile>> read_samples(const std::vector<fs::path>& clouds, const CloudReading& known) {
  std::vector<CloudFile> samples;
  std::optional<Error> failure;
  const std::size_t count = std::min(kNumSamples, clouds.size());
  for (std::size_t k = 0; k < count; ++k) {
    Result<CloudFile> sample =
        read_cloud_file(clouds[count < 2 ? 0 : k * (clouds.size() - 1) / (count - 1)], known);
    if (sample)
      samples.push_back(std::move(*sample));
    else if (!failure)
      failure = sample.error();
  }
  if (samples.empty() && failure) return tl::unexpected(*failure);
  return samples;
}

/// The one VIEWPOINT of all clouds. One that changes is the path of the sensor in some map, not its mount.
std::optional<Pose> common_viewpoint(const std::vector<CloudFile>& samples) {
  const std::optional<Pose> first = samples.front().viewpoint;
  const bool is_common =
      first && std::ranges::all_of(samples, [&](const CloudFile& sample) {
        return sample.viewpoint && (first->inverse() * *sample.viewpoint).log().norm() < 1e-6;
      });
  return is_common ? first : std::nullopt;
}

double distance_of_mean(const PointCloud& cloud) {
  Vector3 sum = Vector3::Zero();
  for (const Eigen::Vector3f& point : cloud.points) sum += point.cast<double>();
  return (sum / static_cast<double>(cloud.size())).norm();
}

/// A millimetre is as far as the position is known.
Vector3 rounded(const Vector3& position) { return (position * 1000.0).array().round() / 1000.0; }

FolderMount found(const SensorOrigin& origin) {
  if (origin.position.norm() < kSamePlace) {
    return {{},
            {},
            format("found in the clouds: the LiDAR is at their origin (contrast {:.1f})", origin.contrast),
            ""};
  }
  const Vector3 place = rounded(origin.position);
  const Pose T_base_lidar(Eigen::Quaterniond::Identity(), place);
  return stated(
      T_base_lidar, CloudFrame::base,
      format("found in the clouds, whose frame is taken for the robot's (contrast {:.1f})", origin.contrast));
}

/// Whether each cloud was shifted to its own mean.
bool are_centred(const std::vector<CloudFile>& samples) {
  return std::ranges::all_of(
      samples, [](const CloudFile& sample) { return distance_of_mean(sample.cloud) < kCentred; });
}

FolderMount assumed(const std::string& why, const std::string& remedy) {
  return {
      {},
      {},
      "assumed: the origin of the clouds",
      format("{}{}; their origin is taken for it. If it stood elsewhere, ranges are wrong and true merges "
             "may be refused, as the space that a scan saw to be free is judged from the wrong place: {}",
             kMountAssumption, why, remedy)};
}

FolderMount found_or_assumed(const std::vector<CloudFile>& samples) {
  if (are_centred(samples))
    return assumed("each cloud was shifted to its own mean, so the LiDAR's place differs from scan to scan",
                   "use the clouds as the LiDAR measured them");
  std::vector<PointCloud> clouds;
  for (const CloudFile& sample : samples) clouds.push_back(sample.cloud);
  const std::optional<SensorOrigin> origin = find_sensor_origin(clouds);
  if (origin) return found(*origin);
  return assumed("nothing says where the LiDAR stood in the clouds, and they do not show it",
                 format("{}, or write 'mount' into recording.toml", kMountRemedy));
}

}  // namespace

Result<FolderMount> mount_of_folder(const std::vector<fs::path>& clouds, const RecordingToml& file,
                                    const std::optional<Pose>& override, Wheels wheels,
                                    const CloudReading& known) {
  if (override) return stated(*override, file.frame, "given by the user");
  if (!file.mount.empty()) {
    return parse_mount(file.mount).map([&](const Pose& T_base_lidar) {
      return stated(T_base_lidar, file.frame, "recording.toml");
    });
  }
  const Result<std::vector<CloudFile>> samples = read_samples(clouds, known);
  if (!samples) return tl::unexpected(samples.error());
  if (const auto viewpoint = common_viewpoint(*samples))
    return stated(*viewpoint, file.frame, "VIEWPOINT of the clouds");
  const FolderMount mount = found_or_assumed(*samples);
  // Wheel odometry is of the base. Only clouds that were moved to it show where the LiDAR is on the robot.
  if (wheels == Wheels::absent || mount.T_lidar_cloud.log().norm() > 0.0) return mount;
  return fail(format(
      "there is wheel odometry, but nothing says where the LiDAR sits on the robot; {}, or write 'mount' "
      "into recording.toml",
      kMountRemedy));
}

}  // namespace adit
