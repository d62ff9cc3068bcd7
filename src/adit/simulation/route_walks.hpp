// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "adit/simulation/route_network.hpp"

namespace adit {

/// Places that a robot passes one after another, each joined to the next by a way of the network.
using Walk = std::vector<std::uint32_t>;

/// Walks for so many robots, chosen from thousands that `config.seed` draws: together they cover much of the
/// network, each pair has `config.shared_m` of it in common where that is possible, they begin apart, at ends
/// of passages, and none turns back on itself or is longer than `config.length_m`. Empty where the network
/// has fewer than two places.
[[nodiscard]] std::vector<Walk> choose_walks(const RouteNetwork& network, std::size_t num_robots,
                                             const RouteConfig& config);

}  // namespace adit
