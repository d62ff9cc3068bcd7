// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/agent_config.hpp"

namespace adit {

LoopRegistrationConfig AgentConfig::loop_registration() const {
  LoopRegistrationConfig out{registration_in_use()};
  if (policy == MergePolicy::adaptive) {
    out.one_place_m = adaptive.one_place_m;
    out.upright = true;
    out.added_noise = adaptive.loop_noise;
  } else {
    out.noise = loop_noise;
  }
  return out;
}

Fields fields_of(AgentConfig& c) {
  Fields fields = {{"max_candidates", &c.max_candidates, "", 0, 1e9,
                    "candidates that a robot registers with the peers it meets first"},
                   {"candidates_per_peer", &c.candidates_per_peer, "", 1, 1e6,
                    "candidates that it registers with each further peer, the most similar ones"},
                   {"loop_translation", &c.loop_noise.translation, "m", 1e-4, 10.0,
                    "the paper's policies: sigma of a loop's translation"},
                   {"loop_rotation_deg", &c.loop_noise.rotation_deg, "deg", 1e-3, 90.0,
                    "the paper's policies: sigma of a loop's rotation"}};
  append(fields, "place", fields_of(c.place));
  append(fields, "registration", fields_of(c.registration));
  append(fields, "adaptive", fields_of(c.adaptive));
  return fields;
}

}  // namespace adit
