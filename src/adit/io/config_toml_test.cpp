// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/config_toml.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace adit {
namespace {

using test::put_file;
using test::TemporaryFolder;

struct TestConfig {
  double voxel = 1.0;
  int count = 3;
  bool on = false;
  std::string mode = "fast";
};
Fields fields_of(TestConfig& c) {
  Fields fields = {{"on", &c.on, "", 0, 1, "whether"}};
  append(fields, "icp",
         {{"voxel", &c.voxel, "m", 0.1, 10, "edge"}, {"count", &c.count, "", 1, 9, "how often"}});
  append(fields, "icp.deep", {{"mode", &c.mode, "", 0, 0, "which", {"fast", "exact"}}});
  return fields;
}

TEST(ConfigToml, SetsNestedFieldsAndReadsItsOwnText) {
  TestConfig config;
  ASSERT_TRUE(
      parse_config(fields_of(config), "on = true\n[icp]\nvoxel = 2\ncount = 4\ndeep.mode = 'exact'\n"));
  EXPECT_EQ(config.voxel, 2.0);
  EXPECT_TRUE(config.on);
  EXPECT_EQ(config.mode, "exact");
  TestConfig back;
  const Result<> parsed = parse_config(fields_of(back), to_toml(fields_of(config)));
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ(to_toml(fields_of(back)), to_toml(fields_of(config)));
  EXPECT_EQ(back.count, 4);
}

TEST(ConfigToml, ErrorsNameTheLine) {
  TestConfig config;
  const Fields fields = fields_of(config);
  EXPECT_ERROR(parse_config(fields, "[icp]\nvoxl = 2.0\n"),
               "line 2: unknown configuration key 'icp.voxl'; did you mean 'icp.voxel'?");
  EXPECT_ERROR(parse_config(fields, "[icp]\nvoxel = 20.0\n"), "outside 0.1 to 10 m");
  EXPECT_ERROR(parse_config(fields, "[icp]\nvoxel = '2.0'\n"), "not a string");
  EXPECT_ERROR(parse_config(fields, "[icp]\ncount = 2.5\n"), "whole number");
  EXPECT_ERROR(parse_config(fields, "[icp.deep]\nmode = 3\n"), "string in quotes");
  EXPECT_ERROR(parse_config(fields, "[icp]\nvoxel = [1]\n"), "line 2: icp.voxel");
  EXPECT_ERROR(parse_config(fields, "on = \n"), "line 1");
  EXPECT_ERROR(load_config("/absent.toml", fields), "/absent.toml: no such file");
}

TEST(ConfigToml, SavedByAnotherVersionKeepsWhatThisOneTakes) {
  TestConfig config;
  const Fields fields = fields_of(config);
  const Result<std::vector<std::string>> not_taken =
      parse_saved_config(fields, "on = true\n[icp]\nvoxel = 20.0\ncount = 4\n[icp.gone]\nkernel = 1.0\n");
  ASSERT_TRUE(not_taken) << not_taken.error().message;
  ASSERT_EQ(not_taken->size(), 2U);
  EXPECT_NE((*not_taken)[0].find("unknown configuration key 'icp.gone.kernel'"), std::string::npos);
  EXPECT_NE((*not_taken)[1].find("line 3: icp.voxel"), std::string::npos);
  EXPECT_TRUE(config.on);
  EXPECT_EQ(config.count, 4);
  EXPECT_EQ(config.voxel, 1.0);
  EXPECT_ERROR(parse_saved_config(fields, "on = \n"), "line 1");
}

struct ListEntry {
  std::string name;
  int size = 1;
};

Result<std::vector<ListEntry>> entries_of(const TemporaryFolder& folder, const std::string& text) {
  put_file(folder / "list.toml", text);
  std::vector<ListEntry> entries;
  return load_entries(folder / "list.toml", "box",
                      [&]() -> Fields {
                        ListEntry& entry = entries.emplace_back();
                        return {{"name", &entry.name, "", 0, 0, "its name"},
                                {"shape.size", &entry.size, "", 1, 9, "its size"}};
                      })
      .map([&] { return entries; });
}

TEST(ConfigToml, AListHasOneEntryATable) {
  const TemporaryFolder folder;
  const auto entries = entries_of(folder, "[[box]]\nname = 'a'\nshape = {size = 3}\n[[box]]\nname = 'b'\n");
  ASSERT_TRUE(entries) << entries.error().message;
  ASSERT_EQ(entries->size(), 2U);
  EXPECT_EQ((*entries)[0].name, "a");
  EXPECT_EQ((*entries)[0].size, 3);
  EXPECT_EQ((*entries)[1].name, "b");
  EXPECT_EQ((*entries)[1].size, 1);
  EXPECT_TRUE(entries_of(folder, "")->empty());
}

TEST(ConfigToml, AListRefusesWhatIsNotItsOwn) {
  const TemporaryFolder folder;
  EXPECT_ERROR(entries_of(folder, "[[bok]]\n"), "line 1");
  EXPECT_ERROR(entries_of(folder, "[box]\nname = 'a'\n"), "[[box]]");
  EXPECT_ERROR(entries_of(folder, "box = [1]\n"), "a table is needed");
  EXPECT_ERROR(entries_of(folder, "[[box]]\nnam = 'a'\n"), "did you mean");
  EXPECT_ERROR(entries_of(folder, "[[box]]\nshape.size = 10\n"), "line 2");
  EXPECT_ERROR(entries_of(folder, "[[box]\n"), "line 1");
  EXPECT_ERROR(load_entries(folder / "absent.toml", "box", [] { return Fields{}; }), "absent.toml");
}

TEST(ConfigToml, MarkdownHasOneRowAField) {
  TestConfig config;
  const std::string text = to_markdown(fields_of(config));
  EXPECT_NE(text.find("## `icp`"), std::string::npos);
  EXPECT_NE(text.find("| `icp.voxel` | 1 | m | 0.1 to 10 | edge |"), std::string::npos) << text;
  EXPECT_NE(text.find("| `icp.deep.mode` | fast |  | fast, exact | which |"), std::string::npos) << text;
}

}  // namespace
}  // namespace adit
