// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// What spoils a map is found in a recording, with the remedy, and nothing is found in a good one.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "adit/core/angles.hpp"
#include "adit/io/mount.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/slam/doctor.hpp"
#include "support/files.hpp"
#include "support/program.hpp"
#include "support/two_drives.hpp"

namespace adit {
namespace {

Diagnosis of(const std::vector<Diagnosis>& all, std::string_view check) {
  const auto found = std::ranges::find(all, check, &Diagnosis::check);
  EXPECT_NE(found, all.end()) << check;
  return found == all.end() ? all.front() : *found;
}

/// The mount that a remedy names.
Pose mount_in(const std::string& remedy) {
  const std::size_t begin = remedy.find("--mount ") + 8;
  std::string mount = remedy.substr(begin, remedy.find(' ', begin) - begin);
  if (mount.ends_with(',')) mount.pop_back();
  return parse_mount(mount).value_or(Pose());
}

/// One drive around a corner, by a robot whose sensors err as real ones do.
class Doctor : public ::testing::Test {
 protected:
  void SetUp() override {
    test::put_two_drives(folder_.path());
    test::expect_done("simulate --routes " + (folder_ / "routes.yaml").string() +
                      " --lidar vlp-16 --conditions field --robot ahead --imu none --out " +
                      (folder_ / "drives").string());
    Result<Recording> recording = open_recording(file());
    ASSERT_TRUE(recording) << recording.error().message;
    good_ = std::move(*recording);
  }
  [[nodiscard]] std::string file() const { return (folder_ / "drives/ahead.mcap").string(); }

  /// The recording with its clouds changed.
  template <class Change>
  [[nodiscard]] Recording with(const Change& change) const {
    Recording changed = good_;
    changed.read_scan = [read = good_.read_scan, change](std::size_t i) {
      return read(i).map([&](Scan scan) {
        change(scan.cloud);
        return scan;
      });
    };
    return changed;
  }
  [[nodiscard]] static std::vector<Diagnosis> found_in(const Recording& recording) {
    const Result<std::vector<Diagnosis>> found = diagnose(recording);
    EXPECT_TRUE(found) << found.error().message;
    return found.value_or(std::vector<Diagnosis>{{"nothing", Health::unknown, ""}});
  }

  const test::TemporaryFolder folder_;
  Recording good_;
};

TEST_F(Doctor, FindsNothingWrongWithAGoodRecording) {
  const test::ProgramRun run = test::run_adit("doctor --json " + file());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json found = nlohmann::json::parse(run.out);
  EXPECT_GE(found["checks"].size(), 9U);
  // One corner is too little to compare wheels with scans.
  for (const nlohmann::json& check : found["checks"])
    EXPECT_EQ(check["health"], check["check"] == "wheels and IMU" ? "unknown" : "good") << check;
  test::expect_refused("doctor " + (folder_ / "world.ply").string(), 1, "world.ply");
}

TEST_F(Doctor, NamesTheMountThatTheFloorAndTheMotionShow) {
  const std::string wrong = "0.4,0,1.3,3,-4,6";
  const test::ProgramRun run = test::run_adit("doctor --json " + file() + " --mount " + wrong);
  EXPECT_EQ(run.exit_code, 1) << "a yaw of 6 degrees spoils a map";
  EXPECT_NE(run.err.find("checks found what spoils a map"), std::string::npos) << run.err;
  Recording recording = good_;
  recording.T_base_lidar = parse_mount(wrong).value();
  const std::vector<Diagnosis> found = found_in(recording);
  EXPECT_EQ(of(found, "mount: tilt and height").health, Health::noted);
  const Diagnosis turn = of(found, "mount: turn and lever arm");
  EXPECT_EQ(turn.health, Health::spoils);
  const Pose error = good_.T_base_lidar.inverse() * mount_in(turn.remedy);
  EXPECT_LT(error.log().tail<3>().norm(), 1.5 * kDegree) << turn.remedy;
  EXPECT_LT(std::abs(error.translation().z()), 0.1) << turn.remedy;
}

TEST_F(Doctor, NamesAMountThatLiesDown) {
  EXPECT_EQ(test::run_adit("doctor " + file() + " --mount 0,0,1,0,45,0").exit_code, 1);
  for (const char* wrong : {"0,0,1,0,-60,0", "0,0,1,0,90,0"}) {
    Recording recording = good_;
    recording.T_base_lidar = parse_mount(wrong).value();
    const Diagnosis tilt = of(found_in(recording), "mount: tilt and height");
    EXPECT_EQ(tilt.health, Health::spoils) << wrong;
    const Pose error = good_.T_base_lidar.inverse() * mount_in(tilt.remedy);
    EXPECT_LT(error.log().tail<3>().norm(), 4.0 * kDegree) << wrong << ": " << tilt.remedy;
    EXPECT_LT(std::abs(error.translation().z()), 0.2) << wrong << ": " << tilt.remedy;
  }
}

// A drive with corners to both sides, as it takes turning to see it.
TEST(DoctorOfALongDrive, NamesTheLeverArmsThatTheMotionShows) {
  const test::TemporaryFolder folder;
  test::put_drives(folder.path(), {{0, 260, "ahead"}});
  test::expect_done("simulate --routes " + (folder / "routes.yaml").string() +
                    " --lidar vlp-16 --conditions field --imu none --out " + (folder / "drives").string());
  const Recording good = open_recording((folder / "drives/ahead.mcap").string()).value();
  for (const Pose& off :
       {Pose::planar(-0.5, 0.5, 0.0), Pose::planar(0.0, -0.5, 0.0), Pose::planar(1.0, 0.0, 9.0 * kDegree)}) {
    Recording shifted = good;
    shifted.T_base_lidar = off * good.T_base_lidar;
    const std::vector<Diagnosis> found = diagnose(shifted).value();
    const Diagnosis lever = of(found, "mount: turn and lever arm");
    ASSERT_NE(lever.health, Health::good) << lever.sentence;
    const Vector3 error = mount_in(lever.remedy).translation() - good.T_base_lidar.translation();
    EXPECT_LT(error.head<2>().cwiseAbs().maxCoeff(), 0.15) << lever.sentence << lever.remedy;
  }
}

TEST_F(Doctor, FindsWhatTheScansLack) {
  Recording gaps = good_;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < gaps.num_scans(); ++i)
    if (i % 5 != 0 && (i < 100 || i > 140)) kept.push_back(i);
  gaps.scan_stamps.clear();
  for (const std::size_t i : kept) gaps.scan_stamps.push_back(good_.scan_stamps[i]);
  gaps.read_scan = [read = good_.read_scan, kept](std::size_t i) { return read(kept[i]); };
  const Diagnosis missing = of(found_in(gaps), "scans: missing");
  EXPECT_EQ(missing.health, Health::spoils);
  EXPECT_NE(missing.sentence.find("the longest gap 4."), std::string::npos) << missing.sentence;

  const Recording wrong_unit = with([](PointCloud& cloud) {
    for (auto& offset : cloud.time_offsets_ns) offset /= 1000;
  });
  EXPECT_EQ(of(found_in(wrong_unit), "scans: times of points").health, Health::spoils);
  const Recording no_times = with([](PointCloud& cloud) { cloud.time_offsets_ns.clear(); });
  EXPECT_EQ(of(found_in(no_times), "scans: times of points").health, Health::noted);

  const Recording empty = with([](PointCloud& cloud) { cloud = {}; });
  const Result<std::vector<Diagnosis>> nothing = diagnose(empty);
  ASSERT_FALSE(nothing);
  EXPECT_NE(nothing.error().message.find("no points"), std::string::npos);
}

TEST_F(Doctor, FindsWhatStandsInTheView) {
  const auto keep = [](PointCloud& cloud, const auto& is_kept) {
    PointCloud kept;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!is_kept(cloud.points[i])) continue;
      kept.points.push_back(cloud.points[i]);
      kept.time_offsets_ns.push_back(cloud.time_offsets_ns[i]);
    }
    cloud = kept;
  };
  const Recording blind = with([&](PointCloud& cloud) {  // from 120 to 180 degrees
    keep(cloud, [](const Eigen::Vector3f& p) { return std::atan2(p.y(), p.x()) < 120.0 * kDegree; });
  });
  const Diagnosis view = of(found_in(blind), "scans: view");
  EXPECT_EQ(view.health, Health::noted);
  EXPECT_NE(view.sentence.find("blind: 120 to 180"), std::string::npos) << view.sentence;

  const Recording cut =
      with([&](PointCloud& cloud) { keep(cloud, [](const Eigen::Vector3f& p) { return p.norm() < 8.0F; }); });
  EXPECT_NE(of(found_in(cut), "scans: range").sentence.find("as if cut off"), std::string::npos);

  const Recording pixels = with([](PointCloud& cloud) {  // that met nothing, as drivers of images send them
    for (std::size_t i = 0; i < cloud.size(); i += 20) cloud.points[i].setZero();
  });
  EXPECT_EQ(of(found_in(pixels), "scans: the robot itself").health, Health::good);
  EXPECT_EQ(of(found_in(pixels), "scans: range").sentence.find("from 0.0 m"), std::string::npos);

  const Recording mast = with([](PointCloud& cloud) {  // a mast at 0.5 m to the left behind
    for (std::size_t i = 0; i < cloud.size(); i += 100) cloud.points[i] = {-0.35F, 0.35F, 0.1F};
  });
  const Diagnosis itself = of(found_in(mast), "scans: the robot itself");
  EXPECT_EQ(itself.health, Health::noted);
  EXPECT_NE(itself.sentence.find("about 13"), std::string::npos) << itself.sentence;
  EXPECT_NE(itself.remedy.find("min_range=0.6"), std::string::npos) << itself.remedy;
}

}  // namespace
}  // namespace adit
