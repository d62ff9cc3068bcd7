// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mount.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

TEST(Mount, ThreeNumbersAreAPlaceWithoutRotation) {
  for (const char* text : {"0.3 -0.1 0.9", "0.3,-0.1,0.9", " 0.3, -0.1 ,0.9 "}) {
    const Result<Pose> mount = parse_mount(text);
    ASSERT_TRUE(mount) << mount.error().message;
    EXPECT_EQ(mount->translation(), Vector3(0.3, -0.1, 0.9));
    EXPECT_EQ(mount->rotation().coeffs(), Pose().rotation().coeffs());
    EXPECT_EQ(mount_text(*mount), "0.3 -0.1 0.9");
  }
}

TEST(Mount, AnglesTurnAboutTheAxesOfTheBase) {
  // Roll first: z of the LiDAR points to -y of the base, which the yaw then turns to +x.
  const Pose mount = parse_mount("0 0 1 90 0 90").value();
  EXPECT_LT((mount.rotation() * Vector3::UnitZ() - Vector3::UnitX()).norm(), 1e-12);
  EXPECT_LT((mount.rotation() * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-12);
  // A LiDAR that looks down by 15 degrees: its x axis goes below the horizon.
  EXPECT_LT((parse_mount("0 0 1 0 15 0").value() * Vector3::UnitX()).z(), 1.0 - 0.25);
}

TEST(Mount, TextReadsBack) {
  Rng rng(5);
  std::vector<Pose> poses = {Pose::planar(1, 2, -3, 0.5), parse_mount("0 0 1 0 90 20").value(),
                             parse_mount("0 0 1 180 0 0").value(), parse_mount("0 0 1 10 -90 0").value()};
  for (int i = 0; i < 100; ++i) {
    Vector6 tangent;
    for (double& x : tangent) x = rng.uniform(-1.7, 1.7);
    poses.push_back(Pose::exp(tangent));
  }
  for (const Pose& pose : poses) {
    const Result<Pose> back = parse_mount(mount_text(pose));
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->translation(), pose.translation());
    EXPECT_LT((back->inverse() * pose).log().norm(), 1e-8) << mount_text(pose);
  }
}

TEST(Mount, AnythingElseIsRefusedWithTheFormThatIsNeeded) {
  EXPECT_ERROR(parse_mount(""), "0 numbers; 'x,y,z' or 'x,y,z,roll,pitch,yaw'");
  EXPECT_ERROR(parse_mount("1 2"), "2 numbers");
  EXPECT_ERROR(parse_mount("1 2 3 4"), "4 numbers");
  EXPECT_ERROR(parse_mount("1 2 up"), "'up' is not a finite number");
  EXPECT_ERROR(parse_mount("1 2 nan"), "'nan' is not a finite number");
  EXPECT_ERROR(mount_of({"1", ""}), "1 numbers");
  EXPECT_FALSE(mount_of({}).value().has_value());
}

TEST(Mount, APositionThatOverflowsIsRefused) {
  EXPECT_ERROR(parse_mount("0 1.7e308 0"), "mount '0 1.7e308 0': 1.7e+308 is not a coordinate in metres");
  EXPECT_ERROR(parse_mount("0 0 -2e9 0 0 90"), "-2000000000 is not a coordinate");
}

}  // namespace
}  // namespace adit
