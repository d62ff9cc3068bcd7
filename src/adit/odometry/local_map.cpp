// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/local_map.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "adit/core/simd.hpp"

namespace adit {
namespace {

constexpr float kInfinitelyFar = std::numeric_limits<float>::infinity();

// Error of distances near a voxel's face, as a share of the coordinate: some roundings of a float.
constexpr float kRounding = 5e-7F;

using simd::all4;
using simd::Float4;
using simd::Int4;

// A block of points is a row of groups: four x, four y, four z.
constexpr std::size_t kGroup = 12;
std::size_t position_in_block(std::size_t point, std::size_t axis) {
  return point / 4 * kGroup + axis * 4 + point % 4;
}

struct Offsets {
  Float4 x, y, z;

  Offsets(const float* group, const Eigen::Vector3f& from)
      : x(simd::load4(group) - all4(from.x())),
        y(simd::load4(group + 4) - all4(from.y())),
        z(simd::load4(group + 8) - all4(from.z())) {}
  [[nodiscard]] Float4 squared_norms() const { return x * x + y * y + z * z; }
};

// Smallest of the squared distances from `q` to the points of a block.
float nearest_in_block(const float* block, std::size_t num_points, const Eigen::Vector3f& q) {
  Float4 first = all4(kInfinitelyFar);
  for (const float* group = block; group < block + num_points * kGroup / 4; group += kGroup)
    first = simd::min(first, Offsets(group, q).squared_norms());
  return simd::least(first);
}

// In each of four lanes the two smallest squared distances seen, where their points are, and the third.
struct NearestOfLanes {
  Float4 first = all4(kInfinitelyFar);
  Float4 second = all4(kInfinitelyFar);
  Float4 third = all4(kInfinitelyFar);
  Int4 first_at = {};
  Int4 second_at = {};

  void add(const Float4& d2, std::int32_t at) {
    const Int4 ats = {at, at, at, at};
    const Int4 before_first = d2 < first;
    const Float4 rest = simd::max(first, d2);
    const Int4 rest_at = before_first ? first_at : ats;
    first = simd::min(first, d2);
    first_at = before_first ? ats : first_at;
    const Int4 before_second = rest < second;
    third = simd::min(third, simd::max(second, rest));
    second = simd::min(second, rest);
    second_at = before_second ? rest_at : second_at;
  }
};

// out = T p for `n` points of three coordinates each.
ADIT_WIDE_VECTORS void transform(const Eigen::Matrix<double, 3, 4>& T, std::size_t n,
                                 const float* __restrict p, float* __restrict out) {
  // A copy that the output cannot overlap stays in registers.
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
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

// Around a query, along each axis.
using Neighbourhood = std::array<Slabs, 3>;

// Calls `visit(dx, dy, dz)` for the 27 voxels around a query that are nearer than the square root of
// `limit2`, from near to far along each axis: where one voxel is beyond the limit, so are those behind it.
// `visit` returns the new limit. The result is the smallest squared distance from a voxel left out.
template <class Visit>
[[gnu::always_inline]] inline float visit_voxels_within(const Neighbourhood& slabs, float limit2,
                                                        const Visit& visit) {
  float skipped2 = kInfinitelyFar;
  for (std::size_t z = 0; z < 3; ++z) {
    const float gap2_z = slabs[2].gap2[z];
    if (gap2_z >= limit2) {
      skipped2 = std::min(skipped2, gap2_z);
      break;
    }
    for (std::size_t y = 0; y < 3; ++y) {
      const float gap2_yz = slabs[1].gap2[y] + gap2_z;
      if (gap2_yz >= limit2) {
        skipped2 = std::min(skipped2, gap2_yz);
        break;
      }
      for (std::size_t x = 0; x < 3; ++x) {
        const float gap2 = slabs[0].gap2[x] + gap2_yz;
        if (gap2 >= limit2) {
          skipped2 = std::min(skipped2, gap2);
          break;
        }
        limit2 = visit(slabs[0].offset[x], slabs[1].offset[y], slabs[2].offset[z]);
      }
    }
  }
  return skipped2;
}

// The points found, of groups that lie at `coordinates`.
std::array<Eigen::Vector3f, LocalMap::Candidates::kNumber> points_of(const NearestOfLanes& near,
                                                                     const float* coordinates) {
  std::array<Eigen::Vector3f, LocalMap::Candidates::kNumber> points;
  for (std::size_t lane = 0; lane < 4; ++lane) {
    const auto point = [&](float d2, std::int32_t group) -> Eigen::Vector3f {
      if (d2 == kInfinitelyFar) return Eigen::Vector3f::Constant(LocalMap::Candidates::kNowhere);
      const float* x = coordinates + static_cast<std::size_t>(group) * kGroup + lane;
      return {x[0], x[4], x[8]};
    };
    points[2 * lane] = point(near.first[lane], near.first_at[lane]);
    points[2 * lane + 1] = point(near.second[lane], near.second_at[lane]);
  }
  return points;
}

}  // namespace

LocalMap::LocalMap(double voxel_size, int max_points_per_voxel)
    : grid_(voxel_size),
      max_points_per_voxel_(static_cast<std::uint32_t>(max_points_per_voxel)),
      min_squared_spacing_(static_cast<float>(voxel_size * voxel_size / max_points_per_voxel)),
      block_size_((max_points_per_voxel_ + 3U) / 4U * kGroup) {
  ADIT_CHECK(max_points_per_voxel > 0, "a map voxel holds at least one point");
  ADIT_CHECK(max_points_per_voxel < 1 << kCountBits, "a map voxel holds at most 255 points");
}

std::size_t LocalMap::num_points() const { return points().size(); }

std::vector<Eigen::Vector3f> LocalMap::points() const {
  VoxelBricks::Reader voxels(voxels_);
  std::vector<Eigen::Vector3f> out;
  for (std::size_t i = 0; i < first_.size(); ++i) {
    if (first_[i].hasNaN()) continue;
    for (std::size_t k = 0; k < count_of(voxels(keys_[i])); ++k)
      out.emplace_back(block(i)[position_in_block(k, 0)], block(i)[position_in_block(k, 1)],
                       block(i)[position_in_block(k, 2)]);
  }
  return out;
}

void LocalMap::add(std::span<const Eigen::Vector3f> points_base, const Pose& T_map_base) {
  if (points_base.empty()) return;
  const std::size_t n = points_base.size();
  new_points_.resize(n);
  new_keys_.resize(n);
  new_places_.resize(n);
  transform(T_map_base.matrix().topRows<3>(), n, points_base.data()->data(), new_points_.data()->data());
  grid_.keys_of(new_points_, new_keys_);
  // First all voxels, then all points: what comes next is then known and under way from memory.
  constexpr std::size_t kAhead = 8;
  for (std::size_t i = 0; i < n; ++i) {
    if (i + kAhead < n) voxels_.prefetch(new_keys_[i + kAhead]);
    if (new_keys_[i] != VoxelKey::none()) new_places_[i] = voxels_.position_of(new_keys_[i]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (i + kAhead < n && new_keys_[i + kAhead] != VoxelKey::none())
      __builtin_prefetch(coordinates_.data() + block_of(voxels_[new_places_[i + kAhead]]) * block_size_);
    if (new_keys_[i] != VoxelKey::none()) add_point(new_points_[i], new_keys_[i], voxels_[new_places_[i]]);
  }
}

void LocalMap::add_point(const Eigen::Vector3f& point, VoxelKey key, std::uint32_t& voxel) {
  const std::uint32_t count = count_of(voxel);
  if (count == 0) {
    voxel = new_block(key, point) << kCountBits;
  } else if (count >= max_points_per_voxel_ ||
             nearest_in_block(block(block_of(voxel)), count, point) < min_squared_spacing_) {
    return;
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    block(block_of(voxel))[position_in_block(count, axis)] = point[static_cast<Eigen::Index>(axis)];
  ++voxel;
}

std::uint32_t LocalMap::new_block(VoxelKey key, const Eigen::Vector3f& first) {
  if (free_.empty()) {
    ADIT_CHECK(keys_.size() < std::size_t{1} << (32U - kCountBits), "the map has no room for more voxels");
    keys_.push_back(key);
    first_.push_back(first);
    coordinates_.resize(coordinates_.size() + block_size_, kInfinitelyFar);
    return static_cast<std::uint32_t>(keys_.size() - 1);
  }
  const std::uint32_t number = free_.back();
  free_.pop_back();
  keys_[number] = key;
  first_[number] = first;
  return number;
}

void LocalMap::remove_beyond(const Eigen::Vector3f& centre, double max_distance) {
  const auto max2 = static_cast<float>(max_distance * max_distance);
  for (std::uint32_t i = 0; i < first_.size(); ++i) {
    if (!((first_[i] - centre).squaredNorm() > max2)) continue;
    voxels_.clear(keys_[i]);
    first_[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    std::fill_n(block(i), block_size_, kInfinitelyFar);
    free_.push_back(i);
  }
}

std::optional<LocalMap::Neighbour> LocalMap::nearest(const Eigen::Vector3f& query, float max_distance) const {
  const Candidates candidates = search(query, max_distance, 0.0F);
  Neighbour best{{}, max_distance * max_distance};
  for (const Eigen::Vector3f& candidate : candidates.points) {
    const float d2 = (candidate - query).squaredNorm();
    if (d2 < best.squared_distance) best = {candidate, d2};
  }
  if (!(best.squared_distance < max_distance * max_distance)) return {};
  return best;
}

LocalMap::Candidates LocalMap::search(const Eigen::Vector3f& query, float max_distance, float margin) const {
  Candidates out;
  out.points.fill(Eigen::Vector3f::Constant(Candidates::kNowhere));
  const auto key = grid_.key_of(query);
  if (!key) return out;
  const float size = grid_.voxel_size();
  const Eigen::Vector3f to_lower = query - key->indices().cast<float>() * size;
  const Neighbourhood slabs = {Slabs(to_lower.x(), size), Slabs(to_lower.y(), size),
                               Slabs(to_lower.z(), size)};
  float best2 = max_distance * max_distance;
  float limit2 = (max_distance + margin) * (max_distance + margin);
  NearestOfLanes near;
  VoxelBricks::Reader voxels(voxels_);
  const float skipped2 = visit_voxels_within(slabs, limit2, [&](int dx, int dy, int dz) {
    const std::uint32_t voxel = voxels(key->shifted(dx, dy, dz));
    if (voxel == 0) return limit2;
    const std::size_t begin = block_of(voxel) * block_size_ / kGroup;
    const std::size_t end = begin + (count_of(voxel) + 3) / 4;
    for (std::size_t group = begin; group < end; ++group)
      near.add(Offsets(&coordinates_[group * kGroup], query).squared_norms(),
               static_cast<std::int32_t>(group));
    const float nearest2 = simd::least(near.first);
    if (nearest2 < best2) {
      best2 = nearest2;
      const float limit = std::sqrt(best2) + margin;
      limit2 = limit * limit;
    }
    return limit2;
  });
  out.points = points_of(near, coordinates_.data());

  // Beyond the neighbourhood nothing is nearer than its border, wherever the query goes. That settles it
  // where the nearest point is within; else the query must stay in its voxel.
  const float rounding = kRounding * query.cwiseAbs().maxCoeff();
  const float to_face = std::min({slabs[0].near, slabs[1].near, slabs[2].near});
  out.clearance = std::sqrt(std::min(skipped2, simd::least(near.third))) - rounding;
  out.room = kInfinitelyFar;
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
  Float4 count = {};
  Float4 sums[3] = {};
  Float4 squares[6] = {};
  VoxelBricks::Reader voxels(voxels_);
  for (int i = 0; i < 27; ++i) {
    const std::uint32_t voxel = voxels(key->shifted(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
    if (voxel == 0) continue;
    const float* points = block(block_of(voxel));
    const float* end = points + count_of(voxel) * kGroup / 4;
    for (const float* group = points; group < end; group += kGroup) {
      const Offsets offset(group, centre);
      const Int4 within = offset.squared_norms() < radius * radius;
      // Unused places: infinity times 0 would not be 0.
      const Float4 x = within ? offset.x : all4(0.0F);
      const Float4 y = within ? offset.y : all4(0.0F);
      const Float4 z = within ? offset.z : all4(0.0F);
      count += within ? all4(1.0F) : all4(0.0F);
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
  out.count = static_cast<int>(simd::sum(count));
  out.sum = {simd::sum(sums[0]), simd::sum(sums[1]), simd::sum(sums[2])};
  out.squares << simd::sum(squares[0]), simd::sum(squares[1]), simd::sum(squares[2]),  //
      simd::sum(squares[1]), simd::sum(squares[3]), simd::sum(squares[4]),             //
      simd::sum(squares[2]), simd::sum(squares[4]), simd::sum(squares[5]);
  return out;
}

}  // namespace adit
