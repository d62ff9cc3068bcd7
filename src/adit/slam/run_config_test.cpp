// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/run_config.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "adit/io/config_toml.hpp"

namespace adit {
namespace {

std::string toml_of(RunConfig config) { return to_toml(fields_of(config)); }

TEST(RunConfig, EveryKeyHasOneMeaning) {
  RunConfig config;
  std::set<std::string> keys;
  for (const Field& field : fields_of(config)) EXPECT_TRUE(keys.insert(field.key).second) << field.key;
  for (const char* key : {"keyframes", "paper_odometry", "robot.odometry.method", "loops.place.max_distance",
                          "loops.registration.min_inliers", "loops.adaptive.registration.voxel_size",
                          "back_end.gnc.mu_step", "simulation.lidar.beams", "world.preset", "bus.loss"})
    EXPECT_TRUE(keys.contains(key)) << key;
}

TEST(RunConfig, WhatIsPrintedIsReadBackAndChangesNothing) {
  for (const Profile profile : kProfiles) {
    const std::string printed = toml_of(config_of(profile));
    RunConfig config;
    const Result<> read = parse_config(fields_of(config), printed);
    ASSERT_TRUE(read.has_value()) << read.error().message;
    EXPECT_EQ(toml_of(config), printed) << to_string(profile);
  }
}

TEST(RunConfig, TheDefaultIsTheSafePolicy) {
  const SlamConfig config;
  EXPECT_EQ(config.keyframes, KeyframeSelection::adaptive);
  EXPECT_EQ(config.agent().policy, MergePolicy::adaptive);
  EXPECT_EQ(toml_of(config_of(Profile::standard)), toml_of(RunConfig{}));
}

TEST(RunConfig, TheProfileOfThePaperIsItsPipeline) {
  const RunConfig config = config_of(Profile::paper);
  EXPECT_EQ(config.slam.keyframes, KeyframeSelection::tunnel_filter);
  EXPECT_EQ(config.slam.agent().policy, MergePolicy::paper);
  RunConfig by_hand;
  for (const auto& [key, value] :
       {std::pair("keyframes", "tunnel_filter"), std::pair("robot.odometry.method", "kinematic-icp")})
    ASSERT_TRUE(set_field(fields_of(by_hand), key, value));
  EXPECT_EQ(toml_of(config), toml_of(by_hand));
}

TEST(RunConfig, StudiesRunThePapersPoliciesOnThePapersOdometry) {
  RunConfig config;
  ASSERT_TRUE(set_field(fields_of(config), "paper_odometry", "kiss-icp"));
  const auto method_under = [&](KeyframeSelection policy) {
    RunConfig under = with_policy(policy, config);
    EXPECT_EQ(under.slam.keyframes, policy);
    const Fields fields = fields_of(under);
    return value_text(*std::ranges::find(fields, "robot.odometry.method", &Field::key));
  };
  EXPECT_EQ(method_under(KeyframeSelection::all), "kiss-icp");
  EXPECT_EQ(method_under(KeyframeSelection::tunnel_filter_keep), "kiss-icp");
  EXPECT_EQ(method_under(KeyframeSelection::adaptive), "plane-icp");
}

}  // namespace
}  // namespace adit
