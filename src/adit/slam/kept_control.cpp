// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/kept_control.hpp"

#include <algorithm>
#include <set>

#include "adit/core/format.hpp"

namespace adit {
namespace {

bool is_same_control(const ControlPoint& one, const ControlPoint& other) {
  return one.name == other.name && one.mark.robot == other.mark.robot && one.mark.stamp == other.mark.stamp &&
         one.mark.position == other.mark.position;
}

std::string name_of_session(const EarlierGeoreferences& session) {
  return session.session.empty() ? "an earlier session" : session.session.string();
}

std::string system_in(const EarlierGeoreferences& session, const std::string& crs) {
  return name_of_session(session) + (crs.empty() ? ": no --crs was given" : ": " + crs);
}

}  // namespace

KeptControl kept_control(const std::vector<EarlierGeoreferences>& earlier) {
  KeptControl kept;
  const EarlierGeoreferences* first = nullptr;
  std::set<std::string> marked;  // robots on which sessions before have points
  for (const EarlierGeoreferences& session : earlier) {
    std::set<std::string> of_session;
    std::vector<std::string> left_out;
    for (const Georeference& map : session.maps) {
      for (const auto& [point, use, residual, misfit] : map.points) {
        if (marked.contains(point.mark.robot)) {
          const auto is_this = [&point = point](const ControlPoint& other) {
            return is_same_control(point, other);
          };
          if (std::ranges::none_of(kept.points, is_this)) left_out.push_back(point.name);
          continue;
        }
        if (first == nullptr) kept.crs = map.crs;
        if (first == nullptr) first = &session;
        if (map.crs != kept.crs || (map.crs.empty() && first != &session))
          return {{},
                  "",
                  {format("the maps may be in different coordinate systems ({}; {}), so that the new session "
                          "is in none; adit georeference sets one",
                          system_in(*first, kept.crs), system_in(session, map.crs))}};
        of_session.insert(point.mark.robot);
        kept.points.push_back(point);
      }
    }
    if (!left_out.empty())
      kept.notes.push_back(
          format("the control points {} of {} are left out: they were found in maps that an earlier one of "
                 "the sessions has too, with its own control points",
                 fmt::join(left_out, ", "), name_of_session(session)));
    marked.merge(of_session);
  }
  return kept;
}

}  // namespace adit
