// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// The map of a session in the formats of others.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "adit/io/tum.hpp"
#include "support/files.hpp"
#include "support/program.hpp"
#include "support/two_drives.hpp"

namespace adit {
namespace {

using test::expect_done;
using test::expect_refused;
using test::get_file;

/// A PGM with its YAML, read as Nav2's map server reads them.
struct NavMap {
  std::size_t width = 0;
  std::size_t height = 0;
  double resolution = 0.0;
  double x = 0.0;
  double y = 0.0;
  std::string pixels;

  explicit NavMap(const std::filesystem::path& pgm) {
    const std::string bytes = get_file(pgm);
    std::istringstream head(bytes);
    std::string magic;
    int largest = 0;
    head >> magic >> width >> height >> largest;
    EXPECT_EQ(magic, "P5");
    EXPECT_EQ(largest, 255);
    pixels = bytes.substr(static_cast<std::size_t>(head.tellg()) + 1);
    EXPECT_EQ(pixels.size(), width * height);
    std::filesystem::path yaml = pgm;
    const std::string text = get_file(yaml.replace_extension(".yaml"));
    EXPECT_NE(text.find("image: " + pgm.filename().string() + "\n"), std::string::npos) << text;
    EXPECT_NE(text.find("mode: trinary\n"), std::string::npos);
    EXPECT_EQ(std::sscanf(text.c_str() + text.find("resolution:"), "resolution: %lf origin: [%lf, %lf, 0]",
                          &resolution, &x, &y),
              3)
        << text;
  }
  /// 'f'ree, 'o'ccupied or 'u'nknown, by the thresholds of the YAML file.
  [[nodiscard]] char at(double px, double py) const {
    const auto column = static_cast<std::size_t>((px - x) / resolution);
    const auto row = static_cast<std::size_t>((py - y) / resolution);
    if (column >= width || row >= height) return 'u';
    const double occupied =
        (255.0 - static_cast<unsigned char>(pixels[(height - 1 - row) * width + column])) / 255.0;
    return occupied > 0.65 ? 'o' : occupied < 0.196 ? 'f' : 'u';
  }
};

TEST(MapsOut, ASessionBecomesCloudsAndAGridThatARobotCanDriveOn) {
  const test::TemporaryFolder folder;
  test::put_two_drives(folder.path());
  const std::string session = (folder / "s").string();
  expect_done("slam " + (folder / "routes.yaml").string() + " --lidar vlp-16 --out " + session);
  for (const char* file : {"map.las", "map.pcd", "map.pgm"})
    expect_done("convert " + session + " " + (folder / file).string());

  const NavMap map(folder / "map.pgm");
  EXPECT_EQ(map.resolution, 0.1);
  int num_walls = 0;
  int num_poses = 0;
  for (const char* robot : {"ahead", "behind"}) {
    const Trajectory trajectory = read_tum(folder / "s" / robot / "trajectory.tum").value();
    for (const StampedPose& pose : trajectory) {
      const Vector3& p = pose.T_world_body.translation();
      EXPECT_EQ(map.at(p.x(), p.y()), 'f') << robot << " drove here: " << p.transpose();
      // To either side a wall comes before anything unknown.
      for (const double side : {1.0, -1.0}) {
        ++num_poses;
        for (double off = 0.0; off < 8.0; off += 0.05) {
          const Vector3 q = pose.T_world_body * Vector3(0.0, side * off, 0.0);
          const char cell = map.at(q.x(), q.y());
          if (cell == 'o') ++num_walls;
          if (cell != 'f') break;
        }
      }
    }
  }
  EXPECT_GT(num_walls, 0.9 * num_poses);
  EXPECT_EQ(map.at(map.x + 0.05, map.y + 0.05), 'u');

  const test::ProgramRun info = test::run_adit("--json info " + (folder / "map.pcd").string());
  const auto num_points = nlohmann::json::parse(info.out)["points"].get<std::size_t>();
  EXPECT_GT(num_points, 10'000U);
  EXPECT_GT(get_file(folder / "map.las").size(), 30 * num_points) << "robots are thinned one by one";
  expect_done("convert " + session + " " + (folder / "fine.pgm").string() +
              " --set maps.grid.resolution_m=0.05");
  EXPECT_GT(NavMap(folder / "fine.pgm").width, 1.9 * static_cast<double>(map.width));

  expect_refused("convert " + session + " " + (folder / "map.dwg").string(), 1,
                 "becomes .las, .pcd, .ply or .pgm");
  std::filesystem::remove(folder / "s/ahead/map.adit");
  expect_refused("convert " + session + " " + (folder / "again.las").string(), 1, "ahead/map.adit");
}

}  // namespace
}  // namespace adit
