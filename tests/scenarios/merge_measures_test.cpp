// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// `adit merge-curves` and `adit merge-calibration` on a world of two short drives: what they write and
// refuse.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "support/files.hpp"
#include "support/program.hpp"
#include "support/two_drives.hpp"

namespace adit {
namespace {

using test::expect_done;
using test::expect_refused;
using test::get_file;
using test::put_file;

constexpr const char* kThin = " --lidar vlp-16 --set simulation.lidar.columns=180";

/// Two worlds of the same two drives, with noise of their own.
void put_worlds(const test::TemporaryFolder& folder) {
  test::put_two_drives(folder.path());
  put_file(folder / "list.toml",
           "[[world]]\nname = 'one'\nroutes_file = 'routes.yaml'\n"
           "[[world]]\nname = 'other'\nnoise_seed = 2\nroutes_file = 'routes.yaml'\n");
}

std::string measure(const test::TemporaryFolder& folder, const std::string& command,
                    const std::string& options) {
  return command + " --worlds " + (folder / "list.toml").string() + " --out " + (folder / "out").string() +
         kThin + " " + options;
}

TEST(MergeCurvesCommand, WritesTablesAndAFigure) {
  const test::TemporaryFolder folder;
  put_worlds(folder);
  put_file(
      folder / "effects.toml",
      "[[effect]]\nname = 'bias'\nfield = 'simulation.lidar_errors.range_bias'\nstated = 0.03\nsteps = 1\n");
  put_file(folder / "page.md", "<!-- merge-curves begin -->\n<!-- merge-curves end -->\n");
  const std::string effects = "--effects " + (folder / "effects.toml").string();
  expect_done(
      measure(folder, "merge-curves", effects + " --only one --page " + (folder / "page.md").string()));
  EXPECT_NE(get_file(folder / "page.md").find("| bias | 0.06 | 2 |"), std::string::npos)
      << get_file(folder / "page.md");
  EXPECT_NE(get_file(folder / "out/curves.svg").find("bias"), std::string::npos);
  EXPECT_NE(get_file(folder / "out/results.json").find("adaptive bias 0.06"), std::string::npos);
  expect_refused(measure(folder, "merge-curves", effects + " --only two"), 1, "no world 'two'");
  put_file(folder / "effects.toml", "[[effect]]\nname = 'bias'\nfield = 'simulation.bias'\nstated = 1\n");
  expect_refused(measure(folder, "merge-curves", effects), 1, "effect 'bias'");
}

TEST(MergeCalibrationCommand, JudgesTheHypothesesOfWorldsAndBetweenThem) {
  const test::TemporaryFolder folder;
  put_worlds(folder);
  put_file(folder / "page.md", "<!-- merge-calibration begin -->\n<!-- merge-calibration end -->\n");
  expect_done(measure(folder, "merge-calibration", "--page " + (folder / "page.md").string()));
  EXPECT_EQ(test::num_entries(folder / "out/maps"), 2U);
  EXPECT_NE(get_file(folder / "page.md").find("Claimed rate"), std::string::npos);
  // The worlds are one in truth: loops between them are found, and count as wrong.
  EXPECT_NE(get_file(folder / "out/calibration.json").find("\"truth\": \"wrong\""), std::string::npos);
  const std::string svg = get_file(folder / "out/merge_calibration.svg");
  EXPECT_NE(svg.find("upper limit"), std::string::npos);
  EXPECT_EQ(get_file(folder / "figures/merge_calibration.svg"), svg) << "beside the page";
  EXPECT_NE(get_file(folder / "page.md").find("](figures/merge_calibration.svg)"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/calibration.part.json"));
  expect_refused(measure(folder, "merge-calibration", "--partners -1"), 2, "partners");
  expect_refused(measure(folder, "merge-calibration", "--only two"), 1, "no world 'two'");
}

/// calibration.json with one hypothesis, made at the default error rate, with a key that only earlier
/// versions write.
std::string calibration_of(const std::string& robots, const std::string& truth, double evidence) {
  return R"({"version": 1, "hypotheses": [{"robots": ")" + robots + R"(", "truth": ")" + truth +
         R"(", "refuted": false, "accepted": false, "evidence": )" + std::to_string(evidence) +
         R"(, "of_walls": 0.5, "needed": 6.214608098422191, "compared_m": 30.5,)"
         R"( "distinctive": 3, "changes": 1,)"
         R"( "things": 0, "wall_patches": 12, "looked_for_again": 0, "equal_signs": 0.5, "equal_signs_sigma": 0.1}]})";
}

TEST(MergeCalibrationCommand, JoinsWhatRunsWrote) {
  const test::TemporaryFolder folder;
  const auto in = [&](const std::string& name) { return (folder / name).string(); };
  put_file(in("a.json"), calibration_of("a/0, a/1", "right", 9.0));
  put_file(in("b.json"), calibration_of("b/0, b/1", "wrong", 1.5));
  const std::string join = "merge-calibration --out " + in("out") + " --join " + in("a.json") + " ";
  expect_done(join + in("b.json"));
  const std::string json = get_file(in("out/calibration.json"));
  EXPECT_LT(json.find("a/0, a/1"), json.find("b/0, b/1"));
  EXPECT_NE(get_file(in("out/merge_calibration.svg")).find("1 false and 1 true"), std::string::npos);
  expect_refused(join + in("a.json"), 1, "a.json: ");
  for (const char* ignored : {"--worlds list.toml", "--groups field", "--only a", "--partners 1",
                              "--lidar os2-32", "--conditions field"})
    expect_refused(join + in("b.json") + " " + ignored, 2, "--join");
  expect_refused("merge-calibration --out " + in("out"), 2, "--worlds is required");
}

TEST(MergeCalibrationCommand, JoinsOnlyWhatItsConfigurationFitsAndReplacesNoRun) {
  const test::TemporaryFolder folder;
  const std::string run = (folder / "run/calibration.json").string();
  const std::string other = (folder / "other.json").string();
  std::filesystem::create_directory(folder / "run");
  put_file(run, calibration_of("a/0, a/1", "right", 9.0));
  put_file(other, calibration_of("b/0, b/1", "wrong", 1.5));
  const std::string join = "merge-calibration --join " + other + " " + run + " --out ";
  expect_refused(join + (folder / "run").string(), 2, "would be replaced");
  EXPECT_EQ(get_file(run), calibration_of("a/0, a/1", "right", 9.0));
  EXPECT_EQ(test::num_entries(folder / "run"), 1U) << "nothing was written";
  const std::string set = " --set loops.adaptive.merge_check.evidence.error_rate=0.01";
  expect_refused(join + (folder / "both").string() + set, 1, "error_rate at 0.002, this command has 0.01");
  EXPECT_FALSE(std::filesystem::exists(folder / "both"));
}

}  // namespace
}  // namespace adit
