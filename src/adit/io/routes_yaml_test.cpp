// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/routes_yaml.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

using test::put_file;
using test::TemporaryFolder;

TEST(Routes, RoundTrip) {
  RoutesFile routes;
  routes.world = "a b.ply";
  routes.routes = {{"robot_0", 1.87, {{0, 0, 0}, {1, 0.1, -0.3}}},
                   {"r\"1", 2.0, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}}};
  const Result<RoutesFile> back = parse_routes(routes_text(routes));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->world, routes.world);
  ASSERT_EQ(back->routes.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back->routes[i].name, routes.routes[i].name);
    EXPECT_EQ(back->routes[i].speed_mps, routes.routes[i].speed_mps);
    EXPECT_EQ(back->routes[i].waypoints, routes.routes[i].waypoints);
  }
}

TEST(Routes, TheWorldIsRelativeToTheFile) {
  const TemporaryFolder folder;
  put_file(folder / "routes.yaml", "world: sub/w.ply\nrobots: [{name: a, waypoints: [[0,0,0],[1,0,0]]}]\n");
  const Result<RoutesFile> routes = read_routes(folder / "routes.yaml");
  ASSERT_TRUE(routes) << routes.error().message;
  EXPECT_EQ(routes->world, folder.path() / "sub/w.ply");
  EXPECT_EQ(routes->routes[0].speed_mps, 1.87);
}

TEST(Routes, ErrorsNameTheLine) {
  const auto robot = [](std::string_view entries) {
    return parse_routes("robots:\n  - " + std::string(entries));
  };
  EXPECT_ERROR(parse_routes("world: w\nrobot: []\n"),
               "line 2, column 1: unknown key 'robot'; did you mean 'robots'?");
  EXPECT_ERROR(parse_routes("world: w\n"), "no robots");
  EXPECT_ERROR(parse_routes(""), "a map of world and robots");
  EXPECT_ERROR(parse_routes("a: [1, 2"), "line ");
  EXPECT_ERROR(robot("speed: 1\n"), "line 2, column 5: the robot has no name");
  EXPECT_ERROR(robot("{name: a, speed: 0, waypoints: [[0,0,0],[1,0,0]]}"), "more than 0 m/s");
  EXPECT_ERROR(robot("{name: a, sped: 1, waypoints: [[0,0,0],[1,0,0]]}"), "did you mean 'speed'?");
  EXPECT_ERROR(robot("{name: a, name: b}"), "appears twice");
  EXPECT_ERROR(robot("{name: ../a, waypoints: [[0,0,0],[1,0,0]]}"), "cannot name a file");
  EXPECT_ERROR(robot("{name: a, waypoints: [[0,0,0]]}"), "at least two waypoints");
  EXPECT_ERROR(robot("{name: a, waypoints: [[0,0,0],[1,0]]}"), "[x, y, z]");
  EXPECT_ERROR(robot("{name: a, waypoints: [[0,0,0],[1,.nan,0]]}"), "finite number");
  EXPECT_ERROR(robot("{name: a, waypoints: [[0,0,0],[1,0,0]]}\n  - {name: a, waypoints: [[0,0,0],[1,0,0]]}"),
               "line 3, column 5: a second robot named 'a'");
}

TEST(Routes, TruncationAndGarbageAreSurvived) {
  const std::string text = routes_text({"w.ply", {{"a", 1.5, {{0, 0, 0}, {1, 0, 0}}}}});
  for (std::size_t size = 0; size < text.size(); ++size)
    static_cast<void>(parse_routes(text.substr(0, size)));
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    std::string damaged = text;
    for (int k = 0; k < 2; ++k) damaged[rng.below(damaged.size())] = static_cast<char>(rng.below(256));
    static_cast<void>(parse_routes(damaged));
  }
}

}  // namespace
}  // namespace adit
