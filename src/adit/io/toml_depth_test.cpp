// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/toml_depth.hpp"

#include <gtest/gtest.h>

#include <string>

#include "adit/io/config_toml.hpp"
#include "adit/io/georeference.hpp"
#include "adit/io/recording_toml.hpp"
#include "adit/io/session_toml.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

using test::put_file;
using test::TemporaryFolder;

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}
/// a.a.a.a, of so many dots.
std::string deep_key(std::size_t dots) { return repeated("a.", dots) + "a"; }

TEST(TomlDepth, KeysHeadersAndBracketsAreCounted) {
  EXPECT_TRUE(check_toml_depth(deep_key(64) + " = 1\n[" + deep_key(60) + "]\n"));
  EXPECT_ERROR(check_toml_depth("b = 1\n" + deep_key(65) + " = 1\n"), "line 2: more than 64 keys");
  EXPECT_ERROR(check_toml_depth("[" + deep_key(65) + "]\n"), "line 1");
  EXPECT_ERROR(check_toml_depth("[[" + deep_key(65) + "]]\n"), "line 1");
  EXPECT_ERROR(check_toml_depth(repeated("a . ", 65) + "a = 1\n"), "line 1");
  EXPECT_ERROR(check_toml_depth(repeated("\"a\".", 65) + "a = 1\n"), "line 1");
  EXPECT_ERROR(check_toml_depth("b = " + repeated("[", 65)), "line 1");
  EXPECT_ERROR(check_toml_depth("b = [\n" + repeated("{a.a.a.a = [\n", 20)), "line 14");
}

TEST(TomlDepth, WhatIsNoKeyIsNot) {
  const std::string dots(200, '.');
  EXPECT_TRUE(check_toml_depth("a = [" + repeated("1.5, ", 200) + "2.5]\n"));
  EXPECT_TRUE(check_toml_depth(repeated("a = 1.5\n", 200)));
  EXPECT_TRUE(check_toml_depth("a = \"" + dots + "\\\"" + dots + "\" # " + dots + "\n"));
  EXPECT_TRUE(check_toml_depth("a = '" + dots + "\\' # " + dots + "\n"));
  EXPECT_TRUE(check_toml_depth("a = \"\"\"\n" + dots + "\n\" " + dots + "\"\"\"\n"));
  EXPECT_TRUE(check_toml_depth(repeated("a = [{b = 1}, [2]]\n", 200)));
  // After a text that ends in quotes of its own, keys count again.
  EXPECT_ERROR(check_toml_depth("b = \"\"\"x\"\"\"\"\n" + deep_key(65) + " = 1\n"), "line 2");
  EXPECT_ERROR(check_toml_depth("b = ''\n" + deep_key(65) + " = 1\n"), "line 2");
}

TEST(TomlDepth, EveryReaderRefusesWhatWouldOverflowTheStack) {
  const std::string deep = deep_key(200'000) + " = 1\n";
  EXPECT_ERROR(parse_config({}, deep), "line 1: more than 64");
  EXPECT_ERROR(parse_saved_config({}, deep), "line 1: more than 64");
  EXPECT_ERROR(parse_session_toml(deep), "line 1: more than 64");
  EXPECT_ERROR(parse_session_merges(deep), "line 1: more than 64");
  const TemporaryFolder folder;
  for (const char* name : {"georeference.toml", "recording.toml", "list.toml"}) put_file(folder / name, deep);
  EXPECT_ERROR(read_georeferences(folder.path()), "georeference.toml: line 1: more than 64");
  EXPECT_ERROR(read_recording_toml(folder / "recording.toml"), "recording.toml: line 1: more than 64");
  EXPECT_ERROR(load_entries(folder / "list.toml", "box", [] { return Fields{}; }),
               "list.toml: line 1: more than 64");
}

}  // namespace
}  // namespace adit
