// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/look_alikes.hpp"

#include <algorithm>
#include <bit>

namespace adit {

void LookAlikes::add(std::size_t passed, std::size_t num_ended) {
  Phase& phase = phases_[std::min<std::size_t>(std::bit_width(passed + 1), phases_.size()) - 1];
  ++phase.num_steps;
  phase.num_ended += num_ended;
}

ChancesToGoOn LookAlikes::chances() const {
  ChancesToGoOn chances{};
  double chance = prior_chance_;
  for (std::size_t p = 0; p < phases_.size(); ++p) {
    const auto steps = static_cast<double>(phases_[p].num_steps);
    const auto went_on = steps - static_cast<double>(phases_[p].num_ended);
    const double measured = (went_on + chance * prior_steps_) / (steps + prior_steps_);
    chance = p == 0 ? measured : std::max(chance, measured);
    chances[p] = chance;
  }
  return chances;
}

}  // namespace adit
