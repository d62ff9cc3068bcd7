// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The messages of the fleet. Every message can be encoded (transport/wire), may arrive twice and may be
/// lost: robots say how much they have of each other's results, and are sent the rest. Lists are bounded by
/// the constants below where a message is read; texts and the items of a MergeCheck where it is taken
/// (FleetLedger). Not bounded are Hello::known, the points of a cloud and the cells of a descriptor: what
/// receives bytes has to limit how many it takes as one message.
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

/// In every encoded message. Those of versions before the oldest are refused, and those of later ones. So a
/// robot of this version reads what one of the oldest says, which does not read it in turn: all robots of a
/// fleet have to be updated together. What an older version saved stays readable.
///@{
inline constexpr std::uint8_t kProtocolVersion = 13;
/// Lacks the unconfirmed shares, and like 12 has three counts of a hypothesis more; otherwise identical.
inline constexpr std::uint8_t kOldestProtocolVersion = 11;
///@}
/// The most that one message holds; longer lists are sent in parts.
///@{
inline constexpr std::size_t kPlacesPerMessage = 64;
inline constexpr std::size_t kCloudsPerMessage = 16;
inline constexpr std::size_t kNodesPerMessage = 512;
inline constexpr std::size_t kLoopsPerMessage = 256;
inline constexpr std::size_t kChecksPerMessage = 16;
///@}
/// The most that is taken of any one robot, whoever sends it: without a bound a broken or hostile peer fills
/// the memory. A robot that drives 60 km, or decides eight times about each of the others, stays below.
///@{
inline constexpr std::size_t kKeyframesPerRobot = 200'000;
inline constexpr std::size_t kLoopsPerRobot = 100'000;
inline constexpr std::size_t kChecksPerRobot = 2'048;
///@}
/// The most that is taken of one text (a name or a reason, bytes) and of one MergeCheck (loops and places of
/// all its hypotheses together).
///@{
inline constexpr std::size_t kBytesPerText = 2'048;
inline constexpr std::size_t kItemsPerCheck = 16'384;
///@}
/// The most that a MergeCheck states, the best ones.
inline constexpr std::size_t kHypothesesPerCheck = 16;

/// A keyframe as the graph needs it.
struct GraphNode {
  Stamp stamp;       ///< Of its scan, by the clock of the owner.
  Pose T_odom_base;  ///< In the odometry frame of the owner.
  Matrix6 step_covariance =
      Matrix6::Zero();  ///< Of the pose relative to the keyframe before; zero for the first.
};

/// Opens a meeting: what the sender knows already, so that only the rest is sent.
struct Hello {
  /// How much the sender knows of one robot; parts are received in order, so that numbers say it all.
  struct Known {
    RobotId robot;                 ///< Also the sender itself.
    std::uint32_t num_nodes = 0;   ///< Keyframes of its graph.
    std::uint32_t num_places = 0;  ///< Descriptors received from it.
    std::uint32_t num_loops = 0;   ///< Of those that this robot registered.
    std::uint32_t num_checks = 0;  ///< Of those that this robot decided.
  };
  std::vector<Known> known;  ///< At most one per robot.
  bool answer = false;       ///< This is the reply to a Hello.
};

/// Nodes first_index, first_index + 1, ... of the graph of `owner`, who need not be the sender.
struct GraphPart {
  RobotId owner;                  ///< Whose keyframes they are.
  std::string name;               ///< Of the owner.
  std::uint32_t first_index = 0;  ///< Keyframe index of nodes.front().
  std::vector<GraphNode> nodes;   ///< At most kNodesPerMessage; none says that the owner exists.
};

/// Descriptors of the sender's own searchable keyframes, in their order; `first` counts those sent before.
struct Places {
  /// A keyframe to be recognised.
  struct Place {
    std::uint32_t index = 0;  ///< Of the keyframe.
    ScanContext context;      ///< Compared only where the receiver describes places on the same grid.
  };
  std::uint32_t first = 0;    ///< Number of places.front() among the searchable keyframes.
  std::vector<Place> places;  ///< At most kPlacesPerMessage.
  bool last = false;          ///< Nothing follows.
};

/// Views are compared: a scan and those beside it, seen from where it stood. Submaps (robot/submap.hpp) are
/// registered.
enum class CloudKind : std::uint8_t { view, submap };

/// Asks for clouds of the receiver's own keyframes.
struct CloudRequest {
  std::vector<std::uint32_t> indices;  ///< Of keyframes, at most kCloudsPerMessage.
  CloudKind kind = CloudKind::view;    ///< Of all clouds that are asked for.
};

/// The sender's own keyframe clouds, each in its keyframe's base frame.
struct Clouds {
  /// What was seen at one keyframe, metres.
  struct Cloud {
    std::uint32_t index = 0;                              ///< Of the keyframe.
    Eigen::Vector3f viewpoint = Eigen::Vector3f::Zero();  ///< The LiDAR, in the frame of the points.
    std::vector<Eigen::Vector3f> points;                  ///< Of the keyframe's scan, or of the submap.
    std::vector<Eigen::Vector3f> beside = {};  ///< Of a view: what the scans beside it saw and it did not.
    /// Of the points of a view, in the unit of the sensor, to 4 % between 0.0011 and 93,000; empty: it gives
    /// none.
    std::vector<float> intensities = {};
    /// Of the keyframe's scan (RobotMap::unconfirmed); none, too, where the sender did not say it.
    std::optional<float> unconfirmed = {};
  };
  std::vector<Cloud> clouds;         ///< In the order of the request, without keyframes that do not exist.
  CloudKind kind = CloudKind::view;  ///< As requested.
};

/// Loops number first, first + 1, ... of those that `author`, who need not be the sender, registered:
/// accepted and rejected ones alike, so that all know what was tried. They start at keyframes of the author;
/// those within its own map at the earlier one.
struct Loops {
  RobotId author;                  ///< Numbered them in the order of registration.
  std::uint32_t first = 0;         ///< Number of loops.front().
  std::vector<LoopClosure> loops;  ///< At most kLoopsPerMessage.
};

/// What became of one alignment of two maps.
enum class HypothesisOutcome : std::uint8_t {
  accepted,  ///< It joins the maps.
  refuted,   ///< Scans differ at more places than a true alignment leaves.
  unsure,    ///< The best one, without a rival, but with too little evidence or too few loops.
  rival,     ///< Its evidence and that of another one differ by less than log(1 / rival_rate).
  behind,    ///< Its evidence is less than that of the best one by at least log(1 / rival_rate).
  vetoed,    ///< The best one of two maps that a person keeps apart, whatever its evidence.
};
/// accepted, refuted, unsure, rival, behind, vetoed.
[[nodiscard]] std::string_view to_string(HypothesisOutcome outcome);

/// What comparing two scans that a hypothesis puts side by side has shown.
enum class PlaceOutcome : std::uint8_t {
  differs,      ///< The scans cannot be of one place.
  agrees,       ///< It would agree if displaced along the tunnel, too: no evidence.
  distinctive,  ///< Agrees, and a displacement along the tunnel would have shown.
};

/// A place of the claimed overlap: the keyframes that were compared there.
struct TestedPlace {
  std::uint32_t a = 0;                           ///< Index of the keyframe of robot a of the MergeCheck.
  std::uint32_t b = 0;                           ///< And of robot b.
  PlaceOutcome outcome = PlaceOutcome::differs;  ///< After a second look, where one was taken.
};

/// What was counted while the places of a hypothesis were compared; its evidence comes from this.
struct HypothesisCounts {
  std::uint32_t num_distinctive = 0;   ///< Places that agree and where a displacement would have shown.
  std::uint32_t num_changes = 0;       ///< Of structure, each once.
  std::uint32_t num_things = 0;        ///< That stand on the floor and only one robot met, each once.
  std::uint32_t num_wall_patches = 0;  ///< That two pairs of scans or more saw.
  double compared_m = 0.0;             ///< Length of tunnel that the compared scans show.
  /// Of the relief of walls: the share of equal signs and its standard deviation, 0.5 without patches.
  ///@{
  double equal_signs = 0.5;
  double equal_signs_sigma = 0.5;
  ///@}
  bool operator==(const HypothesisCounts&) const = default;
};

/// One alignment of two maps, put forward by loops that agree with one another, and what testing it has
/// shown.
struct MergeHypothesis {
  HypothesisOutcome outcome = HypothesisOutcome::refuted;  ///< Beside the others of its check.
  double evidence = 0.0;                                   ///< As in MergeCheck; 0 where it is refuted.
  std::uint32_t num_checked = 0;                           ///< Places that were compared.
  std::uint32_t num_passed = 0;  ///< Of these, places that agree or whose difference is explained.
  double from_best_m = 0.0;      ///< Metres between where it and the best one put the other robot.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> loops;  ///< Keyframes of a and b.
  std::vector<TestedPlace> places{};  ///< In the order driven by a; left out where it is refuted.
  double walls = 0.0;                 ///< The part of the evidence that comes from the relief of walls.
  HypothesisCounts counts{};          ///< Stated where it is refuted, too.

  /// Places that differ, without those that are explained.
  [[nodiscard]] std::uint32_t num_differing() const { return num_checked - num_passed; }
};

/// Where robot b of a MergeCheck should drive to decide it: along the path of robot a, where b has not been
/// yet; beyond the stretch that both drove, or where nothing is shared, where a would recognise it best.
struct MergeAdvice {
  double from_m = 0.0;  ///< Along a's path: where b begins,
  double to_m = 0.0;    ///< and where b may stop; less than `from_m` against a's direction of driving.
  Vector3 from = Vector3::Zero();  ///< Position at `from_m`, metres, in the odometry frame of a.
  double gain = 0.0;               ///< Evidence from there, if a and b are in one tunnel.
  double missing = 0.0;            ///< Evidence that a merge lacks.
};

/// Of the scans of two robots: the mean share of returns that nothing confirmed. None where no scan was
/// judged, or nothing compared, and in what earlier versions decided.
struct UnconfirmedShares {
  /// From 0 to 1, of each robot's own.
  ///@{
  std::optional<double> a, b;
  ///@}
};

/// The verdict on the loops between two robots: whether they may join the maps. Robot `a`, which searched,
/// decides; where `b` is the same robot it is about places of its own map that it came back to. A later
/// verdict replaces those before it. Evidence, numbers and loops are those of the best hypothesis.
struct MergeCheck {
  /// The smaller id first.
  ///@{
  RobotId a, b;
  ///@}
  double evidence = 0.0;  ///< log P(what was observed | same stretch) / P(... | stretches only look alike).
  double needed = 0.0;    ///< Evidence that joins maps: log(1 / error rate).
  std::uint32_t num_checked = 0;  ///< As in MergeHypothesis.
  std::uint32_t num_passed = 0;   ///< As in MergeHypothesis.
  bool accepted = false;          ///< The loops join the maps, unless third robots contradict them.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> loops;  ///< Keyframes of a and b.
  std::string reason;                               ///< One sentence: why, and what would lead to a merge.
  std::vector<MergeHypothesis> hypotheses{};        ///< At most kHypothesesPerCheck, the best one first.
  RefusalKind refused_kind = RefusalKind::unknown;  ///< Where it is not accepted.
  std::optional<MergeAdvice> advice = {};           ///< Where a place is known; `reason` names it.
  UnconfirmedShares unconfirmed = {};               ///< Of the scans that were compared.
};

/// Number first, first + 1, ... of those that `author`, who need not be the sender, decided.
struct MergeChecks {
  RobotId author;                  ///< Numbered them in the order of decision.
  std::uint32_t first = 0;         ///< Number of checks.front().
  std::vector<MergeCheck> checks;  ///< At most kChecksPerMessage.
};

/// What a message says. The order of the kinds is part of the protocol.
using MessageBody = std::variant<Hello, GraphPart, Places, CloudRequest, Clouds, Loops, MergeChecks>;

/// From one robot to one other.
struct Message {
  RobotId from;      ///< Who sends it; what it says may be of others.
  RobotId to;        ///< The agent that takes it (Agent::on).
  MessageBody body;  ///< One statement, request or part of a list.
};

}  // namespace adit
