// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Compares the scans of both robots at the places that a merge check asks for.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "adit/fleet/merge/comparison_plan.hpp"
#include "adit/fleet/merge/discernment.hpp"
#include "adit/fleet/merge/hypothesis.hpp"
#include "adit/fleet/sync/peer_session.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// Fits what was seen at both keyframes of a place, and judges the fit by the limit of the own map.
class PlaceComparer {
 public:
  /// `discernment`: of `map`. All must outlive it.
  PlaceComparer(const RobotMap& map, Discernment& discernment, const RegistrationConfig& registration)
      : map_(map), discernment_(discernment), registration_(registration) {}

  /// Own keyframes with those of a peer, whose `views` have all that are asked for.
  [[nodiscard]] std::vector<ComparedPlace> with_views(const std::vector<PlannedComparison>& asked,
                                                      const PeerSession::Views& views);
  /// Keyframes of the own map with later ones of it.
  [[nodiscard]] std::vector<ComparedPlace> within_own_map(const std::vector<PlannedComparison>& asked);

 private:
  /// What a place has shown, and where its two views fit.
  struct Fitted {
    ComparedPlace place;
    Pose T_own_theirs;
  };
  /// The view of theirs at the i-th place that is asked for.
  using ViewOfTheirs = std::function<const SeenSurface&(std::size_t i)>;

  /// All but the walls. `kept`: further own keyframes whose views `theirs` reads.
  [[nodiscard]] std::vector<Fitted> compare_views(const std::vector<PlannedComparison>& asked,
                                                  const ViewOfTheirs& theirs,
                                                  const std::vector<std::uint32_t>& kept);
  /// The own view has been prepared.
  [[nodiscard]] Fitted fit(const PlannedComparison& place, const SeenSurface& theirs) const;
  /// Whether what the peer saw would agree with what was seen some metres on, too, as if the robot stood
  /// there; those views have been prepared. Own scans may tell those places apart where two unlike sensors,
  /// by what both see, cannot.
  [[nodiscard]] bool agrees_displaced(std::uint32_t own, const SeenSurface& theirs,
                                      const Pose& T_own_theirs) const;
  /// Of the places where walls are asked for and the views agree.
  [[nodiscard]] static std::vector<std::size_t> those_with_walls(const std::vector<PlannedComparison>& asked,
                                                                 const std::vector<Fitted>& found);
  [[nodiscard]] static std::vector<ComparedPlace> places_of(std::vector<Fitted> found);
  /// The walls of the own scan, which has been prepared, and of the peer's.
  void add_walls(const PlannedComparison& place, const SearchableSurface& theirs, Fitted& fitted) const;

  const RobotMap& map_;
  Discernment& discernment_;
  const RegistrationConfig& registration_;
};

}  // namespace adit
