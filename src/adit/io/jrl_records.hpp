// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The records of a JSON Robot Log as plain types; for jrl.cpp only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// A robot's measurement: the index of its entry, and its index in the entry.
using JrlFactorId = std::pair<std::size_t, std::size_t>;
/// By robot; absent where the file lacks the list.
using JrlFactorIds = std::optional<std::map<std::string, std::set<JrlFactorId>>>;
/// Pose3 or Pose2 of the file.
using JrlPose = std::variant<Pose, Pose2>;

/// A prior (one key) or a relative pose (two).
struct JrlFactor {
  std::vector<std::uint64_t> keys;  ///< Of the nodes: the one, or from and to.
  JrlPose pose;                     ///< Of the node in the world, or T_from_to.
  std::vector<double> covariance;   ///< As written, row by row: as many numbers as its pose calls for.
  std::size_t robot = 0;            ///< Whose measurement it is.
  JrlFactorId id;                   ///< By which lists of outliers refer to it.
  std::string place;                ///< In the file, for errors: "measurements.a[3].measurements[0]".
};

/// A pose of `initialization` or `groundtruth`.
struct JrlValue {
  std::uint64_t key = 0;  ///< Of the node.
  JrlPose pose;           ///< T_world_node.
  std::size_t robot = 0;  ///< Whose list it is in.
  std::string place;      ///< In the file, for errors: "initialization.a[3]".
};

/// All that is read of a file, before it becomes a graph.
struct JrlRecords {
  std::string name;  ///< Of the data set; "" where the file has none.
  /// Their letters, each once. JrlFactor::robot and JrlValue::robot are indices into this list.
  std::vector<std::string> robots;
  std::vector<JrlFactor> factors;               ///< Robot by robot, each in the order of the file.
  std::map<std::string, std::size_t> left_out;  ///< Counts of factors that are known but not of poses.
  JrlFactorIds potential;                       ///< Factors that may be outliers.
  JrlFactorIds outliers;                        ///< Factors that are labelled as outliers.
  std::vector<JrlValue> initialization;         ///< Where solvers may start.
  std::vector<JrlValue> truth;                  ///< For judging only.
};

/// From JSON or CBOR. Checks the form of everything, not whether it makes a graph. Errors name the place.
[[nodiscard]] Result<JrlRecords> parse_jrl_records(const std::string& bytes);

/// As JSON, the inverse of that. Factors stand in the order of their robots and ids; `place` and `left_out`
/// are not written.
[[nodiscard]] std::string jrl_text(const JrlRecords& records);

}  // namespace adit
