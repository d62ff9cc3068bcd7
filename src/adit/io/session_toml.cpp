// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/session_toml.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <tuple>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/version.hpp"
#include "adit/io/mount.hpp"
#include "adit/io/toml_depth.hpp"

namespace adit {
namespace {

std::string name_of(const FleetGraph& fleet, RobotId id) { return fleet.robots.at(id).name; }

double rounded(double value) { return std::round(100.0 * value) / 100.0; }

/// Nothing where no scan was judged.
void insert_share(toml::table& table, const char* key, const std::optional<double>& share) {
  if (share) table.insert(key, std::round(1000.0 * *share) / 1000.0);
}

/// In the odometry frame of the first robot, along its path.
toml::table advice_table(const MergeAdvice& advice) {
  return toml::table{
      {"from_m", rounded(advice.from_m)},
      {"to_m", rounded(advice.to_m)},
      {"from", toml::array{rounded(advice.from.x()), rounded(advice.from.y()), rounded(advice.from.z())}},
      {"gain", rounded(advice.gain)},
      {"missing", rounded(advice.missing)}};
}

/// A merge that was tested, joined or not, with the hypotheses about it, the best one first.
toml::table merge_table(const FleetGraph& fleet, const MergeCheck& check) {
  toml::array hypotheses;
  for (const MergeHypothesis& h : check.hypotheses) {
    toml::array loops;
    for (const auto& [a, b] : h.loops)
      loops.push_back(toml::array{static_cast<std::int64_t>(a), static_cast<std::int64_t>(b)});
    hypotheses.push_back(
        toml::table{{"outcome", std::string(to_string(h.outcome))},
                    {"evidence", rounded(h.evidence)},
                    {"places_compared", static_cast<std::int64_t>(h.num_checked)},
                    {"places_differing", static_cast<std::int64_t>(h.num_differing())},
                    {"from_best_m", rounded(h.from_best_m)},
                    {"compared_m", rounded(h.counts.compared_m)},
                    {"places_distinctive", static_cast<std::int64_t>(h.counts.num_distinctive)},
                    {"changes", static_cast<std::int64_t>(h.counts.num_changes)},
                    {"things", static_cast<std::int64_t>(h.counts.num_things)},
                    {"wall_patches", static_cast<std::int64_t>(h.counts.num_wall_patches)},
                    {"equal_signs", rounded(h.counts.equal_signs)},
                    {"evidence_of_walls", rounded(h.walls)},
                    {"loops", loops}});
  }
  toml::table out{{"robots", toml::array{name_of(fleet, check.a), name_of(fleet, check.b)}},
                  {"accepted", check.accepted},
                  {"evidence_needed", rounded(check.needed)},
                  {"reason", check.reason},
                  {"hypotheses", hypotheses}};
  if (!check.accepted) out.insert("refused_kind", std::string(to_string(check.refused_kind)));
  if (check.advice) out.insert("where_to_drive", advice_table(*check.advice));
  insert_share(out, "unconfirmed_a", check.unconfirmed.a);
  insert_share(out, "unconfirmed_b", check.unconfirmed.b);
  return out;
}

toml::array array_of(const std::vector<std::string>& texts) {
  toml::array array;
  for (const std::string& text : texts) array.push_back(text);
  return array;
}

std::vector<std::string> strings_of(const toml::node* node) {
  std::vector<std::string> out;
  const toml::array* array = node == nullptr ? nullptr : node->as_array();
  if (array == nullptr) return out;
  for (const toml::node& item : *array) out.push_back(item.value_or(std::string()));
  return out;
}

/// How each robot was mapped, and how much of its scans nothing confirmed.
toml::array mapping_of(const Session& session) {
  toml::array mapping;
  for (const RobotProvenance& robot : session.provenance.robots) {
    toml::table entry{{"name", robot.name}};
    if (!robot.failure.empty()) {
      entry.insert("failed", robot.failure);
    } else {
      entry.insert("odometry", robot.odometry);
      entry.insert("lidar", robot.lidar);
      entry.insert("scans", static_cast<std::int64_t>(robot.scans));
      if (robot.T_base_lidar) entry.insert("mount", mount_text(*robot.T_base_lidar));
    }
    for (const auto& map : session.maps)
      if (robot.is_of_map(map->name)) insert_share(entry, "unconfirmed", mean_of_judged(map->unconfirmed));
    mapping.push_back(std::move(entry));
  }
  return mapping;
}

void insert_provenance(const Session& session, toml::table& table) {
  const Provenance& provenance = session.provenance;
  table.insert("command", provenance.command);
  if (!provenance.earlier_commands.empty())
    table.insert("earlier_commands", array_of(provenance.earlier_commands));
  table.insert("inputs", array_of(provenance.inputs));
  table.insert("world", provenance.world);
  table.insert("profile", provenance.profile);
  table.insert("settings", array_of(provenance.settings));
  table.insert("seed", static_cast<std::int64_t>(provenance.seed));
  table.insert("mapping", mapping_of(session));
}

void insert_solution(const Session& session, toml::table& table) {
  toml::array robots;
  for (const auto& map : session.maps) robots.push_back(map->name);
  table.insert("robots", robots);
  toml::array components;
  for (const Component& component : session.solution.components) {
    toml::array names;
    for (const RobotId id : component.robots) names.push_back(name_of(session.fleet, id));
    components.push_back(names);
  }
  table.insert("components", components);
  toml::array refusals;
  toml::array merged;
  for (const PairOutcome& pair : session.solution.pairs) {
    if (pair.merged) {
      merged.push_back(toml::array{name_of(session.fleet, pair.a), name_of(session.fleet, pair.b)});
      continue;
    }
    refusals.push_back(format("{} and {}: {}", name_of(session.fleet, pair.a), name_of(session.fleet, pair.b),
                              pair.refused_reason));
  }
  table.insert("merged_pairs", merged);
  table.insert("refusals", refusals);
}

/// How well the frame between two robots is known, one standard deviation each.
toml::table sigma_table(const MergeAccuracy& accuracy) {
  return toml::table{{"along_m", accuracy.along_m},
                     {"across_m", accuracy.across_m},
                     {"up_m", accuracy.up_m},
                     {"turn_deg", accuracy.turn_deg},
                     {"loops_in_use", static_cast<std::int64_t>(accuracy.num_loops)}};
}

void insert_merges(const Session& session, toml::table& table) {
  const auto outcome_of = [&](const MergeCheck& check) {
    return std::ranges::find_if(session.solution.pairs, [&](const PairOutcome& pair) {
      return pair.a == check.a && pair.b == check.b;
    });
  };
  toml::array merges;
  toml::array revisits;
  for (const auto& [pair, check] : session.fleet.checks) {
    toml::table tested = merge_table(session.fleet, check);
    if (const auto outcome = outcome_of(check); outcome != session.solution.pairs.end()) {
      tested.insert("merged", outcome->merged);  // an accepted one may be taken back
      if (outcome->accuracy) tested.insert("sigma", sigma_table(*outcome->accuracy));
    }
    (check.a == check.b ? revisits : merges).push_back(std::move(tested));
  }
  table.insert("merges", merges);
  table.insert("revisits", revisits);
}

/// 0 for what is not written as an integer: toml++ would cast a fraction, whatever its size.
std::int64_t integer_of(const toml::node* node) {
  return node == nullptr ? 0 : node->value_exact<std::int64_t>().value_or(0);
}

std::uint32_t count_of(const toml::node* node) {
  return static_cast<std::uint32_t>(
      std::clamp<std::int64_t>(integer_of(node), 0, std::numeric_limits<std::uint32_t>::max()));
}

std::uint32_t count_in(const toml::table& table, const char* key) { return count_of(table.get(key)); }

/// None where it is missing, as in sessions of earlier versions, or is no mount.
std::optional<Pose> saved_mount(const toml::table& mapping) {
  const Result<Pose> T_base_lidar = parse_mount(mapping["mount"].value_or(std::string()));
  return T_base_lidar ? std::optional(*T_base_lidar) : std::nullopt;
}

std::vector<RobotProvenance> mapping_in(const toml::table& table) {
  std::vector<RobotProvenance> robots;
  const toml::array* mapping = table["mapping"].as_array();
  if (mapping == nullptr) return robots;
  for (const toml::node& node : *mapping) {
    const toml::table* entry = node.as_table();
    if (entry == nullptr) continue;
    robots.push_back({(*entry)["name"].value_or(std::string()), (*entry)["odometry"].value_or(std::string()),
                      (*entry)["lidar"].value_or(std::string()), count_in(*entry, "scans"),
                      (*entry)["failed"].value_or(std::string()), saved_mount(*entry)});
  }
  return robots;
}

Provenance provenance_in(const toml::table& table) {
  Provenance provenance;
  provenance.command = table["command"].value_or(std::string());
  provenance.earlier_commands = strings_of(table["earlier_commands"].node());
  provenance.inputs = strings_of(table["inputs"].node());
  provenance.world = table["world"].value_or(std::string());
  provenance.profile = table["profile"].value_or(std::string("default"));
  provenance.settings = strings_of(table["settings"].node());
  provenance.seed = static_cast<std::uint64_t>(integer_of(table.get("seed")));
  provenance.robots = mapping_in(table);
  if (const toml::table* configuration = table["configuration"].as_table()) {
    std::ostringstream text;
    text << *configuration;
    provenance.configuration = text.str();
  }
  return provenance;
}

HypothesisOutcome outcome_in(const std::string& words) {
  using enum HypothesisOutcome;
  for (const HypothesisOutcome outcome : {accepted, unsure, rival, behind, vetoed})
    if (words == to_string(outcome)) return outcome;
  return refuted;
}

MergeHypothesis hypothesis_in(const toml::table& table) {
  MergeHypothesis h;
  h.outcome = outcome_in(table["outcome"].value_or(std::string()));
  h.evidence = table["evidence"].value_or(0.0);
  h.num_checked = count_in(table, "places_compared");
  h.num_passed = h.num_checked - std::min(count_in(table, "places_differing"), h.num_checked);
  h.from_best_m = table["from_best_m"].value_or(0.0);
  h.walls = table["evidence_of_walls"].value_or(0.0);
  h.counts = {count_in(table, "places_distinctive"),
              count_in(table, "changes"),
              count_in(table, "things"),
              count_in(table, "wall_patches"),
              table["compared_m"].value_or(0.0),
              table["equal_signs"].value_or(0.5),
              0.0};
  if (const toml::array* loops = table["loops"].as_array())
    for (const toml::node& node : *loops)
      if (const toml::array* loop = node.as_array(); loop != nullptr && loop->size() == 2)
        h.loops.emplace_back(count_of(loop->get(0)), count_of(loop->get(1)));
  return h;
}

MergeAdvice advice_in(const toml::table& table) {
  MergeAdvice advice{table["from_m"].value_or(0.0), table["to_m"].value_or(0.0), Vector3::Zero(),
                     table["gain"].value_or(0.0), table["missing"].value_or(0.0)};
  if (const toml::array* from = table["from"].as_array(); from != nullptr && from->size() == 3)
    for (std::size_t i = 0; i < 3; ++i) advice.from[static_cast<Eigen::Index>(i)] = (*from)[i].value_or(0.0);
  return advice;
}

/// Only what lies between 0 and 1: a person may have edited the file.
std::optional<double> share_in(const toml::table& table, const char* key) {
  const std::optional<double> share = table[key].value<double>();
  return share && *share >= 0.0 && *share <= 1.0 ? share : std::nullopt;
}

SavedMerge merge_in(const toml::table& table) {
  SavedMerge merge;
  const std::vector<std::string> robots = strings_of(table["robots"].node());
  if (robots.size() == 2) std::tie(merge.a, merge.b) = std::pair(robots[0], robots[1]);
  MergeCheck& check = merge.check;
  check.accepted = table["accepted"].value_or(false);
  merge.merged = table["merged"].value_or(false);
  check.needed = table["evidence_needed"].value_or(0.0);
  check.reason = table["reason"].value_or(std::string());
  check.refused_kind = refusal_kind(table["refused_kind"].value_or(std::string()));
  if (const toml::table* advice = table["where_to_drive"].as_table()) check.advice = advice_in(*advice);
  check.unconfirmed = {share_in(table, "unconfirmed_a"), share_in(table, "unconfirmed_b")};
  if (const toml::array* hypotheses = table["hypotheses"].as_array())
    for (const toml::node& node : *hypotheses)
      if (const toml::table* h = node.as_table()) check.hypotheses.push_back(hypothesis_in(*h));
  if (!check.hypotheses.empty()) {
    const MergeHypothesis& best = check.hypotheses.front();
    check.evidence = best.evidence;
    check.num_checked = best.num_checked;
    check.num_passed = best.num_passed;
    check.loops = best.loops;
  }
  if (const toml::table* sigma = table["sigma"].as_table()) {
    MergeAccuracy& accuracy = merge.accuracy.emplace();
    accuracy.along_m = (*sigma)["along_m"].value_or(0.0);
    accuracy.across_m = (*sigma)["across_m"].value_or(0.0);
    accuracy.up_m = (*sigma)["up_m"].value_or(0.0);
    accuracy.turn_deg = (*sigma)["turn_deg"].value_or(0.0);
    accuracy.num_loops = count_in(*sigma, "loops_in_use");
  }
  return merge;
}

std::vector<SavedMerge> merges_in(const toml::table& table, const char* key) {
  std::vector<SavedMerge> merges;
  if (const toml::array* array = table[key].as_array())
    for (const toml::node& node : *array)
      if (const toml::table* merge = node.as_table()) merges.push_back(merge_in(*merge));
  return merges;
}

using Names = std::pair<std::string, std::string>;

Names in_order(const std::string& a, const std::string& b) { return std::minmax(a, b); }

/// Any two that one of the lists names, each in order.
std::set<Names> pairs_in(const toml::array* lists) {
  std::set<Names> pairs;
  if (lists == nullptr) return pairs;
  for (const toml::node& list : *lists) {
    const std::vector<std::string> names = strings_of(&list);
    for (std::size_t a = 0; a < names.size(); ++a)
      for (std::size_t b = a + 1; b < names.size(); ++b) pairs.insert(in_order(names[a], names[b]));
  }
  return pairs;
}

/// The sentences of "A and B: sentence" by "A and B".
std::map<std::string, std::string> refusals_in(const toml::table& table) {
  std::map<std::string, std::string> refusals;
  for (const std::string& refusal : strings_of(table["refusals"].node()))
    if (const std::size_t end = refusal.find(": "); end != std::string::npos)
      refusals[refusal.substr(0, end)] = refusal.substr(end + 2);
  return refusals;
}

/// What became of any two robots, tested or not.
std::vector<SavedMerge> merges_of_pairs(const std::vector<std::string>& robots, const toml::table& table) {
  std::map<Names, SavedMerge> tested;
  for (SavedMerge& merge : merges_in(table, "merges"))
    tested.try_emplace({merge.a, merge.b}, std::move(merge));
  const std::set<Names> merged = pairs_in(table["merged_pairs"].as_array());
  const std::set<Names> sharing = pairs_in(table["components"].as_array());
  const std::map<std::string, std::string> refusals = refusals_in(table);
  std::vector<SavedMerge> merges;
  for (std::size_t a = 0; a < robots.size(); ++a)
    for (std::size_t b = a + 1; b < robots.size(); ++b) {
      const Names names{robots[a], robots[b]};
      SavedMerge& merge = merges.emplace_back();
      if (const auto found = tested.find(names); found != tested.end()) merge = std::move(found->second);
      std::tie(merge.a, merge.b) = names;
      merge.merged = merge.merged || merged.contains(in_order(robots[a], robots[b]));
      merge.share_a_map = sharing.contains(in_order(robots[a], robots[b]));
      const auto refusal = refusals.find(format("{} and {}", names.first, names.second));
      if (refusal != refusals.end()) merge.refusal = refusal->second;
    }
  return merges;
}

}  // namespace

std::string session_toml(const Session& session) {
  toml::table table;
  table.insert("version", std::string(version()));
  insert_provenance(session, table);
  insert_solution(session, table);
  insert_merges(session, table);
  std::ostringstream text;
  text << table << "\n";
  const toml::parse_result configuration = toml::parse(session.provenance.configuration);
  toml::table nested;
  nested.insert("configuration", configuration);
  text << nested << "\n";
  return text.str();
}

Result<SessionHeader> parse_session_toml(std::string_view text) {
  if (const Result<> checked = check_toml_depth(text); !checked) return tl::unexpected(checked.error());
  try {
    const toml::table table = toml::parse(text);
    SessionHeader header;
    header.version = table["version"].value_or(std::string());
    header.provenance = provenance_in(table);
    header.robots = strings_of(table["robots"].node());
    if (const toml::array* components = table["components"].as_array())
      for (const toml::node& node : *components) header.components.push_back(strings_of(&node));
    return header;
  } catch (const toml::parse_error& error) {
    return fail(format("line {}: {}", error.source().begin.line, error.description()));
  }
}

Result<std::vector<SavedMerge>> parse_session_merges(std::string_view text) {
  if (const Result<> checked = check_toml_depth(text); !checked) return tl::unexpected(checked.error());
  try {
    const toml::table table = toml::parse(text);
    const std::vector<std::string> robots = strings_of(table["robots"].node());
    std::vector<SavedMerge> merges = merges_of_pairs(robots, table);
    std::ranges::copy(merges_in(table, "revisits"), std::back_inserter(merges));
    return merges;
  } catch (const toml::parse_error& error) {
    return fail(format("line {}: {}", error.source().begin.line, error.description()));
  }
}

}  // namespace adit
