// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// The results of merging on disk.
#include <nlohmann/json.hpp>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "merge_run.hpp"

namespace adit::app {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const MergePair& pair) {
  return {{"robots", pair.robots},
          {"shared_m", pair.shared_m},
          {"distinctive_places", pair.distinctive_places},
          {"outcome", to_string(pair.outcome)},
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
  return {{"world", run.world},         {"group", run.group},
          {"keyframes", run.keyframes}, {"registrations", run.registrations},
          {"time_s", run.time_s},       {"pairs", pairs},
          {"joint", json_of(run.joint)}};
}

template <class T>
void get(const Json& json, const char* key, T& value) {
  value = json.at(key).get<T>();
}

MergePair pair_of(const Json& json) {
  MergePair pair;
  get(json, "robots", pair.robots);
  get(json, "shared_m", pair.shared_m);
  get(json, "distinctive_places", pair.distinctive_places);
  pair.outcome = merge_outcome(json.at("outcome").get<std::string>());
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
  get(json, "registrations", run.registrations);
  get(json, "time_s", run.time_s);
  for (const Json& pair : json.at("pairs")) run.pairs.push_back(pair_of(pair));
  run.joint = joint_of(json.at("joint"));
  return run;
}

std::string csv_quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

Result<std::vector<MergeRun>> read_merge_runs(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::vector<MergeRun>{};
  const Result<std::string> bytes = read_bytes(file);
  if (!bytes) return tl::unexpected(bytes.error());
  try {
    std::vector<MergeRun> runs;
    const Json file_content = Json::parse(*bytes);
    for (const Json& run : file_content.at("runs")) runs.push_back(run_of(run));
    return runs;
  } catch (const std::exception&) {
    return fail(file.string() + ": these are no results of this version; remove the file");
  }
}

Result<> write_merge_runs(const std::filesystem::path& file, const std::vector<MergeRun>& runs) {
  Json all = Json::array();
  for (const MergeRun& run : runs) all.push_back(json_of(run));
  return write_bytes(file, Json{{"version", 2}, {"runs", all}}.dump(1) + "\n");
}

Result<> write_merge_csv(const std::filesystem::path& file, const std::vector<MergeRun>& runs) {
  std::string text =
      "world,group,keyframes,robot_a,robot_b,shared_m,distinctive_places,outcome,registrations,loops_in_use,"
      "wrong_loops_in_use,"
      "ate_max_a_m,ate_max_b_m,ate_max_a_pct,ate_max_b_pct,refused_reason\n";
  for (const MergeRun& run : runs)
    for (const MergePair& pair : run.pairs)
      text +=
          format("{},{},{},{},{},{:.1f},{},{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{}\n", run.world,
                 run.group, run.keyframes, pair.robots[0], pair.robots[1], pair.shared_m,
                 pair.distinctive_places, to_string(pair.outcome), pair.registrations, pair.loops_in_use,
                 pair.wrong_loops_in_use, pair.ate_max_m[0], pair.ate_max_m[1], pair.ate_max_over_path_pct[0],
                 pair.ate_max_over_path_pct[1], csv_quoted(pair.refused_reason));
  return write_bytes(file, text);
}

}  // namespace adit::app
