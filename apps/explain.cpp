// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/core/json_text.hpp"
#include "adit/fleet/joint/merge_accuracy.hpp"
#include "adit/fleet/merge/scan_quality.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/session_toml.hpp"
#include "adit/report/text_tables.hpp"
#include "command_line.hpp"

namespace adit::app {
namespace {

struct ExplainOptions {
  std::string session;
  std::vector<std::string> robots;
};

bool is_asked_for(const SavedMerge& merge, const std::vector<std::string>& robots) {
  return std::ranges::all_of(robots,
                             [&](const std::string& robot) { return merge.a == robot || merge.b == robot; });
}

std::string title_of(const SavedMerge& merge) {
  if (merge.a == merge.b)
    return format("{}, places that it came back to: {}", merge.a,
                  merge.check.accepted ? "loops in use" : "no loops in use");
  const std::string robots = format("{} and {}", merge.a, merge.b);
  if (merge.merged) return robots + ": merged" + (merge.accuracy ? ", " + to_string(*merge.accuracy) : "");
  const std::string kind = merge.check.accepted || merge.check.refused_kind == RefusalKind::unknown
                               ? ""
                               : format(" ({})", to_string(merge.check.refused_kind));
  return robots + ": not merged" + kind + (merge.share_a_map ? ", but share a map through other robots" : "");
}

/// Why the pair ended as it did: that of the test, and of what came after it.
std::string why(const SavedMerge& merge) {
  if (merge.check.reason.empty()) return merge.refusal.empty() ? "was not tested" : merge.refusal;
  const bool came_after = !merge.refusal.empty() && merge.refusal != merge.check.reason;
  return merge.check.reason + (came_after ? "; and then: " + merge.refusal : "");
}

Table hypotheses_of(const SavedMerge& merge) {
  Table table{
      .title = {},
      .caption = format("One line for each alignment that loops put forward and that was tested (at "
                        "most {}), the best first. A merge needs an evidence of {:.1f}, and every "
                        "other alignment has to stay well behind. Evidence is the logarithm of "
                        "a likelihood ratio: of loops and places, where only distinctive places that "
                        "agree speak for it and changes against it, and of the relief of walls "
                        "(equal signs: the share of patches on which two pairs of scans find the wall "
                        "displaced to the same side; half for one wall). Movable objects (vehicles, pallets) "
                        "come and go and say nothing. Few loops speak against an alignment.",
                        kHypothesesPerCheck, merge.check.needed),
      .groups = {},
      .header = {"alignment", "loops", "evidence", "of walls", "compared m", "places", "agree", "distinctive",
                 "changes", "movable objects", "patches", "equal signs", "m apart"},
      .rows = {}};
  for (const MergeHypothesis& h : merge.check.hypotheses) {
    const bool is_weighed = h.outcome != HypothesisOutcome::refuted;
    const bool has_walls = h.counts.num_wall_patches > 0;
    table.rows.push_back({std::string(to_string(h.outcome)), format("{}", h.loops.size()),
                          is_weighed ? format("{:.1f}", h.evidence) : "-",
                          is_weighed ? format("{:.1f}", h.walls) : "-", format("{:.0f}", h.counts.compared_m),
                          format("{}", h.num_checked), format("{}", h.num_passed),
                          format("{}", h.counts.num_distinctive), format("{}", h.counts.num_changes),
                          format("{}", h.counts.num_things), format("{}", h.counts.num_wall_patches),
                          has_walls ? format("{:.0f} %", 100.0 * h.counts.equal_signs) : "-",
                          format("{:.1f}", h.from_best_m)});
  }
  return table;
}

void print_text(const SavedMerge& merge) {
  std::printf("%s\n  %s\n", title_of(merge).c_str(), why(merge).c_str());
  const std::string quality =
      merge.a == merge.b ? "" : what_was_unconfirmed(merge.check.unconfirmed, merge.a, merge.b);
  if (!quality.empty()) std::printf("  %s\n", quality.c_str());
  if (!merge.check.hypotheses.empty()) std::printf("%s", text_of(hypotheses_of(merge)).c_str());
  std::printf("\n");
}

nlohmann::ordered_json unconfirmed_json(const std::optional<double>& share) {
  return share ? nlohmann::ordered_json(*share) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json json_of(const SavedMerge& merge) {
  nlohmann::ordered_json hypotheses = nlohmann::ordered_json::array();
  for (const MergeHypothesis& h : merge.check.hypotheses)
    hypotheses.push_back({{"outcome", to_string(h.outcome)},
                          {"loops", h.loops.size()},
                          {"evidence", h.evidence},
                          {"evidence_of_walls", h.walls},
                          {"compared_m", h.counts.compared_m},
                          {"places_compared", h.num_checked},
                          {"places_agreeing", h.num_passed},
                          {"places_distinctive", h.counts.num_distinctive},
                          {"changes", h.counts.num_changes},
                          {"things", h.counts.num_things},
                          {"wall_patches", h.counts.num_wall_patches},
                          {"equal_signs", h.counts.equal_signs},
                          {"from_best_m", h.from_best_m}});
  nlohmann::ordered_json out = {
      {"robots", {merge.a, merge.b}},     {"merged", merge.merged}, {"share_a_map", merge.share_a_map},
      {"accepted", merge.check.accepted}, {"why", why(merge)},      {"evidence_needed", merge.check.needed},
      {"hypotheses", hypotheses}};
  out["unconfirmed"] = {unconfirmed_json(merge.check.unconfirmed.a),
                        unconfirmed_json(merge.check.unconfirmed.b)};
  if (!merge.merged && !merge.check.accepted && merge.a != merge.b)
    out["refused_kind"] = to_string(merge.check.refused_kind);
  if (const auto& advice = merge.check.advice)
    out["where_to_drive"] = {{"robot", merge.b},
                             {"along", merge.a},
                             {"from_m", advice->from_m},
                             {"to_m", advice->to_m},
                             {"from", {advice->from.x(), advice->from.y(), advice->from.z()}},
                             {"gain", advice->gain},
                             {"missing", advice->missing}};
  return out;
}

Result<std::vector<SavedMerge>> read_merges(const std::filesystem::path& session) {
  const std::filesystem::path file = session / "session.toml";
  const Result<std::string> text = read_bytes(file);
  if (!text) return fail(session.string() + ": not a session directory", text.error());
  Result<std::vector<SavedMerge>> merges = parse_session_merges(*text);
  if (!merges) return fail(file.string(), merges.error());
  return merges;
}

Result<> explain(const ExplainOptions& options, const Common& common) {
  if (options.robots.size() > 2) usage_error("a merge is of two robots; name at most two");
  Result<std::vector<SavedMerge>> merges = read_merges(options.session);
  if (!merges) return tl::unexpected(merges.error());
  for (const std::string& robot : options.robots) {
    const auto has_it = [&](const SavedMerge& merge) { return is_asked_for(merge, {robot}); };
    if (std::ranges::none_of(*merges, has_it))
      return fail(format("{}: no merge with a robot '{}' in it; `adit info {}` lists the robots",
                         options.session, robot, options.session));
  }
  std::erase_if(*merges, [&](const SavedMerge& merge) { return !is_asked_for(merge, options.robots); });
  if (merges->empty() && !common.json)
    std::printf("one robot, and no place that it came back to was tested\n");
  if (common.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const SavedMerge& merge : *merges) all.push_back(json_of(merge));
    std::printf("%s\n", json_text(all).c_str());
  } else {
    for (const SavedMerge& merge : *merges) print_text(merge);
  }
  return {};
}

}  // namespace

void add_explain(Program& program) {
  const auto options = std::make_shared<ExplainOptions>();
  const Command command = program.add_command(
      "explain",
      "Say why robots of a session were or were not merged, by what evidence, and where to drive to decide",
      [options](const Common& common) { return explain(*options, common); });
  command.add_option("session", options->session, "Session directory of adit slam").required();
  command.add_option("robots", options->robots, "Only merges of this robot, or of these two");
}

}  // namespace adit::app
