// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/adaptive_config.hpp"

namespace adit {

Fields fields_of(DiscernmentConfig& c) {
  return {
      {"samples", &c.samples, "", 4, 10000,
       "places of its own map on which a robot measures how much scans of one place differ"},
      {"look_alikes", &c.look_alikes, "", 0, 10000,
       "stretches of its own map that look most like others of it, on which it measures how long they agree"},
      {"displacement_m", &c.displacement_m, "m", 0.5, 1000.0,
       "a place is distinctive when scans displaced by this along the path differ"},
      {"usual_share", &c.usual_share, "", 0.0, 1.0,
       "share of pairs of scans of one place that differ less than usual"},
      {"allowance", &c.allowance, "", 1.0, 100.0, "scans differ beyond this times the usual difference"},
      {"second_looks", &c.second_looks, "", 0, 0,
       "a place differs only if a second pair of scans, nearby, differs too: one fit in many fails"},
      {"second_look_m", &c.second_look_m, "m", 0.1, 100.0, "from the first pair of scans to the second"},
      {"followed_m", &c.followed_m, "m", 1.0, 10000.0, "path along which look-alikes are followed, each way"},
      {"starts_per_look_alike", &c.starts_per_look_alike, "", 1, 1000,
       "candidates of a stretch that are tried until one can be followed"},
      {"prior_chance", &c.prior_chance, "", 0.0, 1.0,
       "chance that look-alikes agree at one more place, believed before anything is measured"},
      {"prior_steps", &c.prior_steps, "", 0.0, 1e6, "measured places that this belief is worth"},
      {"shortest_reach_m", &c.shortest_reach_m, "m", 1.0, 10000.0,
       "maps are compared this far from a loop at least"},
      {"longest_reach_m", &c.longest_reach_m, "m", 1.0, 10000.0, "and this far at most:"},
      {"reach_off_m", &c.reach_off_m, "m", 0.01, 10.0,
       "as far as odometry leads to within this distance to the side"}};
}

Fields fields_of(MergeCheckConfig& c) {
  Fields fields = {
      {"error_rate", &c.error_rate, "", 1e-12, 0.5, "chance that a wrong merge passes"},
      {"refusal_rate", &c.refusal_rate, "", 1e-12, 0.5,
       "chance that a true merge is refused because scans differ"},
      {"spacing_m", &c.spacing_m, "m", 0.1, 1000.0, "path between two places where maps are compared"},
      {"max_checks", &c.max_checks, "", 1, 10000, "places that are compared at most, per hypothesis"},
      {"first_checks", &c.first_checks, "", 1, 10000,
       "places that are compared of each hypothesis before the best ones are compared further"},
      {"max_hypotheses", &c.max_hypotheses, "", 1, 1000,
       "sets of consistent loops that are tested, the largest ones"},
      {"min_loops", &c.min_loops, "", 1, 1000, "loops that have to agree in a hypothesis that joins maps"},
      {"odometry_slack", &c.odometry_slack, "", 1.0, 100.0,
       "loops make one hypothesis if they agree within this many times the noise of odometry"},
      {"same_alignment_m", &c.same_alignment_m, "m", 0.0, 1000.0,
       "hypotheses that put the other robot this near to one another are one"},
      {"agreement_at_worst", &c.agreement_at_worst, "", 0.5, 0.999999,
       "least chance that scans of one place agree: a hypothesis is refuted when they differ more often"},
      {"gross_difference", &c.gross_difference, "", 1.0, 1000.0,
       "differences beyond this times the limit are niches or cabinets, not noise"},
      {"gross_rate", &c.gross_rate, "", 1e-6, 0.5, "chance of such a difference between scans of one place"},
      {"misplaced_m", &c.misplaced_m, "m", 0.0, 1000.0,
       "a loop contradicts another one nearby if they disagree by more"},
      {"misplaced_keyframes", &c.misplaced_keyframes, "", 0, 1e6,
       "which is this many keyframes away at most"},
      {"misplaced_neighbours", &c.misplaced_neighbours, "", 1, 1e6,
       "so many of the nearest loops are asked, and a loop that most of them contradict is left out,"},
      {"misplaced_quorum", &c.misplaced_quorum, "", 1, 1e6, "unless there are fewer than this"},
      {"distinctive_only", &c.distinctive_only, "", 0, 0,
       "agreement counts only where a displacement along the path would show"},
      {"relief", &c.relief, "", 0, 0,
       "compare the relief of walls, too: walls that stay apart in the same direction in all scans are "
       "others"}};
  append(fields, "discernment", fields_of(c.discernment));
  return fields;
}

Fields fields_of(AdaptiveConfig& c) {
  Fields fields = fields_of(c.search);
  fields.push_back({"one_place_m", &c.one_place_m, "m", 0.1, 1000.0,
                    "loops whose keyframes stand farther apart are rejected: not one place"});
  fields.push_back({"second_search_share", &c.second_search_share, "", 1, 1e6,
                    "the search goes on where one candidate in so many became a loop and all are refuted"});
  append(fields, "registration", fields_of(c.registration));
  append(fields, "merge_check", fields_of(c.merge_check));
  return fields;
}

}  // namespace adit
