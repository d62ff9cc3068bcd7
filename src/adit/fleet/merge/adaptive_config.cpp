// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/adaptive_config.hpp"

namespace adit {

Fields fields_of(DiscernmentConfig& c) {
  Fields fields = {
      {"samples", &c.samples, "", 4, 10000,
       "places of its own map on which a robot measures how much scans of one place differ"},
      {"look_alikes", &c.look_alikes, "", 0, 10000,
       "stretches of its own map that look most like others of it, on which it measures how long they agree"},
      {"displacement_m", &c.displacement_m, "m", 0.5, 1000.0,
       "a place is distinctive when scans displaced by this along the path differ"},
      {"second_looks", &c.second_looks, "", 0, 0,
       "a place differs only if a second pair of scans, nearby, differs too: one fit in many fails"},
      {"second_look_m", &c.second_look_m, "m", 0.1, 100.0,
       "distance from the first pair of scans to the second"},
      {"followed_m", &c.followed_m, "m", 1.0, 10000.0, "path along which look-alikes are followed, each way"},
      {"starts_per_look_alike", &c.starts_per_look_alike, "", 1, 1000,
       "candidates of a stretch that are tried until one can be followed"},
      {"shortest_reach_m", &c.shortest_reach_m, "m", 1.0, 10000.0,
       "maps are compared at least this far from a loop"},
      {"longest_reach_m", &c.longest_reach_m, "m", 1.0, 10000.0,
       "maps are compared at most this far from a loop,"},
      {"reach_off_m", &c.reach_off_m, "m", 0.01, 10.0,
       "and only as far as odometry's sideways error stays below this"}};
  append(fields, "segment", fields_of(c.segment));
  return fields;
}

Fields fields_of(MergeCheckConfig& c) {
  Fields fields = {
      {"spacing_m", &c.spacing_m, "m", 0.1, 1000.0, "path between two places where maps are compared"},
      {"max_checks", &c.max_checks, "", 1, 10000, "places that are compared at most, per hypothesis"},
      {"wall_spacing_m", &c.wall_spacing_m, "m", 0.1, 1000.0,
       "path between two pairs of scans whose walls are compared where little evidence is missing"},
      {"max_wall_checks", &c.max_wall_checks, "", 0, 10000, "such pairs between the places, at most"},
      {"first_checks", &c.first_checks, "", 1, 10000,
       "places compared per hypothesis before the best ones are compared further"},
      {"max_hypotheses", &c.max_hypotheses, "", 1, 1000,
       "sets of consistent loops that are tested, the largest ones"},
      {"loops_agree", &c.loops_agree, "", 0.01, 0.999999,
       "loops are of one set if each two agree as true loops do with this probability"},
      {"same_alignment_m", &c.same_alignment_m, "m", 0.0, 1000.0,
       "hypotheses are one if they put the other robot within this distance of one another"},
      {"misplaced_m", &c.misplaced_m, "m", 0.0, 1000.0,
       "a loop contradicts another one nearby if they disagree by more"},
      {"misplaced_keyframes", &c.misplaced_keyframes, "", 0, 1e6,
       "and nearby is at most this many keyframes away"},
      {"misplaced_neighbours", &c.misplaced_neighbours, "", 1, 1e6,
       "a loop is left out if most of this many nearest loops contradict it,"},
      {"misplaced_quorum", &c.misplaced_quorum, "", 1, 1e6, "unless there are fewer nearby loops than this"},
      {"relief", &c.relief, "", 0, 0,
       "compare the relief of walls, too: walls that stay apart in the same direction in all scans are "
       "others"}};
  append(fields, "evidence", fields_of(c.evidence));
  append(fields, "discernment", fields_of(c.discernment));
  return fields;
}

Fields fields_of(AdaptiveConfig& c) {
  Fields fields = fields_of(c.search);
  fields.push_back({"one_place_m", &c.one_place_m, "m", 0.1, 1000.0,
                    "loops whose keyframes stand farther apart are rejected: not one place"});
  fields.push_back({"loop_translation", &c.loop_noise.translation, "m", 1e-4, 10.0,
                    "sigma of what two LiDARs' errors add to what a registration states"});
  fields.push_back({"loop_rotation_deg", &c.loop_noise.rotation_deg, "deg", 1e-3, 90.0, "likewise"});
  append(fields, "registration", fields_of(c.registration));
  append(fields, "submap", fields_of(c.submap));
  append(fields, "view", fields_of(c.view));
  append(fields, "merge_check", fields_of(c.merge_check));
  return fields;
}

}  // namespace adit
