// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/point_cloud.hpp"
#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// The polar grid around the robot. Defaults: the paper of Scan Context (20 rings of 4 m, 60 sectors of 6
/// degrees).
struct ScanContextConfig {
  int num_rings = 20;
  int num_sectors = 60;
  double max_radius_m = 80.0;
  /// Added to each height, so that a cell with floor alone (z = 0 in the base frame) differs from an empty
  /// one and a falling floor stays positive. Points below -height_offset_m are left out.
  double height_offset_m = 2.0;
  /// Points higher above the horizon, seen from the sensor, are left out: 90 leaves out none. What only some
  /// sensors look up at would make one place look like two.
  double max_elevation_deg = 90.0;
};
/// The keys are the names of the fields.
inline Fields fields_of(ScanContextConfig& c) {
  return {{"num_rings", &c.num_rings, "", 1, 200, "rings of the polar grid"},
          {"num_sectors", &c.num_sectors, "", 3, 720, "sectors of the polar grid"},
          {"max_radius_m", &c.max_radius_m, "m", 1.0, 500.0, "outer radius; points beyond are left out"},
          {"height_offset_m", &c.height_offset_m, "m", 0.0, 20.0,
           "added to z, metres above the base frame's floor"},
          {"max_elevation_deg", &c.max_elevation_deg, "deg", 1.0, 90.0,
           "points higher above the sensor's horizon are left out; 90: none"}};
}

/// The appearance of a place: the greatest height in each cell of a polar grid around the robot. Made by
/// `describe`, `from_heights` or `decode`. Cells are kept as the unit vectors of the columns (sectors) and
/// the columns' norms, which is all that a comparison needs; `height` gives the cell back.
struct ScanContext {
  int num_rings = 0;                ///< 0: default-made.
  int num_sectors = 0;              ///< 0: default-made.
  std::vector<float> unit_columns;  ///< Sector by sector, `num_rings` cells each, nearest ring first.
  std::vector<float>
      norms;  ///< Of each sector's heights; 0: nothing seen there, and its unit column is zero.
  std::vector<float> ring_key;    ///< Mean height of each ring; does not change when the robot turns.
  std::vector<float> sector_key;  ///< Mean height of each sector; shifts when the robot turns.

  /// Metres above -height_offset_m; 0: empty.
  [[nodiscard]] float height(int ring, int sector) const;
  [[nodiscard]] bool empty() const;  ///< No cell was seen, or default-made.
};

/// The descriptor of a cloud in the base frame (x forward, z up, z = 0 on the floor). `viewpoint`: where
/// the sensor stood, base frame, metres; only `max_elevation_deg` below 90 needs it. Points that are not
/// finite, lie farther out than `max_radius_m`, below -`height_offset_m` or above `max_elevation_deg` are
/// left out. Sectors count from the x axis towards y; within rounding of a border a point falls to either
/// side. A cloud without points gives a context that is `empty()`. Throws ContractViolation when `config` is
/// out of its ranges. Source: Kim and Kim, "Scan Context", IROS 2018, section III-A.
[[nodiscard]] ScanContext describe(const PointCloud& cloud_base, const ScanContextConfig& config,
                                   const Vector3& viewpoint = Vector3::Zero());

/// From heights sector by sector (as `unit_columns` is laid out), 0 for empty cells. Throws ContractViolation
/// when the size does not fit or a height is negative or not finite.
[[nodiscard]] ScanContext from_heights(int num_rings, int num_sectors, std::span<const float> heights);

/// The distance of two contexts. T_match_query is about a turn by `yaw` about z.
struct ContextMatch {
  double distance =
      1.0;           ///< 1 - mean cosine over the sectors that both saw: 0 (same) to 1 (nothing in common).
  int shift = 0;     ///< Sector s of the query lies on sector (s + shift) mod num_sectors of the match.
  double yaw = 0.0;  ///< Heading of the query in the frame of the match: shift as an angle in (-pi, pi].
};

/// The distance at one shift, 0 to num_sectors - 1.
[[nodiscard]] double distance_at(const ScanContext& query, const ScanContext& match, int shift);

/// Aligns the sector keys over all shifts, then compares the columns at that shift and the 3 (a tenth of half
/// the sectors) to either side. Two contexts that share no sector have distance 1. Of equal distances the
/// smallest shift wins. Throws ContractViolation when the grids differ in size. Source: the same paper,
/// section III-B and III-C.
[[nodiscard]] ContextMatch compare(const ScanContext& query, const ScanContext& match);

/// A shift as an angle in (-pi, pi].
[[nodiscard]] double yaw_of_shift(int shift, int num_sectors);

/// One byte per cell (heights in steps of a 255th of the greatest), for messages: 1.2 kB with the default
/// grid. `decode` gives heights back to 0.2 % of the greatest. Errors: a truncated or malformed buffer.
[[nodiscard]] std::vector<std::uint8_t> encode(const ScanContext& context);
/// The context that `encode` was given, but for rounding; fails as said there.
[[nodiscard]] Result<ScanContext> decode(std::span<const std::uint8_t> bytes);

}  // namespace adit
