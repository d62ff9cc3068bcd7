// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/voxel_grid.hpp"

#include <algorithm>
#include <bit>

namespace adit {
namespace {

// Thinned clouds seldom have more voxels than this; the table grows for those that do.
constexpr std::size_t kUsualVoxels = 1U << 14U;

// The first point of each voxel, as positions in `points`.
std::vector<std::uint32_t> first_in_voxel(std::span<const Eigen::Vector3f> points, double voxel_size) {
  const VoxelGrid grid(voxel_size);
  VoxelTable table(std::min(points.size(), kUsualVoxels));
  std::vector<std::uint32_t> kept;
  std::optional<VoxelKey> previous;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto key = grid.key_of(points[i]);
    if (!key || key == previous) continue;  // neighbours in a scan often share a voxel
    previous = key;
    if (!table.find_or_insert(*key, 0)) kept.push_back(i);
  }
  return kept;
}

template <class T>
std::vector<T> selected(std::span<const T> values, const std::vector<std::uint32_t>& indices) {
  std::vector<T> out;
  if (values.empty()) return out;
  out.reserve(indices.size());
  for (const std::uint32_t i : indices) out.push_back(values[i]);
  return out;
}

struct VoxelSum {
  Vector3 position = Vector3::Zero();
  double intensity = 0.0;
  double time = 0.0;
  double count = 0.0;
};

}  // namespace

VoxelTable::VoxelTable(std::size_t expected)
    : slots_(std::bit_ceil(std::max<std::size_t>(16, 2 * expected + 2))) {
  shift_ = 64U - static_cast<unsigned>(std::countr_zero(slots_.size()));
}

void VoxelTable::grow() {
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  --shift_;
  size_ = 0;
  for (const Slot& slot : old)
    if (slot.key != kEmpty) find_or_insert(slot.key, slot.number);
}

bool VoxelTable::erase(VoxelKey key) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t hole = home_of(key);
  while (slots_[hole].key != key) {
    if (slots_[hole].key == kEmpty) return false;
    hole = (hole + 1) & mask;
  }
  // Close the gap, so that no probe ends early and no tombstones gather: an entry moves back into the hole
  // unless its home lies behind the hole.
  for (std::size_t i = (hole + 1) & mask; slots_[i].key != kEmpty; i = (i + 1) & mask) {
    if (((i - home_of(slots_[i].key)) & mask) >= ((i - hole) & mask)) {
      slots_[hole] = slots_[i];
      hole = i;
    }
  }
  slots_[hole] = Slot{};
  --size_;
  return true;
}

PointCloud voxel_downsample(const PointCloud& cloud, double voxel_size) {
  cloud.check();
  const std::vector<std::uint32_t> kept = first_in_voxel(cloud.points, voxel_size);
  return {selected<Eigen::Vector3f>(cloud.points, kept), selected<float>(cloud.intensities, kept),
          selected<std::int32_t>(cloud.time_offsets_ns, kept)};
}

std::vector<Eigen::Vector3f> voxel_downsample(std::span<const Eigen::Vector3f> points, double voxel_size) {
  return selected(points, first_in_voxel(points, voxel_size));
}

PointCloud voxel_centroids(const PointCloud& cloud, double voxel_size) {
  cloud.check();
  const VoxelGrid grid(voxel_size);
  VoxelTable table(std::min(cloud.size(), kUsualVoxels));
  std::vector<VoxelSum> sums;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto key = grid.key_of(cloud.points[i]);
    if (!key) continue;
    const auto known = table.find_or_insert(*key, static_cast<std::uint32_t>(sums.size()));
    VoxelSum& sum = known ? sums[*known] : sums.emplace_back();
    sum.position += cloud.points[i].cast<double>();
    if (!cloud.intensities.empty()) sum.intensity += static_cast<double>(cloud.intensities[i]);
    if (cloud.has_times()) sum.time += static_cast<double>(cloud.time_offsets_ns[i]);
    sum.count += 1.0;
  }
  PointCloud out;
  for (const VoxelSum& sum : sums) {
    out.points.emplace_back((sum.position / sum.count).cast<float>());
    if (!cloud.intensities.empty()) out.intensities.push_back(static_cast<float>(sum.intensity / sum.count));
    if (cloud.has_times())
      out.time_offsets_ns.push_back(static_cast<std::int32_t>(std::lround(sum.time / sum.count)));
  }
  return out;
}

}  // namespace adit
