// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The messages of the fleet. Every message is bounded in size, can be encoded (transport/wire), may arrive
/// twice and may be lost: robots say how much they have of each other's results, and are sent the rest.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/core/refusal_kind.hpp"
#include "adit/place/scan_context.hpp"

namespace adit {

inline constexpr std::uint8_t kProtocolVersion = 10;
inline constexpr std::size_t kPlacesPerMessage = 64;
inline constexpr std::size_t kCloudsPerMessage = 16;
inline constexpr std::size_t kNodesPerMessage = 512;
inline constexpr std::size_t kLoopsPerMessage = 256;
inline constexpr std::size_t kChecksPerMessage = 16;
inline constexpr std::size_t kHypothesesPerCheck = 16;

/// A keyframe as the graph needs it.
struct GraphNode {
  Stamp stamp;
  Pose T_odom_base;
  Matrix6 step_covariance =
      Matrix6::Zero();  ///< Of the pose relative to the keyframe before; zero for the first.
};

/// Opens a meeting: what the sender knows already, so that only the rest is sent.
struct Hello {
  struct Known {
    RobotId robot;
    std::uint32_t num_nodes = 0;
    std::uint32_t num_places = 0;
    std::uint32_t num_loops = 0;   ///< Of those that this robot registered.
    std::uint32_t num_checks = 0;  ///< Of those that this robot decided.
  };
  std::vector<Known> known;
  bool answer = false;  ///< This is the reply to a Hello.
};

/// Nodes first_index, first_index + 1, ... of the graph of `owner`, who need not be the sender.
struct GraphPart {
  RobotId owner;
  std::string name;
  std::uint32_t first_index = 0;
  std::vector<GraphNode> nodes;
};

/// Descriptors of the sender's own searchable keyframes, in their order; `first` counts those sent before.
struct Places {
  struct Place {
    std::uint32_t index = 0;
    ScanContext context;
  };
  std::uint32_t first = 0;
  std::vector<Place> places;
  bool last = false;  ///< Nothing follows.
};

/// Views are compared: a scan and those beside it, seen from where it stood. Submaps (robot/submap.hpp) are
/// registered.
enum class CloudKind : std::uint8_t { view, submap };

struct CloudRequest {
  std::vector<std::uint32_t> indices;
  CloudKind kind = CloudKind::view;
};

/// The sender's own keyframe clouds, each in its keyframe's base frame.
struct Clouds {
  struct Cloud {
    std::uint32_t index = 0;
    Eigen::Vector3f viewpoint = Eigen::Vector3f::Zero();  ///< The LiDAR, in the frame of the points.
    std::vector<Eigen::Vector3f> points;                  ///< Of the keyframe's scan, or of the submap.
    std::vector<Eigen::Vector3f> beside = {};  ///< Of a view: what the scans beside it saw and it did not.
  };
  std::vector<Cloud> clouds;
  CloudKind kind = CloudKind::view;
};

/// Loops number first, first + 1, ... of those that `author`, who need not be the sender, registered:
/// accepted and rejected ones alike, so that all know what was tried. They start at keyframes of the author;
/// those within its own map at the earlier one.
struct Loops {
  RobotId author;
  std::uint32_t first = 0;
  std::vector<LoopClosure> loops;
};

enum class HypothesisOutcome : std::uint8_t {
  accepted,
  refuted,  ///< Scans differ at more places than a true alignment leaves.
  unsure,   ///< The best one, with less evidence than needed.
  rival,    ///< Its evidence and that of another one differ by less than what is needed.
  behind,   ///< Its evidence is less than that of the best one by at least what is needed.
};
[[nodiscard]] std::string_view to_string(HypothesisOutcome outcome);

/// What comparing two scans that a hypothesis puts side by side has shown.
enum class PlaceOutcome : std::uint8_t {
  differs,
  agrees,       ///< It would agree if displaced along the tunnel, too: no evidence.
  distinctive,  ///< Agrees, and a displacement along the tunnel would have shown.
};

/// A place of the claimed overlap: the keyframes that were compared there.
struct TestedPlace {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  PlaceOutcome outcome = PlaceOutcome::differs;
};

/// What was counted while the places of a hypothesis were compared; its evidence comes from this.
struct HypothesisCounts {
  std::uint32_t num_distinctive = 0;  ///< Places that agree and where a displacement would have shown.
  std::uint32_t num_changes = 0;      ///< Of structure, each once.
  std::uint32_t num_things = 0;       ///< That stand on the floor and only one robot met, each once.
  std::uint32_t num_wall_patches = 0;
  double compared_m = 0.0;  ///< Length of tunnel that the compared scans show.
  /// Of the relief of walls: the share of equal signs and its standard deviation, 0.5 without patches.
  double equal_signs = 0.5;
  double equal_signs_sigma = 0.5;
  bool operator==(const HypothesisCounts&) const = default;
};

/// One alignment of two maps, put forward by loops that agree with one another, and what testing it has
/// shown.
struct MergeHypothesis {
  HypothesisOutcome outcome = HypothesisOutcome::refuted;
  double evidence = 0.0;  ///< As in MergeCheck; 0 where it is refuted.
  std::uint32_t num_checked = 0;
  std::uint32_t num_passed = 0;
  double from_best_m = 0.0;  ///< Metres between where it and the best one put the other robot.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> loops;  ///< Keyframes of a and b.
  std::vector<TestedPlace> places{};  ///< In the order driven by a; left out where it is refuted.
  double walls = 0.0;                 ///< The part of the evidence that comes from the relief of walls.
  HypothesisCounts counts{};

  [[nodiscard]] std::uint32_t num_differing() const { return num_checked - num_passed; }
};

/// Where robot b of a MergeCheck should drive to decide it: along the path of robot a, beyond the stretch
/// that both drove, where b has not been yet.
struct MergeAdvice {
  double from_m = 0.0;  ///< Along a's path: where what both drove ends,
  double to_m = 0.0;    ///< and where b may stop; less than `from_m` against a's direction of driving.
  Vector3 from = Vector3::Zero();  ///< Position at `from_m`, metres, in the odometry frame of a.
  double gain = 0.0;               ///< Evidence from there, if a and b are in one tunnel.
  double missing = 0.0;            ///< Evidence that a merge lacks.
};

/// The verdict on the loops between two robots: whether they may join the maps. Robot `a`, which searched,
/// decides; where `b` is the same robot it is about places of its own map that it came back to. A later
/// verdict replaces those before it. Evidence, numbers and loops are those of the best hypothesis.
struct MergeCheck {
  RobotId a, b;
  double evidence = 0.0;  ///< log P(what was observed | same stretch) / P(... | stretches only look alike).
  double needed = 0.0;    ///< Evidence that joins maps: log(1 / error rate).
  std::uint32_t num_checked = 0;
  std::uint32_t num_passed = 0;
  bool accepted = false;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> loops;  ///< Keyframes of a and b.
  std::string reason;                               ///< One sentence: why, and what would lead to a merge.
  std::vector<MergeHypothesis> hypotheses{};        ///< At most kHypothesesPerCheck, the best one first.
  RefusalKind refused_kind = RefusalKind::unknown;  ///< Where it is not accepted.
  std::optional<MergeAdvice> advice = {};           ///< Where a place is known; `reason` names it.
};

/// Number first, first + 1, ... of those that `author`, who need not be the sender, decided.
struct MergeChecks {
  RobotId author;
  std::uint32_t first = 0;
  std::vector<MergeCheck> checks;
};

using MessageBody = std::variant<Hello, GraphPart, Places, CloudRequest, Clouds, Loops, MergeChecks>;

struct Message {
  RobotId from;
  RobotId to;
  MessageBody body;
};

}  // namespace adit
