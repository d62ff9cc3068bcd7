// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/ros_messages.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "adit/core/format.hpp"
#include "adit/io/cdr.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/stated_pose.hpp"
#include "adit/io/tum.hpp"

namespace adit::ros {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

// Of visualization_msgs/msg/Marker.
constexpr std::int32_t kLineList = 5;
constexpr std::int32_t kSphereList = 7;

void write_header(CdrWriter& writer, Stamp stamp, std::string_view frame) {
  ADIT_CHECK(fits_ros(stamp), "a ROS stamp has 32 bits of seconds, from 0");
  writer.number(static_cast<std::int32_t>(stamp.ns / kNanosecondsPerSecond));
  writer.number(static_cast<std::uint32_t>(stamp.ns % kNanosecondsPerSecond));
  writer.text(frame);
}

Stamp read_stamp(MessageReader& reader) {
  // The header of ROS 1 counts its messages first.
  if (reader.encoding() == MessageEncoding::ros1) static_cast<void>(reader.number<std::uint32_t>());
  const std::int64_t seconds = reader.number<std::int32_t>();
  const std::int64_t nanoseconds = reader.number<std::uint32_t>();
  return {seconds * kNanosecondsPerSecond + nanoseconds};
}

void write_pose(CdrWriter& writer, const Pose& pose) {
  const Vector3& t = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation();
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) writer.number(value);
}

Result<Pose> read_pose(MessageReader& reader) {
  Vector3 t;
  for (double& value : t) value = reader.number<double>();
  Eigen::Quaterniond q;
  for (double& value : q.coeffs()) value = reader.number<double>();  // stored as x y z w, in the file too
  if (!reader.ok()) return fail(format("byte {}: the message ends inside a pose", reader.offset()));
  const Result<Pose> pose = stated_pose(t, q);
  return pose ? pose : fail(format("byte {}", reader.offset()), pose.error());
}

/// A matrix row by row.
template <class Matrix>
void write_rows(CdrWriter& writer, const Matrix& matrix) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) writer.number(matrix(i, k));
}
template <class Matrix>
void read_rows(MessageReader& reader, Matrix& matrix) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) matrix(i, k) = reader.number<double>();
}

/// sensor_msgs/PointField's numbers.
std::optional<ScalarType> scalar_type(std::uint8_t datatype) {
  static constexpr ScalarType kTypes[] = {ScalarType::int8,    ScalarType::uint8,  ScalarType::int16,
                                          ScalarType::uint16,  ScalarType::int32,  ScalarType::uint32,
                                          ScalarType::float32, ScalarType::float64};
  if (datatype < 1 || datatype > 8) return std::nullopt;
  return kTypes[datatype - 1];
}

Result<CloudMessage> unpacked(const PackedCloud& packed, CloudMessage out) {
  if (packed.num_points == 0) return out;  // nothing was in view; drivers then state no fields either
  return unpack(packed).map([&](CloudFile file) {
    out.scan.cloud = std::move(file.cloud);
    out.times = std::move(file.times);
    return std::move(out);
  });
}

/// For times that count from `time_base`, nanoseconds: from the scan's stamp. Where the two are further apart
/// than two sweeps they are of different clocks, and times are taken to count from the stamp already.
void count_from_stamp(Scan& scan, std::uint64_t time_base) {
  constexpr std::int64_t kRounding = 1'000;  // nanoseconds: drivers keep stamps as floating-point seconds
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  std::vector<std::int32_t>& offsets = scan.cloud.time_offsets_ns;
  if (offsets.empty() || time_base > static_cast<std::uint64_t>(kLargestStamp.ns)) return;
  const auto [first, last] = std::ranges::minmax(offsets);
  const std::int64_t late = static_cast<std::int64_t>(time_base) - scan.stamp.ns;
  if (std::abs(late) < kRounding || std::abs(late) > 2 * std::int64_t{last}) return;
  if (first + late < -kMost || last + late > kMost) return;
  for (std::int32_t& offset : offsets) offset = static_cast<std::int32_t>(offset + late);
}

struct CloudField {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;
};

std::vector<CloudField> fields_of(const PointCloud& cloud) {
  std::vector<CloudField> fields = {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}};
  if (!cloud.intensities.empty()) fields.push_back({"intensity", 12, 7});
  if (cloud.has_times()) fields.push_back({"t", cloud.intensities.empty() ? 12U : 16U, 5});
  return fields;
}

std::vector<CloudField> read_fields(MessageReader& reader) {
  std::vector<CloudField> fields;
  const auto count = reader.number<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && reader.ok(); ++i) {
    CloudField field;
    field.name = reader.text();
    field.offset = reader.number<std::uint32_t>();
    field.datatype = reader.number<std::uint8_t>();
    static_cast<void>(reader.number<std::uint32_t>());  // elements per field; the first is taken
    fields.push_back(std::move(field));
  }
  return fields;
}

/// Rows of an image-like cloud may be padded at their ends; without padding the cloud is one long row.
Result<std::string> dense_rows(std::string_view data, std::uint32_t height, std::uint64_t row,
                               std::uint64_t row_step) {
  if (row_step < row || (height > 0 && data.size() / height < row_step)) {
    return fail(
        format("{} bytes for {} rows of {} bytes; the message is damaged", data.size(), height, row_step));
  }
  std::string dense;
  for (std::uint64_t i = 0; i < height; ++i) dense.append(data.substr(i * row_step, row));
  return dense;
}

}  // namespace

std::string encode_cloud(const Scan& scan, std::string_view frame) {
  const PointCloud& cloud = scan.cloud;
  const std::vector<CloudField> fields = fields_of(cloud);
  const std::string rows = packed_rows(cloud);
  CdrWriter writer;
  write_header(writer, scan.stamp, frame);
  writer.number(std::uint32_t{1}).number(static_cast<std::uint32_t>(cloud.size()));
  writer.number(static_cast<std::uint32_t>(fields.size()));
  for (const CloudField& field : fields) {
    writer.text(field.name).number(field.offset).number(field.datatype).number(std::uint32_t{1});
  }
  writer.number(std::uint8_t{0});
  writer.number(static_cast<std::uint32_t>(4 * fields.size()))
      .number(static_cast<std::uint32_t>(rows.size()));
  writer.blob(rows).number(std::uint8_t{1});
  return writer.take();
}

Result<CloudMessage> decode_cloud(std::string_view message, MessageEncoding encoding,
                                  const KnownTimes& known) {
  MessageReader reader(message, encoding);
  CloudMessage out;
  out.scan.stamp = read_stamp(reader);
  out.frame = reader.text();
  const auto height = reader.number<std::uint32_t>();
  const auto width = reader.number<std::uint32_t>();
  const std::vector<CloudField> fields = read_fields(reader);
  const bool is_big_endian = reader.number<std::uint8_t>() != 0;
  const auto point_step = reader.number<std::uint32_t>();
  const auto row_step = reader.number<std::uint32_t>();
  const std::string_view data = reader.blob();
  if (!reader.ok()) return fail(format("byte {}: the PointCloud2 message ends early", reader.offset()));
  const std::uint64_t row = std::uint64_t{width} * point_step;
  PackedCloud packed;
  std::string dense;
  if (height > 1 && row_step != row) {
    Result<std::string> rows = dense_rows(data, height, row, row_step);
    if (!rows) return tl::unexpected(rows.error());
    dense = std::move(*rows);
  }
  packed.bytes = dense.empty() ? data : std::string_view(dense);
  packed.num_points = std::size_t{width} * height;
  packed.order = is_big_endian ? std::endian::big : std::endian::little;
  packed.stamp = out.scan.stamp;
  packed.known_times = known;
  for (const CloudField& field : fields) {
    if (const auto type = scalar_type(field.datatype))
      assign_field(packed, field.name, {*type, field.offset, point_step});
  }
  if (point_step == 0 && packed.num_points > 1)
    return fail("the points of the PointCloud2 message have zero bytes");
  return unpacked(packed, std::move(out));
}

Result<std::string> describe_cloud(std::string_view message, MessageEncoding encoding) {
  static constexpr std::string_view kNames[] = {"int8",  "uint8",  "int16",   "uint16",
                                                "int32", "uint32", "float32", "float64"};
  MessageReader reader(message, encoding);
  static_cast<void>(read_stamp(reader));
  static_cast<void>(reader.text());
  const auto height = reader.number<std::uint32_t>();
  const auto width = reader.number<std::uint32_t>();
  std::vector<std::string> fields;
  for (const CloudField& field : read_fields(reader)) {
    const bool is_known = field.datatype >= 1 && field.datatype <= 8;
    fields.push_back(
        format("{} {}", field.name, is_known ? kNames[field.datatype - 1] : "of an unknown type"));
  }
  if (!reader.ok()) return fail(format("byte {}: the PointCloud2 message ends early", reader.offset()));
  return format("{}; {} x {} points", fmt::join(fields, ", "), width, height);
}

bool is_livox(std::string_view type) {
  return type == "livox_ros_driver2/msg/CustomMsg" || type == "livox_ros_driver/msg/CustomMsg" ||
         type == "livox_interfaces/msg/CustomMsg";
}

Result<CloudMessage> decode_livox(std::string_view message, MessageEncoding encoding,
                                  const KnownTimes& known) {
  MessageReader reader(message, encoding);
  CloudMessage out;
  out.scan.stamp = read_stamp(reader);
  out.frame = reader.text();
  const auto time_base = reader.number<std::uint64_t>();  // of the first point, nanoseconds
  static_cast<void>(reader.number<std::uint32_t>());  // the number of points, which their sequence repeats
  for (int i = 0; i < 4; ++i) static_cast<void>(reader.number<std::uint8_t>());  // which LiDAR; reserved
  PackedCloud packed;
  packed.num_points = reader.number<std::uint32_t>();
  packed.bytes = reader.rest();
  packed.order = reader.order();
  packed.known_times = {TimeUnit::nanoseconds, known.from_first_point, known.none, known.field};
  const std::size_t stride = encoding == MessageEncoding::cdr ? 20 : 19;  // CDR pads to a multiple of four
  assign_field(packed, "offset_time", {ScalarType::uint32, 0, stride});
  assign_field(packed, "x", {ScalarType::float32, 4, stride});
  assign_field(packed, "y", {ScalarType::float32, 8, stride});
  assign_field(packed, "z", {ScalarType::float32, 12, stride});
  assign_field(packed, "reflectivity", {ScalarType::uint8, 16, stride});
  assign_field(packed, "tag", {ScalarType::uint8, 17, stride});
  assign_field(packed, "line", {ScalarType::uint8, 18, stride});
  packed.stamp = out.scan.stamp;
  if (!reader.ok()) return fail(format("byte {}: the CustomMsg message ends early", reader.offset()));
  return unpacked(packed, std::move(out)).map([&](CloudMessage cloud) {
    count_from_stamp(cloud.scan, time_base);
    return cloud;
  });
}

std::string encode_odometry(const OdometryMessage& odometry) {
  CdrWriter writer;
  write_header(writer, odometry.pose.stamp, odometry.frame);
  writer.text(odometry.child);
  write_pose(writer, odometry.pose.T_world_body);
  write_rows(writer, odometry.covariance.pose);
  write_rows(writer, Vector6(Vector6::Zero()));
  write_rows(writer, odometry.covariance.twist);
  return writer.take();
}

Result<OdometryMessage> decode_odometry(std::string_view message, MessageEncoding encoding) {
  MessageReader reader(message, encoding);
  OdometryMessage out;
  out.pose.stamp = read_stamp(reader);
  out.frame = reader.text();
  out.child = reader.text();
  const Result<Pose> pose = read_pose(reader);
  if (!pose) return tl::unexpected(pose.error());
  out.pose.T_world_body = *pose;
  read_rows(reader, out.covariance.pose);
  Vector6 twist;
  read_rows(reader, twist);
  read_rows(reader, out.covariance.twist);
  if (!reader.ok()) return fail(format("byte {}: the Odometry message ends early", reader.offset()));
  return out;
}

std::string encode_transforms(const std::vector<TransformMessage>& transforms) {
  CdrWriter writer;
  writer.number(static_cast<std::uint32_t>(transforms.size()));
  for (const TransformMessage& transform : transforms) {
    write_header(writer, transform.pose.stamp, transform.frame);
    writer.text(transform.child);
    write_pose(writer, transform.pose.T_world_body);
  }
  return writer.take();
}

Result<TransformsMessage> decode_transforms(std::string_view message, MessageEncoding encoding) {
  MessageReader reader(message, encoding);
  TransformsMessage transforms;
  const auto count = reader.number<std::uint32_t>();
  for (std::uint32_t i = 0; i < count; ++i) {
    TransformMessage transform;
    transform.pose.stamp = read_stamp(reader);
    transform.frame = reader.text();
    transform.child = reader.text();
    const Result<Pose> pose = read_pose(reader);
    if (!reader.ok()) return fail("the TFMessage ends early");
    if (!pose) {
      transforms.left_out.push_back(pose.error());
      continue;
    }
    transform.pose.T_world_body = *pose;
    transforms.links.push_back(std::move(transform));
  }
  if (!reader.ok()) return fail("the TFMessage ends early");
  return transforms;
}

Result<TwistMessage> decode_twist(std::string_view message, MessageEncoding encoding) {
  MessageReader reader(message, encoding);
  TwistMessage out;
  out.stamp = read_stamp(reader);
  out.frame = reader.text();
  read_rows(reader, out.twist);
  if (!reader.ok()) return fail(format("byte {}: the TwistStamped message ends early", reader.offset()));
  if (!out.twist.allFinite()) return fail("a number of the TwistStamped message is not finite");
  return out;
}

Result<JointStateMessage> decode_joint_state(std::string_view message, MessageEncoding encoding) {
  MessageReader reader(message, encoding);
  JointStateMessage out;
  out.stamp = read_stamp(reader);
  static_cast<void>(reader.text());  // the frame, which drivers leave empty
  const auto num_names = reader.number<std::uint32_t>();
  for (std::uint32_t i = 0; i < num_names && reader.ok(); ++i) out.names.emplace_back(reader.text());
  for (std::vector<double>* values : {&out.positions, &out.velocities}) {
    const auto count = reader.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count && reader.ok(); ++i) values->push_back(reader.number<double>());
  }
  if (!reader.ok()) return fail(format("byte {}: the JointState message ends early", reader.offset()));
  return out;
}

std::string encode_path(std::string_view frame, const Trajectory& poses) {
  ADIT_CHECK(!poses.empty(), "a path has the stamp of its first pose");
  CdrWriter writer;
  write_header(writer, poses.front().stamp, frame);
  writer.number(static_cast<std::uint32_t>(poses.size()));
  for (const StampedPose& pose : poses) {
    write_header(writer, pose.stamp, frame);
    write_pose(writer, pose.T_world_body);
  }
  return writer.take();
}

std::string encode_markers(const std::vector<Marker>& markers) {
  CdrWriter writer;
  const auto zero = [&](std::size_t bytes_each, int count) {
    for (int i = 0; i < count; ++i)
      bytes_each == 4 ? writer.number(std::uint32_t{0}) : writer.number(std::uint8_t{0});
  };
  writer.number(static_cast<std::uint32_t>(markers.size()));
  std::int32_t id = 0;
  for (const Marker& marker : markers) {
    const bool round = marker.shape == MarkerShape::spheres;
    write_header(writer, marker.stamp, marker.frame);
    writer.text(marker.name).number(id++).number(round ? kSphereList : kLineList).number(std::int32_t{0});
    write_pose(writer, Pose());
    const double other_sides = round ? marker.width : 0.0;  // lines have none
    for (const double scale : {marker.width, other_sides, other_sides}) writer.number(scale);
    for (const float channel : marker.color) writer.number(channel);
    zero(4, 2);  // for ever
    zero(1, 1);  // not locked to the frame
    writer.number(static_cast<std::uint32_t>(marker.points.size()));
    for (const Vector3& point : marker.points)
      for (const double value : point) writer.number(value);
    zero(4, 1);  // no colours of their own
    writer.text("");
    zero(4, 2);  // a texture's header
    writer.text("").text("");
    zero(4, 2);  // no image, no coordinates in one
    writer.text("").text("").text("");
    zero(4, 1);  // no mesh
    zero(1, 1);
  }
  return writer.take();
}

std::string encode_imu(const ImuMessage& imu) {
  CdrWriter writer;
  write_header(writer, imu.sample.stamp, imu.frame);
  for (const double value : imu.orientation.coeffs()) writer.number(value);
  write_rows(writer, imu.orientation_covariance);
  write_rows(writer, imu.sample.angular_velocity);
  write_rows(writer, imu.covariance.angular_velocity);
  write_rows(writer, imu.sample.specific_force);
  write_rows(writer, imu.covariance.specific_force);
  return writer.take();
}

Result<ImuMessage> decode_imu(std::string_view message, MessageEncoding encoding) {
  MessageReader reader(message, encoding);
  ImuMessage out;
  out.sample.stamp = read_stamp(reader);
  out.frame = reader.text();
  for (double& value : out.orientation.coeffs()) value = reader.number<double>();
  read_rows(reader, out.orientation_covariance);
  read_rows(reader, out.sample.angular_velocity);
  read_rows(reader, out.covariance.angular_velocity);
  read_rows(reader, out.sample.specific_force);
  read_rows(reader, out.covariance.specific_force);
  if (!reader.ok()) return fail(format("byte {}: the Imu message ends early", reader.offset()));
  return out;
}

Result<MessageHeader> decode_header(std::string_view message, MessageEncoding encoding) {
  MessageReader reader(message, encoding);
  MessageHeader header{read_stamp(reader), {}};
  header.frame = reader.text();
  if (!reader.ok()) return fail("the message is too short for a header");
  return header;
}

Result<Stamp> decode_stamp(std::string_view message, MessageEncoding encoding) {
  return decode_header(message, encoding).map([](const MessageHeader& header) { return header.stamp; });
}

bool fits_ros(Stamp stamp) {
  return stamp.ns >= 0 && stamp.ns / kNanosecondsPerSecond <= std::numeric_limits<std::int32_t>::max();
}

}  // namespace adit::ros
