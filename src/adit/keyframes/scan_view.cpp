// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/keyframes/scan_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/parallel.hpp"

namespace adit {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::size_t kGrain = 2048;
constexpr int kEnoughOthers = 12;
constexpr int kDoublings = 2;
constexpr std::size_t kSamples = 256;  // of the returns, for the typical number in a window
constexpr auto kNowhere = std::numeric_limits<std::uint32_t>::max();

// To 1e-4 rad, a two hundredth of the narrowest window: a minimax polynomial of atan on [0, 1], extended to
// the full turn. An arc tangent of the library takes four times as long.
float arc_tangent(float y, float x) {
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float longer = std::max(std::max(ax, ay), std::numeric_limits<float>::min());
  const float t = std::min(ax, ay) / longer;
  const float u = t * t;
  float angle = ((-0.0464964749F * u + 0.15931422F) * u - 0.327622764F) * u * t + t;
  angle = ay > ax ? 0.5F * kPi - angle : angle;
  angle = x < 0.0F ? kPi - angle : angle;
  return y < 0.0F ? -angle : angle;
}

std::size_t num_rows(float window) { return static_cast<std::size_t>(kPi / window) + 1; }

// Row by row upwards.
std::size_t cell_of(float azimuth, float elevation, float window, std::size_t num_columns) {
  const float columns_per_radian = static_cast<float>(num_columns) / (2.0F * kPi);
  const auto row = static_cast<std::size_t>(std::max(elevation + 0.5F * kPi, 0.0F) / window);
  const auto column = static_cast<std::size_t>(std::max(azimuth + kPi, 0.0F) * columns_per_radian);
  return std::min(row, num_rows(window) - 1) * num_columns + std::min(column, num_columns - 1);
}

std::int64_t floor_of(float x) { return static_cast<std::int64_t>(std::floor(x)); }

}  // namespace

Fields fields_of(ConfirmConfig& c) {
  return {{"window_deg", &c.window_deg, "deg", 0.05, 10.0,
           "returns no farther from a direction, sideways and upwards, are its neighbours"},
          {"farther", &c.farther, "", 0.001, 1.0,
           "neighbours confirm a return where they are farther by at most this share of its range"},
          {"nearer", &c.nearer, "", 0.0, 1.0, "and at least this share of its range away"},
          {"min_neighbours", &c.min_neighbours, "", 0, 100,
           "fewer do not confirm it; 0 with min_share = 0: all returns are believed"},
          {"min_share", &c.min_share, "", 0.0, 1.0, "a smaller share of all neighbours does not confirm it"},
          {"clear_m", &c.clear_m, "m", 0.01, 1000.0,
           "a place is looked through where all rays about it end this much farther"},
          {"clear_share", &c.clear_share, "", 0.0, 1.0, "and farther by this share of the range"}};
}

ScanView::ScanView(std::span<const Eigen::Vector3f> points, const Vector3& viewpoint,
                   const ConfirmConfig& config)
    : config_(config), viewpoint_(viewpoint.cast<float>()), num_points_(points.size()) {
  const Result<> valid = check_fields(fields_of(config_));
  ADIT_CHECK(valid.has_value(), valid ? "" : valid.error().message.c_str());
  std::vector<Direction> directions(points.size());
  parallel_for_each(
      points.size(), [&](std::size_t i) { directions[i] = direction_of(points[i]); }, kGrain);
  float window = static_cast<float>(config_.window_deg * kDegree);
  for (int doublings = 0; doublings <= kDoublings && !is_dense_; ++doublings, window *= 2.0F) {
    sort_by_cell(window, directions);
    is_dense_ = has_enough_others();
  }
}

double ScanView::window_deg() const { return window_ / kDegree; }

ScanView::Direction ScanView::direction_of(const Eigen::Vector3f& point) const {
  const Eigen::Vector3f ray = point - viewpoint_;
  const float across = std::sqrt(ray.x() * ray.x() + ray.y() * ray.y());
  return {arc_tangent(ray.y(), ray.x()), arc_tangent(ray.z(), across), ray.norm()};
}

// Cells have the window's height, and its width or a little more.
void ScanView::sort_by_cell(float window, std::span<const Direction> directions) {
  window_ = window;
  num_columns_ = static_cast<std::size_t>(std::max(1.0F, std::floor(2.0F * kPi / window)));
  std::vector<std::uint32_t> cells(directions.size(), kNowhere);
  begins_.assign(num_rows(window) * num_columns_ + 1, 0);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Direction& d = directions[i];
    if (!(d.range > 0.0F && d.range <= std::numeric_limits<float>::max())) continue;
    cells[i] = static_cast<std::uint32_t>(cell_of(d.azimuth, d.elevation, window, num_columns_));
    ++begins_[cells[i] + 1];
  }
  for (std::size_t cell = 1; cell < begins_.size(); ++cell) begins_[cell] += begins_[cell - 1];
  const std::size_t size = begins_.back();
  for (std::vector<float>* values : {&azimuths_, &elevations_, &ranges_}) values->resize(size);
  indices_.resize(size);
  std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (cells[i] == kNowhere) continue;
    const std::uint32_t slot = next[cells[i]]++;
    azimuths_[slot] = directions[i].azimuth;
    elevations_[slot] = directions[i].elevation;
    ranges_[slot] = directions[i].range;
    indices_[slot] = static_cast<std::uint32_t>(i);
  }
}

// `visit(begin, end, azimuth)`: stretches of returns that hold all in the window, and the azimuth of its
// middle as it counts there (beyond the seam it is a turn more or less); until it returns false.
template <class Visit>
void ScanView::visit_around(const Direction& direction, float half_height, const Visit& visit) const {
  const auto columns = static_cast<std::int64_t>(num_columns_);
  const auto last_row = static_cast<std::int64_t>((begins_.size() - 1) / num_columns_) - 1;
  const float columns_per_radian = static_cast<float>(num_columns_) / (2.0F * kPi);
  const float half_width = std::min(window_ / std::max(std::cos(direction.elevation), 1e-6F), kPi);
  const float from_left = direction.azimuth + kPi;
  const std::int64_t first = floor_of((from_left - half_width) * columns_per_radian);
  const std::int64_t last =
      std::min(floor_of((from_left + half_width) * columns_per_radian), first + columns - 1);
  const float from_below = direction.elevation + 0.5F * kPi;
  const std::int64_t bottom = std::max<std::int64_t>(floor_of((from_below - half_height) / window_), 0);
  const std::int64_t top = std::min(floor_of((from_below + half_height) / window_), last_row);
  for (std::int64_t row = bottom; row <= top; ++row) {
    const auto stretch = [&](std::int64_t from, std::int64_t to, float turns) {
      if (from > to) return true;
      const auto at = static_cast<std::size_t>(row * columns);
      return visit(begins_[at + static_cast<std::size_t>(from)],
                   begins_[at + static_cast<std::size_t>(to) + 1], direction.azimuth + 2.0F * kPi * turns);
    };
    const bool goes_on = stretch(std::max<std::int64_t>(first, 0), std::min(last, columns - 1), 0.0F) &&
                         stretch(first + columns, first < 0 ? columns - 1 : -1, 1.0F) &&
                         stretch(0, last - columns, -1.0F);
    if (!goes_on) return;
  }
}

// The return itself counts, once, in both.
ScanView::Counts ScanView::counts_at(const Direction& direction) const {
  const float half_width = std::min(window_ / std::max(std::cos(direction.elevation), 1e-6F), kPi);
  const float nearest = static_cast<float>(config_.nearer) * direction.range;
  const float farthest = static_cast<float>(1.0 + config_.farther) * direction.range;
  Counts counts{-1, -1};
  visit_around(direction, window_, [&](std::uint32_t begin, std::uint32_t end, float azimuth) {
    int others = 0;
    int similar = 0;
    for (std::uint32_t k = begin; k < end; ++k) {
      const int inside = static_cast<int>(std::abs(azimuths_[k] - azimuth) <= half_width) &
                         static_cast<int>(std::abs(elevations_[k] - direction.elevation) <= window_);
      others += inside;
      similar += inside & static_cast<int>(ranges_[k] >= nearest) & static_cast<int>(ranges_[k] <= farthest);
    }
    counts.others += others;
    counts.similar += similar;
    return true;
  });
  return counts;
}

bool ScanView::has_enough_others() const {
  const std::size_t step = std::max<std::size_t>(ranges_.size() / kSamples, 1);
  std::size_t num = 0;
  std::size_t enough = 0;
  for (std::size_t k = 0; k < ranges_.size(); k += step, ++num)
    enough += counts_at({azimuths_[k], elevations_[k], ranges_[k]}).others >= kEnoughOthers ? 1 : 0;
  return 2 * enough > num;
}

std::vector<std::uint8_t> ScanView::confirmed_by_neighbours() const {
  std::vector<std::uint8_t> flags(num_points_, 0);
  parallel_for_each(
      ranges_.size(),
      [&](std::size_t k) {
        const Counts counts = is_dense_ ? counts_at({azimuths_[k], elevations_[k], ranges_[k]}) : Counts{};
        flags[indices_[k]] = !is_dense_ || (counts.similar >= config_.min_neighbours &&
                                            counts.similar >= config_.min_share * counts.others)
                                 ? 1
                                 : 0;
      },
      kGrain);
  return flags;
}

void ScanView::keep(std::span<const std::uint8_t> flags) {
  ADIT_CHECK(flags.size() == num_points_, "one flag per point");
  for (std::size_t k = 0; k < ranges_.size(); ++k)
    if (flags[indices_[k]] == 0) ranges_[k] = std::numeric_limits<float>::quiet_NaN();
}

bool ScanView::looks_through(const Eigen::Vector3f& point) const {
  const Direction d = direction_of(point);
  if (!is_dense_ || !(d.range > 0.0F && d.range <= std::numeric_limits<float>::max())) return false;
  const float clear = d.range + static_cast<float>(config_.clear_m + config_.clear_share * d.range);
  // All of the place's own cell lies in the window: nearly every place is decided here.
  const std::size_t cell = cell_of(d.azimuth, d.elevation, window_, num_columns_);
  for (std::uint32_t k = begins_[cell]; k < begins_[cell + 1]; ++k)
    if (ranges_[k] <= clear) return false;
  const float half_width = std::min(window_ / std::max(std::cos(d.elevation), 1e-6F), kPi);
  const float half_height = 2.0F * window_;
  bool left = false;
  bool right = false;
  bool above = false;
  bool below = false;
  bool is_clear = true;
  visit_around(d, half_height, [&](std::uint32_t begin, std::uint32_t end, float azimuth) {
    for (std::uint32_t k = begin; k < end && is_clear; ++k) {
      const float aside = azimuths_[k] - azimuth;
      const float up = elevations_[k] - d.elevation;
      if (std::abs(aside) > half_width || std::abs(up) > half_height || std::isnan(ranges_[k])) continue;
      is_clear = ranges_[k] > clear;
      left = left || aside >= 0.0F;
      right = right || aside <= 0.0F;
      above = above || up >= 0.0F;
      below = below || up <= 0.0F;
    }
    return is_clear;
  });
  return is_clear && left && right && above && below;
}

PointCloud only(const PointCloud& cloud, std::span<const std::uint8_t> flags) {
  ADIT_CHECK(flags.size() == cloud.size(), "one flag per point");
  cloud.check();
  PointCloud out;
  out.points.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (flags[i] == 0) continue;
    out.points.push_back(cloud.points[i]);
    if (!cloud.intensities.empty()) out.intensities.push_back(cloud.intensities[i]);
    if (cloud.has_times()) out.time_offsets_ns.push_back(cloud.time_offsets_ns[i]);
  }
  return out;
}

}  // namespace adit
