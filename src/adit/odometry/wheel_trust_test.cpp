// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/wheel_trust.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

constexpr double kScanStep = 0.15;  // metres from scan to scan

// Scans until the judgement is `slipping`, at most 50.
int scans_until(WheelTrust& trust, bool slipping, double counted_m, double driven_m, double sigma_m = 0.0) {
  for (int i = 1; i <= 50; ++i) {
    trust.compare(counted_m, driven_m, sigma_m);
    if (trust.are_slipping() == slipping) return i;
  }
  return 51;
}

TEST(WheelTrust, WheelsThatSlipAFewPerCentAreBelieved) {
  WheelTrust trust;
  EXPECT_EQ(scans_until(trust, true, 1.04 * kScanStep, kScanStep), 51);
  EXPECT_EQ(scans_until(trust, true, 0.0, 0.0), 51);
}

TEST(WheelTrust, ABurstIsFoundWithinHalfASecondAndItsEndToo) {
  for (const double slip : {0.35, 0.6, 1.0}) {
    WheelTrust trust;
    EXPECT_EQ(scans_until(trust, true, kScanStep, kScanStep), 51);
    EXPECT_LE(scans_until(trust, true, kScanStep, (1.0 - slip) * kScanStep), 5) << slip;
    EXPECT_LE(scans_until(trust, false, kScanStep, kScanStep), 20) << slip;
  }
}

TEST(WheelTrust, WhatIsNotKnownBetterThanByWheelsIsNoReasonToDoubtThem) {
  WheelTrust trust;
  EXPECT_LE(scans_until(trust, true, kScanStep, 0.5 * kScanStep, 0.005), 5);
  EXPECT_LE(scans_until(trust, false, kScanStep, 0.5 * kScanStep, 0.05), 5);
}

TEST(WheelTrust, ARobotThatIsCarriedIsFoundAtOnce) {
  WheelTrust trust;
  EXPECT_EQ(scans_until(trust, true, 0.0, 0.0), 51);
  EXPECT_LE(scans_until(trust, true, 0.0, 0.05), 2);
}

}  // namespace
}  // namespace adit
