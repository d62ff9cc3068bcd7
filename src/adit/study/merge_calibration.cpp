// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/evaluation/loop_stats.hpp"
#include "adit/evaluation/statistics.hpp"
#include "adit/report/palette.hpp"
#include "adit/report/rate_plot.hpp"
#include "adit/slam/meeting.hpp"

namespace adit {
namespace {

/// What a meeting came to, and where its robots truly were; none for robots that never met.
struct CheckedPair {
  const FleetGraph& known;
  const MergeCheck& check;
  std::string robots;
};
using TrueRuns = std::map<RobotId, const RobotRun*>;

/// What T_from_to of a loop is off by: metres and radians; infinite where the truth has no pose.
struct LoopError {
  double metres = std::numeric_limits<double>::infinity();
  double radians = std::numeric_limits<double>::infinity();
};

LoopError error_of(const LoopClosure& loop, const TrueRuns& runs) {
  const auto true_pose = [&](KeyframeId id) {
    const RobotRun& run = *runs.at(id.robot);
    return pose_at(run.truth, run.map->keyframes.at(id.index).stamp);
  };
  const Result<Pose> from = true_pose(loop.from);
  const Result<Pose> to = true_pose(loop.to);
  if (!from || !to) return {};
  const Pose error = loop.T_from_to.inverse() * (from->inverse() * *to);
  return {error.translation().norm(), error.angle()};
}

HypothesisTruth truth_of(const MergeHypothesis& hypothesis, const CheckedPair& pair, const TrueRuns& runs) {
  std::vector<double> metres;
  std::vector<double> radians;
  for (const auto& [a, b] : hypothesis.loops) {
    const auto loop = pair.known.loops.find({{pair.check.a, a}, {pair.check.b, b}});
    if (loop == pair.known.loops.end()) continue;
    const LoopError error = error_of(loop->second, runs);
    metres.push_back(error.metres);
    radians.push_back(error.radians);
  }
  if (metres.empty()) return HypothesisTruth::wrong;
  const double off = median(metres);
  const bool is_turned = median(radians) > LoopTolerance{}.rotation_deg * kDegree;
  if (is_turned || !(off <= LoopTolerance{}.place_m)) return HypothesisTruth::wrong;
  return off <= MergeCheckConfig{}.same_alignment_m ? HypothesisTruth::right : HypothesisTruth::near;
}

/// Of one check; without runs all hypotheses are wrong.
void judge_check(const CheckedPair& pair, const TrueRuns& runs, std::vector<JudgedHypothesis>& out) {
  for (const MergeHypothesis& hypothesis : pair.check.hypotheses)
    out.push_back({runs.empty() ? HypothesisTruth::wrong : truth_of(hypothesis, pair, runs),
                   hypothesis.outcome == HypothesisOutcome::refuted,
                   hypothesis.outcome == HypothesisOutcome::accepted && pair.check.accepted,
                   hypothesis.evidence, pair.check.needed, hypothesis.counts, hypothesis.walls, pair.robots});
}

std::vector<std::shared_ptr<const RobotMap>> maps_of(const std::vector<RobotRun>& runs,
                                                     const SlamConfig& config) {
  std::vector<const RobotRun*> all;
  for (const RobotRun& run : runs) all.push_back(&run);
  return selected_maps(all, config);
}

std::shared_ptr<const RobotMap> with_id(const RobotMap& map, RobotId id) {
  auto copy = std::make_shared<RobotMap>(map);
  copy->id = id;
  copy->name = format("robot_{}", id.value);
  for (Keyframe& keyframe : copy->keyframes) keyframe.id.robot = id;
  return copy;
}

std::string named(const ListedWorld& world, const RobotMap& map) { return world.name + "/" + map.name; }

Result<std::vector<RobotRun>> driven(const CalibrationStudy& study, const ListedWorld& world) {
  return driven_robots(world, study.config, {KeyframeSelection::adaptive}, study.folder / "maps");
}

/// Whether it would have been accepted at that evidence if nothing else decided.
bool reaches(const JudgedHypothesis& h, double evidence) { return !h.refuted && h.evidence >= evidence; }

std::size_t count_if(const std::vector<JudgedHypothesis>& all, HypothesisTruth truth, const auto& holds) {
  return static_cast<std::size_t>(
      std::ranges::count_if(all, [&](const JudgedHypothesis& h) { return h.truth == truth && holds(h); }));
}

std::string share_with_limit(std::size_t part, std::size_t total) {
  if (total == 0) return "-";
  return format("{} of {} ({:.2g}; < {:.2g})", part, total,
                static_cast<double>(part) / static_cast<double>(total), share_upper_limit(part, total));
}

std::string plain_share(std::size_t part, std::size_t total) {
  return total == 0 ? "-"
                    : format("{} of {} ({:.0f} %)", part, total,
                             100.0 * static_cast<double>(part) / static_cast<double>(total));
}

Table rates_table(const std::vector<JudgedHypothesis>& all, double needed) {
  Table table{
      "Stated and observed rate of wrong merges",
      "Of all false hypotheses those that reach an evidence, beside the rate that this evidence claims at "
      "most, exp(-evidence). In brackets the observed rate and its upper limit at a confidence of 95 %, as "
      "if "
      "hypotheses were independent. Accepted: joined maps, which rivals, too few loops and other tests may "
      "prevent beyond evidence. Hypotheses 3 to 10 m off are neither true nor false.",
      {},
      {"Evidence", "Claimed rate", "False that reach it", "True that reach it"},
      {}};
  const auto any = [](const JudgedHypothesis&) { return true; };
  const std::size_t num_false = count_if(all, HypothesisTruth::wrong, any);
  const std::size_t num_true = count_if(all, HypothesisTruth::right, any);
  for (const double evidence : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, needed, needed + 2.0, needed + 4.0}) {
    const auto does = [&](const JudgedHypothesis& h) { return reaches(h, evidence); };
    table.rows.push_back({format("{:.1f}{}", evidence, evidence == needed ? " (needed)" : ""),
                          format("{:.2g}", std::exp(-evidence)),
                          share_with_limit(count_if(all, HypothesisTruth::wrong, does), num_false),
                          plain_share(count_if(all, HypothesisTruth::right, does), num_true)});
  }
  const auto accepted = [](const JudgedHypothesis& h) { return h.accepted; };
  table.rows.push_back({"accepted", format("{:.2g}", std::exp(-needed)),
                        share_with_limit(count_if(all, HypothesisTruth::wrong, accepted), num_false),
                        plain_share(count_if(all, HypothesisTruth::right, accepted), num_true)});
  return table;
}

Table bins_table(const std::vector<JudgedHypothesis>& all, double needed) {
  Table table{"False hypotheses by evidence",
              "Of the hypotheses that were not refuted, by their evidence; and those that were.",
              {},
              {"Evidence", "True", "Near", "False", "Share of false"},
              {}};
  const double far = std::numeric_limits<double>::infinity();
  const std::vector<double> bounds = {-far, -2.0, 0.0, 2.0, 4.0, needed, needed + 3.0, needed + 10.0, far};
  const auto add = [&](const std::string& name, const auto& holds) {
    const std::size_t right = count_if(all, HypothesisTruth::right, holds);
    const std::size_t wrong = count_if(all, HypothesisTruth::wrong, holds);
    table.rows.push_back({name, format("{}", right),
                          format("{}", count_if(all, HypothesisTruth::near, holds)), format("{}", wrong),
                          share_with_limit(wrong, right + wrong)});
  };
  add("refuted", [](const JudgedHypothesis& h) { return h.refuted; });
  for (std::size_t i = 0; i + 1 < bounds.size(); ++i) {
    const double least = bounds[i];
    const double most = bounds[i + 1];
    const std::string name = i == 0                   ? format("below {:.1f}", most)
                             : i + 2 == bounds.size() ? format("{:.1f} and more", least)
                                                      : format("{:.1f} to {:.1f}", least, most);
    add(name, [&](const JudgedHypothesis& h) { return reaches(h, least) && h.evidence < most; });
  }
  return table;
}

/// The evidence that joins maps, the same for all hypotheses of a study.
double needed_by(const std::vector<JudgedHypothesis>& hypotheses) {
  return hypotheses.empty() ? -std::log(EvidenceModel{}.error_rate) : hypotheses.front().needed;
}

/// Both ends of each step that has a value above 0, which no logarithmic axis shows.
template <class Value>
std::vector<Eigen::Vector2d> staircase(const std::vector<CalibrationStep>& steps, const Value& value) {
  std::vector<Eigen::Vector2d> points;
  for (const CalibrationStep& step : steps) {
    const double height = value(step);
    if (!(height > 0.0)) continue;
    points.emplace_back(step.from, height);
    points.emplace_back(step.to, height);
  }
  return points;
}

}  // namespace

Result<std::vector<JudgedHypothesis>> hypotheses_within(const CalibrationStudy& study,
                                                        const ListedWorld& world) {
  const Result<std::vector<RobotRun>> runs = driven(study, world);
  if (!runs) return tl::unexpected(runs.error());
  const SlamConfig config = with_policy(KeyframeSelection::adaptive, study.config).slam;
  const Result<Meeting> meeting = hold_meeting(maps_of(*runs, config), config);
  if (!meeting) return tl::unexpected(meeting.error());
  TrueRuns truths;
  for (const RobotRun& run : *runs) truths.emplace(run.map->id, &run);
  std::vector<JudgedHypothesis> judged;
  const FleetGraph& known = meeting->agents.front().known();
  for (const auto& [robots, check] : known.checks)
    if (check.a != check.b)
      judge_check({known, check,
                   named(world, *truths.at(check.a)->map) + ", " + named(world, *truths.at(check.b)->map)},
                  truths, judged);
  return judged;
}

Result<std::vector<JudgedHypothesis>> hypotheses_between(const CalibrationStudy& study,
                                                         const ListedWorld& one, const ListedWorld& other) {
  const Result<std::vector<RobotRun>> ours = driven(study, one);
  if (!ours) return tl::unexpected(ours.error());
  const Result<std::vector<RobotRun>> theirs = driven(study, other);
  if (!theirs) return tl::unexpected(theirs.error());
  const SlamConfig config = with_policy(KeyframeSelection::adaptive, study.config).slam;
  std::vector<std::shared_ptr<const RobotMap>> maps = maps_of(*ours, config);
  for (const auto& map : maps_of(*theirs, config))
    maps.push_back(with_id(*map, {static_cast<std::uint8_t>(maps.size())}));
  const std::size_t num_ours = ours->size();
  const Phase phase(format("{} against {}", one.name, other.name),
                    maps.size() + num_ours * (maps.size() - num_ours));
  LoopbackBus bus(config.bus);
  std::vector<Agent> agents;
  agents.reserve(maps.size());  // the bus keeps addresses
  for (const auto& map : maps) {
    agents.emplace_back(map, config.agent());
    agents.back().find_revisits();
    bus.join(agents.back());
    phase.advance();
  }
  std::vector<JudgedHypothesis> judged;
  for (std::size_t a = 0; a < num_ours; ++a)
    for (std::size_t b = num_ours; b < maps.size(); ++b) {
      if (const Result<> met = bus.meet(maps[a]->id, maps[b]->id); !met) return tl::unexpected(met.error());
      const FleetGraph& known = agents[a].known();
      const auto check = known.checks.find({maps[a]->id, maps[b]->id});
      if (check != known.checks.end())
        judge_check({known, check->second,
                     named(one, *maps[a]) + ", " + format("{}/robot_{}", other.name, b - num_ours)},
                    {}, judged);
      phase.advance();
    }
  return judged;
}

std::vector<Table> calibration_tables(const std::vector<JudgedHypothesis>& hypotheses) {
  const double needed = needed_by(hypotheses);
  return {rates_table(hypotheses, needed), bins_table(hypotheses, needed)};
}

double CalibrationStep::share() const { return static_cast<double>(num_reached) / static_cast<double>(num); }

double CalibrationStep::upper_limit() const { return share_upper_limit(num_reached, num); }

std::vector<CalibrationStep> calibration_steps(const std::vector<JudgedHypothesis>& hypotheses,
                                               HypothesisTruth truth) {
  std::size_t num = 0;
  std::vector<double> reached;  // Evidence, ascending.
  for (const JudgedHypothesis& h : hypotheses) {
    if (h.truth != truth) continue;
    ++num;
    if (reaches(h, 0.0)) reached.push_back(h.evidence);
  }
  std::ranges::sort(reached);
  std::vector<CalibrationStep> steps;
  auto next = reached.begin();
  for (double from = 1.0; num > 0 && from > kLeastRate; from = steps.back().to) {
    const auto left = static_cast<std::size_t>(reached.end() - next);
    const double to = left == 0 ? kLeastRate : std::max(std::exp(-*next), kLeastRate);
    steps.push_back({from, to, left, num});
    if (left > 0) next = std::upper_bound(next, reached.end(), *next);
  }
  return steps;
}

std::string calibration_plot(const std::vector<JudgedHypothesis>& hypotheses) {
  const std::vector<CalibrationStep> wrong = calibration_steps(hypotheses, HypothesisTruth::wrong);
  const std::vector<CalibrationStep> right = calibration_steps(hypotheses, HypothesisTruth::right);
  const auto num_of = [](const auto& steps) { return steps.empty() ? std::size_t{0} : steps.front().num; };
  const auto share = [](const CalibrationStep& step) { return step.share(); };
  const auto limit = [](const CalibrationStep& step) { return step.upper_limit(); };
  RateFigure figure;
  figure.title = "Wrong acceptance, claimed and observed";
  figure.note = format("{} false and {} true hypotheses; limits treat hypotheses as independent",
                       num_of(wrong), num_of(right));
  figure.curves = {{"true, observed", staircase(right, share), method_color(1)},
                   {"false, upper limit (95 %)", staircase(wrong, limit), method_color(0), Dash::dashes},
                   {"false, observed", staircase(wrong, share), method_color(0)}};
  figure.rate_in_use = std::exp(-needed_by(hypotheses));
  if (wrong.empty()) figure.absent = "no false hypotheses";
  return plot_rates(figure);
}

}  // namespace adit
