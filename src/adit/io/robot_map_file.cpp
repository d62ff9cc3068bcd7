// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/robot_map_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "adit/core/decompositions.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/crc32.hpp"

namespace adit {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers stand in the file as they do in memory");

/// Its last digit counts the layouts that there have been. A change of RobotMap raises it, and what layout 7
/// and later ones lack is then filled in: sessions keep such files.
constexpr std::string_view kMagic = "adit map 7\n";

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
    if (q.coeffs().allFinite() && t.allFinite() && std::abs(q.norm() - 1.0) < kRounding)
      value = Pose(q, t);
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

template <class Archive, class Bits>
void bits(Archive& archive, Bits& value) {
  if (!size_of_vector(archive, value, 1)) return;
  for (std::size_t i = 0; i < value.size(); ++i) {
    std::uint8_t bit = value[i] ? 1 : 0;
    archive.number(bit);
    if constexpr (Archive::kReads) value[i] = bit != 0;
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

template <class Archive, class Map>
void transfer(Archive& archive, Map& map) {
  archive.number(map.id.value);
  text(archive, map.name);
  trajectory(archive, map.odometry);
  plain_vector(archive, map.slips);
  plain_vector(archive, map.innovations);
  archive.number(map.num_degenerate);
  archive.number(map.num_refused);
  if (size_of_vector(archive, map.keyframes, 8 * sizeof(double)))
    for (auto& entry : map.keyframes) keyframe(archive, entry);
  if (size_of_vector(archive, map.step_covariances, sizeof(Matrix6)))
    for (auto& covariance : map.step_covariances) archive.raw(covariance.data(), sizeof(Matrix6));
  if (size_of_vector(archive, map.pose_noise, sizeof(Matrix6)))
    for (auto& covariance : map.pose_noise) archive.raw(covariance.data(), sizeof(Matrix6));
  scan_context_config(archive, map.scan_context);
  if (size_of_vector(archive, map.places, 1))
    for (auto& entry : map.places) place(archive, entry);
  if (size_of_vector(archive, map.tunnel, 3 * sizeof(double)))
    for (auto& verdict : map.tunnel) {
      archive.raw(verdict.extents.data(), 3 * sizeof(double));
      archive.number(verdict.tunnel_like);
    }
  bits(archive, map.searchable);
  plain_vector(archive, map.unconfirmed);
  archive.raw(map.viewpoint.data(), 3 * sizeof(double));
}

bool is_whole(const PointCloud& cloud) {
  const std::size_t n = cloud.points.size();
  return (cloud.intensities.empty() || cloud.intensities.size() == n) &&
         (cloud.time_offsets_ns.empty() || cloud.time_offsets_ns.size() == n);
}

bool is_whole(const ScanContext& place, const ScanContextConfig& config) {
  const auto rings = static_cast<std::size_t>(config.num_rings);
  const auto sectors = static_cast<std::size_t>(config.num_sectors);
  return place.num_rings == config.num_rings && place.num_sectors == config.num_sectors &&
         place.unit_columns.size() == rings * sectors && place.norms.size() == sectors &&
         place.ring_key.size() == rings && place.sector_key.size() == sectors;
}

/// The solver inverts the covariance of each step but the first.
bool are_usable(const std::vector<Matrix6>& step_covariances) {
  for (std::size_t k = 1; k < step_covariances.size(); ++k)
    if (!step_covariances[k].allFinite() || !is_positive_definite(step_covariances[k])) return false;
  return true;
}

bool is_consistent(const RobotMap& map) {
  const std::size_t n = map.keyframes.size();
  return map.step_covariances.size() == n && map.pose_noise.size() == n && map.places.size() == n &&
         map.tunnel.size() == n && map.searchable.size() == n && map.unconfirmed.size() == n &&
         are_usable(map.step_covariances) &&
         std::ranges::all_of(map.places,
                             [&](const ScanContext& place) { return is_whole(place, map.scan_context); }) &&
         std::ranges::all_of(map.keyframes,
                             [](const Keyframe& keyframe) { return is_whole(*keyframe.cloud); });
}

}  // namespace

std::string robot_map_bytes(const RobotMap& map) {
  Writer content;
  transfer(content, map);
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
  if (!bytes.starts_with(kMagic))
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
  if (crc32(*plain) != sum) return fail("the map is damaged");
  Reader content(*plain);
  RobotMap map;
  transfer(content, map);
  if (!content.done() || !is_consistent(map)) return fail("the map is damaged");
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
