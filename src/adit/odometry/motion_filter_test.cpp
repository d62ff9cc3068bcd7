// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/motion_filter.hpp"

#include <gtest/gtest.h>

#include "adit/core/angles.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr Duration kScanPeriod = std::chrono::milliseconds(100);

Vector6 normal(Rng& rng, const Matrix6& covariance) {
  Vector6 out;
  for (int i = 0; i < 6; ++i) out[i] = std::sqrt(covariance(i, i)) * rng.normal();  // diagonal
  return out;
}

WheelDelta wheels(const Pose& T_base0_base1) {
  WheelDelta wheel;
  wheel.duration = kScanPeriod;
  wheel.T_base0_base1 = T_base0_base1;
  return wheel;
}

/// A filter with a clock.
class Filter : public MotionFilter {
 public:
  explicit Filter(const MotionNoise& motion = {}, const WheelNoise& wheels = {})
      : MotionFilter(motion, wheels, {}) {}
  void predict(Duration duration, const SensedMotion& motion = {}) {
    MotionFilter::predict(now_, now_ + duration, motion);
    if (motion.wheel) measure(*motion.wheel);
    now_ = now_ + duration;
  }

 private:
  Stamp now_;
};

SensedMotion sensed(const WheelDelta& wheel) {
  SensedMotion motion;
  motion.wheel = wheel;
  return motion;
}

TEST(WheelCovariance, IsThatOfADistributionEvenAtRest) {
  for (const Pose& motion : {Pose(), Pose::planar(0.2, 0.0, 0.05), Pose::translation_of(3.0, 0.0, 0.0)}) {
    const Matrix6 covariance = wheel_covariance({}, motion);
    EXPECT_TRUE(covariance.allFinite());
    EXPECT_TRUE(is_positive_definite(covariance));
  }
  const Matrix6 near = wheel_covariance({}, Pose::translation_of(0.1, 0, 0));
  const Matrix6 far = wheel_covariance({}, Pose::translation_of(1.0, 0, 0));
  for (int k = 0; k < 6; ++k) EXPECT_GT(far(k, k), near(k, k)) << k;
}

/// A robot whose twist is the random walk that the filter assumes, with wheels of the assumed noise and slip.
class Walk {
 public:
  Walk(std::uint64_t seed, const MotionNoise& motion, const WheelNoise& wheels)
      : rng_(seed),
        motion_(motion),
        wheels_(wheels),
        scale_(wheels.scale * rng_.normal()),
        yaw_(wheels.yaw_deg * kDegree * rng_.normal()),
        slip_(wheels.slip_that_lasts * rng_.normal()) {
    twist_ << 1.5, 0.0, 0.0, 0.0, 0.0, 0.2;
  }

  /// The next interval, in small steps.
  Pose moved() {
    constexpr int kSteps = 50;
    const double dt = to_seconds(kScanPeriod) / kSteps;
    Pose T;
    for (int i = 0; i < kSteps; ++i) {
      T = T * Pose::exp(dt * twist_);
      for (int k = 0; k < 6; ++k)
        twist_[k] += (k < 3 ? motion_.speed : motion_.turn_rate) * std::sqrt(dt) * rng_.normal();
    }
    return T;
  }
  WheelDelta wheels_of(const Pose& T_moved) {
    // T_moved = turned(scaled(wheels)) exp(noise): the wheels saw what is left without all of it.
    const Pose T_scaled = T_moved * Pose::exp(-normal(rng_, wheel_covariance(wheels_, T_moved)));
    const double kept = std::exp(-to_seconds(kScanPeriod) / wheels_.slip_time);
    slip_ = kept * slip_ + wheels_.slip_that_lasts * std::sqrt(1.0 - kept * kept) * rng_.normal();
    Matrix3 turned_and_scaled =
        Matrix3::Identity() * (1.0 + scale_ + slip_) + yaw_ * so3::hat(Vector3::UnitZ());
    return wheels({T_scaled.rotation(), turned_and_scaled.inverse() * T_scaled.translation()});
  }
  Pose measured(const Pose& T, const Matrix6& covariance) { return T * Pose::exp(normal(rng_, covariance)); }
  bool chance(double p) { return rng_.uniform() < p; }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] const Vector6& twist() const { return twist_; }

 private:
  Rng rng_;
  MotionNoise motion_;
  WheelNoise wheels_;
  double scale_;
  double yaw_;
  double slip_;
  Vector6 twist_;
};

/// Mean of e^T P^-1 e / 6 over many drives, of the prior before each scan; 1 where the covariance is true.
double mean_nees(bool with_wheels, double missing) {
  const MotionNoise motion{0.3, 0.3};
  const WheelNoise wheel_noise{
      .slip = 0.02, .climb = 0.05, .tilt_deg = 3.0, .scale = 0.03, .yaw_deg = 2.0, .slip_that_lasts = 0.05};
  Matrix6 of_a_scan = Matrix6::Identity() * 1e-4;
  of_a_scan.bottomRightCorner<3, 3>() *= 0.04;
  double sum = 0.0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Walk walk(seed, motion, wheel_noise);
    Filter filter(motion, wheel_noise);
    Pose T_ref_now;
    for (int i = 0; i < 60; ++i) {
      const Pose T_moved = walk.moved();
      T_ref_now = T_ref_now * T_moved;
      filter.predict(kScanPeriod,
                     with_wheels && !walk.chance(0.1) ? sensed(walk.wheels_of(T_moved)) : SensedMotion());
      const MotionPrior prior = filter.prior();
      if (i > 2) {
        const Vector6 error = (prior.T_ref_now.inverse() * T_ref_now).log();
        sum += error.dot(inverse(prior.covariance) * error) / 6.0;
        ++count;
      }
      if (walk.chance(missing)) {
        filter.missed();
        continue;
      }
      // The prior and a scan of known noise, fused as the odometry does it.
      const Pose T_scan = walk.measured(T_ref_now, of_a_scan);
      const Matrix6 posterior = inverse(Matrix6(inverse(prior.covariance) + inverse(of_a_scan)));
      const Vector6 off = (prior.T_ref_now.inverse() * T_scan).log();
      const Pose T_found = prior.T_ref_now * Pose::exp(posterior * inverse(of_a_scan) * off);
      filter.registered(T_found, posterior);
      // What is off from here on: where the prior decided, the scan takes the map along.
      const Matrix6 of_scan = posterior * inverse(of_a_scan);
      T_ref_now = Pose::exp(of_scan * (T_found.inverse() * T_ref_now).log());
    }
  }
  return sum / count;
}

TEST(MotionFilter, ItsCovarianceIsThatOfItsErrors) {
  EXPECT_NEAR(mean_nees(true, 0.0), 1.0, 0.2);
  EXPECT_NEAR(mean_nees(false, 0.0), 1.0, 0.2);
  EXPECT_NEAR(mean_nees(true, 0.4), 1.0, 0.2);
  EXPECT_NEAR(mean_nees(false, 0.4), 1.0, 0.2);
}

TEST(MotionFilter, KeepsTheVelocityWithoutWheels) {
  const Pose T_step = Pose::exp((Vector6() << 0.15, 0.0, 0.01, 0.0, 0.01, 0.03).finished());
  Filter filter;
  for (int i = 0; i < 20; ++i) {
    filter.predict(kScanPeriod);
    filter.registered(T_step, Matrix6::Identity() * 1e-6);
  }
  filter.predict(3 * kScanPeriod);  // two scans are missing
  EXPECT_LT((filter.T_last_now().inverse() * T_step * T_step * T_step).log().norm(), 0.005);
  EXPECT_LT((filter.prior().T_ref_now.inverse() * T_step * T_step * T_step).log().norm(), 0.005);
}

// A recorder that stalled: where the robot is after half a minute is not known, and that is said.
TEST(MotionFilter, AVelocityIsNotKeptForEver) {
  const Pose T_step = Pose::translation_of(0.1, 0, 0);
  Filter filter;
  for (int i = 0; i < 50; ++i) {
    filter.predict(kScanPeriod);
    filter.registered(T_step, Matrix6::Identity() * 1e-6);
  }
  filter.predict(std::chrono::seconds(30));
  const MotionPrior prior = filter.prior();
  EXPECT_NEAR(prior.T_ref_now.translation().x(), 2.0, 0.1);
  EXPECT_GT(std::sqrt(prior.covariance(0, 0)), 25.0);
}

TEST(MotionFilter, FindsTheScaleOfTheWheels) {
  Filter filter({}, {.scale = 0.1, .slip_that_lasts = 0.02});
  const double before = filter.wheel_scale_sigma();
  for (int i = 0; i < 200; ++i) {
    filter.predict(kScanPeriod, sensed(wheels(Pose::translation_of(0.15, 0, 0))));
    filter.registered(Pose::translation_of(0.15 * 1.05, 0, 0), Matrix6::Identity() * 1e-5);
  }
  EXPECT_NEAR(filter.wheel_scale(), 0.05, 0.005);
  EXPECT_LT(filter.wheel_scale_sigma(), 0.1 * before);
}

// Wheels that drive two degrees askew are followed there where scans have gone missing.
TEST(MotionFilter, FindsWhereTheWheelsDrive) {
  Filter filter({}, {.yaw_deg = 2.0});
  const Pose T_wheels = Pose::translation_of(0.15, 0, 0);
  const Pose T_true = Pose::planar(0, 0, 2.0 * kDegree) * T_wheels * Pose::planar(0, 0, -2.0 * kDegree);
  for (int i = 0; i < 200; ++i) {
    filter.predict(kScanPeriod, sensed(wheels(T_wheels)));
    filter.registered(T_true, Matrix6::Identity() * 1e-5);
  }
  for (int i = 0; i < 50; ++i) {
    filter.predict(kScanPeriod, sensed(wheels(T_wheels)));
    filter.missed();
  }
  filter.predict(kScanPeriod, sensed(wheels(T_wheels)));
  EXPECT_NEAR(filter.prior().T_ref_now.translation().y(), 51 * T_true.translation().y(), 0.02);
}

// Registration weighs each residual of a scan, though one in twenty is independent. A filter that is told so
// learns as one whose poses were found with the information that counts.
TEST(MotionFilter, LearnsNoMoreThanTheShareOfAScanThatCounts) {
  constexpr double kShare = 0.05;
  const WheelNoise noise{.scale = 0.05};
  Walk walk(3, {0.3, 0.3}, noise);
  Filter by_what_counts({0.3, 0.3}, noise);
  Filter by_all({0.3, 0.3}, noise);
  const Matrix6 of_a_scan = Matrix6::Identity() * 1e-4;
  for (int i = 0; i < 60; ++i) {
    const Pose T_moved = walk.moved();
    const SensedMotion motion = sensed(walk.wheels_of(T_moved));
    const Vector6 noise_of_scan = (T_moved.inverse() * walk.measured(T_moved, of_a_scan)).log();
    const auto register_scan = [&](Filter& filter, double share) {
      filter.predict(kScanPeriod, motion);
      const MotionPrior prior = filter.prior();
      const Matrix6 before = inverse(prior.covariance);
      const Matrix6 counted = inverse(of_a_scan);
      const Matrix6 weighed = counted / share;
      const Vector6 off = (prior.T_ref_now.inverse() * T_moved * Pose::exp(noise_of_scan)).log();
      const Vector6 step = inverse(Matrix6(before + weighed)) * weighed * off;
      filter.registered(prior.T_ref_now * Pose::exp(step), inverse(Matrix6(before + counted)),
                        Matrix6::Identity(), share);
    };
    register_scan(by_what_counts, 1.0);
    register_scan(by_all, kShare);
  }
  EXPECT_GT(std::abs(by_all.wheel_scale()), 0.01);
  EXPECT_NEAR(by_all.wheel_scale(), by_what_counts.wheel_scale(), 1e-6);
}

// Along a tube each scan leaves the prior as it was, and nothing is learnt about the wheels.
TEST(MotionFilter, WhatNoScanMeasuresStaysUnknown) {
  Filter filter;
  for (int i = 0; i < 200; ++i) {
    filter.predict(kScanPeriod, sensed(wheels(Pose::translation_of(0.15, 0, 0))));
    const MotionPrior prior = filter.prior();
    filter.registered(prior.T_ref_now, prior.covariance);
  }
  EXPECT_NEAR(filter.wheel_scale_sigma(), WheelNoise().scale, 0.1 * WheelNoise().scale);
  EXPECT_NEAR(filter.wheel_scale(), 0.0, 1e-3);
}

// Along a tube, where no scan measures the way ahead.
TEST(MotionFilter, WheelsThatSlipWeighLessUntilTheRestKnowsNoBetter) {
  Filter filter({.speed = 0.1});
  const auto drive = [&](double counted_m, int num) {
    for (int i = 0; i < num; ++i) {
      filter.predict(kScanPeriod, sensed(wheels(Pose::translation_of(counted_m, 0, 0))));
      const MotionPrior prior = filter.prior();
      filter.registered(prior.T_ref_now, prior.covariance);
    }
    filter.predict(kScanPeriod);
    return filter.prior().T_ref_now.translation().x();
  };
  EXPECT_NEAR(drive(0.15, 30), 0.15, 1e-3);
  EXPECT_LT(drive(0.21, 5), 0.185) << "half of the slip in half a second";
  EXPECT_NEAR(drive(0.21, 100), 0.21, 5e-3);
}

// A second of slip by 30 % is no error of the radius, and neither is slip to and fro. The derivative by the
// scale is the counted distance, which has that slip in it: were the scale corrected by wheels, a tenth of
// the way would be lost here.
TEST(MotionFilter, NoSlipIsTakenForTheScaleWhereScansLeaveTheWayOpen) {
  Filter filter({.speed = 0.1});
  Rng rng(5);
  double truth_m = 0.0;
  double driven_m = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double burst = i >= 1000 && i < 1010 ? 1.3 : 1.0;
    const double counted_m = 0.15 * burst * (1.0 + WheelNoise().slip * rng.normal());
    truth_m += 0.15;
    filter.predict(kScanPeriod, sensed(wheels(Pose::translation_of(counted_m, 0, 0))));
    const MotionPrior prior = filter.prior();
    driven_m += prior.T_ref_now.translation().x();
    filter.registered(prior.T_ref_now, prior.covariance);
  }
  EXPECT_NEAR(driven_m, truth_m, 0.005 * truth_m);
  EXPECT_EQ(filter.wheel_scale(), 0.0);
}

// Along a tube that scans leave open, what lasts counts: an error of the scale is the same in every step.
double open_variance(const WheelNoise& noise, int num_scans) {
  Filter filter({}, noise);
  Matrix6 onto_fixed = Matrix6::Identity();
  onto_fixed(0, 0) = 0.0;
  double variance = 0.0;
  for (int i = 0; i < num_scans; ++i) {
    filter.predict(kScanPeriod, sensed(wheels(Pose::translation_of(0.15, 0, 0))));
    const MotionPrior prior = filter.prior();
    Matrix6 posterior = Matrix6::Identity() * 1e-8;
    posterior(0, 0) = prior.covariance(0, 0);
    filter.registered(prior.T_ref_now, posterior, onto_fixed);
    variance += filter.open_drift()(0, 0);
  }
  return variance;
}

TEST(MotionFilter, ErrorsThatLastAddUpAlongOpenDirections) {
  // The first scans only tell how fast the robot is.
  const auto over = [](const WheelNoise& noise, int from, int to) {
    return open_variance(noise, to) - open_variance(noise, from);
  };
  const WheelNoise only_scale{.slip = 1e-4, .scale = 0.02, .slip_that_lasts = 0.0};
  const double metres = 0.15 * 200;
  EXPECT_NEAR(std::sqrt(open_variance(only_scale, 200)) / (0.02 * metres), 1.0, 0.15);
  const WheelNoise only_slip{.slip = 0.02, .scale = 0.0, .slip_that_lasts = 0.1};
  EXPECT_NEAR(over(only_slip, 100, 200) / open_variance(only_slip, 100), 1.0, 0.3);  // a random walk
}

TEST(MotionFilter, UncertaintyGrowsOverScansThatWereMissed) {
  Filter filter;
  for (int i = 0; i < 20; ++i) {
    filter.predict(kScanPeriod, sensed(wheels(Pose::translation_of(0.15, 0, 0))));
    if (i < 10) filter.registered(Pose::translation_of(0.15, 0, 0), Matrix6::Identity() * 1e-5);
    if (i >= 10 && i < 19) filter.missed();
  }
  const MotionPrior prior = filter.prior();
  EXPECT_NEAR(prior.T_ref_now.translation().x(), 1.5, 0.05);
  // Scale and slip of a metre and a half, at least.
  EXPECT_GT(std::sqrt(prior.covariance(0, 0)), 0.005);
  EXPECT_GT(prior.covariance(2, 2), 9.0 * wheel_covariance({}, Pose::translation_of(0.15, 0, 0))(0, 0));
}

TEST(MotionFilter, ARobotThatStandsIsKnownToStand) {
  Filter filter;
  for (int i = 0; i < 10; ++i) {
    filter.predict(kScanPeriod);
    filter.registered(Pose::translation_of(0.15, 0, 0), Matrix6::Identity() * 1e-5);
  }
  for (int i = 0; i < 5000; ++i) {
    filter.predict(kScanPeriod, sensed(wheels(Pose())));
    filter.stopped(Pose());
  }
  filter.predict(kScanPeriod);
  const MotionPrior prior = filter.prior();
  EXPECT_LT(prior.T_ref_now.log().norm(), 0.005);
  EXPECT_LT(prior.covariance.diagonal().maxCoeff(), 2e-3);  // of a start within a tenth of a second
}

TEST(MotionFilter, TimeMustPass) {
  Filter filter;
  EXPECT_THROW(filter.predict(Duration(0)), ContractViolation);
}

}  // namespace
}  // namespace adit
