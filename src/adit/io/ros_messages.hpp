// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The ROS messages that recordings are made of: written in CDR, as ROS 2 does, with their definitions for
/// MCAP's `ros2msg` schemas; read in CDR and as ROS 1 writes them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/cdr.hpp"
#include "adit/io/point_times.hpp"

namespace adit::ros {

/// The message types that adit knows, as ROS 2 names them.
///@{
inline constexpr std::string_view kPointCloud2 = "sensor_msgs/msg/PointCloud2";
inline constexpr std::string_view kOdometry = "nav_msgs/msg/Odometry";
inline constexpr std::string_view kTwist = "geometry_msgs/msg/TwistStamped";
inline constexpr std::string_view kJointState = "sensor_msgs/msg/JointState";
inline constexpr std::string_view kImu = "sensor_msgs/msg/Imu";
inline constexpr std::string_view kTransforms = "tf2_msgs/msg/TFMessage";
inline constexpr std::string_view kPath = "nav_msgs/msg/Path";
///@}
inline constexpr std::string_view kMarkers = "visualization_msgs/msg/MarkerArray";  ///< As from Humble on.

/// The CustomMsg of Livox's drivers (decode_livox).
[[nodiscard]] bool is_livox(std::string_view type);
/// What decode_cloud or decode_livox take.
[[nodiscard]] inline bool is_cloud(std::string_view type) { return type == kPointCloud2 || is_livox(type); }

/// The full text of a message type and all types in it; the type must be one of
/// those that are encoded below.
[[nodiscard]] std::string definition_of(std::string_view type);

/// A cloud in the frame named.
struct CloudMessage {
  std::string frame;      ///< Of the points, as the header names it.
  Scan scan;              ///< With the stamp of the header; points in metres.
  PointTimes times = {};  ///< As in CloudFile.
};
/// The stamp's seconds must fit 32 bits: see `fits_ros`.
[[nodiscard]] std::string encode_cloud(const Scan& scan, std::string_view frame);
/// Takes the fields that pcd.hpp lists, of any type and byte order. Points that are not finite are left out.
/// `known`: of the times of points (packed_cloud.hpp).
Result<CloudMessage> decode_cloud(std::string_view message, MessageEncoding encoding = MessageEncoding::cdr,
                                  const KnownTimes& known = {});
/// What a PointCloud2 holds, as it stands: "x float32, y float32, z float32, t uint32; 1024 x 64 points".
Result<std::string> describe_cloud(std::string_view message, MessageEncoding encoding = MessageEncoding::cdr);
/// The same of Livox's CustomMsg: intensity is the reflectivity, times are nanoseconds from its `timebase`,
/// the time of the first point. Where that is further from the stamp than two sweeps, as by another clock,
/// they count from the stamp. Their field is `offset_time`, also for `known`.
Result<CloudMessage> decode_livox(std::string_view message, MessageEncoding encoding = MessageEncoding::cdr,
                                  const KnownTimes& known = {});

/// T_frame_child at a time.
struct TransformMessage {
  std::string frame;  ///< The parent.
  std::string child;  ///< A pose of this frame in the parent.
  StampedPose pose;   ///< T_frame_child and its stamp.
};
/// A pose with the covariances that its message states; its twist is not read, and written as zero.
struct OdometryMessage : TransformMessage {
  WheelCovariance covariance = {};  ///< As the message states it, not checked.
};
/// In CDR. The stamp must fit: see `fits_ros`.
[[nodiscard]] std::string encode_odometry(const OdometryMessage& odometry);
/// Fails when the message ends early, or its pose is not valid: not finite, farther away than 1e9 m, or with
/// a quaternion not of length 1.
Result<OdometryMessage> decode_odometry(std::string_view message,
                                        MessageEncoding encoding = MessageEncoding::cdr);
/// In CDR. The stamps must fit: see `fits_ros`.
[[nodiscard]] std::string encode_transforms(const std::vector<TransformMessage>& transforms);
/// What a TFMessage links.
struct TransformsMessage {
  std::vector<TransformMessage> links;  ///< Those that are poses.
  std::vector<Error> left_out;  ///< Why, for each link whose pose is not valid (tf2 drops these, too).
};
/// Fails when the message ends early.
Result<TransformsMessage> decode_transforms(std::string_view message,
                                            MessageEncoding encoding = MessageEncoding::cdr);

/// A twist of the body in its own frame: metres per second, radians per second.
struct TwistMessage {
  Stamp stamp;                      ///< Of the header.
  std::string frame;                ///< Of the header.
  Vector6 twist = Vector6::Zero();  ///< [linear; angular]
};
/// Fails when the message ends early or a number is not finite.
Result<TwistMessage> decode_twist(std::string_view message, MessageEncoding encoding = MessageEncoding::cdr);

/// Angles (radians) or lengths (metres) of joints and their velocities; either may be empty, or shorter than
/// the names.
struct JointStateMessage {
  Stamp stamp;                     ///< Of the header.
  std::vector<std::string> names;  ///< Of the joints.
  std::vector<double> positions;   ///< In the order of the names.
  std::vector<double> velocities;  ///< The same, per second.
};
/// Numbers are handed on as they are. Fails when the message ends early.
Result<JointStateMessage> decode_joint_state(std::string_view message,
                                             MessageEncoding encoding = MessageEncoding::cdr);

/// A nav_msgs/Path in CDR, of one pose or more in `frame`. The stamps must fit: see `fits_ros`.
[[nodiscard]] std::string encode_path(std::string_view frame, const Trajectory& poses);

/// Separate lines, of which points 2i and 2i + 1 are the ends of one, or a sphere at every point.
enum class MarkerShape { lines, spheres };
/// Shapes of one colour that a viewer draws.
struct Marker {
  MarkerShape shape = MarkerShape::lines;  ///< Of all points.
  std::string frame;                       ///< Of the points.
  std::string name;                        ///< Namespace: viewers switch markers on and off by it.
  Stamp stamp;                             ///< Must fit: see `fits_ros`.
  std::array<float, 4> color = {};         ///< Red, green, blue, opacity; 0 to 1.
  double width = 0.0;                      ///< Of lines; the diameter of spheres. Metres.
  std::vector<Vector3> points;             ///< Metres.
};
/// A MarkerArray in CDR, whose markers stay until others of their names and numbers replace them.
[[nodiscard]] std::string encode_markers(const std::vector<Marker>& markers);

/// One measurement of an IMU, as sensor_msgs/msg/Imu defines it: a covariance of zeros is unknown, one whose
/// first element is -1 says that its quantity was not measured.
struct ImuMessage {
  std::string frame;                                                ///< Of the IMU, as the header names it.
  ImuSample sample;                                                 ///< With the stamp of the header.
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< As it stands, of any length.
  Matrix3 orientation_covariance = Matrix3::Zero();                 ///< rad^2
  ImuCovariance covariance;                                         ///< Of the sample.
};
/// In CDR. The stamp must fit: see `fits_ros`.
[[nodiscard]] std::string encode_imu(const ImuMessage& imu);
/// Numbers are handed on as they are, also those that are not finite. Fails when the message ends early.
Result<ImuMessage> decode_imu(std::string_view message, MessageEncoding encoding = MessageEncoding::cdr);
/// The first element of the covariance of a quantity that was not measured.
inline constexpr double kUnmeasured = -1.0;
/// Whether a covariance says that its quantity was not measured.
[[nodiscard]] inline bool is_unmeasured(const Matrix3& covariance) { return covariance(0, 0) == kUnmeasured; }

/// What nearly every message starts with.
struct MessageHeader {
  Stamp stamp;        ///< Of what the message tells, not of its arrival.
  std::string frame;  ///< "" where it is of no use.
};
/// Reads no further than the header. Fails when the message is too short for one.
Result<MessageHeader> decode_header(std::string_view message,
                                    MessageEncoding encoding = MessageEncoding::cdr);
/// That of decode_header, which fails for it.
Result<Stamp> decode_stamp(std::string_view message, MessageEncoding encoding = MessageEncoding::cdr);
/// ROS keeps seconds in 32 bits, up to 2038; MCAP none before 0.
[[nodiscard]] bool fits_ros(Stamp stamp);

}  // namespace adit::ros
