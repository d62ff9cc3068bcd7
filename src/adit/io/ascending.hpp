// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Stamps that ascend: what a driver whose clock jumped, or a message sent twice, must not disturb.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// The indices, ascending, of a longest part of `stamps` that ascends strictly. Stamps that lie apart from
/// the others, in the past or in the future, are not in it. Source: Schensted, "Longest increasing and
/// decreasing subsequences", 1961, in O(n log n).
[[nodiscard]] std::vector<std::size_t> longest_ascending(std::span<const Stamp> stamps);

/// "3 of 100 THINGS are left out, whose stamps do not ascend with the others' (...); the first is at S s";
/// none where nothing is left out. `kept`: indices of `stamps`.
[[nodiscard]] std::optional<std::string> note_of_left_out(std::string_view things,
                                                          std::span<const Stamp> stamps,
                                                          std::span<const std::size_t> kept);

/// Of poses, or of anything else with a stamp.
template <class Stamped>
std::vector<Stamp> stamps_of(const std::vector<Stamped>& all) {
  std::vector<Stamp> stamps;
  stamps.reserve(all.size());
  for (const Stamped& one : all) stamps.push_back(one.stamp);
  return stamps;
}

/// The entries of those indices.
template <class T>
std::vector<T> taken(std::vector<T> all, const std::vector<std::size_t>& kept) {
  if (kept.size() == all.size()) return all;
  std::vector<T> out;
  out.reserve(kept.size());
  for (const std::size_t i : kept) out.push_back(std::move(all[i]));
  return out;
}

}  // namespace adit
