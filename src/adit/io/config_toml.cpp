// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/config_toml.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <sstream>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/toml_depth.hpp"

namespace adit {
namespace {

/// The value as the text that `set_field` takes; nothing for lists, dates and the like.
std::optional<std::string> text_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* whole = node.as_integer()) return format("{}", whole->get());
  if (const auto* real = node.as_floating_point()) return format("{}", real->get());
  return std::nullopt;
}

/// A quoted number is not a number: `set_field` alone, which sees text only, would take it.
Result<> check_type(const Field& field, const toml::node& node) {
  if (field.is_text() == node.is_string()) return {};
  return fail(
      format("{}: {}", field.key,
             field.is_text() ? "a string in quotes is needed" : "a bare value, not a string, is needed"));
}

Result<> set_node(const Fields& fields, const std::string& key, const toml::node& node) {
  const std::string place = format("line {}", node.source().begin.line);
  const std::optional<std::string> text = text_of(node);
  if (!text) return fail(format("{}: {}: a number, true, false or a string is needed", place, key));
  const auto field = std::ranges::find(fields, key, &Field::key);
  Result<> set = field == fields.end() ? Result<>{} : check_type(*field, node);
  if (set) set = set_field(fields, key, *text);
  if (!set) return fail(place, set.error());
  return {};
}

/// Where `not_taken` is given, values that cannot be set are told there instead of ending it.
Result<> set_table(const Fields& fields, const std::string& prefix, const toml::table& table,
                   std::vector<std::string>* not_taken = nullptr) {
  for (const auto& [name, node] : table) {
    const std::string key = prefix + std::string(name.str());
    if (const auto* nested = node.as_table()) {
      if (Result<> set = set_table(fields, key + ".", *nested, not_taken); !set) return set;
    } else if (Result<> set = set_node(fields, key, node); !set) {
      if (not_taken == nullptr) return set;
      not_taken->push_back(set.error().message);
    }
  }
  return {};
}

/// Calls `use` with the parsed text; a syntax error says where it is.
template <class Use>
Result<> with_parsed(std::string_view text, const Use& use) {
  if (const Result<> checked = check_toml_depth(text); !checked) return checked;
  try {
    return use(toml::parse(text));
  } catch (const toml::parse_error& error) {
    const toml::source_position& at = error.source().begin;
    return fail(format("line {}, column {}: {}", at.line, at.column, error.description()));
  }
}

Result<> set_entries(const toml::table& file, std::string_view name, const std::function<Fields()>& entry) {
  for (const auto& [key, node] : file) {
    const toml::array* entries = key.str() == name ? node.as_array() : nullptr;
    if (entries == nullptr)
      return fail(format("line {}: '{}' is not expected here; the file is a list of [[{}]]",
                         node.source().begin.line, key.str(), name));
    for (const toml::node& item : *entries) {
      const auto* table = item.as_table();
      if (table == nullptr) return fail(format("line {}: a table is needed", item.source().begin.line));
      if (const Result<> set = set_table(entry(), "", *table); !set) return set;
    }
  }
  return {};
}

/// "kiss_icp" and "voxel_size" of kiss_icp.voxel_size.
std::pair<std::string, std::string> split_key(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  if (dot == std::string::npos) return {"", key};
  return {key.substr(0, dot), key.substr(dot + 1)};
}

/// The table names in the order of their first field; fields without a table come first, as TOML needs it.
std::vector<std::string> table_names(const Fields& fields) {
  std::vector<std::string> names = {""};
  for (const Field& field : fields) {
    std::string table = split_key(field.key).first;
    if (std::ranges::find(names, table) == names.end()) names.push_back(std::move(table));
  }
  return names;
}

Fields fields_of_table(const Fields& fields, const std::string& table) {
  Fields members;
  std::ranges::copy_if(fields, std::back_inserter(members),
                       [&](const Field& field) { return split_key(field.key).first == table; });
  return members;
}

std::string range_text(const Field& field) {
  if (std::holds_alternative<bool*>(field.target)) return "true, false";
  if (field.is_text()) {
    std::vector<std::string> choices = field.choices;
    std::ranges::replace(choices, "", "empty");
    return choices.empty() ? "any text" : format("{}", fmt::join(choices, ", "));
  }
  return format("{} to {}", field.min, field.max);
}

std::string toml_value(const Field& field) {
  const std::string text = value_text(field);
  if (field.is_text()) {
    std::ostringstream quoted;
    quoted << toml::value<std::string>(text);
    return quoted.str();
  }
  // In TOML a real number has a point or an exponent, and a digit after the point.
  const bool is_real = std::holds_alternative<double*>(field.target);
  return is_real && text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

}  // namespace

Result<> parse_config(const Fields& fields, std::string_view toml) {
  return with_parsed(toml, [&](const toml::table& file) { return set_table(fields, "", file); });
}

Result<std::vector<std::string>> parse_saved_config(const Fields& fields, std::string_view toml) {
  std::vector<std::string> not_taken;
  return with_parsed(toml, [&](const toml::table& file) { return set_table(fields, "", file, &not_taken); })
      .map([&] { return not_taken; });
}

Result<> load_config(const std::filesystem::path& path, const Fields& fields) {
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  const Result<> parsed = parse_config(fields, *bytes);
  if (!parsed) return fail(path.string(), parsed.error());
  return {};
}

Result<> load_entries(const std::filesystem::path& path, std::string_view name,
                      const std::function<Fields()>& entry) {
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  const Result<> parsed =
      with_parsed(*bytes, [&](const toml::table& file) { return set_entries(file, name, entry); });
  if (!parsed) return fail(path.string(), parsed.error());
  return {};
}

std::string to_toml(const Fields& fields) {
  std::string text;
  for (const std::string& table : table_names(fields)) {
    const Fields members = fields_of_table(fields, table);
    if (!table.empty()) text += format("{}[{}]\n", text.empty() ? "" : "\n", table);
    for (const Field& field : members) {
      text += format("{} = {}  # {}{}{}; {}\n", split_key(field.key).second, toml_value(field), field.meaning,
                     field.unit.empty() ? "" : ", ", field.unit, range_text(field));
    }
  }
  return text;
}

std::string to_markdown(const Fields& fields) {
  std::string text;
  for (const std::string& table : table_names(fields)) {
    const Fields members = fields_of_table(fields, table);
    if (members.empty()) continue;
    text += format("{}## {}\n\n| key | default | unit | range | meaning |\n| --- | --- | --- | --- | --- |\n",
                   text.empty() ? "" : "\n", table.empty() ? "General" : "`" + table + "`");
    for (const Field& field : members) {
      text += format("| `{}` | {} | {} | {} | {} |\n", field.key, value_text(field), field.unit,
                     range_text(field), field.meaning);
    }
  }
  return text;
}

}  // namespace adit
