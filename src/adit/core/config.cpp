// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/config.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "adit/core/format.hpp"

namespace adit {
namespace {

template <class T>
Result<T> parse_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    return fail(format("'{}' is not a number", text));
  return value;
}

Result<> check_range(const Field& field, double value) {
  if (std::isfinite(value) && value >= field.min && value <= field.max) return {};
  return fail(format("{} = {} is outside {} to {}{}{}", field.key, value, field.min, field.max,
                     field.unit.empty() ? "" : " ", field.unit));
}

Result<> check_choice(const Field& field, std::string_view value) {
  if (field.choices.empty() || std::ranges::find(field.choices, value) != field.choices.end()) return {};
  std::vector<std::string> choices = field.choices;
  std::ranges::replace(choices, "", "empty");
  return fail(format("{} = '{}' is not one of {}", field.key, value, fmt::join(choices, ", ")));
}

Result<> assign(const Field& field, std::string_view text, double* target) {
  const Result<double> value = parse_number<double>(text);
  if (!value) return fail(field.key, value.error());
  return check_range(field, *value).map([&] { *target = *value; });
}

template <class Integer>
Result<> assign(const Field& field, std::string_view text, Integer* target) {
  const Result<Integer> value = parse_number<Integer>(text);
  if (!value) return fail(field.key + ": " + value.error().message + " (a whole number is needed)");
  return check_range(field, static_cast<double>(*value)).map([&] { *target = *value; });
}

Result<> assign(const Field& field, std::string_view text, bool* target) {
  if (text != "true" && text != "false")
    return fail(format("{}: '{}' is neither true nor false", field.key, text));
  *target = text == "true";
  return {};
}

Result<> assign(const Field& field, std::string_view text, std::string* target) {
  return check_choice(field, text).map([&] { *target = std::string(text); });
}

Result<> assign(const Field& field, std::string_view text, const EnumTarget& target) {
  return check_choice(field, text).map([&] {
    target.set(static_cast<std::size_t>(std::ranges::find(field.choices, text) - field.choices.begin()));
  });
}

Result<> check_value(const Field&, const bool*) { return {}; }
Result<> check_value(const Field& field, const std::string* text) { return check_choice(field, *text); }
Result<> check_value(const Field& field, const EnumTarget& target) {
  return check_choice(field, target.name());
}
template <class Number>
Result<> check_value(const Field& field, const Number* number) {
  return check_range(field, static_cast<double>(*number));
}

template <class Value>
std::string text_of(const Value* value) {
  return format("{}", *value);
}
std::string text_of(const EnumTarget& target) { return std::string(target.name()); }

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0U : 1U);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row.back();
}

}  // namespace

void append(Fields& fields, const std::string& prefix, Fields nested) {
  for (Field& field : nested) {
    field.key = prefix + "." + field.key;
    fields.push_back(std::move(field));
  }
}

std::string nearest_key(const std::vector<std::string>& known, std::string_view key) {
  const auto is_longer_form = [end = format(".{}", key)](const std::string& candidate) {
    return candidate.ends_with(end);
  };
  if (std::ranges::count_if(known, is_longer_form) == 1) return *std::ranges::find_if(known, is_longer_form);
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(3, key.size() / 3);
  for (const std::string& candidate : known) {
    // A bare field name is compared with the last part of a dotted key, so that "voxel_size" finds its
    // module.
    const std::string tail = candidate.substr(candidate.rfind('.') + 1);
    const std::size_t distance = std::min(edit_distance(key, candidate), edit_distance(key, tail) + 1);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

Result<> set_field(const Fields& fields, std::string_view key, std::string_view value) {
  const auto field = std::ranges::find(fields, key, &Field::key);
  if (field == fields.end()) {
    std::vector<std::string> known;
    for (const Field& f : fields) known.push_back(f.key);
    const std::string nearest = nearest_key(known, key);
    return fail(format(
        "unknown configuration key '{}'{}", key,
        nearest.empty() ? "; docs/configuration.md lists them all" : "; did you mean '" + nearest + "'?"));
  }
  return std::visit([&](const auto& target) { return assign(*field, value, target); }, field->target);
}

std::string value_text(const Field& field) {
  return std::visit([](const auto& target) { return text_of(target); }, field.target);
}

Result<> check_fields(const Fields& fields) {
  for (const Field& field : fields) {
    Result<> checked =
        std::visit([&](const auto& target) { return check_value(field, target); }, field.target);
    if (!checked) return checked;
  }
  return {};
}

}  // namespace adit
