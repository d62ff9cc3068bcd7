// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/page_tables.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace adit {
namespace {

using test::get_file;
using test::put_file;

const std::string kBefore = "# Page\n<!-- other begin -->\nstays\n<!-- other end -->\n";
const std::string kBegin = "<!-- merging begin -->\n";
const std::string kEnd = "<!-- merging end -->\n";

Table table(const std::string& title, const std::string& cell) {
  return {title, "What it says.", {}, {"World", "Wrong"}, {{"zab", cell}}};
}

TEST(WriteTables, ReplacesTheSectionAndNothingElse) {
  const test::TemporaryFolder folder;
  put_file(folder / "page.md", kBefore + kBegin + "| old |\n" + kEnd + "The end.\n");
  ASSERT_TRUE(write_tables(folder / "page.md", "merging", {table("First", "3"), table("Second", "a|b")}));
  const std::string page = get_file(folder / "page.md");
  EXPECT_TRUE(page.starts_with(kBefore + kBegin)) << page;
  EXPECT_TRUE(page.ends_with(kEnd + "The end.\n")) << page;
  EXPECT_EQ(page.find("old"), std::string::npos);
  EXPECT_NE(page.find("| zab | 3 |"), std::string::npos) << page;
  EXPECT_NE(page.find("| zab | a\\|b |"), std::string::npos) << page;
  EXPECT_LT(page.find("**First**"), page.find("**Second**"));
}

TEST(WriteTables, ASecondTimeLeavesTheSameBytes) {
  const test::TemporaryFolder folder;
  put_file(folder / "page.md", kBegin + kEnd);
  ASSERT_TRUE(write_tables(folder / "page.md", "merging", {table("First", "3")}));
  const std::string once = get_file(folder / "page.md");
  ASSERT_TRUE(write_tables(folder / "page.md", "merging", {table("First", "3")}));
  EXPECT_EQ(get_file(folder / "page.md"), once);
}

TEST(WriteTables, APageWithoutTheMarksStaysAsItIs) {
  const test::TemporaryFolder folder;
  for (const std::string& page : {kBefore, kBefore + kBegin, kBefore + kEnd + kBegin}) {
    put_file(folder / "page.md", page);
    const Result<> written = write_tables(folder / "page.md", "merging", {table("First", "3")});
    EXPECT_ERROR(written, "page.md: the page needs the lines '<!-- merging begin -->'");
    EXPECT_EQ(get_file(folder / "page.md"), page);
  }
}

TEST(WriteTables, FiguresLieBesideThePageAndBelowTheTables) {
  const test::TemporaryFolder folder;
  put_file(folder / "page.md", kBegin + kEnd);
  const std::vector<PageFigure> figures = {{"rates.svg", "Rates", "<svg/>"}};
  ASSERT_TRUE(write_tables(folder / "page.md", "merging", {table("First", "3")}, figures));
  const std::string page = get_file(folder / "page.md");
  EXPECT_LT(page.find("| zab | 3 |"), page.find("\n![Rates](figures/rates.svg)\n")) << page;
  EXPECT_EQ(get_file(folder / "figures/rates.svg"), "<svg/>");
  ASSERT_TRUE(write_tables(folder / "page.md", "merging", {table("First", "3")}, figures));
  EXPECT_EQ(get_file(folder / "page.md"), page);
  std::filesystem::remove_all(folder / "figures");
  EXPECT_FALSE(write_tables(folder / "page.md", "other", {}, figures));
  EXPECT_FALSE(std::filesystem::exists(folder / "figures")) << "a page without the marks takes none";
}

TEST(WriteTables, APageThatIsNotThereIsNamedAndNotMade) {
  const test::TemporaryFolder folder;
  EXPECT_ERROR(write_tables(folder / "away.md", "merging", {}), "away.md");
  EXPECT_FALSE(std::filesystem::exists(folder / "away.md"));
}

}  // namespace
}  // namespace adit
