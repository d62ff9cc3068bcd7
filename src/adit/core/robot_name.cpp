// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/robot_name.hpp"

#include <algorithm>
#include <cstddef>
#include <set>

#include "adit/core/format.hpp"

namespace adit {
namespace {

constexpr std::size_t kMaxBytes = 64;

bool is_allowed(char c) {
  constexpr std::string_view kForbidden = "/\\:*?\"'<>|,;`$";
  return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f && kForbidden.find(c) == std::string_view::npos;
}

bool is_dot_or_blank(char c) { return c == '.' || c == ' '; }

/// At most kMaxBytes, without cutting a UTF-8 character in two.
std::string_view shortened(std::string_view text) {
  if (text.size() <= kMaxBytes) return text;
  std::size_t size = kMaxBytes;
  const auto continues = [&](std::size_t i) {
    return (static_cast<unsigned char>(text[i]) & 0xC0U) == 0x80U;
  };
  while (size > 0 && continues(size)) --size;
  return text.substr(0, size);
}

}  // namespace

std::string robot_name(std::string_view text) {
  std::string name(shortened(text));
  std::ranges::replace_if(
      name, [](char c) { return !is_allowed(c); }, '_');
  for (std::size_t i = 0; i < name.size() && is_dot_or_blank(name[i]); ++i) name[i] = '_';
  for (std::size_t i = name.size(); i > 0 && is_dot_or_blank(name[i - 1]); --i) name[i - 1] = '_';
  const bool says_nothing = std::ranges::all_of(name, [](char c) { return c == '_'; });
  return says_nothing ? "robot" : name;
}

std::vector<std::string> distinct_names(const std::vector<std::string>& names) {
  std::set<std::string> taken(names.begin(), names.end());
  std::set<std::string> used;
  std::vector<std::string> distinct;
  for (const std::string& name : names) {
    std::string chosen = name;
    for (int number = 2; used.contains(chosen) || (number > 2 && taken.contains(chosen)); ++number)
      chosen = format("{}_{}", name, number);
    used.insert(chosen);
    distinct.push_back(std::move(chosen));
  }
  return distinct;
}

std::string printable(std::string_view text) {
  std::string line(text);
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return line;
}

}  // namespace adit
