// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// The map of a session in the formats of others.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "adit/geometry/point_grid.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/mesh_files.hpp"
#include "adit/io/ros_messages.hpp"
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
    EXPECT_NE(text.find("image: '" + pgm.filename().string() + "'\n"), std::string::npos) << text;
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

/// The session in `folder`/s as a cloud with all fields, and as a surface: both look to where robots drove.
void expect_fields_and_faces(const std::filesystem::path& folder) {
  const std::string session = (folder / "s").string();
  expect_done("convert " + session + " " + (folder / "map.ply").string() + " --set maps.normals=true");
  const std::string ply = get_file(folder / "map.ply");
  const std::size_t begin = ply.find("end_header\n") + 11;
  // The simulated sensor of ideal conditions has no intensities.
  EXPECT_NE(ply.substr(0, begin).find("float z\nproperty float nx\n"), std::string::npos);
  std::vector<Eigen::Vector3f> driven;
  for (const char* robot : {"ahead", "behind"}) {
    const Trajectory poses = read_tum(folder / "s" / robot / "trajectory.tum").value();
    for (const StampedPose& pose : poses) driven.push_back(pose.T_world_body.translation().cast<float>());
  }
  const PointGrid near_robots(driven, 5.0);
  const auto looks_to_robots = [&](const Eigen::Vector3f& at, const Eigen::Vector3f& normal) {
    return normal.dot(driven[near_robots.nearest(at)->index] + Eigen::Vector3f(0, 0, 1) - at) > 0.0F;
  };
  constexpr std::size_t kRobot = 24;  // bytes from the start of a row
  constexpr std::size_t kRow = kRobot + 2;
  std::map<int, int> num_of_robot;
  int num_normals = 0;
  int num_turned_right = 0;
  std::vector<Eigen::Vector3f> points;
  for (std::size_t at = begin; at + kRow <= ply.size(); at += kRow) {
    std::array<float, 6> numbers{};
    std::uint16_t robot = 0;
    std::memcpy(numbers.data(), &ply[at], kRobot);
    std::memcpy(&robot, &ply[at + kRobot], 2);
    ++num_of_robot[robot];
    points.emplace_back(numbers[0], numbers[1], numbers[2]);
    const Eigen::Vector3f normal(numbers[3], numbers[4], numbers[5]);
    if (normal.isZero()) continue;
    ASSERT_NEAR(normal.norm(), 1.0F, 1e-4F);
    ++num_normals;
    num_turned_right += looks_to_robots(points.back(), normal) ? 1 : 0;
  }
  EXPECT_EQ(num_of_robot.size(), 2U);
  EXPECT_GT(std::min(num_of_robot[1], num_of_robot[2]), 5000);
  EXPECT_GT(num_normals, 0.9 * static_cast<double>(points.size()));
  EXPECT_GT(num_turned_right, 0.97 * num_normals);

  expect_done("convert " + session + " " + (folder / "surface.ply").string() + " --mesh");
  const Result<TriangleMesh> mesh = read_mesh(folder / "surface.ply");
  ASSERT_TRUE(mesh) << mesh.error().message;
  const PointGrid cloud(points, 0.3);
  std::size_t num_near = 0;
  for (const Eigen::Vector3f& vertex : mesh->vertices) num_near += cloud.nearest(vertex, 0.2F) ? 1 : 0;
  EXPECT_GT(static_cast<double>(num_near), 0.95 * static_cast<double>(mesh->vertices.size()));
  std::size_t num_facing = 0;
  for (const Eigen::Vector3i& triangle : mesh->triangles) {
    const auto corner = [&](Eigen::Index i) { return mesh->vertices[static_cast<std::size_t>(triangle[i])]; };
    num_facing += looks_to_robots(corner(0), (corner(1) - corner(0)).cross(corner(2) - corner(0))) ? 1 : 0;
  }
  // Some were seen from the other side than the nearest place of the robot lies on.
  EXPECT_GT(static_cast<double>(num_facing), 0.95 * static_cast<double>(mesh->triangles.size()));
}

/// Coarser clouds, trees of voxels, and poses without stamps.
void expect_other_forms(const std::filesystem::path& folder, std::size_t num_points) {
  const std::string convert = "convert " + (folder / "s").string() + " ";
  expect_done(convert + (folder / "coarse.pcd").string() + " --set maps.voxel_m=0.4");
  const test::ProgramRun info = test::run_adit("--json info " + (folder / "coarse.pcd").string());
  EXPECT_LT(nlohmann::json::parse(info.out)["points"].get<std::size_t>(), num_points / 4);
  expect_done(convert + (folder / "map.bt").string());
  EXPECT_TRUE(get_file(folder / "map.bt").starts_with("# Octomap OcTree binary file"));
  expect_done(convert + (folder / "at.kitti").string());
  for (const char* robot : {"ahead", "behind"}) {
    const std::string lines = get_file(folder / (std::string("at_") + robot + ".kitti"));
    const Result<Trajectory> scans = read_tum(folder / "s" / robot / "odometry.tum");
    ASSERT_TRUE(scans) << scans.error().message;
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(lines, '\n')), scans->size());
  }
}

/// The covariances of that robot's poses: one for each pose, growing from the place that is held fixed.
void expect_covariances(const std::filesystem::path& folder, const std::string& robot) {
  expect_done("convert " + (folder / "s").string() + " " + (folder / "at.tum").string() + " --covariance");
  const Trajectory poses = read_tum(folder / ("at_" + robot + ".tum")).value();
  std::istringstream csv(get_file(folder / ("at_" + robot + "_covariance.csv")));
  std::string line;
  ASSERT_TRUE(std::getline(csv, line));
  EXPECT_TRUE(line.starts_with("stamp_s,x_x,x_y,")) << line;
  std::vector<double> sigmas;  // of z
  for (const StampedPose& pose : poses) {
    ASSERT_TRUE(std::getline(csv, line));
    std::istringstream row(line);
    std::string word;
    std::vector<double> numbers;
    std::getline(row, word, ',');
    EXPECT_EQ(word, stamp_text(pose.stamp));
    while (std::getline(row, word, ',')) numbers.push_back(std::stod(word));
    ASSERT_EQ(numbers.size(), 21U);
    for (const std::size_t diagonal : {0U, 6U, 11U, 15U, 18U, 20U}) EXPECT_GE(numbers[diagonal], 0.0);
    sigmas.push_back(std::sqrt(numbers[11]));
  }
  EXPECT_FALSE(std::getline(csv, line)) << "more covariances than poses";
  EXPECT_LT(sigmas.front(), sigmas.back());
  EXPECT_LT(sigmas.back(), 0.5);
}

/// The session in `folder`/s as a JSON Robot Log, and that as a g2o file.
void expect_graphs(const std::filesystem::path& folder) {
  const auto info_of = [](const std::filesystem::path& path) {
    return nlohmann::json::parse(test::run_adit("--json info " + path.string()).out);
  };
  expect_done("convert " + (folder / "s").string() + " " + (folder / "s.jrl").string());
  const nlohmann::json log = info_of(folder / "s.jrl");
  EXPECT_EQ(log["robots"], nlohmann::json::array({"a", "b"}));
  for (const char* what : {"nodes", "edges"})
    EXPECT_EQ(log[what], info_of(folder / "s/graph_initial.g2o")[what]) << what;
  expect_done("convert " + (folder / "s.jrl").string() + " " + (folder / "again.g2o").string());
  EXPECT_EQ(info_of(folder / "again.g2o")["edges"], log["edges"]);
}

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

  expect_other_forms(folder.path(), num_points);
  expect_graphs(folder.path());
  expect_fields_and_faces(folder.path());
  expect_covariances(folder.path(), "behind");

  expect_refused("convert " + session + " " + (folder / "map.dwg").string(), 1,
                 "becomes .las, .pcd, .ply, .pgm");
  expect_refused("convert " + session + " " + (folder / "map.pcd").string() + " --mesh", 2,
                 "--mesh is for a .ply");
  std::filesystem::remove(folder / "s/ahead/map.adit");
  expect_refused("convert " + session + " " + (folder / "again.las").string(), 1, "ahead/map.adit");
}

/// The messages of one topic, decoded.
template <class Decode>
auto messages_of(const Bag& bag, const std::string& topic, Decode decode) {
  std::vector<std::decay_t<decltype(*decode(std::string(), MessageEncoding::cdr))>> out;
  for (const BagMessage& message : bag.messages)
    if (bag.topics[message.topic].name == topic) out.push_back(decoded(bag, message, decode).value());
  return out;
}

/// What the messages of a session say of one robot.
struct ShownRobot {
  Trajectory at_scans;                      ///< Of the file that `adit convert` wrote.
  Trajectory keyframes;                     ///< Of the session.
  std::map<std::int64_t, Pose> T_map_base;  ///< By the stamp of the message.

  [[nodiscard]] Duration later() const { return Stamp{T_map_base.begin()->first} - at_scans.front().stamp; }
};

ShownRobot shown_robot(const Bag& bag, const std::filesystem::path& folder, const std::string& robot) {
  ShownRobot out;
  out.at_scans = read_tum(folder / ("poses_" + robot + ".tum")).value();
  out.keyframes = read_tum(folder / "s" / robot / "trajectory.tum").value();
  const auto decode = [](std::string_view message, MessageEncoding encoding) {
    return ros::decode_transforms(message, encoding);
  };
  for (const ros::TransformsMessage& message : messages_of(bag, "/tf", decode)) {
    const std::vector<ros::TransformMessage>& both = message.links;
    EXPECT_EQ(both.size(), 2U);
    EXPECT_EQ(both[0].frame, "map");
    EXPECT_EQ(both[0].child, both[1].frame);
    if (both[1].child == robot + "/base_link")
      out.T_map_base[both[1].pose.stamp.ns] = both[0].pose.T_world_body * both[1].pose.T_world_body;
  }
  return out;
}

void expect_shown(const ShownRobot& robot, const Trajectory& poses) {
  for (const StampedPose& pose : poses) {
    const Pose& shown = robot.T_map_base.at((pose.stamp + robot.later()).ns);
    EXPECT_LT((shown.inverse() * pose.T_world_body).log().norm(), 1e-5) << stamp_text(pose.stamp);
  }
}

void expect_topics(const Bag& bag, const std::string& robot, const ShownRobot& shown) {
  const std::string topic = "/" + robot;
  EXPECT_EQ(messages_of(bag, topic + "/odometry", ros::decode_odometry).size(), shown.at_scans.size());
  EXPECT_EQ(messages_of(bag, topic + "/path", ros::decode_stamp).size(), 1U);
  EXPECT_EQ(messages_of(bag, topic + "/map", ros::decode_stamp).size(), 1U);
  const auto decode = [](std::string_view message, MessageEncoding encoding) {
    return ros::decode_cloud(message, encoding);
  };
  const auto clouds = messages_of(bag, topic + "/points", decode);
  EXPECT_EQ(clouds.size(), shown.keyframes.size());
  for (const ros::CloudMessage& cloud : clouds) EXPECT_EQ(cloud.frame, robot + "/base_link");
}

TEST(MapsOut, ASessionPlaysAsRosMessages) {
  const test::TemporaryFolder folder;
  test::put_two_drives(folder.path());
  const std::string session = (folder / "s").string();
  expect_done("slam " + (folder / "routes.yaml").string() + " --lidar vlp-16 --out " + session);
  expect_done("convert " + session + " " + (folder / "s.mcap").string() + " --set maps.start_together=true");
  expect_done("convert " + session + " " + (folder / "poses.tum").string());

  const Bag bag = open_bag(folder / "s.mcap").value();
  EXPECT_TRUE(bag.warnings.empty());
  const auto count_of = [](std::string_view message, MessageEncoding) -> Result<std::uint32_t> {
    return MessageReader(message).number<std::uint32_t>();
  };
  EXPECT_EQ(messages_of(bag, "/graph", count_of), std::vector<std::uint32_t>{4})
      << "lines and their ends, of loops in use and of those not used";
  std::vector<std::int64_t> starts;
  for (const std::string robot : {"ahead", "behind"}) {
    const ShownRobot shown = shown_robot(bag, folder.path(), robot);
    ASSERT_EQ(shown.T_map_base.size(), shown.at_scans.size());
    EXPECT_GT(shown.at_scans.size(), shown.keyframes.size());
    expect_shown(shown, shown.at_scans);
    expect_shown(shown, shown.keyframes);
    expect_topics(bag, robot, shown);
    starts.push_back(shown.T_map_base.begin()->first);
  }
  EXPECT_EQ(starts[0], starts[1]);

  const nlohmann::json layout = nlohmann::json::parse(get_file(folder / "s.layout.json"));
  const nlohmann::json& panel = layout["configById"][layout["layout"].get<std::string>()];
  EXPECT_EQ(panel["followTf"], "map");
  EXPECT_EQ(panel["topics"].size(), 9U);
  for (const auto& [topic, settings] : panel["topics"].items())
    EXPECT_TRUE(std::ranges::count(bag.topics, topic, &BagTopic::name) == 1) << topic;
  // Nothing that was there is lost.
  const std::string before = get_file(folder / "s.mcap");
  std::filesystem::remove(folder / "s/ahead/map.adit");
  expect_refused("convert " + session + " " + (folder / "s.mcap").string(), 1, "ahead/map.adit");
  EXPECT_EQ(get_file(folder / "s.mcap"), before);
}

}  // namespace
}  // namespace adit
