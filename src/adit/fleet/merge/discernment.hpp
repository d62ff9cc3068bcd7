// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How well places can be told apart where a robot has been: measured on its own map, so that a merge is
/// judged by what this site and this sensor allow and by nothing that was tuned elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/fleet/merge/keyframe_store.hpp"
#include "adit/fleet/search/lanes.hpp"
#include "adit/fleet/sync/protocol.hpp"
#include "adit/place/place_index.hpp"
#include "adit/posegraph/pcm.hpp"
#include "adit/registration/registration_config.hpp"
#include "adit/registration/relief.hpp"

namespace adit {

struct DiscernmentConfig {
  int samples = 32;
  int look_alikes = 16;
  double spacing_m = 3.0;
  double displacement_m = 5.0;
  double allowance = 1.5;
  bool second_looks = true;
};
inline Fields fields_of(DiscernmentConfig& c) {
  return {
      {"samples", &c.samples, "", 4, 10000,
       "places of its own map on which a robot measures how much scans of one place differ"},
      {"look_alikes", &c.look_alikes, "", 0, 10000,
       "stretches of its own map that look most like others of it, on which it measures how long they agree"},
      {"spacing_m", &c.spacing_m, "m", 0.1, 1000.0, "way between two places where maps are compared"},
      {"displacement_m", &c.displacement_m, "m", 0.5, 1000.0,
       "a place is distinctive when scans this much farther along the way differ"},
      {"allowance", &c.allowance, "", 1.0, 100.0,
       "scans differ beyond this times what nine of ten pairs of scans of one place do"},
      {"second_looks", &c.second_looks, "", 0, 0,
       "where scans differ, others a metre on decide whether the place does"}};
}

/// Where scans differ a fit may have failed, or a niche lie in the shadow of one of them. Whether they differ
/// so far along the way, too, decides: metres.
inline constexpr double kSecondLook = 1.0;

/// Way driven up to each keyframe, metres.
[[nodiscard]] std::vector<double> way_along(const OdometryChain& chain);
/// The first keyframe after that way; none before the start and beyond the end.
[[nodiscard]] std::optional<std::uint32_t> keyframe_at(const std::vector<double>& way, double metres);

/// Which places of a map look like others that odometry keeps apart from them.
class OtherPlaces {
 public:
  OtherPlaces(std::shared_ptr<const RobotMap> map, const OdometryChain& chain, PlaceIndexConfig config);
  /// The most similar one.
  [[nodiscard]] std::optional<LoopCandidate> most_similar(std::uint32_t k) const {
    return most_similar(k, map_->places[k]);
  }
  /// With another context than its own, as from another lane.
  [[nodiscard]] std::optional<LoopCandidate> most_similar(std::uint32_t k, const ScanContext& context) const;
  /// Places and others that look like them from one of the lanes, all along the way, each pair once.
  [[nodiscard]] std::vector<LoopCandidate> look_alikes(const Lanes& lanes) const;
  /// Of each keyframe the descriptor distance of the most similar other place; 1 where there is none.
  [[nodiscard]] std::vector<double> likeness() const;

 private:
  [[nodiscard]] bool is_elsewhere(std::uint32_t k, std::uint32_t other) const;

  std::shared_ptr<const RobotMap> map_;
  OdometryChain chain_;
  std::vector<double> way_;
  PlaceIndex index_;
};

/// How long tunnels agree that only look alike. The longer they have agreed, the likelier they go on: chance
/// resemblance ends soon, tunnels that were built alike do not. So the chance is a hazard rate that never
/// rises, of phases that double in length (Grenander, "On the theory of mortality measurement", 1956, with
/// the pooling of neighbours replaced by a prior from the phase before).
class LookAlikes {
 public:
  /// One that has agreed at `passed` distinctive places so far agreed at the next one, or differed.
  void add(std::size_t passed, bool went_on);
  /// Of each phase.
  [[nodiscard]] ChancesToGoOn chances() const;

 private:
  struct Phase {
    std::size_t num_steps = 0;
    std::size_t num_ended = 0;
  };
  std::array<Phase, std::tuple_size_v<ChancesToGoOn>> phases_;
};

/// What a robot has measured on its own map, to judge what it shares with others.
struct Measured {
  LookAlikes look_alikes;  ///< What became of places that only look alike, followed along the way.
  StandingShares walls;    ///< Of its own walls seen twice, and of those that only look alike.
};
/// The same each time it is asked; whoever asks first waits until it has been measured.
using MeasuredWhenAsked = std::function<const Measured&()>;

/// Each part is measured when it is first asked for; all together take some seconds of processor time.
class Discernment {
 public:
  using FindLookAlikes = std::function<std::vector<LoopCandidate>()>;
  /// `find_look_alikes` names places of the map and others of it that look like them, all along the way.
  Discernment(const std::shared_ptr<const RobotMap>& map, OdometryChain chain,
              FindLookAlikes find_look_alikes, std::shared_ptr<FeatureStore> features,
              const RegistrationConfig& registration, const DiscernmentConfig& config);

  /// A difference beyond this does not occur between scans of one place.
  [[nodiscard]] double limit() const { return limit_; }
  [[nodiscard]] bool differ(const Agreement& agreement) const {
    return !(agreement.largest_difference <= limit_);
  }
  [[nodiscard]] const Measured& measured();
  /// Metres along the way over which odometry leads to within half a metre, within 50 to 150: by how much its
  /// heading differs from that of the scans.
  [[nodiscard]] double reach_m();
  /// Of each of `indices`: whether a displacement along the way would show there.
  [[nodiscard]] std::vector<bool> distinctive(const std::vector<std::uint32_t>& indices);
  [[nodiscard]] SurfaceStore& surfaces() { return surfaces_; }

 private:
  struct Fit {
    std::uint32_t a;
    std::uint32_t b;
    Pose T_a_b;
  };
  struct Walk;
  [[nodiscard]] std::vector<LocalFit> fits(const std::vector<Fit>& asked, double enough, FitFrom from);
  [[nodiscard]] double usual_difference();
  [[nodiscard]] StandingOffsets compare_own_walls();
  [[nodiscard]] double measure_reach();
  [[nodiscard]] std::vector<Walk> walks_from(const std::vector<LoopCandidate>& similar) const;
  [[nodiscard]] std::optional<Walk> walk_from(const LoopCandidate& candidate) const;
  void follow(std::vector<Walk> walks, Measured& measured);
  /// So far along the walk; the two that are compared stand `apart` metres from one another.
  [[nodiscard]] std::optional<Fit> at(const Walk& walk, double way, double apart) const;
  /// Takes the place of what was fitted where scans differ, if they agree there.
  void look_again(const std::vector<Walk>& walks, const std::vector<std::size_t>& which,
                  std::vector<Fit>& fitted, std::vector<LocalFit>& found);

  static constexpr std::array<double, 3> kDistances = {0.5, 1.0, 2.0};  ///< Metres.
  RegistrationConfig registration_;
  DiscernmentConfig config_;
  OdometryChain chain_;
  std::vector<double> way_;
  FindLookAlikes find_look_alikes_;
  std::shared_ptr<FeatureStore> features_;
  SurfaceStore surfaces_;
  double limit_ = 0.0;
  std::optional<Measured> measured_;
  std::optional<double> reach_m_;
  std::map<std::uint32_t, bool> distinctive_;
};

}  // namespace adit
