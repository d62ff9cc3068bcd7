// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// A session in the coordinates of surveyors.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "adit/core/format.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/georeference.hpp"
#include "adit/io/tum.hpp"
#include "support/files.hpp"
#include "support/program.hpp"
#include "support/two_drives.hpp"

namespace adit {
namespace {

using test::expect_done;
using test::expect_refused;
using test::get_file;
using test::put_file;
using test::run_adit;

/// The world of the simulator in a national grid.
const Pose kT_grid_world = Pose(so3::exp({0, 0, 2.2}), {403'217.4, 5'719'842.9, -312.6});

class Georeferenced : public ::testing::Test {
 protected:
  void SetUp() override {
    test::put_drives(folder_.path(), {{0, 50, "ahead"}, {10, 60, "behind"}, {5, 55, "later"}});
    expect_done("simulate --routes " + in("routes.yaml") + " --lidar vlp-16 --out " + in("drives"));
    expect_done("slam " + drive("ahead") + " " + drive("behind") + " --out " + in("s"));
  }

  [[nodiscard]] std::string in(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string drive(const std::string& robot) const { return in("drives/" + robot + ".mcap"); }
  [[nodiscard]] Trajectory truth(const std::string& robot) const {
    return read_tum(in("drives/" + robot + "_truth.tum")).value();
  }
  [[nodiscard]] Trajectory mapped(const std::string& robot) const {
    return read_tum(in("s/" + robot + "/trajectory.tum")).value();
  }

  enum class Seen { in_scan, in_map, robot_itself };
  /// A line of the CSV about a point beside the robot at a share of its drive, or about the robot.
  [[nodiscard]] std::string line(const std::string& name, const std::string& robot, double share, Seen seen,
                                 const Vector3& blunder = Vector3::Zero(),
                                 const std::string& role = "control") const {
    const Trajectory keyframes = mapped(robot);
    const StampedPose& keyframe =
        keyframes[static_cast<std::size_t>(share * static_cast<double>(keyframes.size() - 1))];
    const Vector3 in_base =
        seen == Seen::robot_itself ? Vector3::Zero() : Vector3(3.0, share < 0.5 ? 2.0 : -2.0, 1.5);
    const Vector3 surveyed =
        kT_grid_world * (pose_at(truth(robot), keyframe.stamp).value() * in_base) + blunder;
    const Vector3 mark = seen == Seen::in_map ? keyframe.T_world_body * in_base : in_base;
    return format("{},{},{},{},0.01,{},{},{}{}\n", name, surveyed.x(), surveyed.y(), surveyed.z(), role,
                  robot, seen == Seen::in_map ? "" : stamp_text(keyframe.stamp),
                  seen == Seen::robot_itself ? ",,," : format(",{},{},{}", mark.x(), mark.y(), mark.z()));
  }
  /// Six control points, the fourth of them a blunder, and two check points, the second of them wrong.
  void put_control() const {
    put_file(in("points.csv"),
             "name,x,y,z,sigma,role,robot,stamp,mark_x,mark_y,mark_z\n" +
                 line("T1", "ahead", 0.0, Seen::in_scan) + line("T2", "ahead", 0.4, Seen::in_map) +
                 line("T3", "ahead", 1.0, Seen::robot_itself) +
                 line("T4", "behind", 0.6, Seen::in_scan, {0, 4, 0}) +
                 line("T5", "behind", 0.8, Seen::in_scan) + line("T6", "behind", 1.0, Seen::in_scan) +
                 line("C1", "behind", 0.3, Seen::in_scan, Vector3::Zero(), "check") +
                 line("C2", "behind", 0.5, Seen::in_map, {0, 0, 3}, "check"));
  }

  const test::TemporaryFolder folder_;
};

void expect_uses(const nlohmann::json& points, const std::vector<std::string>& uses) {
  ASSERT_EQ(points.size(), uses.size());
  for (std::size_t i = 0; i < uses.size(); ++i) EXPECT_EQ(points[i]["use"], uses[i]) << points[i].dump();
}

/// The variances of x, y and z at each pose, in the axes of the robot, of a file that convert --covariance
/// wrote.
std::vector<Vector3> variances_in(const std::string& csv) {
  std::istringstream text(get_file(csv));
  std::string line;
  std::getline(text, line);
  std::vector<Vector3> variances;
  while (std::getline(text, line)) {
    std::vector<double> numbers;
    std::istringstream row(line);
    for (std::string word; std::getline(row, word, ',');) numbers.push_back(std::stod(word));
    variances.emplace_back(numbers.at(1), numbers.at(7), numbers.at(12));
  }
  return variances;
}

TEST_F(Georeferenced, CovariancesHoldTheErrorOfTheTransform) {
  put_control();
  expect_done("georeference " + in("s") + " --control " + in("points.csv"));
  expect_done("convert " + in("s") + " " + in("own.tum") + " --covariance --frame map");
  expect_done("convert " + in("s") + " " + in("grid.tum") + " --covariance");
  double largest = 0.0;
  for (const std::string robot : {"ahead", "behind"}) {
    const Trajectory poses = read_tum(in("grid_" + robot + ".tum")).value();
    const std::vector<Vector3> in_grid = variances_in(in("grid_" + robot + "_covariance.csv"));
    ASSERT_EQ(in_grid.size(), poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Vector3 true_position =
          kT_grid_world * pose_at(truth(robot), poses[i].stamp).value().translation();
      const double error_m = (poses[i].T_world_body.translation() - true_position).norm();
      EXPECT_LT(error_m, 5.0 * std::sqrt(in_grid[i].sum())) << robot << ", pose " << i;
      largest = std::max(largest, in_grid[i].sum());
    }
  }
  // The map is fixed where it begins; in the grid no place is.
  EXPECT_LT(variances_in(in("own_ahead_covariance.csv")).front().sum(),
            variances_in(in("grid_ahead_covariance.csv")).front().sum());
  EXPECT_LT(std::sqrt(largest), 0.3);
  // T3 is where `ahead` stood at its end, by a survey of 0.01 m and a mark of 0.05 m: better is its place
  // known there, whatever the map may have drifted.
  EXPECT_LT(variances_in(in("grid_ahead_covariance.csv")).back().sum(), 3.0 * (0.05 * 0.05 + 0.01 * 0.01));
}

TEST_F(Georeferenced, MapsAndPosesLeaveInTheTargetFrame) {
  put_control();
  const test::ProgramRun run =
      run_adit("--json georeference " + in("s") + " --control " + in("points.csv") + " --crs EPSG:25833");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json map = nlohmann::json::parse(run.out)["maps"].at(0);
  expect_uses(map["points"], {"used", "used", "used", "rejected", "used", "used", "check", "failed check"});
  EXPECT_LT(std::abs(map["points"][3]["residual_m"][1].get<double>() - 4.0), 0.3);
  EXPECT_LT(std::abs(map["points"][6]["residual_m"][0].get<double>()), 0.3);
  EXPECT_LT(map["far_end"]["sigma_xy_m"].get<double>(), 0.3);
  EXPECT_LT(std::abs(map["scale_ppm"].get<double>()), 4.0 * map["scale_sigma_ppm"].get<double>());

  const nlohmann::json info = nlohmann::json::parse(run_adit("--json info " + in("s")).out);
  EXPECT_EQ(info["georeferences"][0]["crs"], "EPSG:25833");
  EXPECT_EQ(info["georeferences"][0]["rejected"], 1);

  expect_done("convert " + in("s") + " " + in("poses.tum"));
  for (const std::string robot : {"ahead", "behind"}) {
    const Trajectory true_path = truth(robot);
    const Result<Trajectory> poses = read_tum(in("poses_" + robot + ".tum"));
    ASSERT_TRUE(poses) << poses.error().message;
    for (const StampedPose& pose : *poses) {
      const Pose T_grid_base = kT_grid_world * pose_at(true_path, pose.stamp).value();
      EXPECT_LT((pose.T_world_body.translation() - T_grid_base.translation()).norm(), 0.3) << robot;
    }
  }

  expect_done("convert " + in("s") + " " + in("map.las"));
  const std::string las = get_file(in("map.las"));
  double high_and_low[6];
  std::memcpy(high_and_low, las.data() + 179, sizeof(high_and_low));
  EXPECT_NEAR(high_and_low[0], 403'217.0, 300.0);
  EXPECT_NEAR(high_and_low[2], 5'719'843.0, 300.0);
  EXPECT_NE(las.find("PROJCS[\"ETRS89 / UTM zone 33N\""), std::string::npos);

  expect_done("convert " + in("s") + " " + in("map.ply"));
  EXPECT_NE(get_file(in("map.ply")).find("comment EPSG:25833; add the offset 403000 5720000 0\n"),
            std::string::npos);
  const Result<PointCloud> cloud = read_cloud(in("map.ply"));
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_LT((cloud->points.front().cast<double>() + Vector3(403'000, 5'720'000, 0) -
             kT_grid_world * truth("ahead").front().T_world_body.translation())
                .norm(),
            300.0);
  expect_done("convert " + in("s") + " " + in("surface.ply") + " --mesh");
  EXPECT_NE(get_file(in("surface.ply")).substr(0, 200).find("add the offset"), std::string::npos);
  expect_done("convert " + in("s") + " " + in("own.ply") + " --frame map");
  EXPECT_EQ(get_file(in("own.ply")).find("add the offset"), std::string::npos);
  expect_done("convert " + in("s") + " " + in("map.pgm"));
  expect_refused("convert " + in("s") + " " + in("map.pgm") + " --frame target", 2, "own frame");
}

TEST_F(Georeferenced, ASessionThatGrowsKeepsItsFrame) {
  put_control();
  const std::string control = " --control " + in("points.csv") + " --crs \"Grubennetz Nord\"";
  expect_done("georeference " + in("s") + control);
  const Georeference before = read_georeferences(in("s")).value().at(0);
  expect_done("slam --session " + in("s") + " " + drive("later"));
  const Georeference after = read_georeferences(in("s")).value().at(0);
  EXPECT_EQ(after.crs, "Grubennetz Nord");
  EXPECT_EQ(after.robots, (std::vector<std::string>{"ahead", "behind", "later"}));
  EXPECT_LT((before.T_target_map.inverse() * after.T_target_map).log().head<3>().norm(), 0.3);
  ASSERT_EQ(after.points.size(), before.points.size());
  for (std::size_t i = 0; i < after.points.size(); ++i) {
    EXPECT_EQ(after.points[i].use, before.points[i].use) << after.points[i].point.name;
    EXPECT_LT((after.points[i].point.mark.position - before.points[i].point.mark.position).norm(), 1e-6);
  }

  // The second of two sessions, whose robots get other names.
  expect_done("slam ahead=" + drive("later") + " --out " + in("other"));
  expect_done("merge " + in("other") + " " + in("s") + " --out " + in("both"));
  const Georeference merged = read_georeferences(in("both")).value().at(0);
  EXPECT_EQ(merged.points[0].point.mark.robot, "ahead_2");
  EXPECT_EQ(merged.points[3].use, ControlUse::rejected);

  // In one step, too; what is wrong with the points shows before the work.
  expect_done("slam " + drive("ahead") + " " + drive("behind") + " --out " + in("at_once") + control);
  EXPECT_LT((before.T_target_map.inverse() * read_georeferences(in("at_once")).value().at(0).T_target_map)
                .log()
                .norm(),
            1e-6);
  put_file(in("bad.csv"), "name,x\n");
  expect_refused("slam " + drive("ahead") + " --out " + in("never") + " --control " + in("bad.csv"), 1,
                 "bad.csv: line 1");
  EXPECT_FALSE(std::filesystem::exists(in("never")));
}

TEST_F(Georeferenced, WhatCannotBePlacedIsRefusedAndNothingWritten) {
  const std::string heading = "name,x,y,z,sigma,role,robot,stamp,mark_x,mark_y,mark_z\n";
  const auto expect_no = [&](const std::string& lines, const std::string& reason) {
    put_file(in("points.csv"), heading + lines);
    expect_refused("georeference " + in("s") + " --control " + in("points.csv"), 1, reason);
    EXPECT_FALSE(std::filesystem::exists(in("s/georeference.toml")));
  };
  const std::string first = line("T1", "ahead", 0.0, Seen::in_scan);
  expect_no(first + line("T2", "ahead", 1.0, Seen::in_scan), "2 control points, and three");
  expect_no(first + "T2,1,2,3,0.01,control,nobody,1\n",
            "'T2': no robot is called 'nobody'; there are ahead, behind");
  expect_no(first + "T2,1,2,3,0.01,control,ahead,1e6\n", "'T2': ahead");
  expect_no(first + "T2,1,2,3,0.01,control,,,403217,5719842,-312\n", "picked in map.ply of the session");
  expect_refused("convert " + in("s") + " " + in("map.las") + " --frame target", 1,
                 "adit georeference sets one");
  expect_refused("georeference " + in("s"), 2, "--control is required");
  expect_refused("convert " + in("s/map.ply") + " " + in("x.pcd") + " --frame target", 2, "is none");
  expect_refused("georeference " + in("s") + " --control " + in("points.csv") + " --crs EPSG:4326", 1,
                 "no plane system");
}

}  // namespace
}  // namespace adit
