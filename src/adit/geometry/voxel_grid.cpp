// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/voxel_grid.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "adit/core/parallel.hpp"
#include "adit/core/simd.hpp"

namespace adit {
namespace {

// Thinned clouds seldom have more voxels than this; the table grows for those that do.
constexpr std::size_t kUsualVoxels = 1U << 14U;

// Points whose keys are made together, and points of a part of the parallel loop.
constexpr std::size_t kBlock = 512;
constexpr std::size_t kGrain = 32 * kBlock;
constexpr unsigned kRecentBits = 12;

// VoxelGrid::key_of for `n` points of three coordinates each, without a branch. Conversions to int see
// numbers within the limit only; NaN becomes the limit.
ADIT_WIDE_VECTORS void make_keys(const float* xyz, std::size_t n, float inverse, float limit,
                                 std::uint64_t* keys) {
  const auto biased = [limit](float cell) {
    cell = cell < limit ? cell : limit;
    cell = cell > -limit ? cell : -limit;
    const int truncated = static_cast<int>(cell);
    const int floor = truncated - static_cast<int>(static_cast<float>(truncated) > cell);
    return static_cast<std::uint32_t>(floor + (1 << 20));
  };
  for (std::size_t i = 0; i < n; ++i) {
    const float x = xyz[3 * i] * inverse;
    const float y = xyz[3 * i + 1] * inverse;
    const float z = xyz[3 * i + 2] * inverse;
    const std::uint32_t outside = static_cast<std::uint32_t>(!(std::abs(x) < limit)) |
                                  static_cast<std::uint32_t>(!(std::abs(y) < limit)) |
                                  static_cast<std::uint32_t>(!(std::abs(z) < limit));
    const std::uint32_t low = biased(x) | biased(y) << 21U;
    const std::uint32_t high = biased(y) >> 11U | biased(z) << 10U;
    keys[i] = std::uint64_t{low | (0U - outside)} | std::uint64_t{high | (0U - outside)} << 32U;
  }
}

template <class T>
std::vector<T> selected(std::span<const T> values, std::span<const std::uint32_t> indices) {
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

void VoxelGrid::keys_of(std::span<const Eigen::Vector3f> points, std::span<VoxelKey> keys) const {
  if (!points.empty()) make_keys(points.data()->data(), points.size(), inverse_, kLimit, &keys.data()->value);
}

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
    if (slot.key != VoxelKey::none()) find_or_insert(slot.key, slot.number);
}

bool VoxelTable::erase(VoxelKey key) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t hole = home_of(key);
  while (slots_[hole].key != key) {
    if (slots_[hole].key == VoxelKey::none()) return false;
    hole = (hole + 1) & mask;
  }
  // Close the gap, so that no probe ends early and no tombstones gather: an entry moves back into the hole
  // unless its home lies behind the hole.
  for (std::size_t i = (hole + 1) & mask; slots_[i].key != VoxelKey::none(); i = (i + 1) & mask) {
    if (((i - home_of(slots_[i].key)) & mask) >= ((i - hole) & mask)) {
      slots_[hole] = slots_[i];
      hole = i;
    }
  }
  slots_[hole] = Slot{};
  --size_;
  return true;
}

VoxelSet::VoxelSet(std::size_t expected)
    : slots_(std::bit_ceil(std::max<std::size_t>(16, 2 * expected + 2)), VoxelKey::none()) {
  shift_ = 64U - static_cast<unsigned>(std::countr_zero(slots_.size()));
}

void VoxelSet::clear() {
  std::ranges::fill(slots_, VoxelKey::none());
  size_ = 0;
}

void VoxelSet::grow() {
  std::vector<VoxelKey> old(2 * slots_.size(), VoxelKey::none());
  old.swap(slots_);
  --shift_;
  size_ = 0;
  for (const VoxelKey key : old)
    if (key != VoxelKey::none()) insert(key);
}

// In parallel, each part of the cloud drops points that are certainly not the first of their voxel; survivors
// are inserted serially, in cloud order.
std::span<const std::uint32_t> VoxelThinner::first_in_voxel(std::span<const Eigen::Vector3f> points,
                                                            double voxel_size) {
  const VoxelGrid grid(voxel_size);
  candidates_.resize(points.size());
  num_candidates_.resize((points.size() + kGrain - 1) / kGrain);
  parallel_for(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    num_candidates_[begin / kGrain] =
        find_candidates(grid, points.subspan(begin, end - begin), static_cast<std::uint32_t>(begin),
                        candidates_.data() + begin);
  });
  seen_.clear();
  first_.clear();
  for (std::size_t part = 0; part < num_candidates_.size(); ++part) {
    const Candidate* candidate = candidates_.data() + part * kGrain;
    for (std::size_t i = 0; i < num_candidates_[part]; ++i, ++candidate)
      if (candidate->key != VoxelKey::none() && seen_.insert(candidate->key))
        first_.push_back(candidate->index);
  }
  return first_;
}

// Neighbours in a scan often share a voxel, and so do points of successive rings: what is left are points
// whose voxel is neither that of the point before nor in `recent`. Where voxels change is chance, so there is
// no branch: each point is written down, and overwritten by the next unless it counts.
std::size_t VoxelThinner::find_candidates(const VoxelGrid& grid, std::span<const Eigen::Vector3f> points,
                                          std::uint32_t first_index, Candidate* candidates) {
  std::array<VoxelKey, kBlock + 1> keys;
  std::array<std::uint32_t, kBlock> changes;
  std::array<VoxelKey, 1U << kRecentBits> recent;
  recent.fill(VoxelKey::none());
  const Candidate* const begin = candidates;
  keys[0] = VoxelKey::none();
  for (std::size_t block = 0; block < points.size(); block += kBlock) {
    const std::size_t n = std::min(kBlock, points.size() - block);
    grid.keys_of(points.subspan(block, n), std::span(keys).subspan(1));
    std::size_t num_changes = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      changes[num_changes] = i;
      num_changes += keys[i + 1] != keys[i] ? 1U : 0U;
    }
    for (std::size_t k = 0; k < num_changes; ++k) {
      const VoxelKey key = keys[changes[k] + 1];
      VoxelKey& seen = recent[key.hash() >> (64U - kRecentBits)];
      *candidates = {key, first_index + static_cast<std::uint32_t>(block) + changes[k]};
      candidates += key != seen ? 1 : 0;
      seen = key;
    }
    keys[0] = keys[n];
  }
  return static_cast<std::size_t>(candidates - begin);
}

PointCloud voxel_downsample(const PointCloud& cloud, double voxel_size) {
  cloud.check();
  VoxelThinner thinner;
  const std::span<const std::uint32_t> kept = thinner.first_in_voxel(cloud.points, voxel_size);
  return {selected<Eigen::Vector3f>(cloud.points, kept), selected<float>(cloud.intensities, kept),
          selected<std::int32_t>(cloud.time_offsets_ns, kept)};
}

std::vector<Eigen::Vector3f> voxel_downsample(std::span<const Eigen::Vector3f> points, double voxel_size) {
  return selected(points, VoxelThinner().first_in_voxel(points, voxel_size));
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
