// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/faults.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "adit/core/format.hpp"

namespace adit {
namespace {

std::optional<double> number_of(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// "10:13" -> 10 and 13.
std::optional<std::pair<double, double>> stretch_of(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const std::optional<double> begin = number_of(text.substr(0, colon));
  const std::optional<double> end = number_of(text.substr(colon + 1));
  if (!begin || !end || *begin < 0.0 || *end <= *begin) return std::nullopt;
  return std::pair(*begin, *end);
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

Result<SensorFault> parse_fault(const std::string& text, const std::string& sensor,
                                std::span<const FaultKind> kinds, Stamp start) {
  const std::vector<std::string> words = words_of(text);
  const auto kind = std::ranges::find(kinds, words.empty() ? "" : words[0], &FaultKind::name);
  if (kind == kinds.end()) {
    std::vector<std::string_view> names;
    for (const FaultKind& known : kinds) names.push_back(known.name);
    return fail(format("fault '{}': it starts with one of {}", text, fmt::join(names, ", ")));
  }
  const std::size_t num_words = kind->amount == FaultAmount::needed ? 3 : 2;
  const auto stretch = words.size() == num_words ? stretch_of(words[1]) : std::nullopt;
  const std::optional<double> amount = words.size() > 2 ? number_of(words[2]) : 0.0;
  if (!stretch || !amount) {
    return fail(format("fault '{}': '{} BEGIN:END{}' is needed, seconds after the start", text, kind->name,
                       num_words == 3 ? " AMOUNT" : ""));
  }
  return SensorFault{sensor, std::string(kind->name), start + from_seconds(stretch->first),
                     start + from_seconds(stretch->second), *amount};
}

}  // namespace

Result<std::vector<SensorFault>> parse_faults(const std::string& text, const std::string& sensor,
                                              std::span<const FaultKind> kinds, Stamp start) {
  std::vector<SensorFault> faults;
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    Result<SensorFault> fault = parse_fault(item, sensor, kinds, start);
    if (!fault) return tl::unexpected(fault.error());
    faults.push_back(std::move(*fault));
  }
  return faults;
}

bool is_faulty(const std::vector<SensorFault>& faults, std::string_view kind, Stamp stamp) {
  return std::ranges::any_of(faults, [&](const SensorFault& fault) {
    return fault.kind == kind && fault.begin <= stamp && stamp < fault.end;
  });
}

}  // namespace adit
