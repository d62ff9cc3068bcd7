// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/lidar_model.hpp"

namespace adit {
namespace {

LidarConfig ouster(const std::string& name, int beams, double half_field_deg) {
  LidarConfig c;
  c.name = name;
  c.beams = beams;
  c.elevation_min_deg = -half_field_deg;
  c.elevation_max_deg = half_field_deg;
  return c;
}

LidarConfig with_columns(LidarConfig c, int columns) {
  c.columns = columns;
  return c;
}

LidarConfig with_range(LidarConfig c, double min, double max) {
  c.range_min = min;
  c.range_max = max;
  return c;
}

// For which data sheets state a target of 10 %.
LidarConfig with_reach(LidarConfig c, double reach) {
  c.reach = reach;
  return c;
}

LidarConfig with_divergence(LidarConfig c, double degrees) {
  c.divergence_deg = degrees;
  return c;
}

LidarConfig with_noise(LidarConfig c, double near, double far) {
  c.noise_near = near;
  c.noise_far = far;
  return c;
}

LidarConfig vlp16() {
  LidarConfig c = ouster("vlp-16", 16, 15.0);
  c = with_noise(with_range(with_columns(c, 1800), 0.5, 100.0), 0.03, 0.03);
  return with_reach(with_divergence(c, 0.18), 50.0);  // not stated; half of its range, as of others
}

LidarConfig os1(const std::string& name, int beams) {
  const LidarConfig c = with_noise(with_range(ouster(name, beams, 22.5), 0.5, 120.0), 0.007, 0.05);
  return with_reach(with_divergence(c, 0.18), 90.0);
}

LidarConfig os1_64_front() {
  LidarConfig c = os1("os1-64-front", 64);
  c.azimuth_min_deg = -45.0;
  c.azimuth_max_deg = 45.0;
  return c;
}

LidarConfig os0() {
  const LidarConfig c = with_noise(with_range(ouster("os0-128", 128, 45.0), 0.3, 50.0), 0.008, 0.04);
  return with_reach(with_divergence(c, 0.35), 35.0);
}

LidarConfig livox(const std::string& name, LidarPattern pattern, int shots_per_column) {
  LidarConfig c;
  c.name = name;
  c.pattern = pattern;
  c.columns = 400;  // 0.25 ms each
  c.beams = shots_per_column;
  return with_divergence(with_noise(c, 0.02, 0.02), 0.15);  // 0.03 by 0.28: the model's beams are round
}

LidarConfig mid40() {
  LidarConfig c = livox("livox-mid-40", LidarPattern::rosette, 25);
  c.elevation_min_deg = -19.2;
  c.elevation_max_deg = 19.2;
  return with_reach(with_range(c, 1.0, 260.0), 90.0);
}

LidarConfig avia() {
  LidarConfig c = livox("livox-avia", LidarPattern::rosette, 60);
  c.elevation_min_deg = -36.0;
  c.elevation_max_deg = 36.0;
  return with_reach(with_range(c, 1.0, 320.0), 190.0);
}

LidarConfig mid360() {
  LidarConfig c = livox("livox-mid-360", LidarPattern::wave, 50);
  c.elevation_min_deg = -7.0;
  c.elevation_max_deg = 52.0;
  c.first_rpm = 1813.0;
  c.second_rpm = 11057.0;
  return with_reach(with_range(c, 0.1, 70.0), 40.0);
}

// Fields of view, ranges, range noise and divergence after the makers' data sheets.
std::vector<LidarConfig> presets() {
  return {ouster("os2-128", 128, 11.25),
          with_columns(ouster("os2-128-512", 128, 11.25), 512),
          with_columns(ouster("os2-128-2048", 128, 11.25), 2048),
          with_columns(ouster("os2-32", 32, 11.25), 512),
          os1("os1-64", 64),
          os1("os1-128", 128),
          os0(),
          vlp16(),
          os1_64_front(),
          mid40(),
          avia(),
          mid360()};
}

}  // namespace

std::vector<std::string> lidar_presets() {
  std::vector<std::string> names;
  for (const LidarConfig& preset : presets()) names.push_back(preset.name);
  return names;
}

Result<LidarConfig> lidar_preset(const std::string& name) {
  for (LidarConfig& preset : presets()) {
    if (preset.name == name) return preset;
  }
  std::string known;
  for (const std::string& preset : lidar_presets()) known += (known.empty() ? "" : ", ") + preset;
  return fail("unknown LiDAR '" + name + "'; known are " + known);
}

}  // namespace adit
