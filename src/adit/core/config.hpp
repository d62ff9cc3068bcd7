// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Configuration: one plain struct per module, its defaults in the struct, and beside it one function
/// `fields_of` that describes each field once. From that description come TOML reading, `--set key=value`,
/// range checks, the saved configuration and docs/configuration.md.
///
///     enum class Loss { square, huber };
///     inline constexpr std::array kLosses{Loss::square, Loss::huber};
///     std::string_view to_string(Loss loss);  // the name that TOML and --set use
///
///     struct IcpConfig { double voxel_size = 1.0; int max_iterations = 500; Loss loss = Loss::square; };
///     inline Fields fields_of(IcpConfig& c) {
///       return {{"voxel_size", &c.voxel_size, "m", 0.01, 10.0, "edge of a map voxel"},
///               {"max_iterations", &c.max_iterations, "", 1, 10000, "Gauss-Newton iterations per scan"},
///               enum_field("loss", &c.loss, kLosses, "how residuals count")};
///     }
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "adit/core/result.hpp"

namespace adit {

/// A value of an enumeration, read and set by name (`enum_field`).
struct EnumTarget {
  std::function<std::string_view()> name;  ///< Of the present value.
  std::function<void(std::size_t)> set;    ///< To the value whose name is Field::choices[index].
};

/// Where the value of a field lies, by its type. The value must outlive the field.
using FieldTarget = std::variant<double*, int*, bool*, std::uint64_t*, std::string*, EnumTarget>;

/// One setting of a configuration: its key, its value, and what the value may be.
struct Field {
  std::string key;                        ///< "voxel_size"; with the module's prefix "kiss_icp.voxel_size".
  FieldTarget target;                     ///< Points into the struct that `fields_of` was given.
  std::string unit;                       ///< "m", "deg", "" ...
  double min = 0.0;                       ///< The least that a number may be.
  double max = 0.0;                       ///< The most. Texts and bools have no range.
  std::string meaning;                    ///< One line.
  std::vector<std::string> choices = {};  ///< Allowed values of a text; empty: any.

  /// Whether the value is text, which TOML writes in quotes: a string or an enumeration.
  [[nodiscard]] bool is_text() const {
    return std::holds_alternative<std::string*>(target) || std::holds_alternative<EnumTarget>(target);
  }
};
/// In the order in which files and tables list them.
using Fields = std::vector<Field>;

/// A field that is one of `values`, spelled as `to_string` of the enumeration spells them.
template <class Enum, std::size_t N>
[[nodiscard]] Field enum_field(std::string key, Enum* target, const std::array<Enum, N>& values,
                               std::string meaning) {
  Field field{std::move(key),
              EnumTarget{[target] { return std::string_view(to_string(*target)); },
                         [target, values](std::size_t index) { *target = values.at(index); }},
              "",
              0.0,
              0.0,
              std::move(meaning)};
  for (const Enum value : values) field.choices.emplace_back(to_string(value));
  return field;
}

/// Puts "prefix." in front of each key of `nested` and appends them.
void append(Fields& fields, const std::string& prefix, Fields nested);

/// Sets one field from text. An unknown key fails with the nearest known key; a value of the wrong type, out
/// of range or not among the choices fails with what is allowed. Nothing is changed on failure.
Result<> set_field(const Fields& fields, std::string_view key, std::string_view value);

/// The value as text that `set_field` reads back: numbers shortest-exact, bools `true`/`false`, text bare.
[[nodiscard]] std::string value_text(const Field& field);

/// Checks every number against its range and every text against its choices (after a struct was filled by
/// code).
Result<> check_fields(const Fields& fields);

/// The key among `known` that `key` was most likely meant to be: the only one that ends in ".key", else the
/// nearest by edits; "" when none is near.
[[nodiscard]] std::string nearest_key(const std::vector<std::string>& known, std::string_view key);

}  // namespace adit
