// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// `adit merge-study` on a world of two short drives: what it keeps, what it redoes and what it writes.
#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/program.hpp"
#include "support/two_drives.hpp"

namespace adit {
namespace {

using test::expect_done;
using test::expect_refused;
using test::get_file;
using test::put_file;

/// A list of one world in which two robots follow one another around a corner, and of one that is absent.
void put_list(const test::TemporaryFolder& folder) {
  test::put_two_drives(folder.path());
  put_file(folder / "list.toml",
           "[[world]]\nname = 'short'\ngroup = 'check'\nroutes_file = 'routes.yaml'\n"
           "[[world]]\nname = 'absent'\nroutes_file = 'nowhere.yaml'\n");
}

std::string study_of(const test::TemporaryFolder& folder, const std::string& options) {
  return "merge-study --worlds " + (folder / "list.toml").string() + " --out " + (folder / "out").string() +
         " " + options;
}

std::filesystem::path only_map_folder(const test::TemporaryFolder& folder) {
  EXPECT_EQ(test::num_entries(folder / "out/maps"), 1U);
  return std::filesystem::directory_iterator(folder / "out/maps")->path();
}

TEST(MergeStudy, KeepsTheMapsAndTheResultsOfEarlierRuns) {
  const test::TemporaryFolder folder;
  put_list(folder);
  put_file(folder / "page.md", "# Page\n<!-- merging begin -->\n<!-- merging end -->\nThe end.\n");
  expect_done(study_of(folder, "--keyframes all"));
  const std::string results = get_file(folder / "out/results.json");
  EXPECT_NE(results.find("\"world\": \"short\""), std::string::npos);
  EXPECT_NE(results.find("\"group\": \"check\""), std::string::npos);
  const auto recorded = std::filesystem::last_write_time(only_map_folder(folder) / "0.map");

  expect_done(study_of(
      folder, "--keyframes tunnel_filter_keep --only short --page " + (folder / "page.md").string()));
  EXPECT_EQ(std::filesystem::last_write_time(only_map_folder(folder) / "0.map"), recorded);
  const std::string csv = get_file(folder / "out/results.csv");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 3) << csv;  // The header, and one pair per policy.
  EXPECT_NE(csv.find("short,check,all,os2-32,field,ahead,behind,"), std::string::npos) << csv;
  EXPECT_NE(csv.find("short,check,tunnel_filter_keep,os2-32,field,ahead,behind,"), std::string::npos) << csv;
  const std::string page = get_file(folder / "page.md");
  EXPECT_TRUE(page.starts_with("# Page\n<!-- merging begin -->\n"));
  EXPECT_TRUE(page.ends_with("<!-- merging end -->\nThe end.\n"));
  EXPECT_NE(page.find("| short | all | os2-32 | field | 1 |"), std::string::npos) << page;

  // Another configuration of the robots is another drive, and has a place of its own where it is named.
  expect_done(study_of(folder, "--keyframes all --variant coarse --set robot.keyframes.distance_m=1"));
  EXPECT_EQ(test::num_entries(folder / "out/maps"), 2U);
  EXPECT_NE(get_file(folder / "out/results.csv").find("short,check,all coarse,"), std::string::npos);
}

TEST(MergeStudy, TheLastRunsResultsAreTheSameFromTheCache) {
  const test::TemporaryFolder folder;
  put_list(folder);
  const auto pair_line = [&] {
    const std::string csv = get_file(folder / "out/results.csv");
    return csv.substr(csv.find('\n'));
  };
  expect_done(study_of(folder, "--keyframes all"));
  const std::string first = pair_line();
  expect_done(study_of(folder, "--keyframes all --threads 1"));
  EXPECT_EQ(pair_line(), first);
}

TEST(MergeStudy, WrongUsageAndDamageAreRefused) {
  const test::TemporaryFolder folder;
  put_file(folder / "list.toml", "[[world]]\nname = 'a'\n[[world]]\nname = 'a'\n");
  expect_refused(study_of(folder, ""), 1, "two worlds are called 'a'");
  put_file(folder / "list.toml", "[[world]]\ngroup = 'tuning'\n");
  expect_refused(study_of(folder, ""), 1, "no name");
  put_file(folder / "list.toml", "[[world]]\nname = 'a'\n");
  expect_refused(study_of(folder, "--only b"), 1, "no world 'b'");
  expect_refused(study_of(folder, "--keyframes best"), 2, "tunnel_filter_keep");
  expect_refused(study_of(folder, "--groups most"), 2, "most");
  std::filesystem::create_directories(folder / "out");
  put_file(folder / "out/results.json", "{}");
  expect_refused(study_of(folder, "--only a"), 1, "results.json");
}

}  // namespace
}  // namespace adit
