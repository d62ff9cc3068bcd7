// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/transport/wire_merge_checks.hpp"

#include <cmath>

namespace adit::wire {

void put(Writer& out, const std::pair<std::uint32_t, std::uint32_t>& ends) {
  out.scalar(ends.first);
  out.scalar(ends.second);
}
void get(Reader& in, std::pair<std::uint32_t, std::uint32_t>& ends) {
  ends.first = in.scalar<std::uint32_t>();
  ends.second = in.scalar<std::uint32_t>();
}

void put(Writer& out, const TestedPlace& place) {
  out.scalar(place.a);
  out.scalar(place.b);
  out.scalar(place.outcome);
}
void get(Reader& in, TestedPlace& place) {
  place.a = in.scalar<std::uint32_t>();
  place.b = in.scalar<std::uint32_t>();
  place.outcome = in.scalar<PlaceOutcome>();
  if (place.outcome > PlaceOutcome::distinctive) in.refuse();
}

void put(Writer& out, const HypothesisCounts& counts) {
  for (const std::uint32_t value :
       {counts.num_distinctive, counts.num_changes, counts.num_things, counts.num_wall_patches})
    out.scalar(value);
  for (const double value : {counts.compared_m, counts.equal_signs, counts.equal_signs_sigma})
    out.scalar(value);
}
void get(Reader& in, HypothesisCounts& counts) {
  constexpr std::uint8_t kLastWithMore = 12;
  constexpr int kMore = 3;  // of places that were looked for again
  for (std::uint32_t* value :
       {&counts.num_distinctive, &counts.num_changes, &counts.num_things, &counts.num_wall_patches})
    *value = in.scalar<std::uint32_t>();
  for (int i = 0; in.version() <= kLastWithMore && i < kMore; ++i) in.scalar<std::uint32_t>();
  for (double* value : {&counts.compared_m, &counts.equal_signs, &counts.equal_signs_sigma}) {
    *value = in.scalar<double>();
    if (!std::isfinite(*value)) in.refuse();
  }
}

void put(Writer& out, const MergeHypothesis& hypothesis) {
  out.scalar(hypothesis.outcome);
  out.scalar(hypothesis.evidence);
  out.scalar(hypothesis.num_checked);
  out.scalar(hypothesis.num_passed);
  out.scalar(hypothesis.from_best_m);
  out.vector(hypothesis.loops);
  out.vector(hypothesis.places);
  out.scalar(hypothesis.walls);
  put(out, hypothesis.counts);
}
void get(Reader& in, MergeHypothesis& hypothesis) {
  hypothesis.outcome = in.scalar<HypothesisOutcome>();
  hypothesis.evidence = in.scalar<double>();
  hypothesis.num_checked = in.scalar<std::uint32_t>();
  hypothesis.num_passed = in.scalar<std::uint32_t>();
  hypothesis.from_best_m = in.scalar<double>();
  in.vector(hypothesis.loops);
  in.vector(hypothesis.places);
  hypothesis.walls = in.scalar<double>();
  get(in, hypothesis.counts);
  if (hypothesis.outcome > HypothesisOutcome::vetoed || !std::isfinite(hypothesis.evidence) ||
      !std::isfinite(hypothesis.walls) || !std::isfinite(hypothesis.from_best_m) ||
      hypothesis.num_passed > hypothesis.num_checked)
    in.refuse();
}

void put(Writer& out, const MergeAdvice& advice) {
  for (const double value : {advice.from_m, advice.to_m, advice.from.x(), advice.from.y(), advice.from.z(),
                             advice.gain, advice.missing})
    out.scalar(value);
}
void get(Reader& in, MergeAdvice& advice) {
  for (double* value : {&advice.from_m, &advice.to_m, &advice.from.x(), &advice.from.y(), &advice.from.z(),
                        &advice.gain, &advice.missing}) {
    *value = in.scalar<double>();
    if (!std::isfinite(*value)) in.refuse();
  }
}

void put(Writer& out, const MergeCheck& check) {
  out.scalar(check.a.value);
  out.scalar(check.b.value);
  out.scalar(check.evidence);
  out.scalar(check.needed);
  out.scalar(check.num_checked);
  out.scalar(check.num_passed);
  out.scalar(static_cast<std::uint8_t>(check.accepted ? 1 : 0));
  out.vector(check.loops);
  put(out, check.reason);
  out.vector(check.hypotheses);
  out.scalar(check.refused_kind);
  out.scalar(static_cast<std::uint8_t>(check.advice ? 1 : 0));
  if (check.advice) put(out, *check.advice);
  put_share(out, check.unconfirmed.a);
  put_share(out, check.unconfirmed.b);
}
void get(Reader& in, MergeCheck& check) {
  check.a.value = in.scalar<std::uint8_t>();
  check.b.value = in.scalar<std::uint8_t>();
  check.evidence = in.scalar<double>();
  check.needed = in.scalar<double>();
  check.num_checked = in.scalar<std::uint32_t>();
  check.num_passed = in.scalar<std::uint32_t>();
  check.accepted = in.scalar<std::uint8_t>() != 0;
  in.vector(check.loops);
  get(in, check.reason);
  in.vector(check.hypotheses, kHypothesesPerCheck);
  check.refused_kind = in.scalar<RefusalKind>();
  if (check.refused_kind > RefusalKind::vetoed) in.refuse();
  if (in.scalar<std::uint8_t>() != 0) get(in, check.advice.emplace());
  get_share(in, check.unconfirmed.a);
  get_share(in, check.unconfirmed.b);
  if (!std::isfinite(check.evidence) || !std::isfinite(check.needed) || check.num_passed > check.num_checked)
    in.refuse();
}

void put(Writer& out, const MergeChecks& checks) {
  out.scalar(checks.author.value);
  out.scalar(checks.first);
  out.vector(checks.checks);
}
void get(Reader& in, MergeChecks& checks) {
  checks.author.value = in.scalar<std::uint8_t>();
  checks.first = in.scalar<std::uint32_t>();
  in.vector(checks.checks, kChecksPerMessage);
}

}  // namespace adit::wire
