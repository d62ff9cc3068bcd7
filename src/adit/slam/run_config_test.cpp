// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/run_config.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "adit/io/config_toml.hpp"
#include "adit/odometry/scan_to_map.hpp"
#include "adit/place/scan_context.hpp"
#include "adit/simulation/lidar_model.hpp"
#include "adit/slam/settings_to_watch.hpp"

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

TEST(RunConfig, SettingsToWatchAreFieldsInTheirOrder) {
  RunConfig config;
  const Fields fields = fields_of(config);
  auto from = fields.begin();
  for (const SettingToWatch& one : settings_to_watch()) {
    from = std::ranges::find(from, fields.end(), one.key, &Field::key);
    ASSERT_NE(from++, fields.end()) << one.key;
    EXPECT_EQ((std::string(one.when) + std::string(one.watch)).find('|'), std::string::npos)
        << "a table's edge";
  }
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

// Defaults for which a header names a source, compared with that source.
TEST(RunConfig, DefaultsAreThoseThatHeadersNameASourceFor) {
  const ScanContextConfig place;  // Kim and Kim, IROS 2018: 20 rings of 4 m, 60 sectors
  EXPECT_EQ(place.num_rings, 20);
  EXPECT_EQ(place.num_sectors, 60);
  EXPECT_EQ(place.max_radius_m, 20 * 4.0);
  const ScanToMapConfig kiss_icp;  // KISS-ICP 1.2, default.yaml
  EXPECT_EQ(kiss_icp.voxel_size, kiss_icp.max_range / 100.0);
  EXPECT_EQ(kiss_icp.max_points_per_voxel, 20);
  EXPECT_EQ(kiss_icp.max_iterations, 500);
  EXPECT_EQ(kiss_icp.convergence, 1e-4);
  const LidarConfig lidar;  // data sheet of the Ouster OS2-128: 22.5 degrees
  EXPECT_EQ(lidar.name, "os2-128");
  EXPECT_EQ(lidar.beams, 128);
  EXPECT_EQ(lidar.elevation_max_deg - lidar.elevation_min_deg, 22.5);
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
