// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Pages of docs/ that list values of the code by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "adit/fleet/joint/cycle.hpp"
#include "adit/fleet/merge/adaptive_config.hpp"
#include "adit/simulation/scenario.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

const fs::path kSources = fs::path(ADIT_CONFORMANCE).parent_path().parent_path();

std::string without_blanks(std::string text) {
  std::erase_if(text, [](unsigned char c) { return std::isspace(c) != 0; });
  return text;
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" `");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" `") + 1 - begin);
}

/// The cells of all rows of tables whose first one is code.
std::vector<std::vector<std::string>> rows_of(const fs::path& page) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(test::get_file(kSources / page));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("| `")) continue;
    std::istringstream row(line.substr(1));
    rows.emplace_back();
    for (std::string cell; std::getline(row, cell, '|');) rows.back().push_back(trimmed(cell));
  }
  return rows;
}

/// Under field conditions, every number before them as small or as large as it may be.
ScenarioConfig field_after(bool largest) {
  ScenarioConfig config;
  for (const Field& field : fields_of(config)) {
    const double number = largest ? field.max : field.min;
    if (auto* const* real = std::get_if<double*>(&field.target)) **real = number;
    if (auto* const* whole = std::get_if<int*>(&field.target)) **whole = static_cast<int>(number);
    if (auto* const* seed = std::get_if<std::uint64_t*>(&field.target))
      **seed = static_cast<std::uint64_t>(number);
    if (auto* const* on = std::get_if<bool*>(&field.target)) **on = largest;
  }
  set_conditions(Conditions::field, config);
  return config;
}

TEST(Pages, EveryFieldThatFieldConditionsSetHasItsValueAndASource) {
  ScenarioConfig low = field_after(false);
  ScenarioConfig high = field_after(true);
  const Fields fields = fields_of(low);
  const Fields others = fields_of(high);
  std::map<std::string, std::vector<std::string>> rows;
  for (const auto& row : rows_of("docs/simulation_fields.md"))
    EXPECT_TRUE(rows.emplace(row.front(), row).second) << row.front() << " stands twice";
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].is_text() || value_text(fields[i]) != value_text(others[i])) continue;  // not set
    const std::string key = "simulation." + fields[i].key;
    ASSERT_TRUE(rows.contains(key)) << key << " is set by field conditions and has no row";
    const std::vector<std::string>& row = rows.at(key);
    ASSERT_EQ(row.size(), 4U) << key;
    EXPECT_EQ(row[1], value_text(fields[i])) << key;
    EXPECT_EQ(row[2], fields[i].unit) << key;
    EXPECT_FALSE(row[3].empty()) << key << " has no source";
    rows.erase(key);
  }
  for (const auto& [key, row] : rows) ADD_FAILURE() << key << " is not set by field conditions";
}

/// Whether the file sets the constant to that value.
bool sets(const std::string& text, const std::string& constant, const std::string& value) {
  const std::string stated = without_blanks(constant + "=" + value);
  for (std::size_t at = 0; (at = text.find(stated, at)) != std::string::npos; at += stated.size())
    if (std::string_view(";F").find(text[at + stated.size()]) != std::string_view::npos) return true;
  return false;
}

TEST(Pages, ScalesOfMeasuringAreThoseInUse) {
  AdaptiveConfig adaptive;
  CycleConfig cycles;
  Fields settings;
  append(settings, "loops.adaptive", fields_of(adaptive));
  append(settings, "back_end.cycles", fields_of(cycles));
  const auto scales = rows_of("docs/scales_of_measuring.md");
  EXPECT_GT(scales.size(), 70U);
  for (const std::vector<std::string>& row : scales) {
    ASSERT_EQ(row.size(), 6U) << row.front();  // name, value, unit, file, what it does, source
    EXPECT_FALSE(row[4].empty() || row[5].empty()) << row.front();
    if (row[3] == "setting") {
      const auto field = std::ranges::find(settings, row[0], &Field::key);
      ASSERT_NE(field, settings.end()) << row[0];
      EXPECT_EQ(row[1], value_text(*field)) << row[0];
      EXPECT_EQ(row[2], field->unit) << row[0];
    } else {
      const std::string text = without_blanks(test::get_file(kSources / "src/adit" / row[3]));
      EXPECT_TRUE(sets(text, row[0], row[1])) << row[3] << " has no " << row[0] << " = " << row[1];
    }
  }
}

}  // namespace
}  // namespace adit
