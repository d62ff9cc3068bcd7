// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_curves.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <set>
#include <sstream>
#include <system_error>

#include "adit/core/format.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/io/folders.hpp"
#include "adit/report/curve_plot.hpp"

namespace adit {
namespace {

constexpr double kFarthest = 2.0;  ///< Times what is stated.

Fields fields_of(MergeEffect& c) {
  return {{"name", &c.name, "", 0, 0, "what tables call it"},
          {"field", &c.field, "", 0, 0, "configuration field that is its amplitude"},
          {"unit", &c.unit, "", 0, 0, "of the amplitude"},
          {"stated", &c.stated, "", 1e-6, 1e6, "amplitude by data sheets or in a working mine"},
          {"steps", &c.steps, "", 1, 100, "amplitudes above 0, up to twice what is stated"},
          {"set", &c.set, "", 0, 0, "other fields, as key=value, separated by commas"}};
}

Result<> check(const std::deque<MergeEffect>& effects) {
  const RunConfig defaults;
  std::set<std::string> names;
  for (const MergeEffect& effect : effects) {
    if (effect.name.empty()) return fail("an entry has no name; add name = \"...\"");
    if (!names.insert(effect.name).second)
      return fail("two effects are called '" + effect.name + "'; rename one");
    for (const double amplitude : effect.amplitudes())
      if (const auto config = with_effect(effect, amplitude, defaults); !config)
        return fail("effect '" + effect.name + "'", config.error());
  }
  return {};
}

/// What results call the policy at that amplitude; the same for all effects at 0.
std::string variant_of(const MergeEffect& effect, double amplitude) {
  return amplitude == 0.0 ? "without effects" : format("{} {:g}", effect.name, amplitude);
}

/// The run that `run_world` makes of that world under that study; null if it has not been made yet.
const MergeRun* find_run(const std::vector<MergeRun>& runs, const MergeStudy& study,
                         const ListedWorld& world) {
  const ScenarioConfig scenario = scenario_of(world, study.config.simulation);
  MergeRun wanted;
  wanted.world = world.name;
  wanted.keyframes = format("{} {}", to_string(KeyframeSelection::adaptive), study.variant);
  wanted.sensors = sensors_text(scenario);
  wanted.conditions = conditions_text(scenario);
  const auto found =
      std::ranges::find_if(runs, [&](const MergeRun& run) { return is_same_run(run, wanted); });
  return found == runs.end() ? nullptr : &*found;
}

/// Runs one world at one amplitude, unless that was done.
Result<> run_amplitude(MergeStudy study, const ListedWorld& world, std::vector<MergeRun>& runs) {
  if (find_run(runs, study, world) != nullptr) return {};
  const bool passes = study.variant != variant_of({}, 0.0);
  const std::filesystem::path results = study.folder;
  if (passes) study.folder = results / "passing";
  if (const Result<> made = make_folder(study.folder / "maps"); !made) return made;
  const Result<> done = run_world(study, world, runs);
  std::error_code ignored;
  if (passes) std::filesystem::remove_all(study.folder, ignored);
  return done.and_then([&] { return write_merge_runs(results / "results.json", runs); });
}

std::optional<CurvePoint> point_of(const std::vector<CurvePoint>& points, const std::string& effect,
                                   double amplitude) {
  const auto found = std::ranges::find_if(points, [&](const CurvePoint& point) {
    return point.effect == effect && point.amplitude == amplitude;
  });
  return found == points.end() ? std::nullopt : std::optional(*found);
}

int merged_of(const MergeCounts& counts) { return counts.success + counts.bent; }

std::string amplitude_text(const MergeEffect& effect, double amplitude) {
  return format("{:g}{}{}", amplitude, effect.unit.empty() ? "" : " ", effect.unit);
}

/// The first amplitude at which `holds`, "none" otherwise.
template <class Holds>
std::string first_amplitude(const MergeEffect& effect, const std::vector<CurvePoint>& points,
                            const Holds& holds) {
  for (const double amplitude : effect.amplitudes())
    if (const auto point = point_of(points, effect.name, amplitude); point && holds(point->counts))
      return amplitude_text(effect, amplitude);
  return "none";
}

}  // namespace

std::vector<double> MergeEffect::amplitudes() const {
  std::vector<double> all;
  for (int k = 0; k <= steps; ++k) all.push_back(kFarthest * stated * k / steps);
  return all;
}

Result<std::vector<MergeEffect>> read_effects(const std::filesystem::path& list) {
  std::deque<MergeEffect> effects;  // Entries stay where they are while others are added.
  const Result<> loaded =
      load_entries(list, "effect", [&] { return fields_of(effects.emplace_back()); }).and_then([&] {
        return check(effects).map_error(
            [&](const Error& error) { return Error{list.string() + ": " + error.message}; });
      });
  if (!loaded) return tl::unexpected(loaded.error());
  return std::vector<MergeEffect>(effects.begin(), effects.end());
}

Result<RunConfig> with_effect(const MergeEffect& effect, double amplitude, RunConfig config) {
  if (amplitude == 0.0) return config;
  const Fields fields = adit::fields_of(config);
  if (const Result<> set = set_field(fields, effect.field, format("{:g}", amplitude)); !set)
    return tl::unexpected(set.error());
  std::istringstream others(effect.set);
  for (std::string entry; std::getline(others, entry, ',');) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos) return fail(entry + ": key=value is needed");
    if (const Result<> set = set_field(fields, entry.substr(0, equals), entry.substr(equals + 1)); !set)
      return tl::unexpected(set.error());
  }
  return config;
}

Result<std::vector<CurvePoint>> measure_curves(const MergeStudy& study,
                                               const std::vector<ListedWorld>& worlds,
                                               const std::vector<MergeEffect>& effects,
                                               std::vector<MergeRun>& runs) {
  std::vector<CurvePoint> points;
  for (const MergeEffect& effect : effects)
    for (const double amplitude : effect.amplitudes()) {
      const Result<RunConfig> config = with_effect(effect, amplitude, study.config);
      if (!config) return tl::unexpected(config.error());
      MergeStudy one = study;
      one.config = *config;
      one.policies = {KeyframeSelection::adaptive};
      one.variant = variant_of(effect, amplitude);
      CurvePoint point{effect.name, amplitude, {}};
      for (ListedWorld world : worlds) {
        world.conditions.clear();
        if (const Result<> done = run_amplitude(one, world, runs); !done) return tl::unexpected(done.error());
        if (const MergeRun* run = find_run(runs, one, world)) point.counts.add(*run);
      }
      points.push_back(std::move(point));
    }
  return points;
}

std::vector<Table> curve_tables(const std::vector<MergeEffect>& effects,
                                const std::vector<CurvePoint>& points) {
  Table each{
      "Outcome against amplitude",
      "Each effect alone, the other errors being none; the first row of each is the ideal sensor. Merged, "
      "refused: of the mergeable pairs, each by itself, and merged where all robots met. Bent: of the "
      "merged ones, with an ATE of 1 % of the path or more. Wrong: of all pairs.",
      {},
      {"Effect", "Amplitude", "Of what is stated", "Merged", "Bent", "Refused", "Wrong", "Joint: merged",
       "Joint: wrong"},
      {}};
  Table first{
      "Where merges begin to be refused",
      "The least amplitude measured at which fewer mergeable pairs merge than without the effect, and at "
      "which any pair is merged wrongly.",
      {},
      {"Effect", "Stated", "Refused from", "Jointly refused from", "Wrong from"},
      {}};
  for (const MergeEffect& effect : effects) {
    for (const double amplitude : effect.amplitudes()) {
      const auto point = point_of(points, effect.name, amplitude);
      if (!point) continue;
      const MergeCounts& c = point->counts;
      each.rows.push_back({effect.name, amplitude_text(effect, amplitude),
                           format("{:g}", amplitude / effect.stated),
                           format("{} of {}", merged_of(c), c.mergeable), format("{}", c.bent),
                           format("{}", c.refused), format("{}", c.wrong),
                           format("{} of {}", c.joint_merged, c.mergeable), format("{}", c.joint_wrong)});
    }
    const auto without = point_of(points, effect.name, 0.0);
    if (!without) continue;
    const int merged = merged_of(without->counts);
    const int joint = without->counts.joint_merged;
    first.rows.push_back(
        {effect.name, amplitude_text(effect, effect.stated),
         first_amplitude(effect, points, [&](const MergeCounts& c) { return merged_of(c) < merged; }),
         first_amplitude(effect, points, [&](const MergeCounts& c) { return c.joint_merged < joint; }),
         first_amplitude(effect, points, [](const MergeCounts& c) { return c.wrong + c.joint_wrong > 0; })});
  }
  return {first, each};
}

std::string curves_plot(const std::vector<MergeEffect>& effects, const std::vector<CurvePoint>& points) {
  std::vector<ShareCurve> curves;
  for (const MergeEffect& effect : effects) {
    ShareCurve curve{effect.name, {}};
    for (const double amplitude : effect.amplitudes())
      if (const auto point = point_of(points, effect.name, amplitude); point && point->counts.mergeable > 0)
        curve.points.emplace_back(amplitude / effect.stated,
                                  static_cast<double>(merged_of(point->counts)) / point->counts.mergeable);
    curves.push_back(std::move(curve));
  }
  return plot_shares(curves, kFarthest, "amplitude, in units of what is stated", "mergeable pairs merged");
}

}  // namespace adit
