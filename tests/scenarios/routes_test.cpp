// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Routes planned through a mesh, from the command line, and what robots make of them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "adit/io/mesh_files.hpp"
#include "adit/io/routes_yaml.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"
#include "support/two_drives.hpp"

namespace adit {
namespace {

using test::expect_done;
using test::expect_refused;
using test::get_file;
using test::run_adit;

TEST(Routes, ArePlannedDrivenAndMapped) {
  const test::TemporaryFolder folder;
  test::put_two_drives(folder.path());
  const std::string world = (folder / "world.ply").string();
  const std::string planned = (folder / "planned.yaml").string();
  const std::string command = "routes " + world + " --robots 2 --length 40 --json --out ";
  const test::ProgramRun run = run_adit(command + planned);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json report = nlohmann::json::parse(run.out);
  ASSERT_EQ(report["robots"].size(), 2U);
  EXPECT_GT(report["floor_m2"].get<double>(), 1000.0);
  for (const nlohmann::json& robot : report["robots"]) {
    EXPECT_LE(robot["length_m"].get<double>(), 40.0);
    EXPECT_GT(robot["length_m"].get<double>(), 20.0);
    EXPECT_GE(robot["clearance_m"].get<double>(), 0.6);
  }
  ASSERT_EQ(report["pairs"].size(), 1U);
  const Result<RoutesFile> file = read_routes(planned);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->world, folder / "world.ply");

  expect_done(command + (folder / "again.yaml").string() + " --threads 1");
  EXPECT_EQ(get_file(folder / "again.yaml"), get_file(planned));

  expect_done("simulate --routes " + planned + " --lidar vlp-16 --set simulation.lidar.rate_hz=2 --out " +
              (folder / "recordings").string());
  EXPECT_EQ(test::num_entries(folder / "recordings"), 4U);
  expect_done("slam " + planned + " --lidar vlp-16 --set simulation.lidar.columns=180 --out " +
              (folder / "session").string());
}

TEST(Routes, RefusesWhatNoRobotCanDrive) {
  const test::TemporaryFolder folder;
  const std::string low = (folder / "low.ply").string();
  ASSERT_TRUE(write_mesh(low, test::room({0, 0, 0}, {50, 10, 1.2})));
  const std::string out = " --out " + (folder / "routes.yaml").string();
  expect_refused("routes " + low + out, 1, low + ": no floor is high enough: the robot needs 1.5 m");
  expect_done("routes " + low + " --robots 1 --set routes.height_m=1" + out);
  expect_refused("routes " + low + " --robots 0" + out, 2, "robots");
  expect_refused("routes " + low + " --length 1" + out, 2, "10");
  expect_refused("routes " + (folder / "none.ply").string() + out, 1, "none.ply");
}

TEST(Routes, OnTheSharedMeshesRobotsShareWhatIsAsked) {
  for (const std::string name : {"tunnel_practice_1", "pittsburgh_mine"}) {
    ADIT_NEED_DATA("worlds/" + name + "/world.ply");
    const std::filesystem::path mesh = test::shared_data("worlds/" + name + "/world.ply");
    const test::TemporaryFolder folder;
    const test::ProgramRun run =
        run_adit("routes " + mesh.string() + " --robots 3 --json --out " + (folder / "routes.yaml").string());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const nlohmann::json report = nlohmann::json::parse(run.out);
    for (const nlohmann::json& pair : report["pairs"])
      EXPECT_GT(pair["shared_m"].get<double>(), 40.0) << name << pair;
    for (const nlohmann::json& robot : report["robots"]) {
      EXPECT_GE(robot["clearance_m"].get<double>(), 0.6) << name;
      EXPECT_LE(robot["slope_deg"].get<double>(), 30.0) << name;
    }
  }
}

}  // namespace
}  // namespace adit
