// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// The results of studies on disk.
#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "adit/core/format.hpp"
#include "adit/core/refusal_kind.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/csv.hpp"
#include "adit/study/incremental_study.hpp"
#include "adit/study/loop_study.hpp"
#include "adit/study/merge_calibration.hpp"
#include "adit/study/merge_run.hpp"
#include "adit/study/uncertainty_study.hpp"

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMergeRunsVersion = 4;    // of results.json
constexpr int kCalibrationVersion = 1;  // of calibration.json

/// As calibration.json spells them, in the order of the values.
constexpr std::array<std::string_view, 3> kHypothesisTruths{"right", "near", "wrong"};

Json json_of(const MergePair& pair) {
  return {{"robots", pair.robots},
          {"shared_m", pair.shared_m},
          {"distinctive_m", pair.distinctive_m},
          {"outcome", to_string(pair.outcome)},
          {"refused_kind", to_string(pair.refused_kind)},
          {"refused_reason", pair.refused_reason},
          {"registrations", pair.registrations},
          {"loops_in_use", pair.loops_in_use},
          {"wrong_loops_in_use", pair.wrong_loops_in_use},
          {"ate_max_m", pair.ate_max_m},
          {"ate_max_over_path_pct", pair.ate_max_over_path_pct}};
}

Json json_of(const MergeJoint& joint) {
  return {{"maps", joint.maps},           {"possible_maps", joint.possible_maps},
          {"wrong", joint.wrong},         {"wrong_loops_in_use", joint.wrong_loops_in_use},
          {"ate_max_m", joint.ate_max_m}, {"ate_max_over_path_pct", joint.ate_max_over_path_pct}};
}

Json json_of(const MergeRun& run) {
  Json pairs = Json::array();
  for (const MergePair& pair : run.pairs) pairs.push_back(json_of(pair));
  return {{"world", run.world},           {"group", run.group},
          {"keyframes", run.keyframes},   {"sensors", run.sensors},
          {"conditions", run.conditions}, {"registrations", run.registrations},
          {"time_s", run.time_s},         {"pairs", pairs},
          {"joint", json_of(run.joint)}};
}

Json json_of(const std::optional<LoopDecision>& decision, const std::string& reason) {
  if (!decision) return {{"reason", reason}};
  return {{"true_kept", decision->score.true_kept},
          {"true_lost", decision->score.true_lost},
          {"false_kept", decision->score.false_kept},
          {"false_rejected", decision->score.false_rejected},
          {"refused", decision->refused},
          {"parts", decision->parts},
          {"possible_parts", decision->possible_parts},
          {"off_m", decision->off_m},
          {"time_s", decision->time_s},
          {"optimal", decision->is_optimal}};
}

Json json_of(const FalseLoopRun& run) {
  Json json = {{"graph", run.graph},     {"injection", run.injection}, {"share_pct", run.share_pct},
               {"nodes", run.num_nodes}, {"true_loops", run.num_true}, {"false_loops", run.num_false}};
  for (std::size_t m = 0; m < kLoopMethods.size(); ++m)
    json[std::string(to_string(kLoopMethods[m]))] = json_of(run.decisions[m], run.reasons[m]);
  return json;
}

Json json_of(const OverSteps& figure) {
  return {{"mean", figure.mean}, {"worst", figure.worst}, {"last", figure.last}};
}

Json json_of(const IncrementalRun& run) {
  return {{"graph", run.graph},
          {"share_pct", run.share_pct},
          {"seed", run.seed},
          {"nodes", run.num_nodes},
          {"true_loops", run.num_true},
          {"false_loops", run.num_false},
          {"precision", json_of(run.precision)},
          {"recall", json_of(run.recall)},
          {"ate_m", json_of(run.ate_m)},
          {"most_false_in_use", run.most_false_in_use},
          {"median_ms", run.median_ms},
          {"p99_ms", run.p99_ms},
          {"max_ms", run.max_ms}};
}

template <class T>
void get(const Json& json, const char* key, T& value) {
  value = json.at(key).get<T>();
}

MergePair pair_of(const Json& json) {
  MergePair pair;
  get(json, "robots", pair.robots);
  get(json, "shared_m", pair.shared_m);
  get(json, "distinctive_m", pair.distinctive_m);
  pair.outcome = merge_outcome(json.at("outcome").get<std::string>());
  pair.refused_kind = refusal_kind(json.at("refused_kind").get<std::string>());
  get(json, "refused_reason", pair.refused_reason);
  get(json, "registrations", pair.registrations);
  get(json, "loops_in_use", pair.loops_in_use);
  get(json, "wrong_loops_in_use", pair.wrong_loops_in_use);
  get(json, "ate_max_m", pair.ate_max_m);
  get(json, "ate_max_over_path_pct", pair.ate_max_over_path_pct);
  return pair;
}

MergeJoint joint_of(const Json& json) {
  MergeJoint joint;
  get(json, "maps", joint.maps);
  get(json, "possible_maps", joint.possible_maps);
  get(json, "wrong", joint.wrong);
  get(json, "wrong_loops_in_use", joint.wrong_loops_in_use);
  get(json, "ate_max_m", joint.ate_max_m);
  get(json, "ate_max_over_path_pct", joint.ate_max_over_path_pct);
  return joint;
}

MergeRun run_of(const Json& json) {
  MergeRun run;
  get(json, "world", run.world);
  get(json, "group", run.group);
  get(json, "keyframes", run.keyframes);
  get(json, "sensors", run.sensors);
  get(json, "conditions", run.conditions);
  get(json, "registrations", run.registrations);
  get(json, "time_s", run.time_s);
  for (const Json& pair : json.at("pairs")) run.pairs.push_back(pair_of(pair));
  run.joint = joint_of(json.at("joint"));
  return run;
}

/// What calibration.json has of a hypothesis beside its robots and the truth: `field(key, member)` for each.
/// Described once, so that reading and writing cannot differ; when it reads, `Judged` is mutable.
template <class Judged, class Field>
void for_judged_fields(Judged& h, const Field& field) {
  field("refuted", h.refuted);
  field("accepted", h.accepted);
  field("evidence", h.evidence);
  field("of_walls", h.walls);
  field("needed", h.needed);
  field("compared_m", h.counts.compared_m);
  field("distinctive", h.counts.num_distinctive);
  field("changes", h.counts.num_changes);
  field("things", h.counts.num_things);
  field("wall_patches", h.counts.num_wall_patches);
  field("equal_signs", h.counts.equal_signs);
  field("equal_signs_sigma", h.counts.equal_signs_sigma);
}

Json json_of(const JudgedHypothesis& h) {
  Json json = {{"robots", h.robots}, {"truth", kHypothesisTruths[static_cast<std::size_t>(h.truth)]}};
  for_judged_fields(h, [&](const char* key, const auto& value) { json[key] = value; });
  return json;
}

/// Throws on an unknown one.
HypothesisTruth hypothesis_truth(const std::string& name) {
  const auto found = std::ranges::find(kHypothesisTruths, name);
  if (found == kHypothesisTruths.end())
    throw std::runtime_error(format("truth is '{}', not right, near or wrong", name));
  return static_cast<HypothesisTruth>(found - kHypothesisTruths.begin());
}

JudgedHypothesis judged_of(const Json& json) {
  JudgedHypothesis h;
  get(json, "robots", h.robots);
  h.truth = hypothesis_truth(json.at("truth").get<std::string>());
  for_judged_fields(h, [&](const char* key, auto& value) { get(json, key, value); });
  return h;
}

Result<std::vector<JudgedHypothesis>> judged_hypotheses(const Json& list) {
  std::vector<JudgedHypothesis> all;
  for (const Json& hypothesis : list) {
    try {
      all.push_back(judged_of(hypothesis));
    } catch (const std::exception& error) {
      return fail(format("hypothesis {}: {}", all.size(), error.what()));
    }
  }
  return all;
}

/// The same whichever robot comes first: that only says which one searched.
std::string in_order_of_names(const std::string& robots) {
  constexpr std::string_view kBetween = ", ";
  const std::size_t end = robots.find(kBetween);
  if (end == std::string::npos) return robots;
  const auto [first, second] = std::minmax({robots.substr(0, end), robots.substr(end + kBetween.size())});
  return format("{}{}{}", first, kBetween, second);
}

Json json_of(const UncertaintyRow& row) {
  const Calibration& c = row.calibration;
  Json json = {{"source", row.source}, {"count", c.count()}, {"without_covariance", c.num_unusable()}};
  if (c.count() == 0) return json;
  json["nees_over_dof"] = c.mean();
  json["share_beyond_99_9"] = share_beyond_one_in_a_thousand(c);
  if (!c.has_axes()) return json;
  const Vector6 axes = c.mean_of_axes();
  const Vector6 rms = c.rms();
  json["nees_by_axis"] = std::vector<double>(axes.begin(), axes.end());
  json["rms"] = std::vector<double>(rms.begin(), rms.end());
  return json;
}

}  // namespace

Result<std::vector<MergeRun>> read_merge_runs(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::vector<MergeRun>{};
  const Result<std::string> bytes = read_bytes(file);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto refused = fail(file.string() + ": not results of this version; remove the file");
  try {
    const Json content = Json::parse(*bytes);
    if (content.at("version") != kMergeRunsVersion) return refused;
    std::vector<MergeRun> runs;
    for (const Json& run : content.at("runs")) runs.push_back(run_of(run));
    return runs;
  } catch (const std::exception&) {
    return refused;
  }
}

Result<> write_merge_runs(const std::filesystem::path& file, const std::vector<MergeRun>& runs) {
  Json all = Json::array();
  for (const MergeRun& run : runs) all.push_back(json_of(run));
  return write_bytes(file, Json{{"version", kMergeRunsVersion}, {"runs", all}}.dump(1) + "\n");
}

Result<> write_merge_csv(const std::filesystem::path& file, const std::vector<MergeRun>& runs) {
  std::string text = csv_row({"world", "group", "keyframes", "sensors", "conditions", "robot_a", "robot_b",
                              "shared_m", "distinctive_m", "outcome", "registrations", "loops_in_use",
                              "wrong_loops_in_use", "ate_max_a_m", "ate_max_b_m", "ate_max_a_pct",
                              "ate_max_b_pct", "refused_kind", "refused_reason"});
  const auto number = [](auto value) { return format("{}", value); };
  const auto thousandths = [](double value) { return format("{:.3f}", value); };
  for (const MergeRun& run : runs)
    for (const MergePair& pair : run.pairs)
      text += csv_row({run.world, run.group, run.keyframes, run.sensors, run.conditions, pair.robots[0],
                       pair.robots[1], format("{:.1f}", pair.shared_m), format("{:.1f}", pair.distinctive_m),
                       std::string(to_string(pair.outcome)), number(pair.registrations),
                       number(pair.loops_in_use), number(pair.wrong_loops_in_use),
                       thousandths(pair.ate_max_m[0]), thousandths(pair.ate_max_m[1]),
                       thousandths(pair.ate_max_over_path_pct[0]), thousandths(pair.ate_max_over_path_pct[1]),
                       pair.outcome == MergeOutcome::refused ? std::string(to_string(pair.refused_kind)) : "",
                       pair.refused_reason});
  return write_bytes(file, text);
}

std::string json_of(const std::vector<FalseLoopRun>& runs) {
  Json all = Json::array();
  for (const FalseLoopRun& run : runs) all.push_back(json_of(run));
  return Json{{"version", 1}, {"runs", all}}.dump(1) + "\n";
}

std::string uncertainty_json(const std::vector<MeasuredUncertainty>& measured) {
  Json json = Json::array();
  for (const MeasuredUncertainty& of : measured) {
    Json sources = Json::array();
    for (const UncertaintyRow& row : of.rows) sources.push_back(json_of(row));
    json.push_back({{"sensors", of.sensors}, {"sources", sources}});
  }
  return json.dump(2) + "\n";
}

std::string json_of(const std::vector<IncrementalRun>& runs) {
  Json all = Json::array();
  for (const IncrementalRun& run : runs) all.push_back(json_of(run));
  return all.dump(2) + "\n";
}

std::string calibration_json(const std::vector<JudgedHypothesis>& hypotheses) {
  Json all = Json::array();
  for (const JudgedHypothesis& h : hypotheses) all.push_back(json_of(h));
  return Json{{"version", kCalibrationVersion}, {"hypotheses", all}}.dump(1) + "\n";
}

Result<std::vector<JudgedHypothesis>> read_calibration(const std::filesystem::path& file) {
  const Result<std::string> bytes = read_bytes(file);
  if (!bytes) return tl::unexpected(bytes.error());
  try {
    const Json content = Json::parse(*bytes);
    if (content.at("version") != kCalibrationVersion)
      return fail(file.string() +
                  ": no hypotheses of this version; give calibration.json of merge-calibration");
    Result<std::vector<JudgedHypothesis>> all = judged_hypotheses(content.at("hypotheses"));
    if (!all) return fail(file.string(), all.error());
    return all;
  } catch (const std::exception& error) {
    return fail(format("{}: no calibration.json of merge-calibration, or a damaged one: {}", file.string(),
                       error.what()));
  }
}

Result<std::vector<JudgedHypothesis>> joined_calibrations(const std::vector<std::string>& files) {
  std::vector<JudgedHypothesis> all;
  std::map<std::string, std::string> file_of;  // by the robots, in the order of their names
  for (const std::string& file : files) {
    const Result<std::vector<JudgedHypothesis>> more = read_calibration(file);
    if (!more) return tl::unexpected(more.error());
    for (const JudgedHypothesis& h : *more)
      if (const auto known = file_of.find(in_order_of_names(h.robots)); known != file_of.end())
        return fail(format("{}: {} has hypotheses about {}, too, and they would count twice; leave one out",
                           file, known->second, h.robots));
    if (!all.empty() && !more->empty() && more->front().needed != all.front().needed)
      return fail(format(
          "{}: {:.2f} of evidence was needed, {:.2f} in {}; join runs of one version and configuration", file,
          more->front().needed, all.front().needed, file_of.at(in_order_of_names(all.front().robots))));
    for (const JudgedHypothesis& h : *more) file_of.emplace(in_order_of_names(h.robots), file);
    all.insert(all.end(), more->begin(), more->end());
  }
  return all;
}

}  // namespace adit
