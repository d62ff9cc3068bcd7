// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/robot_map_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/crc32.hpp"
#include "adit/io/stated_pose.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers stand in the file as they do in memory");

/// The last digit counts the layouts that there have been. A change of RobotMap raises it, and what layout 7
/// and later ones lack is then filled in, and what they have besides is passed over: sessions keep such
/// files.
///@{
constexpr std::string_view kMagic = "adit map 8\n";
constexpr std::string_view kMagicOf7 = "adit map 7\n";
static_assert(kMagic.size() == kMagicOf7.size());
///@}

/// Appends what `transfer` names.
class Writer {
 public:
  static constexpr bool kReads = false;
  template <class T>
  requires std::is_arithmetic_v<T>
  void number(const T& value) { raw(&value, sizeof(T)); }
  void raw(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Fills what `transfer` names. After the bytes have ended it fills nothing more and `ok` is false.
class Reader {
 public:
  static constexpr bool kReads = true;
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  requires std::is_arithmetic_v<T>
  void number(T& value) { raw(&value, sizeof(T)); }
  void raw(void* data, std::size_t size) {
    if (!ok_ || size > bytes_.size()) {
      ok_ = false;
      return;
    }
    if (size > 0) std::memcpy(data, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }
  /// Whether `count` items of at least `item_size` bytes may still come.
  [[nodiscard]] bool has(std::uint64_t count, std::size_t item_size) {
    ok_ = ok_ && count <= bytes_.size() / item_size;
    return ok_;
  }
  /// What was read makes no sense.
  void refuse() { ok_ = false; }
  [[nodiscard]] bool done() const { return ok_ && bytes_.empty(); }

 private:
  std::string_view bytes_;
  bool ok_ = true;
};

// One function a type describes its layout for both directions, so that reading and writing cannot differ.
// When it reads, `T` is mutable; when it writes, const.

template <class Archive, class Vector>
bool size_of_vector(Archive& archive, Vector& items, std::size_t item_size) {
  std::uint64_t count = items.size();
  archive.number(count);
  if constexpr (Archive::kReads) {
    if (!archive.has(count, item_size)) return false;
    items.resize(count);
  }
  return true;
}

/// Of a vector that is as long as the keyframes, which come before it. That many of them are in the file: a
/// count alone does not make the memory of more.
template <class Archive, class Map, class Vector>
bool size_of_each(Archive& archive, const Map& map, Vector& items) {
  std::uint64_t count = items.size();
  archive.number(count);
  if constexpr (Archive::kReads) {
    if (count != map.keyframes.size()) archive.refuse();
    if (!archive.has(count, 1)) return false;
    items.resize(count);
  }
  return true;
}

template <class Archive>
bool flag(Archive& archive, bool value) {
  std::uint8_t byte = value ? 1 : 0;
  archive.number(byte);
  if constexpr (Archive::kReads)
    if (byte > 1) archive.refuse();
  return byte == 1;
}

/// Vectors of what can be copied byte by byte.
template <class Archive, class Vector>
void plain_vector(Archive& archive, Vector& items) {
  constexpr std::size_t kSize = sizeof(typename Vector::value_type);
  if (size_of_vector(archive, items, kSize)) archive.raw(items.data(), kSize * items.size());
}

template <class Archive, class Text>
void text(Archive& archive, Text& characters) {
  if (size_of_vector(archive, characters, 1)) archive.raw(characters.data(), characters.size());
}

template <class Archive, class P>
void pose(Archive& archive, P& value) {
  Eigen::Quaterniond q = value.rotation();
  Vector3 t = value.translation();
  archive.raw(q.coeffs().data(), 4 * sizeof(double));
  archive.raw(t.data(), 3 * sizeof(double));
  if constexpr (Archive::kReads) {
    constexpr double kRounding = 1e-9;
    if (const Result<Pose> read = stated_pose(t, q, kRounding))
      value = *read;
    else
      archive.refuse();
  }
}

template <class Archive, class Points>
void cloud(Archive& archive, Points& value) {
  // Eigen's short vectors have no padding.
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  plain_vector(archive, value.points);
  plain_vector(archive, value.intensities);
  plain_vector(archive, value.time_offsets_ns);
}

template <class Archive, class Context>
void place(Archive& archive, Context& value) {
  archive.number(value.num_rings);
  archive.number(value.num_sectors);
  plain_vector(archive, value.unit_columns);
  plain_vector(archive, value.norms);
  plain_vector(archive, value.ring_key);
  plain_vector(archive, value.sector_key);
}

template <class Archive, class StampedPoses>
void trajectory(Archive& archive, StampedPoses& value) {
  if (!size_of_vector(archive, value, 8 * sizeof(double))) return;
  for (auto& entry : value) {
    archive.number(entry.stamp.ns);
    pose(archive, entry.T_world_body);
  }
}

template <class Archive, class K>
void keyframe(Archive& archive, K& value) {
  archive.number(value.stamp.ns);
  pose(archive, value.T_odom_base);
  PointCloud points;
  if constexpr (Archive::kReads) {
    cloud(archive, points);
    value.cloud = std::make_shared<const PointCloud>(std::move(points));
  } else {
    cloud(archive, *value.cloud);
  }
}

template <class Archive, class Config>
void scan_context_config(Archive& archive, Config& value) {
  archive.number(value.num_rings);
  archive.number(value.num_sectors);
  archive.number(value.max_radius_m);
  archive.number(value.height_offset_m);
  archive.number(value.max_elevation_deg);
}

/// A negative share is that of a scan that was not judged; files of before this was told have 0 there.
template <class Archive, class Share>
void share_if_judged(Archive& archive, Share& value) {
  constexpr float kNotJudged = -1.0F;
  float share = value.value_or(kNotJudged);
  archive.number(share);
  if constexpr (Archive::kReads) value = share < 0.0F ? std::nullopt : std::optional(share);
}

/// What the paper's filter said of each keyframe, which layout 7 has: it is found again from the clouds.
template <class Archive, class Map>
void pass_over_verdicts(Archive& archive, const Map& map) {
  std::vector<std::array<char, 3 * sizeof(double) + 1>> verdicts;  // extents and a flag
  if (size_of_each(archive, map, verdicts))
    for (auto& verdict : verdicts) archive.raw(verdict.data(), verdict.size());
}

template <class Archive, class Map>
void transfer(Archive& archive, Map& map, std::string_view magic) {
  archive.number(map.id.value);
  text(archive, map.name);
  trajectory(archive, map.odometry);
  plain_vector(archive, map.slips);
  plain_vector(archive, map.innovations);
  archive.number(map.num_degenerate);
  archive.number(map.num_refused);
  // Stamp, pose and three counts.
  if (size_of_vector(archive, map.keyframes, 11 * sizeof(double)))
    for (auto& entry : map.keyframes) keyframe(archive, entry);
  if (size_of_each(archive, map, map.step_covariances))
    for (auto& covariance : map.step_covariances) archive.raw(covariance.data(), sizeof(Matrix6));
  if (size_of_each(archive, map, map.pose_noise))
    for (auto& covariance : map.pose_noise) archive.raw(covariance.data(), sizeof(Matrix6));
  scan_context_config(archive, map.scan_context);
  if (size_of_each(archive, map, map.places))
    for (auto& entry : map.places) place(archive, entry);
  if (magic == kMagicOf7) pass_over_verdicts(archive, map);
  if (size_of_each(archive, map, map.searchable))
    for (std::size_t k = 0; k < map.searchable.size(); ++k) {
      const bool searchable = flag(archive, map.searchable[k]);
      if constexpr (Archive::kReads) map.searchable[k] = searchable;
    }
  if (size_of_each(archive, map, map.unconfirmed))
    for (auto& share : map.unconfirmed) share_if_judged(archive, share);
  archive.raw(map.viewpoint.data(), 3 * sizeof(double));
}

bool is_whole(const PointCloud& cloud) {
  const std::size_t n = cloud.points.size();
  return (cloud.intensities.empty() || cloud.intensities.size() == n) &&
         (cloud.time_offsets_ns.empty() || cloud.time_offsets_ns.size() == n);
}

bool are_finite(const std::vector<float>& values) {
  return std::ranges::all_of(values, [](float value) { return std::isfinite(value); });
}

bool is_whole(const ScanContext& place, const ScanContextConfig& config) {
  const auto rings = static_cast<std::size_t>(config.num_rings);
  const auto sectors = static_cast<std::size_t>(config.num_sectors);
  return place.num_rings == config.num_rings && place.num_sectors == config.num_sectors &&
         place.unit_columns.size() == rings * sectors && place.norms.size() == sectors &&
         place.ring_key.size() == rings && place.sector_key.size() == sectors &&
         are_finite(place.unit_columns) && are_finite(place.norms) && are_finite(place.ring_key) &&
         are_finite(place.sector_key);
}

/// The solver inverts the covariance of each step but the first.
bool is_usable(const Matrix6& step_covariance, std::size_t k) {
  return step_covariance.allFinite() && (k == 0 || is_positive_definite(step_covariance));
}

/// Far from overflow, and each after the one before.
template <class Stamped>
Result<> check_ascending(const std::vector<Stamped>& all, const char* things) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].stamp < Stamp{-kLargestStamp.ns} || all[i].stamp > kLargestStamp)
      return fail(format("{} {}: its stamp is out of range", things, i));
    if (i > 0 && all[i].stamp <= all[i - 1].stamp)
      return fail(format("{} {}: its stamp is not after that of the one before", things, i));
  }
  return {};
}

Result<> check_keyframe(const RobotMap& map, std::size_t k) {
  const PointCloud& cloud = *map.keyframes[k].cloud;
  const bool are_finite =
      std::ranges::all_of(cloud.points, [](const Eigen::Vector3f& p) { return p.allFinite(); });
  const std::array faults = {
      std::pair(!is_whole(cloud), "its cloud's arrays differ in length"),
      std::pair(!are_finite, "a point is not finite"),
      std::pair(!is_usable(map.step_covariances[k], k), "its step's covariance is not positive definite"),
      std::pair(!map.pose_noise[k].allFinite(), "its pose's noise is not finite"),
      std::pair(!is_whole(map.places[k], map.scan_context), "its place does not fit the grid of places"),
      std::pair(map.unconfirmed[k] && !(*map.unconfirmed[k] <= 1.0F),
                "its share of unconfirmed returns is no share")};
  for (const auto& [is_there, fault] : faults)
    if (is_there) return fail(format("keyframe {}: {}", k, fault));
  return {};
}

/// What RobotMap promises and its users rely on.
Result<> check_map(RobotMap& map) {
  if (const Result<> checked = check_fields(fields_of(map.scan_context)); !checked)
    return fail("scan_context", checked.error());
  if (const Result<> checked = check_ascending(map.odometry, "pose"); !checked) return checked;
  if (const Result<> checked = check_ascending(map.keyframes, "keyframe"); !checked) return checked;
  for (std::size_t k = 0; k < map.keyframes.size(); ++k)
    if (const Result<> checked = check_keyframe(map, k); !checked) return checked;
  if (!map.viewpoint.allFinite()) return fail("the position of the LiDAR is not finite");
  return {};
}

}  // namespace

std::string robot_map_bytes(const RobotMap& map) {
  Writer content;
  transfer(content, map, kMagic);
  const std::string plain = content.take();
  Writer file;
  file.raw(kMagic.data(), kMagic.size());
  file.number(static_cast<std::uint64_t>(plain.size()));
  file.number(crc32(plain));
  const std::string packed = compress_zstd(plain);
  file.raw(packed.data(), packed.size());
  return file.take();
}

Result<RobotMap> parse_robot_map(std::string_view bytes) {
  const std::string_view magic = bytes.substr(0, kMagic.size());
  if (magic != kMagic && magic != kMagicOf7)
    return fail("not a robot's map, or one of a later version of adit, or of one before layout 7");
  bytes.remove_prefix(kMagic.size());
  std::uint64_t size = 0;
  std::uint32_t sum = 0;
  constexpr std::size_t kHead = sizeof(size) + sizeof(sum);
  if (bytes.size() < kHead) return fail("the map ends early");
  Reader head(bytes.substr(0, kHead));
  head.number(size);
  head.number(sum);
  const Result<std::string> plain = decompress(bytes.substr(kHead), "zstd", size);
  if (!plain) return tl::unexpected(plain.error());
  if (crc32(*plain) != sum) return fail("the map is damaged; map the recording again");
  Reader content(*plain);
  RobotMap map;
  transfer(content, map, magic);
  if (!content.done()) return fail("the map is damaged; map the recording again");
  if (const Result<> checked = check_map(map); !checked)
    return fail(format("the map is damaged: {}; map the recording again", checked.error().message));
  for (std::size_t k = 0; k < map.keyframes.size(); ++k)
    map.keyframes[k].id = {map.id, static_cast<std::uint32_t>(k)};
  return map;
}

Result<> write_robot_map(const std::filesystem::path& path, const RobotMap& map) {
  return write_bytes(path, robot_map_bytes(map));
}

Result<RobotMap> read_robot_map(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<RobotMap> map = parse_robot_map(*bytes);
  if (!map) return fail(path.string(), map.error());
  return map;
}

}  // namespace adit
