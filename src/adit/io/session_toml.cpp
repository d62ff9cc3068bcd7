// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/session_toml.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "adit/core/format.hpp"
#include "adit/core/version.hpp"

namespace adit {
namespace {

std::string name_of(const FleetGraph& fleet, RobotId id) { return fleet.robots.at(id).name; }

double rounded(double value) { return std::round(100.0 * value) / 100.0; }

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

/// How each robot was mapped.
toml::array mapping_of(const Provenance& provenance) {
  toml::array mapping;
  for (const RobotProvenance& robot : provenance.robots) {
    toml::table entry{{"name", robot.name}};
    if (!robot.failure.empty()) {
      entry.insert("failed", robot.failure);
    } else {
      entry.insert("odometry", robot.odometry);
      entry.insert("lidar", robot.lidar);
      entry.insert("scans", static_cast<std::int64_t>(robot.scans));
    }
    mapping.push_back(std::move(entry));
  }
  return mapping;
}

void insert_provenance(const Provenance& provenance, toml::table& table) {
  table.insert("command", provenance.command);
  table.insert("inputs", array_of(provenance.inputs));
  table.insert("world", provenance.world);
  table.insert("profile", provenance.profile);
  table.insert("settings", array_of(provenance.settings));
  table.insert("seed", static_cast<std::int64_t>(provenance.seed));
  table.insert("mapping", mapping_of(provenance));
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
  for (const PairOutcome& pair : session.solution.pairs) {
    if (pair.merged) continue;
    refusals.push_back(format("{} and {}: {}", name_of(session.fleet, pair.a), name_of(session.fleet, pair.b),
                              pair.refused_reason));
  }
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

std::vector<RobotProvenance> mapping_in(const toml::table& table) {
  std::vector<RobotProvenance> robots;
  const toml::array* mapping = table["mapping"].as_array();
  if (mapping == nullptr) return robots;
  for (const toml::node& node : *mapping) {
    const toml::table* entry = node.as_table();
    if (entry == nullptr) continue;
    robots.push_back({(*entry)["name"].value_or(std::string()), (*entry)["odometry"].value_or(std::string()),
                      (*entry)["lidar"].value_or(std::string()),
                      static_cast<std::size_t>((*entry)["scans"].value_or(std::int64_t{0})),
                      (*entry)["failed"].value_or(std::string())});
  }
  return robots;
}

Provenance provenance_in(const toml::table& table) {
  Provenance provenance;
  provenance.command = table["command"].value_or(std::string());
  provenance.inputs = strings_of(table["inputs"].node());
  provenance.world = table["world"].value_or(std::string());
  provenance.profile = table["profile"].value_or(std::string("default"));
  provenance.settings = strings_of(table["settings"].node());
  provenance.seed = static_cast<std::uint64_t>(table["seed"].value_or(std::int64_t{0}));
  provenance.robots = mapping_in(table);
  if (const toml::table* configuration = table["configuration"].as_table()) {
    std::ostringstream text;
    text << *configuration;
    provenance.configuration = text.str();
  }
  return provenance;
}

}  // namespace

std::string session_toml(const Session& session) {
  toml::table table;
  table.insert("version", std::string(version()));
  insert_provenance(session.provenance, table);
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

}  // namespace adit
