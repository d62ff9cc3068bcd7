// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How well places can be told apart where a robot has been: measured on its own map, so that a merge is
/// judged by what this site and this sensor allow and by nothing that was tuned elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/fleet/keyframe_store.hpp"
#include "adit/place/place_index.hpp"
#include "adit/posegraph/pcm.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

struct DiscernmentConfig {
  int samples = 32;
  double spacing_m = 3.0;
  double displacement_m = 5.0;
  double allowance = 1.5;
};
inline Fields fields_of(DiscernmentConfig& c) {
  return {{"samples", &c.samples, "", 4, 10000, "places of its own map on which a robot measures"},
          {"spacing_m", &c.spacing_m, "m", 0.1, 1000.0, "way between two places where maps are compared"},
          {"displacement_m", &c.displacement_m, "m", 0.5, 1000.0,
           "a place is distinctive when scans this much farther along the way differ"},
          {"allowance", &c.allowance, "", 1.0, 100.0,
           "scans differ beyond this times what nine of ten pairs of scans of one place do"}};
}

/// Way driven up to each keyframe, metres.
[[nodiscard]] std::vector<double> way_along(const OdometryChain& chain);
/// The first keyframe after that way; none before the start and beyond the end.
[[nodiscard]] std::optional<std::uint32_t> keyframe_at(const std::vector<double>& way, double metres);

/// Which places of a map look like others that odometry keeps apart from them.
class OtherPlaces {
 public:
  OtherPlaces(std::shared_ptr<const RobotMap> map, const OdometryChain& chain, PlaceIndexConfig config);
  /// The most similar one.
  [[nodiscard]] std::optional<LoopCandidate> most_similar(std::uint32_t k) const;
  /// Of each keyframe the descriptor distance of the most similar other place; 1 where there is none.
  [[nodiscard]] std::vector<double> likeness() const;

 private:
  [[nodiscard]] bool is_elsewhere(std::uint32_t k, std::uint32_t other) const;

  std::shared_ptr<const RobotMap> map_;
  OdometryChain chain_;
  std::vector<double> way_;
  PlaceIndex index_;
};

/// Measured when it is made; some seconds of processor time.
class Discernment {
 public:
  Discernment(const std::shared_ptr<const RobotMap>& map, OdometryChain chain, const OtherPlaces& others,
              FeatureStore& features, const RegistrationConfig& registration,
              const DiscernmentConfig& config);

  /// A difference beyond this does not occur between scans of one place.
  [[nodiscard]] double limit() const { return limit_; }
  [[nodiscard]] bool differ(const Agreement& agreement) const {
    return !(agreement.largest_difference <= limit_);
  }
  /// Where two places of the map only look alike and agree at one distinctive place, the chance that they
  /// also agree at the next.
  [[nodiscard]] double chance_to_go_on() const;
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
  [[nodiscard]] std::vector<Agreement> fits(const std::vector<Fit>& asked, double enough, FitFrom from);
  [[nodiscard]] double usual_difference();
  [[nodiscard]] std::vector<Walk> look_alikes(const OtherPlaces& others, FeatureStore& features);
  void follow(std::vector<Walk> walks);

  static constexpr std::array<double, 3> kDistances = {0.5, 1.0, 2.0};  ///< Metres.
  RegistrationConfig registration_;
  DiscernmentConfig config_;
  OdometryChain chain_;
  std::vector<double> way_;
  SurfaceStore surfaces_;
  double limit_ = 0.0;
  std::size_t num_steps_ = 0;    ///< From one distinctive place to the next along look-alikes,
  std::size_t num_went_on_ = 0;  ///< and of these, those that ended in agreement.
  std::map<std::uint32_t, bool> distinctive_;
};

}  // namespace adit
