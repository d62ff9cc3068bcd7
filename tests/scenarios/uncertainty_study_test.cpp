// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// `adit uncertainty-study` on a world of two short drives: what it writes and what it refuses.
#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/program.hpp"
#include "support/two_drives.hpp"

namespace adit {
namespace {

TEST(UncertaintyStudy, WritesTheTableAndTheFigures) {
  const test::TemporaryFolder folder;
  test::put_two_drives(folder.path());
  test::put_file(folder / "list.toml",
                 "[[world]]\nname = 'short'\ngroup = 'check'\nroutes_file = 'routes.yaml'\n");
  test::put_file(folder / "page.md", "<!-- uncertainty begin -->\n<!-- uncertainty end -->\n");
  const std::string study =
      "uncertainty-study --worlds " + (folder / "list.toml").string() + " --out " + (folder / "out").string();
  test::expect_done(study + " --page " + (folder / "page.md").string());
  EXPECT_NE(test::get_file(folder / "out/uncertainty.json").find("\"odometry over 1 m\""), std::string::npos);
  EXPECT_NE(test::get_file(folder / "out/uncertainty.svg").find("too confident"), std::string::npos);
  EXPECT_NE(test::get_file(folder / "page.md").find("| odometry over 10 m |"), std::string::npos);
  test::expect_refused(study + " --only nowhere", 1, "there is no world 'nowhere'");
}

}  // namespace
}  // namespace adit
