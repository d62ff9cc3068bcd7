// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The records that stages hand to one another. They live here so that no stage needs to know another.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/ids.hpp"
#include "adit/core/point_cloud.hpp"
#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"
#include "adit/core/time.hpp"

namespace adit {

/// Where a body was at a time.
struct StampedPose {
  Stamp stamp;        ///< By the clock of whatever states the pose.
  Pose T_world_body;  ///< Which world and which body, the trajectory's owner says.
};
/// Stamps strictly ascending.
using Trajectory = std::vector<StampedPose>;

/// Linear (geodesic) interpolation of a trajectory; outside its span an error that names the span.
[[nodiscard]] Result<Pose> pose_at(const Trajectory& trajectory, Stamp stamp);

/// The length of the polyline through the positions, metres.
[[nodiscard]] double path_length(const Trajectory& trajectory);

/// One LiDAR sweep in the lidar frame. `stamp` is the time that the odometry's pose of this scan refers to;
/// per-point times are offsets from it (adit's simulator stamps the end of the sweep, so its offsets are
/// negative or zero).
struct Scan {
  Stamp stamp;       ///< Recording::scan_stamps has the same.
  PointCloud cloud;  ///< Metres; with times only where the sensor gave them.
};

/// Wheel odometry between two scans, in the base frame, with the covariance of its error in the tangent of
/// T_base0_base1 (right perturbation, [translation; rotation]).
struct WheelDelta {
  Duration duration{};                              ///< From the first scan to the second.
  Pose T_base0_base1;                               ///< The base at the second scan in the base at the first.
  Matrix6 covariance = Matrix6::Identity() * 1e-4;  ///< m^2, rad^2
};

/// One measurement of an IMU, in the IMU's own frame.
struct ImuSample {
  Stamp stamp;                                 ///< Of the measurement, as the message states it.
  Vector3 angular_velocity = Vector3::Zero();  ///< Radians per second.
  Vector3 specific_force = Vector3::Zero();    ///< Metres per second squared; at rest +9.81 upwards.
};

/// Covariances of one sample's noise, as the IMU's messages state them; zero where they do not.
struct ImuCovariance {
  Matrix3 angular_velocity = Matrix3::Zero();  ///< (rad/s)^2
  Matrix3 specific_force = Matrix3::Zero();    ///< (m/s^2)^2
};

/// Covariances as the messages of the wheels state them: of the first message, or of the first one that
/// states what cannot be. Order x, y, z, rotation about x, y, z; zero where nothing is stated. adit does not
/// use them as noise: a pose's covariance is that of a whole drive (decision 0028).
struct WheelCovariance {
  Matrix6 pose = Matrix6::Zero();   ///< m^2, rad^2
  Matrix6 twist = Matrix6::Zero();  ///< (m/s)^2, (rad/s)^2
};

/// What the robot's other sensors measured from one scan to the next.
struct SensedMotion {
  std::optional<WheelDelta> wheel = {};  ///< None without wheels, or where they were silent.
  /// Covers the interval whole: the first sample is the last one at or before its begin, the last sample the
  /// first one at or after its end. Empty without an IMU, and where its samples are too far apart or do not
  /// reach that far.
  std::vector<ImuSample> imu = {};
  Pose T_base_imu = {};  ///< As in Recording; without meaning where `imu` is empty.
};

/// A stretch in which a simulated sensor did not measure what it should.
struct SensorFault {
  std::string sensor;  ///< "wheels", "imu"
  std::string kind;    ///< "slip", "silent", ... as the sensor's model names them.
  Stamp begin;         ///< The first moment that counts.
  Stamp end;           ///< The first moment that does not.
  /// Slip: metres too far per metre; spin: m/s too fast; jump: metres; 0 for other kinds.
  double amount = 0.0;
};

/// All that one robot measured, scan by scan. Scans are read (or cast, by the simulator) when they are asked
/// for. `truth` and `faults` are for evaluation alone; no other stage may look at them.
struct Recording {
  std::string name;          ///< The robot's name.
  std::string lidar;         ///< The sensor's name, "" when unknown.
  Pose T_base_lidar;         ///< The mount: where the LiDAR sits on the robot.
  std::string mount_source;  ///< How the mount is known, for people: "/tf_static: base_link -> os_lidar".
  /// Whether recorded clouds are in the frame of `T_base_lidar`, as scans are: not where the LiDAR moves on
  /// the robot, nor where the files of a folder are in another frame.
  bool clouds_in_mount_frame = true;
  std::vector<std::string> assumptions;  ///< By the reader, a sentence each with its remedy.
  std::vector<std::string> warnings;     ///< What could not be read, a sentence each.
  /// Scans that were recorded and cannot be used, as their stamps do not ascend with the others' or cannot be
  /// read, or nobody knows where the LiDAR was; `warnings` says why. A scan that was sent twice does not
  /// count.
  std::size_t num_scans_left_out = 0;
  std::vector<Stamp> scan_stamps;                      ///< Strictly ascending.
  std::function<Result<Scan>(std::size_t)> read_scan;  ///< Thread-safe; scan i has stamp scan_stamps[i].
  Trajectory wheel;                                    ///< T_wheelodom_base; empty when there are no wheels.
  WheelCovariance wheel_covariance;                    ///< Of `wheel`; zero where its messages state none.
  std::vector<ImuSample> imu;                          ///< Strictly ascending; empty when there is no IMU.
  Pose T_base_imu;                                     ///< The mount of the IMU.
  std::string imu_mount_source;                        ///< As mount_source; "" when there is no IMU.
  std::string imu_name;                                ///< The IMU's model, "" when unknown.
  ImuCovariance imu_covariance;                        ///< As the first message of `imu` states it.
  std::vector<SensorFault> faults;                     ///< Of simulated sensors, by begin.
  Trajectory truth;                                    ///< T_world_base; empty when unknown.

  /// `read_scan` takes numbers below this.
  [[nodiscard]] std::size_t num_scans() const { return scan_stamps.size(); }
};

/// Wheel motion from stamp to stamp, interpolated. Covariance from the distance and angle driven: sigma of 2
/// % along, 1 % across, 0.5 deg per metre plus 2 % of the angle; at least 1 mm and 0.02 deg.
[[nodiscard]] Result<WheelDelta> wheel_delta(const Trajectory& wheel, Stamp from, Stamp to);

/// The samples that cover `begin` to `end`, see SensedMotion::imu; empty where two of them are more than
/// `longest_gap` apart.
[[nodiscard]] std::vector<ImuSample> imu_between(const std::vector<ImuSample>& imu, Stamp begin, Stamp end,
                                                 Duration longest_gap);

/// What the pose of an OdometryStep rests on.
enum class StepStatus {
  ok,      ///< The scan was registered. The pose is the scan's answer.
  no_map,  ///< The first scan: no map yet to register to. The pose is the start or the wheels' prediction.
  too_few_points,  ///< Fewer points or correspondences than needed. The pose is the prediction.
  degenerate,      ///< The geometry leaves a direction open; along it the pose is the prediction.
  diverged,        ///< The solver left the trust region around the prediction. The pose is the prediction.
};
/// The enumerator as it is spelled above.
[[nodiscard]] std::string_view to_string(StepStatus status);

/// The uncertainty of the motion since the last scan that entered the map, as it was predicted.
struct PredictedMotion {
  Matrix6 covariance = Matrix6::Zero();  ///< Right perturbation, [translation; rotation].
  /// By how much the step widens the covariance of the path along directions that the scan leaves open. What
  /// it has in common with earlier steps (errors of the velocity, of the wheels' radius) counts.
  Matrix6 open_drift = Matrix6::Zero();
  bool by_imu = false;  ///< An IMU measured the motion, within the sweep too.
};

/// The answer of an odometry to one scan.
struct OdometryStep {
  Stamp stamp;       ///< Of the scan.
  Pose T_odom_base;  ///< At the stamp. The frame is the method's own, fixed at its first scan.
  Matrix6 information = Matrix6::Zero();  ///< Of T_odom_base, right perturbation; zero along open directions.
  /// What was known of the motion before the scan was looked at, where the method states it.
  std::optional<PredictedMotion> predicted = {};
  /// By how much the scan surprised the prediction: the innovation squared, normalised, over its dimension.
  std::optional<double> innovation = {};
  /// By how much the scan moved the prediction: the log of T_predicted_base.
  Vector6 correction = Vector6::Zero();
  std::optional<Vector3> up = {};  ///< Against gravity, unit length, base frame; where an IMU has felt it.
  /// Where the wheels are not believed: the metres that they counted and the robot did not drive.
  std::optional<double> slip = {};
  StepStatus status = StepStatus::no_map;  ///< Whether the scan or a prediction gave T_odom_base.
  int num_correspondences = 0;             ///< Points with a partner in the map, in the last iteration.
  int iterations = 0;                      ///< Of the solver; 0 where it did not start.
  bool is_guess = false;  ///< No prediction was reliable: several starts were tried, the best fit was taken.
};

/// Immutable once made. `cloud` is in the base frame of this keyframe, deskewed and thinned.
struct Keyframe {
  KeyframeId id;                            ///< Its robot and its place in that robot's map.
  Stamp stamp;                              ///< Of the scan that it was made of.
  Pose T_odom_base;                         ///< By odometry alone: solutions do not change it.
  std::shared_ptr<const PointCloud> cloud;  ///< Shared by all copies of the keyframe.
};

/// "We may have been here before": query is the newer or asking keyframe.
struct LoopCandidate {
  KeyframeId query;       ///< The newer one, or that of the robot that searches.
  KeyframeId match;       ///< The one that looks like it, of the same robot or another.
  double yaw = 0.0;       ///< First guess: heading of `query` in the frame of `match`, radians.
  double distance = 1.0;  ///< Descriptor distance, 0 (same) to 1.
};

/// Two scans whose LoopClosure::weak_axis is below this are free to slide along one another.
inline constexpr double kWeakAxis = 0.01;

/// Whether a registration is believed. Whether it may join maps is decided later.
enum class LoopVerdict { accepted, rejected };
/// "accepted" or "rejected", as in loops.csv.
[[nodiscard]] std::string_view to_string(LoopVerdict verdict);

/// A registered candidate, accepted or not, with its evidence. `from < to`.
struct LoopClosure {
  KeyframeId from;                            ///< The frame of T_from_to: the base at this keyframe.
  KeyframeId to;                              ///< The keyframe that T_from_to places there.
  Pose T_from_to;                             ///< By registration of the clouds.
  Matrix6 information = Matrix6::Identity();  ///< Of T_from_to, right perturbation.
  double place_distance = 1.0;                ///< LoopCandidate::distance of the candidate.
  int num_inliers = 0;  ///< Matches of features that agree with the global registration.
  /// Share of the points of one cloud that have a neighbour in the other; the smaller of both ways, 0 to 1.
  double overlap = 0.0;
  /// Smallest eigenvalue of the normalised translational information, 0 (open) to 1/3.
  double weak_axis = 0.0;
  LoopVerdict verdict = LoopVerdict::rejected;  ///< Of the registration alone.
  std::string reason;                           ///< One sentence: why.

  /// Along a smooth tube: the measurement does not fix the position along it.
  [[nodiscard]] bool is_free_to_slide() const { return weak_axis < kWeakAxis; }
};

/// The same measurement with its ends exchanged: T_to_from, with the information carried over by the adjoint.
[[nodiscard]] LoopClosure reversed(LoopClosure loop);

}  // namespace adit
