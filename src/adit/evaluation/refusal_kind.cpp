// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/refusal_kind.hpp"

#include <algorithm>
#include <utility>

namespace adit {
namespace {

/// What the sentences of each kind hold, the most particular first.
constexpr std::array<std::pair<std::string_view, RefusalKind>, 16> kPhrases = {{
    {"taken back", RefusalKind::taken_back},
    {"two hypotheses", RefusalKind::rival},
    {"only one of the robots met", RefusalKind::changed_place},
    {"scans differ", RefusalKind::other_tunnel},
    {"walls differ", RefusalKind::other_tunnel},
    {"walls stand off", RefusalKind::other_tunnel},
    {"no keyframe of", RefusalKind::no_loop},
    {"left no keyframe", RefusalKind::no_loop},
    {"could be registered", RefusalKind::no_loop},
    {"no loop was accepted", RefusalKind::no_loop},
    {"no along-axis constraint", RefusalKind::too_little},
    {"evidence", RefusalKind::too_little},
    {"are needed", RefusalKind::too_little},
    {"never compared", RefusalKind::too_little},
    {"agree with the odometries", RefusalKind::too_little},
    {"drive on along", RefusalKind::too_little},
}};

}  // namespace

std::string_view to_string(RefusalKind kind) {
  switch (kind) {
    case RefusalKind::no_loop:
      return "no loop";
    case RefusalKind::too_little:
      return "too little";
    case RefusalKind::other_tunnel:
      return "other tunnel";
    case RefusalKind::changed_place:
      return "changed place";
    case RefusalKind::rival:
      return "two hypotheses";
    case RefusalKind::taken_back:
      return "taken back";
    case RefusalKind::unknown:
      break;
  }
  return "unknown";
}

RefusalKind refusal_kind(std::string_view reason) {
  const auto found = std::ranges::find_if(
      kPhrases, [&](const auto& phrase) { return reason.find(phrase.first) != std::string_view::npos; });
  return found == kPhrases.end() ? RefusalKind::unknown : found->second;
}

}  // namespace adit
