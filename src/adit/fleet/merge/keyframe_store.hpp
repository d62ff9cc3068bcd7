// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "adit/core/check.hpp"
#include "adit/core/parallel.hpp"
#include "adit/registration/agreement.hpp"
#include "adit/registration/features.hpp"
#include "adit/robot/robot_map.hpp"
#include "adit/robot/submap.hpp"

namespace adit {

/// Something that is computed of a robot's own keyframes, of each when it is needed: it keeps those used
/// last, as many as fit `max_bytes`.
template <class T>
class KeyframeStore {
 public:
  /// Of one keyframe; called from several threads at once.
  using Compute = std::function<T(const RobotMap&, std::uint32_t index)>;
  /// How much of `max_bytes` a value takes.
  using BytesOf = std::function<std::size_t(const T&)>;

  /// Empty at first. What a single `prepare` asks for is kept even beyond `max_bytes`.
  KeyframeStore(std::shared_ptr<const RobotMap> map, Compute compute, BytesOf bytes_of, std::size_t max_bytes)
      : map_(std::move(map)),
        compute_(std::move(compute)),
        bytes_of_(std::move(bytes_of)),
        max_bytes_(max_bytes),
        entries_(map_->keyframes.size()) {}

  /// Computes what is missing of `indices`, in parallel; forgets what was used longest ago and is not among
  /// them. Call it before `at`.
  void prepare(const std::vector<std::uint32_t>& indices) {
    ++now_;
    std::vector<std::uint32_t> missing;
    for (const std::uint32_t i : indices) {
      Entry& entry = entries_.at(i);
      if (!entry.value && entry.last_used != now_) missing.push_back(i);
      entry.last_used = now_;
    }
    // Kept only once all are there: where one cannot be computed, the others would not be counted.
    std::vector<std::optional<T>> computed(missing.size());
    parallel_for_each(missing.size(), [&](std::size_t i) { computed[i] = compute_(*map_, missing[i]); });
    for (std::size_t i = 0; i < missing.size(); ++i) {
      num_bytes_ += bytes_of_(*computed[i]);
      entries_[missing[i]].value = std::move(computed[i]);
    }
    forget_oldest();
  }
  /// Valid until the next `prepare` or `forget_all`. Throws ContractViolation where it is not kept.
  [[nodiscard]] const T& at(std::uint32_t index) const {
    ADIT_CHECK(entries_.at(index).value.has_value(), "keyframes are prepared before they are asked for");
    return *entries_[index].value;
  }
  /// Of all that is kept, by `bytes_of`.
  [[nodiscard]] std::size_t num_bytes() const { return num_bytes_; }
  /// What is needed later is computed again.
  void forget_all() {
    for (Entry& entry : entries_) entry.value.reset();
    num_bytes_ = 0;
  }

 private:
  struct Entry {
    std::optional<T> value;
    std::uint64_t last_used = 0;
  };
  void forget_oldest() {
    std::vector<std::uint32_t> unused;
    for (std::uint32_t i = 0; i < entries_.size(); ++i) {
      if (entries_[i].value && entries_[i].last_used < now_) unused.push_back(i);
    }
    std::ranges::sort(unused, {}, [&](std::uint32_t i) { return std::pair(entries_[i].last_used, i); });
    for (const std::uint32_t i : unused) {
      if (num_bytes_ <= max_bytes_) return;
      num_bytes_ -= bytes_of_(*entries_[i].value);
      entries_[i].value.reset();
    }
  }

  std::shared_ptr<const RobotMap> map_;
  Compute compute_;
  BytesOf bytes_of_;
  std::size_t max_bytes_;
  std::vector<Entry> entries_;
  std::uint64_t now_ = 0;  ///< Counts calls of `prepare`.
  std::size_t num_bytes_ = 0;
};

/// Keyframes, each with those around it, made ready for registration.
class FeatureStore : public KeyframeStore<Features> {
 public:
  /// Default of `max_bytes`.
  static constexpr std::size_t kMaxBytes = 256'000'000;
  /// Features are of submap(map, k, submap_config), in the base frame of keyframe k.
  FeatureStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config,
               const SubmapConfig& submap_config, std::size_t max_bytes = kMaxBytes);
};

/// What was seen around a keyframe, ready to be fitted: its scan and those beside it, as if all had been seen
/// from `viewpoint`, that of its LiDAR. All in the base frame of the keyframe.
[[nodiscard]] SeenSurface view_of(const PointCloud& scan_and_beside, const Vector3& viewpoint,
                                  const RegistrationConfig& config);
/// The scan of a keyframe alone, ready for comparing walls: what no other keyframe's scan has part in.
[[nodiscard]] SearchableSurface scan_of(const PointCloud& scan, const Vector3& viewpoint,
                                        const RegistrationConfig& config);

/// The views of keyframes.
class ViewStore : public KeyframeStore<SeenSurface> {
 public:
  /// Default of `max_bytes`.
  static constexpr std::size_t kMaxBytes = 256'000'000;
  /// The view of keyframe k is of submap(map, k, view_config).
  ViewStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config,
            const SubmapConfig& view_config, std::size_t max_bytes = kMaxBytes);
};

/// The scans of keyframes; only places whose views agree need theirs.
class ScanStore : public KeyframeStore<SearchableSurface> {
 public:
  /// Default of `max_bytes`.
  static constexpr std::size_t kMaxBytes = 128'000'000;
  /// Of the clouds of `map`.
  ScanStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config,
            std::size_t max_bytes = kMaxBytes);
};

}  // namespace adit
