// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/advised_verdict.hpp"

#include <cstdint>
#include <optional>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/fleet/merge/merge_advice.hpp"

namespace adit {
namespace {

std::optional<MergeAdvice> advice_for(const std::optional<UndecidedStretch>& undecided, double needed,
                                      RobotPair robots, const Advisor& advisor) {
  const OdometryChain own = chain_of(advisor.known.robots.at(robots.first));
  std::optional<MergeAdvice> advice;
  if (undecided)
    advice = where_to_drive(*undecided, own, chain_of(advisor.known.robots.at(robots.second)),
                            advisor.spacing_m, what_own_map_knows(advisor.discernment));
  // Elsewhere more places bring evidence, and neither metres without a change nor a lead before a rival.
  if (!advice && (!undecided || undecided->lacks_evidence_alone()))
    advice = where_to_be_recognised(own, undecided ? undecided->shared : std::vector<std::uint32_t>(),
                                    undecided ? undecided->missing : needed, advisor.spacing_m,
                                    landmarks_of(advisor.search.self_distances(), advisor.discernment));
  return advice;
}

}  // namespace

MergeCheck advised_verdict(const MergeChecker& checker, RobotPair robots, const Advisor& advisor) {
  MergeCheck verdict = checker.verdict(robots.first, robots.second);
  const std::optional<UndecidedStretch> undecided = checker.undecided();
  const bool is_nothing_shared =
      verdict.refused_kind == RefusalKind::no_loop || verdict.refused_kind == RefusalKind::other_tunnel;
  if (!undecided && !is_nothing_shared) return verdict;
  const std::optional<MergeAdvice> advice = advice_for(undecided, verdict.needed, robots, advisor);
  const std::string& own_name = advisor.known.robots.at(robots.first).name;
  if (!advice) {
    verdict.reason += format(", but no place was found on the path of {} that would tell", own_name);
    return verdict;
  }
  const std::string& peer_name = advisor.known.robots.at(robots.second).name;
  verdict = checker.verdict(robots.first, robots.second, in_words(*advice, own_name, peer_name));
  verdict.advice = advice;
  return verdict;
}

}  // namespace adit
