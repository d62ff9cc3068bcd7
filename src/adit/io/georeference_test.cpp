// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/georeference.hpp"

#include <gtest/gtest.h>

#include "adit/io/crs.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

TEST(ControlPoints, SayWhereAPointIsInBothFrames) {
  const Result<std::vector<ControlPoint>> points = parse_control_points(
      "\xEF\xBB\xBFName, "
      "easting,northing,height,sigma,sigma_z,role,robot,stamp,mark_x,mark_y,mark_z,mark_sigma\r\n"
      "\"T1, north wall\",400123.4567,5700321.9876,-312.5,0.005,0.008,,,,1.5,-2,0.25,\r\n"
      "T2,400223,5700421,-313,0.01,,control,red,,4,5,6,0.1\r\n"
      "T3,400323,5700521,-314,0.01,,CHECK,red,12.500000001,7,8,9,\r\n"
      "T4,400423,5700621,-315,0.01,,,red,13\r\n");
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 4U);
  const ControlPoint& first = points->front();
  EXPECT_EQ(first.name, "T1, north wall");
  EXPECT_EQ(first.target, Vector3(400123.4567, 5700321.9876, -312.5));
  EXPECT_EQ(first.sigma_xy, 0.005);
  EXPECT_EQ(first.sigma_z, 0.008);
  EXPECT_FALSE(first.is_check || first.mark.stamp);
  EXPECT_EQ(first.mark.robot, "");
  EXPECT_EQ(first.mark.position, Vector3(1.5, -2.0, 0.25));
  EXPECT_EQ(first.mark.sigma, ControlMark().sigma);
  EXPECT_EQ((*points)[1].sigma_z, 0.01);
  EXPECT_EQ((*points)[1].mark.robot, "red");
  EXPECT_EQ((*points)[1].mark.sigma, 0.1);
  EXPECT_TRUE((*points)[2].is_check);
  EXPECT_EQ((*points)[2].mark.stamp->ns, 12'500'000'001);
  EXPECT_EQ((*points)[3].mark.stamp->ns, 13'000'000'000);
  EXPECT_EQ((*points)[3].mark.position, Vector3::Zero());
}

TEST(ControlPoints, MarksInAScanMayBeInTheFrameOfTheLidar) {
  const std::string heading = "name,x,y,z,sigma,robot,stamp,mark_x,mark_y,mark_z,mark_frame\n";
  const auto points = parse_control_points(heading +
                                           "A,1,2,3,0.01,red,7,4,5,6,lidar\nB,1,2,3,0.01,red,7,4,5,6,Base\n"
                                           "C,1,2,3,0.01,red,7,4,5,6\nD,1,2,3,0.01,red,7,,,,base\n");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_TRUE(points->at(0).mark.is_in_lidar_frame);
  EXPECT_EQ(points->at(0).mark.position, Vector3(4, 5, 6));
  for (const std::size_t i : {1U, 2U, 3U}) EXPECT_FALSE(points->at(i).mark.is_in_lidar_frame) << i;
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01,red,7,4,5,6,map\n"),
               "line 2: mark_frame is 'map'; it is base or lidar");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01,red,,4,5,6,lidar\n"),
               "mark_frame is for marks in a scan: give robot and stamp");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01,red,7,,,,lidar\n"), "0, 0, 0 is the LiDAR");
}

TEST(ControlPoints, WhatIsWrongIsNamedWithItsLine) {
  const std::string heading = "name,x,y,z,sigma,mark_x,mark_y,mark_z,robot,stamp,role\n";
  EXPECT_ERROR(parse_control_points(""), "empty");
  EXPECT_ERROR(parse_control_points(heading), "no control points");
  EXPECT_ERROR(parse_control_points("name,x,y,z\n"), "line 1: the column 'sigma' is missing");
  EXPECT_ERROR(parse_control_points("name,x,y,z,sigmaz\n"), "line 1: no column is called 'sigmaz'");
  EXPECT_ERROR(parse_control_points("name;x;y;z;sigma\n"), "not semicolons");
  EXPECT_ERROR(parse_control_points("name,x,easting,y,z,sigma\n"), "'x' occurs twice");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01,1,2,3\n\nB,1,2,\"3,5\",0.01,1,2,3\n"),
               "line 4: z is '3,5', which is no number");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,nan,0.01,1,2,3\n"), "z is 'nan'");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,,1,2,3\n"), "line 2: sigma is missing");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0,1,2,3\n"), "more than 0");
  EXPECT_ERROR(parse_control_points(heading + ",1,2,3,0.01,1,2,3\n"), "name is missing");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01\n"), "nothing says where the point is");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01,1,,3\n"), "mark_y is missing");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01,1,2,3,red,noon\n"), "stamp is 'noon'");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01,1,2,3,,7\n"), "robot has to say whose");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01,1,2,3,,,maybe\n"), "control or check");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01,1,2,3,,,,,\n"), "13 cells under 11 columns");
  EXPECT_ERROR(parse_control_points(heading + "A,1,2,3,0.01,1,2,3\nA,1,2,3,0.01,1,2,3\n"),
               "line 3: the name 'A' occurs twice");
}

Georeference some_georeference() {
  Georeference map;
  map.robots = {"red", "blue"};
  map.crs = "EPSG:25833";
  map.T_target_map = Pose(so3::exp({0.01, -0.02, 2.5}), {400'123.456789, 5'700'321.987654, -312.5});
  map.covariance = Matrix6::Identity() * 1e-4;
  map.covariance(0, 5) = map.covariance(5, 0) = 1e-5;
  map.chi2 = 7.5;
  map.redundancy = 6;
  map.scale_ppm = -380.0;
  map.scale_sigma_ppm = 50.0;
  map.far_end = {"blue", Stamp{12'345'678'901}, 0.21, 0.13};
  for (const ControlUse use :
       {ControlUse::used, ControlUse::rejected, ControlUse::check, ControlUse::failed_check}) {
    JudgedControl point;
    point.point = {"T\"" + std::to_string(map.points.size()),
                   {1.0 / 3.0, 5'700'000.001, -3.0},
                   0.01,
                   0.02,
                   false,
                   {"red", Stamp{1'000'000'007}, {0.1, 0.2, 0.3}, 0.04}};
    point.point.is_check = use == ControlUse::check || use == ControlUse::failed_check;
    point.use = use;
    point.residual = {0.001, -0.002, 0.003};
    if (use != ControlUse::used) point.misfit = 2.5;
    map.points.push_back(point);
  }
  return map;
}

TEST(Georeferences, ComeBackAsTheyWere) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(read_georeferences(folder.path())->empty());
  const Georeference map = some_georeference();
  ASSERT_TRUE(write_georeferences(folder.path(), {map, map}));
  const Result<std::vector<Georeference>> maps = read_georeferences(folder.path());
  ASSERT_TRUE(maps) << maps.error().message;
  ASSERT_EQ(maps->size(), 2U);
  const Georeference& back = maps->back();
  EXPECT_EQ(back.robots, map.robots);
  EXPECT_EQ(back.crs, map.crs);
  EXPECT_EQ(back.T_target_map.translation(), map.T_target_map.translation());
  EXPECT_TRUE(back.T_target_map.rotation().isApprox(map.T_target_map.rotation(), 1e-15));
  EXPECT_EQ(back.covariance, map.covariance);
  EXPECT_EQ(back.far_end.robot, "blue");
  EXPECT_EQ(back.far_end.stamp.ns, map.far_end.stamp.ns);
  ASSERT_EQ(back.points.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(back.points[i].use, map.points[i].use);
    EXPECT_EQ(back.points[i].point.name, map.points[i].point.name);
    EXPECT_EQ(back.points[i].point.target, map.points[i].point.target);
    EXPECT_EQ(back.points[i].point.is_check, map.points[i].point.is_check);
    EXPECT_EQ(back.points[i].point.mark.stamp->ns, 1'000'000'007);
    EXPECT_EQ(back.points[i].point.mark.position, map.points[i].point.mark.position);
    EXPECT_EQ(back.points[i].misfit, map.points[i].misfit);
  }
  EXPECT_EQ(georeference_of(*maps, "blue"), &maps->front());
  EXPECT_EQ(georeference_of(*maps, "green"), nullptr);
}

TEST(Georeferences, DamageIsAnError) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_georeferences(folder.path(), {some_georeference()}));
  const std::string whole = test::get_file(folder / "georeference.toml");
  for (const std::string word : {"5700321", "rotation_xyzw", "maps", "'used'", "robots"}) {
    std::string damaged = whole;
    damaged.replace(damaged.find(word), word.size(), "oops");
    test::put_file(folder / "georeference.toml", damaged);
    EXPECT_ERROR(read_georeferences(folder.path()), "georeference.toml");
  }
}

TEST(Crs, IsWrittenAsWktOrRefused) {
  const std::string utm = crs_wkt("EPSG:25833").value();
  EXPECT_TRUE(utm.starts_with("PROJCS[\"ETRS89 / UTM zone 33N\"")) << utm;
  EXPECT_EQ(utm.find('\n'), std::string::npos);
  EXPECT_EQ(crs_wkt("ETRS89 / UTM zone 33N").value(), utm);
  EXPECT_EQ(crs_wkt(utm).value(), utm);
  EXPECT_TRUE(crs_wkt("EPSG:25833+7837")->starts_with("COMPD_CS["));
  EXPECT_EQ(crs_wkt("Grubennetz \"Nord\"").value(), "LOCAL_CS[\"Grubennetz Nord\",UNIT[\"metre\",1]]");
  EXPECT_TRUE(crs_wkt("")->starts_with("LOCAL_CS"));
  EXPECT_ERROR(crs_wkt("EPSG:999999"), "knows no coordinate system");
  EXPECT_ERROR(crs_wkt("EPSG:4326"), "no plane system");
  EXPECT_ERROR(crs_wkt("EPSG:2263"), "not in metres");
  EXPECT_ERROR(crs_wkt("EPSG:32633+6360"), "not in metres");  // its heights
}

}  // namespace
}  // namespace adit
