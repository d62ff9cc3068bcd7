// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/progress_line.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/format.hpp"

namespace adit {
namespace {

constexpr std::size_t kBarWidth = 24;  ///< Columns.

std::string bar(const PhaseTree::Running& phase) {
  const std::size_t done = std::min(phase.done, phase.total);
  const std::size_t filled = kBarWidth * done / phase.total;
  return format(" [{}{}] {} %", std::string(filled, '#'), std::string(kBarWidth - filled, ' '),
                100 * done / phase.total);
}

/// "mapping 0:07" where the number of steps is unknown.
std::string innermost(const PhaseTree::Running& phase, PhaseTree::Seconds now) {
  if (phase.total == 0) return format("{}, {} so far", phase.name, rough_time((now - phase.begin).count()));
  const std::optional<double> left = seconds_left(phase, now);
  return phase.name + bar(phase) + (left ? format(", {} left", rough_time(*left)) : "");
}

}  // namespace

PhaseId PhaseTree::begin(std::string_view name, std::size_t total, PhaseId parent, Seconds now) {
  running_.push_back({++last_, parent, std::string(name), total, 0, now});
  return last_;
}

void PhaseTree::advance(PhaseId phase, std::size_t steps) {
  const auto found = std::ranges::find(running_, phase, &Running::id);
  if (found != running_.end()) found->done += steps;
}

void PhaseTree::end(PhaseId phase) {
  std::erase_if(running_, [&](const Running& running) { return running.id == phase; });
}

std::vector<PhaseTree::Running> PhaseTree::chain() const {
  std::vector<Running> chain;
  for (PhaseId around = 0;; around = chain.back().id) {
    const auto inside = [&](const Running& phase) { return phase.parent == around; };
    const auto first = std::ranges::find_if(running_, inside);
    if (first == running_.end()) return chain;
    const bool is_alone = std::find_if(first + 1, running_.end(), inside) == running_.end();
    if (!chain.empty() && !is_alone) return chain;
    chain.push_back(*first);
  }
}

std::optional<double> seconds_left(const PhaseTree::Running& phase, PhaseTree::Seconds now) {
  if (phase.done == 0 || phase.total == 0) return std::nullopt;
  const double rest = static_cast<double>(phase.total - std::min(phase.done, phase.total));
  return (now - phase.begin).count() * rest / static_cast<double>(phase.done);
}

std::string rough_time(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(std::max(seconds, 0.0)));
  if (whole < 60) return format("{} s", whole);
  if (whole < 3600) return format("{} min {:02} s", whole / 60, whole % 60);
  return format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string progress_line(const std::vector<PhaseTree::Running>& chain, PhaseTree::Seconds now,
                          std::size_t width) {
  if (chain.empty()) return "";
  std::string line;
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    line += chain[i].name;
    if (chain[i].total > 0) line += format(" {}/{}", chain[i].done, chain[i].total);
    line += ", ";
  }
  line += innermost(chain.back(), now);
  const std::optional<double> all = chain.size() > 1 ? seconds_left(chain.front(), now) : std::nullopt;
  if (all) line += format(" ({}: {} left)", chain.front().name, rough_time(*all));
  return line.substr(0, width);
}

}  // namespace adit
