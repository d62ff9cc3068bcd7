// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/loop_registration.hpp"

#include <gtest/gtest.h>

#include "adit/fleet/sync/fleet_graph.hpp"
#include "support/box_world.hpp"

namespace adit {
namespace {

std::vector<LoopClosure> registered_with(const RegistrationConfig& config) {
  const std::vector<Pose> truth = {Pose(), Pose::planar(1.0, 0.3, 0.2)};
  const auto map = std::make_shared<const RobotMap>(test::drive(test::BoxWorld(3), {0}, truth, 0.0));
  LoopRegistration registration(std::make_shared<FeatureStore>(map, config, SubmapConfig{}), {config});
  return registration.within_own_map({{{{0}, 0}, {{0}, 1}, 0.0, 0.1}});
}

TEST(LoopRegistration, WhereNoPairOfSurfacesAgreesThereIsNoLoop) {
  RegistrationConfig config;
  config.voxel_size = 0.6;
  const LoopClosure sound = registered_with(config).at(0);
  ASSERT_EQ(sound.verdict, LoopVerdict::accepted) << sound.reason;
  EXPECT_TRUE(is_usable(sound.information));

  config.min_overlap = 0.0;               // as a user may set it
  config.overlap_distance_voxels = 1e-9;  // in place of surfaces of which none agrees
  const LoopClosure unfounded = registered_with(config).at(0);
  EXPECT_EQ(unfounded.verdict, LoopVerdict::rejected);
  EXPECT_NE(unfounded.reason.find("no pair of surfaces agrees"), std::string::npos) << unfounded.reason;
}

}  // namespace
}  // namespace adit
