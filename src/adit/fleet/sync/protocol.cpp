// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

std::string_view to_string(HypothesisOutcome outcome) {
  switch (outcome) {
    case HypothesisOutcome::accepted:
      return "accepted";
    case HypothesisOutcome::refuted:
      return "refuted";
    case HypothesisOutcome::unsure:
      return "unsure";
    case HypothesisOutcome::rival:
      return "rival";
    case HypothesisOutcome::vetoed:
      return "vetoed";
    case HypothesisOutcome::behind:
      return "behind";
  }
  return "unknown";
}

}  // namespace adit
