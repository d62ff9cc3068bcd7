// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The probabilities and scales by which evidence for and against a merge is weighed: one struct, and beside
/// it where each value comes from (`evidence_entries`). Other settings say what is compared and how it is
/// measured: patches, ranges, spacings, and which loops are one hypothesis. `adit merge-calibration` fits
/// what can be fitted and prints the values in use beside the fitted ones (docs/decisions/0045).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// What all robots of a fleet share, because the evidence of several is added up: constants, no settings.
struct FleetEvidence {
  double agreement_if_true = 0.92;  ///< P(a place shows no change of structure that is new | one tunnel).
  double agreement_if_true_worth = 20.0;  ///< Places; the share differs between pairs of visits.
  double least_chance = 0.2;   ///< Least P(look-alikes agree at one more place), whatever was measured.
  double copied = 0.002;       ///< Share of look-alikes that were built to the same plan.
  double copied_worth = 10.0;  ///< Look-alikes; sites differ: where there is one copy there are more.
  double agreement_if_copied = 0.75;       ///< The same as agreement_if_true for these.
  double agreement_if_copied_worth = 8.0;  ///< Places; plans are kept to more or less closely.
};
/// The values in use.
inline constexpr FleetEvidence kFleetEvidence;

/// The values that are settings of each robot.
struct EvidenceModel {
  double error_rate = 2e-3;
  double rival_rate = 0.02;
  double refusal_rate = 0.01;

  double usual_share = 0.9;
  double allowance = 1.5;
  double least_difference_m2 = 0.9;
  double gross = 5.0;

  double few_loops = 2.0;
  double few_loops_if_true = 0.09;
  double few_loops_if_false = 0.65;

  double prior_chance = 0.4;
  double prior_steps = 4.0;

  double sight_m = 20.0;
  double same_object_m = 5.0;
  double structure_reach_m = 10.0;
  double thing_reach_m = 5.0;
  double differing_at_worst = 0.8;
  double changes_at_worst_per_km = 30.0;

  ReliefModel walls = {};
};
/// Keys carry the units and meanings; those of `walls` begin with "walls.".
[[nodiscard]] Fields fields_of(EvidenceModel& model);

/// One value of the model and its origin.
struct EvidenceEntry {
  std::string key;          ///< "error_rate", "walls.same_share", "fleet.copied", ...
  double value = 0.0;       ///< Of the model that was given, or of kFleetEvidence, ThingShape or OffsetPrior.
  std::string unit;         ///< "m", "1/km", ...; "" for shares, chances and numbers.
  std::string meaning;      ///< One line, as in the configuration.
  std::string_view source;  ///< What it was fitted to or chosen by.
  std::string_view date;    ///< Of that, year-month-day.
};
/// All values: those of kFleetEvidence first, with keys that begin with "fleet."; last the shape of what may
/// come and go (ThingShape), with "things.", and the constants by which sensors and fits are taken out of the
/// relief of walls (OffsetPrior), with "sensors.".
[[nodiscard]] std::vector<EvidenceEntry> evidence_entries(EvidenceModel model);

}  // namespace adit
