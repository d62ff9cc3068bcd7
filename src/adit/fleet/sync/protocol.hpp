// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What robots say to one another. Every message is bounded in size, can be encoded (transport/wire), may
/// arrive twice and may be lost: state is synchronised by asking "what do you have" and sending the rest.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/place/scan_context.hpp"

namespace adit {

inline constexpr std::uint8_t kProtocolVersion = 5;
inline constexpr std::size_t kPlacesPerMessage = 64;
inline constexpr std::size_t kCloudsPerMessage = 16;
inline constexpr std::size_t kNodesPerMessage = 512;
inline constexpr std::size_t kLoopsPerMessage = 256;
inline constexpr std::size_t kHypothesesPerCheck = 16;

/// A keyframe as the graph needs it. `step_covariance` is of the relative pose from the keyframe before (zero
/// for the first).
struct GraphNode {
  Stamp stamp;
  Pose T_odom_base;
  Matrix6 step_covariance = Matrix6::Zero();
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

struct CloudRequest {
  std::vector<std::uint32_t> indices;
};

/// The sender's own keyframe clouds, each in its keyframe's base frame.
struct Clouds {
  struct Cloud {
    std::uint32_t index = 0;
    Eigen::Vector3f viewpoint =
        Eigen::Vector3f::Zero();  ///< Where the LiDAR stood, in the frame of the points.
    std::vector<Eigen::Vector3f> points;
  };
  std::vector<Cloud> clouds;
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
  refuted,  ///< Scans differ at more places than a true one would leave.
  unsure,   ///< The best one, with less evidence than needed.
  rival,    ///< So near to another one, or another one to it, that neither can be believed.
  behind,   ///< Left so far behind by the best one that it is out of the question.
};
[[nodiscard]] std::string_view to_string(HypothesisOutcome outcome);

/// What comparing two scans of one place, if it is one, has shown.
enum class PlaceOutcome : std::uint8_t {
  differs,
  agrees,  ///< As it would some metres farther along the way, too: no evidence.
  tells,   ///< Agrees, and a displacement along the way would have shown.
};

/// That tunnels which only look alike agree at one more place that tells, after 0, 1, 3, 7, ... of them.
using ChancesToGoOn = std::array<double, 8>;

/// Keyframes of the two robots that were compared.
struct TestedPlace {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  PlaceOutcome outcome = PlaceOutcome::differs;
};

/// Loops that agree with one another lay one map over the other; this is one way to do so, as it was tested.
struct MergeHypothesis {
  HypothesisOutcome outcome = HypothesisOutcome::refuted;
  double evidence = 0.0;  ///< As in MergeCheck; 0 where it is refuted, for then it is not weighed.
  std::uint32_t num_checked = 0;
  std::uint32_t num_passed = 0;
  double from_best_m = 0.0;  ///< How far from the best one it puts the other robot.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> loops;  ///< Keyframes of a and b.
  std::vector<TestedPlace> places{};  ///< Along the way of a; none of a refuted one, nobody asks for them.
  double walls = 0.0;                 ///< The part of the evidence that is of walls.

  [[nodiscard]] std::uint32_t num_differing() const { return num_checked - num_passed; }
};

/// Whether the loops of two robots may join their maps, decided by the one that searched, `a`; or, where `b`
/// is the same robot, whether it came back to places of its own map. A later one replaces those before it.
/// Evidence, numbers and loops are those of the best hypothesis.
struct MergeCheck {
  RobotId a, b;
  double evidence = 0.0;  ///< Logarithm of the likelihood ratio of "same stretch" to "looks alike",
  double needed = 0.0;    ///< and how much of it joins maps.
  std::uint32_t num_checked = 0;
  std::uint32_t num_passed = 0;
  bool accepted = false;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> loops;  ///< Keyframes of a and b: those it speaks of.
  std::string reason;                         ///< One sentence: why, and what would resolve a refusal.
  std::vector<MergeHypothesis> hypotheses{};  ///< At most kHypothesesPerCheck, the best one first.
  ChancesToGoOn goes_on{};                    ///< As robot a has measured them.
};

/// Number first, first + 1, ... of those that `author`, who need not be the sender, decided.
struct MergeChecks {
  RobotId author;
  std::uint32_t first = 0;
  std::vector<MergeCheck> checks;
};

struct Message {
  RobotId from;
  RobotId to;
  std::variant<Hello, GraphPart, Places, CloudRequest, Clouds, Loops, MergeChecks> body;
};

}  // namespace adit
