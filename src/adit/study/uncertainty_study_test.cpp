// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/uncertainty_study.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "support/files.hpp"
#include "support/short_drives.hpp"

namespace adit {
namespace {

const Calibration& of(const std::vector<UncertaintyRow>& rows, const std::string& source) {
  const auto found = std::ranges::find(rows, source, &UncertaintyRow::source);
  ADIT_CHECK(found != rows.end(), "the study has this source");
  return found->calibration;
}

TEST(UncertaintyStudy, MeasuresOdometryAndLoopsOfAWorld) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "maps");
  const ListedWorld world = test::put_short_drives(folder.path());
  UncertaintyStudy study{test::quick_config(), folder.path()};
  const auto rows = measure_world(study, world);
  ASSERT_TRUE(rows) << rows.error().message;
  // Two robots drive five metres each: nine stretches of a metre or so, none of ten.
  EXPECT_GE(of(*rows, "odometry over 1 m").count(), 6U);
  EXPECT_EQ(of(*rows, "odometry over 10 m").count(), 0U);
  EXPECT_LT(of(*rows, "odometry over 1 m").rms().head<3>().norm(), 0.1);
  EXPECT_EQ(of(*rows, "loops").num_unusable(), 0U);
  EXPECT_GT(of(*rows, "innovations").count(), 20U);

  // Steps that are stated to drift more are measured as more cautious.
  study.config.slam.robot.noise.drift_per_metre *= 4.0;
  const auto cautious = measure_world(study, world);
  ASSERT_TRUE(cautious) << cautious.error().message;
  EXPECT_LT(of(*cautious, "odometry over 1 m").mean(), 0.95 * of(*rows, "odometry over 1 m").mean());
}

TEST(UncertaintyStudy, TheTurnOfAMountIsNoErrorOfThePath) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "maps");
  const ListedWorld world = test::put_short_drives(folder.path());
  UncertaintyStudy study{test::quick_config(), folder.path()};
  study.config.simulation.lidar_errors.mount_deg = 2.0;
  const auto rows = measure_world(study, world);
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_LT(of(*rows, "odometry over 1 m").rms().head<3>().norm(), 0.02) << "by the turn it would be 0.04";
}

TEST(UncertaintyStudy, ATableAndJsonHoldOneRowPerSource) {
  std::vector<UncertaintyRow> rows(1);
  rows[0].source = "odometry over 1 m";
  rows[0].calibration.add(Vector6::Ones() * 0.1, Matrix6::Identity() * 0.01);
  std::vector<UncertaintyRow> more = rows;
  more.push_back({"loops", {}});
  join(rows, more);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].calibration.count(), 2U);
  rows.push_back({"innovations", {}});
  rows[2].calibration.add_normalised(12.0);
  const MeasuredUncertainty measured{"os2-32, no IMU", rows};
  const Table table = uncertainty_table(measured);
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(table.rows[0][1], "2");
  EXPECT_EQ(table.rows[0][4], "1.00");
  EXPECT_EQ(table.rows[1][4], "-");
  // Innovations are known as a whole, not axis by axis.
  EXPECT_EQ(table.rows[2][4], "2.00");
  EXPECT_EQ(table.rows[2][5], "-");
  const nlohmann::json all = nlohmann::json::parse(uncertainty_json({measured}));
  EXPECT_EQ(all[0]["sensors"], "os2-32, no IMU");
  const nlohmann::json json = all[0]["sources"];
  EXPECT_NEAR(json[0]["nees_over_dof"].get<double>(), 1.0, 1e-12);
  EXPECT_EQ(json[1]["count"], 0);
}

}  // namespace
}  // namespace adit
