// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/keyframes/tunnel_filter.hpp"

#include <string>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/geometry/oriented_box.hpp"

namespace adit {
namespace {

void check_config(TunnelFilterConfig config) {
  const Result<> valid = check_fields(fields_of(config));
  ADIT_CHECK(valid.has_value(), valid.error().message.c_str());
}

std::vector<Eigen::Vector3f> cropped(const std::vector<Eigen::Vector3f>& points, double max_range) {
  const auto squared = static_cast<float>(max_range * max_range);
  std::vector<Eigen::Vector3f> near;
  near.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    if (p.squaredNorm() <= squared) near.push_back(p);
  }
  return near;
}

}  // namespace

Result<TunnelVerdict> tunnel_filter(const PointCloud& cloud_base, const TunnelFilterConfig& config) {
  check_config(config);
  const Result<OrientedBox> box = config.max_range_m > 0.0
                                      ? oriented_box(cropped(cloud_base.points, config.max_range_m))
                                      : oriented_box(cloud_base.points);
  if (!box) {
    const std::string limit =
        config.max_range_m > 0.0 ? format(" within {} m (max_range_m)", config.max_range_m) : "";
    return fail(format("tunnel filter of {} points{}", cloud_base.size(), limit), box.error());
  }
  return TunnelVerdict{box->extents, box->extents.y() < config.width_threshold_m};
}

}  // namespace adit
