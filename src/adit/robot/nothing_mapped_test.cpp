// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/nothing_mapped.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/core/angles.hpp"

namespace adit {
namespace {

/// Points 3 m away, within `width_deg` about the x axis.
Recording recording_of(double width_deg, std::size_t num_points) {
  Recording recording;
  recording.name = "robot_3";
  recording.scan_stamps = {Stamp{0}, Stamp{100'000'000}};
  recording.read_scan = [=](std::size_t) -> Result<Scan> {
    Scan scan;
    for (std::size_t i = 0; i < num_points; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(num_points - 1);
      const double azimuth = (share - 0.5) * width_deg * kDegree;
      scan.cloud.points.emplace_back(static_cast<float>(3.0 * std::cos(azimuth)),
                                     static_cast<float>(3.0 * std::sin(azimuth)), 0.0F);
    }
    return scan;
  };
  return recording;
}

TEST(NothingMapped, NamesADepthCameraByItsView) {
  const std::string camera = why_nothing_mapped(recording_of(80.0, 1000));
  EXPECT_NE(camera.find("robot_3: none of 2 scans"), std::string::npos) << camera;
  EXPECT_NE(camera.find("1000 points, 3.0 to 3.0 m away, within a view of 76 degrees"), std::string::npos)
      << camera;
  const std::string lidar = why_nothing_mapped(recording_of(360.0, 12));
  EXPECT_EQ(lidar.find("depth camera"), std::string::npos) << lidar;
  EXPECT_NE(lidar.find("12 points"), std::string::npos) << lidar;
}

TEST(NothingMapped, FewPointsAreNoCamera) {
  for (const std::size_t num : {std::size_t{0}, std::size_t{5}}) {
    const std::string few = why_nothing_mapped(recording_of(3.0, num));
    EXPECT_EQ(few.find("depth camera"), std::string::npos) << few;
    EXPECT_NE(few.find("too few points"), std::string::npos) << few;
  }
}

TEST(NothingMapped, PassesOnWhyAScanCannotBeRead) {
  Recording torn = recording_of(80.0, 10);
  torn.read_scan = [](std::size_t) -> Result<Scan> { return fail("scan 0: ends early"); };
  EXPECT_NE(why_nothing_mapped(torn).find("scan 0: ends early"), std::string::npos);
}

}  // namespace
}  // namespace adit
