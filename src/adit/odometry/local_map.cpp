// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/local_map.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "adit/core/vectors.hpp"

namespace adit {
namespace {

constexpr float kNowhere = std::numeric_limits<float>::infinity();

// Distances near a voxel's face are wrong by some roundings of the coordinate.
constexpr float kRounding = 5e-7F;

// Four floats, compared and added lane by lane. Not `using`: GCC 12 then drops the size.
typedef float Four __attribute__((vector_size(16), aligned(4), may_alias));  // NOLINT(modernize-use-using)
typedef std::int32_t FourInts __attribute__((vector_size(16)));              // NOLINT(modernize-use-using)

Four load(const float* x) { return *reinterpret_cast<const Four*>(x); }
Four min(Four a, Four b) { return a < b ? a : b; }
Four max(Four a, Four b) { return a < b ? b : a; }
Four all(float x) { return Four{x, x, x, x}; }
float sum(Four v) { return (v[0] + v[1]) + (v[2] + v[3]); }

// A block of points is a row of groups: four x, four y, four z.
constexpr std::size_t kGroup = 12;
std::size_t position_in_block(std::size_t point, std::size_t axis) {
  return point / 4 * kGroup + axis * 4 + point % 4;
}

struct Offsets {
  Four x, y, z;

  Offsets(const float* group, const Eigen::Vector3f& from)
      : x(load(group) - all(from.x())),
        y(load(group + 4) - all(from.y())),
        z(load(group + 8) - all(from.z())) {}
  [[nodiscard]] Four squared_norms() const { return x * x + y * y + z * z; }
};

struct NearestTwo {
  float first = kNowhere;
  float second = kNowhere;
};

// Smallest two squared distances from `q` to the points of a block.
NearestTwo nearest_two(const float* block, std::size_t num_points, const Eigen::Vector3f& q) {
  Four first = all(kNowhere);
  Four second = all(kNowhere);
  for (const float* group = block; group < block + num_points * kGroup / 4; group += kGroup) {
    const Four d2 = Offsets(group, q).squared_norms();
    second = min(second, max(first, d2));
    first = min(first, d2);
  }
  // The two halves with each other, then the two lanes that are left.
  const Four first_half = __builtin_shuffle(first, FourInts{2, 3, 0, 1});
  const Four second_half = __builtin_shuffle(second, FourInts{2, 3, 0, 1});
  second = min(min(second, second_half), max(first, first_half));
  first = min(first, first_half);
  return {std::min(first[0], first[1]), std::min({second[0], second[1], std::max(first[0], first[1])})};
}

// The point of a block at this squared distance from `q`.
Eigen::Vector3f point_at(const float* block, const Eigen::Vector3f& q, float d2) {
  std::size_t k = 0;
  while (true) {
    const FourInts here = Offsets(block + k * kGroup / 4, q).squared_norms() == d2;
    for (int lane = 0; lane < 4; ++lane, ++k)
      if (here[lane] != 0)
        return {block[position_in_block(k, 0)], block[position_in_block(k, 1)],
                block[position_in_block(k, 2)]};
  }
}

// out = T p for `n` points of three coordinates each.
ADIT_WIDE_VECTORS void transform(const Eigen::Matrix<double, 3, 4>& T, std::size_t n,
                                 const float* __restrict p, float* __restrict out) {
  const Eigen::Matrix<double, 3, 4> A = T;
  for (std::size_t i = 0; i < n; ++i) {
    const auto x = static_cast<double>(p[3 * i]);
    const auto y = static_cast<double>(p[3 * i + 1]);
    const auto z = static_cast<double>(p[3 * i + 2]);
    out[3 * i] = static_cast<float>(A(0, 0) * x + A(0, 1) * y + A(0, 2) * z + A(0, 3));
    out[3 * i + 1] = static_cast<float>(A(1, 0) * x + A(1, 1) * y + A(1, 2) * z + A(1, 3));
    out[3 * i + 2] = static_cast<float>(A(2, 0) * x + A(2, 1) * y + A(2, 2) * z + A(2, 3));
  }
}

// The three slabs of voxels along one axis around a query: its own, the nearer neighbour, the farther one;
// their offsets, and the squared distances to them.
struct Slabs {
  std::array<int, 3> offset;
  std::array<float, 3> gap2;
  float near;  // to the nearer neighbour

  // `to_lower`: from the lower face of the query's voxel to the query.
  Slabs(float to_lower, float size) {
    const float to_upper = size - to_lower;
    const bool lower_first = to_lower < to_upper;
    near = lower_first ? to_lower : to_upper;
    const float far = lower_first ? to_upper : to_lower;
    offset = {0, lower_first ? -1 : 1, lower_first ? 1 : -1};
    gap2 = {0.0F, near * near, far * far};
  }
};

}  // namespace

LocalMap::LocalMap(double voxel_size, int max_points_per_voxel)
    : grid_(voxel_size),
      max_points_per_voxel_(static_cast<std::uint32_t>(max_points_per_voxel)),
      min_squared_spacing_(static_cast<float>(voxel_size * voxel_size / max_points_per_voxel)),
      block_size_((max_points_per_voxel_ + 3U) / 4U * kGroup) {
  ADIT_CHECK(max_points_per_voxel > 0, "a map voxel holds at least one point");
}

std::size_t LocalMap::num_points() const {
  std::size_t sum = 0;
  for (const std::uint32_t n : num_points_) sum += n;
  return sum;
}

std::vector<Eigen::Vector3f> LocalMap::points() const {
  std::vector<Eigen::Vector3f> out;
  for (std::size_t i = 0; i < num_points_.size(); ++i)
    for (std::size_t k = 0; k < num_points_[i]; ++k)
      out.emplace_back(block(i)[position_in_block(k, 0)], block(i)[position_in_block(k, 1)],
                       block(i)[position_in_block(k, 2)]);
  return out;
}

void LocalMap::add(std::span<const Eigen::Vector3f> points_base, const Pose& T_map_base) {
  if (points_base.empty()) return;
  std::size_t n = points_base.size();
  new_points_.resize(n);
  new_keys_.resize(n);
  new_voxels_.resize(n);
  transform(T_map_base.matrix().topRows<3>(), n, points_base.data()->data(), new_points_.data()->data());
  grid_.keys_of(new_points_, new_keys_);
  // First all voxels, then all points: what comes next is then known and under way from memory.
  constexpr std::size_t kAhead = 8;
  for (std::size_t i = 0; i < n; ++i) {
    if (i + kAhead < n) table_.prefetch(new_keys_[i + kAhead]);
    if (new_keys_[i] != VoxelKey::none()) new_voxels_[i] = voxel_for(new_keys_[i]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (i + kAhead < n) __builtin_prefetch(block(new_voxels_[i + kAhead]));
    if (new_keys_[i] != VoxelKey::none()) add_point(new_points_[i], new_voxels_[i]);
  }
}

void LocalMap::add_point(const Eigen::Vector3f& point, std::uint32_t voxel) {
  std::uint32_t& num_points = num_points_[voxel];
  float* x = block(voxel);
  if (num_points >= max_points_per_voxel_ || nearest_two(x, num_points, point).first < min_squared_spacing_)
    return;
  if (num_points == 0) first_[voxel] = point;
  for (std::size_t axis = 0; axis < 3; ++axis)
    x[position_in_block(num_points, axis)] = point[static_cast<Eigen::Index>(axis)];
  ++num_points;
}

std::uint32_t LocalMap::voxel_for(VoxelKey key) {
  const auto next = free_.empty() ? static_cast<std::uint32_t>(keys_.size()) : free_.back();
  if (const auto known = table_.find_or_insert(key, next)) return *known;
  if (free_.empty()) {
    keys_.push_back(key);
    num_points_.push_back(0);
    first_.emplace_back();
    coordinates_.resize(coordinates_.size() + block_size_, kNowhere);
  } else {
    keys_[next] = key;
    free_.pop_back();
  }
  return next;
}

void LocalMap::remove_beyond(const Eigen::Vector3f& centre, double max_distance) {
  const auto max2 = static_cast<float>(max_distance * max_distance);
  for (std::uint32_t i = 0; i < first_.size(); ++i) {
    if (!((first_[i] - centre).squaredNorm() > max2)) continue;
    table_.erase(keys_[i]);
    num_points_[i] = 0;
    first_[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    std::fill_n(block(i), block_size_, kNowhere);
    free_.push_back(i);
  }
}

LocalMap::Found LocalMap::search(const Eigen::Vector3f& query, float max_distance, float margin) const {
  Found out;
  const auto key = grid_.key_of(query);
  if (!key) return out;
  const float size = grid_.voxel_size();
  const Eigen::Vector3f to_lower = query - key->indices().cast<float>() * size;
  const std::array<Slabs, 3> slabs = {Slabs(to_lower.x(), size), Slabs(to_lower.y(), size),
                                      Slabs(to_lower.z(), size)};
  float best2 = max_distance * max_distance;
  float limit2 = (max_distance + margin) * (max_distance + margin);
  float others2 = kNowhere;
  std::optional<std::uint32_t> best_voxel;
  // From near to far along each axis: where one voxel is out of the limit, so are those behind it.
  for (std::size_t z = 0; z < 3; ++z) {
    const float gap2_z = slabs[2].gap2[z];
    if (gap2_z >= limit2) {
      others2 = std::min(others2, gap2_z);
      break;
    }
    for (std::size_t y = 0; y < 3; ++y) {
      const float gap2_yz = slabs[1].gap2[y] + gap2_z;
      if (gap2_yz >= limit2) {
        others2 = std::min(others2, gap2_yz);
        break;
      }
      for (std::size_t x = 0; x < 3; ++x) {
        const float gap2 = slabs[0].gap2[x] + gap2_yz;
        if (gap2 >= limit2) {
          others2 = std::min(others2, gap2);
          break;
        }
        const auto voxel =
            table_.find(key->shifted(slabs[0].offset[x], slabs[1].offset[y], slabs[2].offset[z]));
        if (!voxel) continue;
        const NearestTwo two = nearest_two(block(*voxel), num_points_[*voxel], query);
        if (two.first < best2) {
          if (best_voxel) others2 = std::min(others2, best2);
          others2 = std::min(others2, two.second);
          best2 = two.first;
          best_voxel = voxel;
          const float limit = std::sqrt(best2) + margin;
          limit2 = limit * limit;
        } else {
          others2 = std::min(others2, two.first);
        }
      }
    }
  }
  if (best_voxel) out.nearest = {point_at(block(*best_voxel), query, best2), best2};
  // Beyond the neighbourhood nothing is nearer than its border, wherever the query goes. That settles it
  // where the nearest point is within; else the query must stay in its voxel.
  const float rounding = kRounding * query.cwiseAbs().maxCoeff();
  const float to_face = std::min({slabs[0].near, slabs[1].near, slabs[2].near});
  out.clearance = std::sqrt(others2) - rounding;
  out.room = kNowhere;
  if (out.clearance > size + to_face - rounding) {
    if (best2 < size * size)
      out.clearance = size + to_face - rounding;
    else
      out.room = to_face - rounding;
  }
  return out;
}

LocalMap::Moments LocalMap::moments_within(const Eigen::Vector3f& centre, float radius) const {
  const auto key = grid_.key_of(centre);
  if (!key) return {};
  Four count = {};
  Four sums[3] = {};
  Four squares[6] = {};
  for (int i = 0; i < 27; ++i) {
    const auto voxel = table_.find(key->shifted(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
    if (!voxel) continue;
    const float* end = block(*voxel) + num_points_[*voxel] * kGroup / 4;
    for (const float* group = block(*voxel); group < end; group += kGroup) {
      const Offsets offset(group, centre);
      const FourInts within = offset.squared_norms() < radius * radius;
      // Unused places: infinity times 0 would not be 0.
      const Four x = within ? offset.x : all(0.0F);
      const Four y = within ? offset.y : all(0.0F);
      const Four z = within ? offset.z : all(0.0F);
      count += within ? all(1.0F) : all(0.0F);
      sums[0] += x;
      sums[1] += y;
      sums[2] += z;
      squares[0] += x * x;
      squares[1] += x * y;
      squares[2] += x * z;
      squares[3] += y * y;
      squares[4] += y * z;
      squares[5] += z * z;
    }
  }
  Moments out;
  out.count = static_cast<int>(sum(count));
  out.sum = {sum(sums[0]), sum(sums[1]), sum(sums[2])};
  out.squares << sum(squares[0]), sum(squares[1]), sum(squares[2]),  //
      sum(squares[1]), sum(squares[3]), sum(squares[4]),             //
      sum(squares[2]), sum(squares[4]), sum(squares[5]);
  return out;
}

}  // namespace adit
