// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/motion_growth.hpp"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr std::ptrdiff_t kMostShift = 25;  // grid steps: half a second
constexpr double kCurves = 0.03;           // rad/s: with less turning there is nothing to compare
constexpr double kClearly = 0.7;           // correlation

/// Of both at the same stamps.
struct Rates {
  std::vector<double> a;
  std::vector<double> b;
};

Rates rates_on_grid(const Growth& a, const Growth& b, Duration half_window) {
  Rates rates;
  const Stamp end = std::min(a.end(), b.end());
  for (Stamp stamp = std::max(a.begin(), b.begin()); stamp <= end; stamp = stamp + kRateGrid) {
    if (const Stamp next = beyond_gap(a, b, stamp); next != stamp) {
      // As many as a shift of clocks may bridge: what was before a gap is not compared with what came after.
      rates.a.insert(rates.a.end(), kMostShift, Growth::kNothing);
      rates.b.insert(rates.b.end(), kMostShift, Growth::kNothing);
      stamp = next;
    }
    rates.a.push_back(a.rate(stamp, half_window));
    rates.b.push_back(b.rate(stamp, half_window));
  }
  return rates;
}

}  // namespace

void Growth::add(Stamp stamp, double value) {
  const std::size_t piece = pieces_.empty() ? 0 : pieces_.back();
  pieces_.push_back(std::isnan(value) ? piece + 1 : piece);
  stamps_.push_back(stamp);
  values_.push_back(value);
}

Growth::Value Growth::find(Stamp stamp) const {
  const auto after = std::ranges::lower_bound(stamps_, stamp);
  if (after == stamps_.end() || (after == stamps_.begin() && *after != stamp)) return {};
  const auto i = static_cast<std::size_t>(after - stamps_.begin());
  if (*after == stamp) return {values_[i], pieces_[i]};
  const Duration gap = stamps_[i] - stamps_[i - 1];
  if (gap > longest_gap_) return {};
  return {
      values_[i - 1] + (values_[i] - values_[i - 1]) * to_seconds(stamp - stamps_[i - 1]) / to_seconds(gap),
      pieces_[i]};
}

Stamp Growth::resumes(Stamp stamp) const {
  const auto after = std::ranges::upper_bound(stamps_, stamp);
  if (after == stamps_.begin() || after == stamps_.end() || *after - *(after - 1) <= longest_gap_)
    return stamp;
  return *after;
}

double Growth::rate(Stamp stamp, Duration half) const {
  const Value before = find(stamp - half);
  const Value after = find(stamp + half);
  if (before.piece != after.piece) return kNothing;
  return (after.value - before.value) / (2.0 * to_seconds(half));
}

Growths growths_of(const Trajectory& wheel) {
  Growths out;
  out.turn.add(wheel.front().stamp, 0.0);
  out.forward.add(wheel.front().stamp, 0.0);
  for (std::size_t i = 1; i < wheel.size(); ++i) {
    const Pose step = wheel[i - 1].T_world_body.inverse() * wheel[i].T_world_body;
    out.turn.add(wheel[i].stamp, out.turn.last() + step.yaw());
    out.forward.add(wheel[i].stamp, out.forward.last() + step.translation().x());
  }
  return out;
}

Regression regress(const std::vector<double>& x, const std::vector<double>& y, std::ptrdiff_t shift) {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::ptrdiff_t k = static_cast<std::ptrdiff_t>(i) + shift;
    if (k < 0 || k >= static_cast<std::ptrdiff_t>(y.size())) continue;
    const double a = x[i];
    const double b = y[static_cast<std::size_t>(k)];
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    n += 1.0, sx += a, sy += b, sxx += a * a, sxy += a * b, syy += b * b;
  }
  if (n < 2.0) return {};
  const double vx = sxx / n - sx * sx / (n * n);
  const double vy = syy / n - sy * sy / (n * n);
  const double c = sxy / n - sx * sy / (n * n);
  if (vx <= 0.0 || vy <= 0.0) return {};
  return {static_cast<std::size_t>(n), c / std::sqrt(vx * vy), c / vx, std::sqrt(vx)};
}

bool TurnComparison::has_curves() const { return best.num >= num_enough && best.sigma >= kCurves; }

bool TurnComparison::agrees() const { return has_curves() && std::abs(best.correlation) >= kClearly; }

Stamp beyond_gap(const Growth& a, const Growth& b, Stamp stamp) {
  const Stamp next = std::max(a.resumes(stamp), b.resumes(stamp));
  return next - stamp > std::chrono::seconds(1) ? next : stamp;
}

TurnComparison compare_turns(const Growth& wheels, const Growth& other, Duration half_window) {
  const Rates rates = rates_on_grid(wheels, other, half_window);
  const auto compared = [&](std::ptrdiff_t shift) { return regress(rates.a, rates.b, shift); };
  const auto strength = [&](std::ptrdiff_t shift) { return std::abs(compared(shift).correlation); };
  std::ptrdiff_t at = 0;
  for (std::ptrdiff_t shift = -kMostShift; shift <= kMostShift; ++shift)
    if (strength(shift) > strength(at) + 1e-12) at = shift;
  TurnComparison out;
  out.best = compared(at);
  // The vertex of the parabola through the best shift and its neighbours.
  const double before = strength(at - 1);
  const double after = strength(at + 1);
  const double bend = before - 2.0 * strength(at) + after;
  const double beyond = bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
  out.late_s = -(static_cast<double>(at) + beyond) * to_seconds(kRateGrid);
  out.unexplained = (1.0 - std::pow(strength(at), 2)) / std::max(1e-12, 1.0 - std::pow(strength(0), 2));
  return out;
}

}  // namespace adit
