// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/evidence_model.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "adit/core/check.hpp"
#include "adit/registration/changed_thing.hpp"
#include "adit/registration/sensor_difference.hpp"

namespace adit {
namespace {

struct Origin {
  std::string_view key;
  std::string_view source;
  std::string_view date;
};

constexpr std::string_view kChosen = "chosen: the rate that is aimed at";
constexpr std::string_view kOfForty = "1410 false and 130 true hypotheses of 40 worlds (decision 0048)";
constexpr std::string_view kOfElevenWorlds = "hypotheses of eleven field worlds (decision 0063)";
constexpr std::string_view kTrueOfEleven = "38 true pairs of eleven field worlds (decision 0059)";
constexpr std::string_view kWalksOfFifteen =
    "106 first steps of look-alikes on 15 maps of five tuning worlds (decision 0043)";
constexpr std::string_view kJudgement = "judgement: no site was counted (decision 0043)";
constexpr std::string_view kSitesDiffer =
    "judgement: 5 and 20 decide all but three of 57 pairs alike (decision 0081)";
constexpr std::string_view kOfCopies =
    "chosen between 27 pairs of six worlds of copies and judgement (decision 0079)";
constexpr std::string_view kLining = "half of 20 m of fresh lining (decision 0041)";
constexpr std::string_view kVehicle = "chosen: the length of a vehicle";
constexpr std::string_view kVehicles = "chosen: sizes of the vehicles that drive in drifts (decision 0041)";
constexpr std::string_view kOfScans = "pairs of scans of the tuning worlds (decision 0010)";
constexpr std::string_view kLoopsOfFortyTwo =
    "167 true and 414 false hypotheses of 42 seen field worlds (decision 0066)";
constexpr std::string_view kOfWalls = "three tuning worlds (decision 0015)";
constexpr std::string_view kDataSheets = "what data sheets allow (decision 0035)";
constexpr std::string_view kOfFits = "six true pairs (decision 0052)";

constexpr std::array kOrigins = {
    Origin{"fleet.agreement_if_true", kTrueOfEleven, "2026-11-27"},
    Origin{"fleet.agreement_if_true_worth", kOfCopies, "2026-11-29"},
    Origin{"fleet.least_chance", "places 3 m apart see in part the same (decision 0043)", "2026-11-25"},
    Origin{"fleet.copied", kOfForty, "2026-11-25"},
    Origin{"fleet.copied_worth", kSitesDiffer, "2026-11-29"},
    Origin{"fleet.agreement_if_copied", kOfCopies, "2026-11-29"},
    Origin{"fleet.agreement_if_copied_worth", kOfCopies, "2026-11-29"},
    Origin{"error_rate", "of 93 pairs 0.5 % merged one wrongly (decisions 0060, 0095)", "2026-12-01"},
    Origin{"rival_rate", "106 true and 1501 false hypotheses of 34 field worlds (decision 0063)",
           "2026-11-27"},
    Origin{"refusal_rate", kChosen, "2026-11-21"},
    Origin{"usual_share", kOfScans, "2026-11-21"},
    Origin{"allowance", kOfScans, "2026-11-21"},
    Origin{"least_difference_m2", kOfScans, "2026-11-21"},
    Origin{"gross", kOfScans, "2026-11-25"},
    Origin{"few_loops", kLoopsOfFortyTwo, "2026-11-27"},
    Origin{"few_loops_if_true", kLoopsOfFortyTwo, "2026-11-27"},
    Origin{"few_loops_if_false", kLoopsOfFortyTwo, "2026-11-27"},
    Origin{"prior_chance", kWalksOfFifteen, "2026-11-25"},
    Origin{"prior_steps", kWalksOfFifteen, "2026-11-25"},
    Origin{"sight_m", "chosen: not measured", "2026-11-24"},
    Origin{"same_object_m", kVehicle, "2026-11-24"},
    Origin{"structure_reach_m", kLining, "2026-11-24"},
    Origin{"thing_reach_m", kVehicle, "2026-11-24"},
    Origin{"differing_at_worst", kOfElevenWorlds, "2026-11-27"},
    Origin{"changes_at_worst_per_km", "true pairs of zab and mine worlds (decision 0059)", "2026-11-27"},
    Origin{"walls.same_share", kOfWalls, "2026-11-22"},
    Origin{"walls.same_sigma", kOfWalls, "2026-11-22"},
    Origin{"walls.prior_other_share", "tuning worlds (decision 0013)", "2026-11-21"},
    Origin{"walls.prior_sigma", kOfWalls, "2026-11-22"},
    Origin{"walls.stretch_sigma", kOfElevenWorlds, "2026-11-27"},
    Origin{"walls.prior_stretches", kOfWalls, "2026-11-22"},
    Origin{"walls.prior_moulded", kJudgement, "2026-11-25"},
    Origin{"walls.moulded", kJudgement, "2026-11-25"},
    Origin{"walls.changed", "3 of some 380 true pairs of 120 worlds (decision 0054)", "2026-11-26"},
    Origin{"walls.lined_anew", kOfElevenWorlds, "2026-11-27"},
    Origin{"walls.lined_share", kOfElevenWorlds, "2026-11-27"},
    Origin{"walls.few_patches", kOfWalls, "2026-11-22"},
    Origin{"walls.min_patches", kOfElevenWorlds, "2026-11-27"},
    Origin{"things.tallest_m", kVehicles, "2026-11-24"},
    Origin{"things.longest_m", kVehicles, "2026-11-24"},
    Origin{"things.highest_foot_m", kVehicles, "2026-11-24"},
    Origin{"things.floor_around_m", kVehicles, "2026-11-24"},
    Origin{"sensors.bias_m", kDataSheets, "2026-11-24"},
    Origin{"sensors.walk_m", kDataSheets, "2026-11-24"},
    Origin{"sensors.per_tenfold_m",
           "as bias and walk, between returns one of which is a hundred times as strong (decision 0068)",
           "2026-11-28"},
    Origin{"sensors.ring_m", kDataSheets, "2026-11-24"},
    Origin{"sensors.fit_m", kOfFits, "2026-11-26"},
    Origin{"sensors.fit_rad", kOfFits, "2026-11-26"},
};

Fields fields_of(FleetEvidence& c) {
  return {
      {"agreement_if_true", &c.agreement_if_true, "", 0.0, 1.0,
       "chance that a place shows no change of structure that none before has shown, if the alignment is "
       "true"},
      {"agreement_if_true_worth", &c.agreement_if_true_worth, "", 0.0, 1e6,
       "number of places that this is worth: more or less changes between two visits"},
      {"least_chance", &c.least_chance, "", 0.0, 1.0,
       "look-alikes agree at one more place at least this often, however seldom a robot has seen it"},
      {"copied", &c.copied, "", 0.0, 1.0,
       "share of the tunnels that look alike that were built to the same plan"},
      {"copied_worth", &c.copied_worth, "", 0.0, 1e6,
       "number of look-alikes that this is worth, beside those that two maps show: sites differ"},
      {"agreement_if_copied", &c.agreement_if_copied, "", 0.0, 1.0,
       "the same chance as agreement_if_true for tunnels built to the same plan: rock and furniture differ"},
      {"agreement_if_copied_worth", &c.agreement_if_copied_worth, "", 0.0, 1e6,
       "number of places that this is worth: plans are kept to more or less closely"}};
}

double number_of(const Field& field) {
  if (const auto* whole = std::get_if<int*>(&field.target)) return **whole;
  const auto* number = std::get_if<double*>(&field.target);
  ADIT_CHECK(number, "all values of the evidence model are numbers");
  return **number;
}

}  // namespace

Fields fields_of(EvidenceModel& c) {
  Fields fields = {
      {"error_rate", &c.error_rate, "", 1e-12, 0.5,
       "largest chance that a wrong merge passes, by this model (measured: decisions 0060 and 0095)"},
      {"rival_rate", &c.rival_rate, "", 1e-12, 0.5,
       "chance that another alignment is the right one, by their evidence, above which it is a rival"},
      {"refusal_rate", &c.refusal_rate, "", 1e-12, 0.5,
       "chance that a true merge is refused because scans differ"},
      {"usual_share", &c.usual_share, "", 0.0, 1.0,
       "share of pairs of scans of one place that differ less than usual"},
      {"allowance", &c.allowance, "", 1.0, 100.0, "scans differ beyond this times the usual difference"},
      {"least_difference_m2", &c.least_difference_m2, "m2", 0.0, 100.0,
       "smaller differences are none, as small as the usual one may be: beams that meet an edge elsewhere"},
      {"gross", &c.gross, "", 1.0, 100.0,
       "what differs by more than this times the limit is no chance meeting of beams and edges"},
      {"few_loops", &c.few_loops, "", 0.0, 1000.0,
       "no more loops than this in a hypothesis are few, and speak against it"},
      {"few_loops_if_true", &c.few_loops_if_true, "", 1e-6, 1.0, "chance that a true alignment has so few"},
      {"few_loops_if_false", &c.few_loops_if_false, "", 1e-6, 1.0,
       "chance that a false alignment, not given up, has so few"},
      {"prior_chance", &c.prior_chance, "", 0.0, 1.0,
       "prior chance that look-alikes agree at one more place"},
      {"prior_steps", &c.prior_steps, "", 0.0, 1e6, "number of measured places that this prior counts as"},
      {"sight_m", &c.sight_m, "m", 1.0, 200.0, "length of tunnel that a pair of scans shows"},
      {"same_object_m", &c.same_object_m, "m", 0.1, 100.0,
       "distance between the middles of one object, as seen from two places, at most"},
      {"structure_reach_m", &c.structure_reach_m, "m", 0.1, 100.0,
       "what differs within this of where a change of structure was first seen belongs to it: half of 20 m "
       "of fresh lining to each side"},
      {"thing_reach_m", &c.thing_reach_m, "m", 0.1, 100.0,
       "the same for what may come and go, which is counted and told and is no evidence: the length of a "
       "vehicle"},
      {"differing_at_worst", &c.differing_at_worst, "", 0.5, 1.0,
       "share of the places of one tunnel that differ at the first look, at worst; where one place more "
       "does, changes count before a second look confirms them"},
      {"changes_at_worst_per_km", &c.changes_at_worst_per_km, "1/km", 0.1, 1000.0,
       "changes of structure between two visits of one stretch, at worst: doors, blocked, lined or widened "
       "tunnels"}};
  append(fields, "walls", fields_of(c.walls));
  return fields;
}

std::vector<EvidenceEntry> evidence_entries(EvidenceModel model) {
  FleetEvidence fleet;
  Fields fields;
  append(fields, "fleet", fields_of(fleet));
  for (Field& field : fields_of(model)) fields.push_back(std::move(field));
  ThingShape things;
  append(fields, "things", fields_of(things));
  OffsetPrior sensors;
  append(fields, "sensors", fields_of(sensors));
  std::vector<EvidenceEntry> entries;
  for (const Field& field : fields) {
    const auto* origin = std::ranges::find(kOrigins, field.key, &Origin::key);
    ADIT_CHECK(origin != kOrigins.end(), "every value of the evidence model has an origin");
    entries.push_back({field.key, number_of(field), field.unit, field.meaning, origin->source, origin->date});
  }
  return entries;
}

}  // namespace adit
