// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// The definitions of ROS messages (common_interfaces, Humble), without their comments.
#include <initializer_list>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/io/ros_messages.hpp"

namespace adit::ros {
namespace {

struct Definition {
  std::string_view type;
  std::string_view fields;
};
constexpr Definition kTime{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"};
constexpr Definition kHeader{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"};
constexpr Definition kPointField{
    "sensor_msgs/PointField",
    "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
    "uint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n"};
constexpr Definition kPoint{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"};
constexpr Definition kVector3{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"};
constexpr Definition kQuaternion{"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"};
constexpr Definition kPose{"geometry_msgs/Pose",
                           "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"};
constexpr Definition kTwistOnly{"geometry_msgs/Twist",
                                "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"};
constexpr Definition kPoseWithCovariance{"geometry_msgs/PoseWithCovariance",
                                         "geometry_msgs/Pose pose\nfloat64[36] covariance\n"};
constexpr Definition kTwistWithCovariance{"geometry_msgs/TwistWithCovariance",
                                          "geometry_msgs/Twist twist\nfloat64[36] covariance\n"};
constexpr Definition kTransform{"geometry_msgs/Transform",
                                "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"};
constexpr Definition kTransformStamped{
    "geometry_msgs/TransformStamped",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"};
constexpr Definition kPoseStamped{"geometry_msgs/PoseStamped",
                                  "std_msgs/Header header\ngeometry_msgs/Pose pose\n"};
constexpr Definition kDuration{"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"};
constexpr Definition kColor{"std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n"};
constexpr Definition kCompressedImage{"sensor_msgs/CompressedImage",
                                      "std_msgs/Header header\nstring format\nuint8[] data\n"};
constexpr Definition kUvCoordinate{"visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n"};
constexpr Definition kMeshFile{"visualization_msgs/MeshFile", "string filename\nuint8[] data\n"};
constexpr Definition kMarker{
    "visualization_msgs/Marker",
    "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 LINE_STRIP=4\nint32 LINE_LIST=5\n"
    "int32 CUBE_LIST=6\nint32 SPHERE_LIST=7\nint32 POINTS=8\nint32 TEXT_VIEW_FACING=9\nint32 "
    "MESH_RESOURCE=10\n"
    "int32 TRIANGLE_LIST=11\nint32 ADD=0\nint32 MODIFY=0\nint32 DELETE=2\nint32 DELETEALL=3\n"
    "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\n"
    "geometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\n"
    "bool frame_locked\ngeometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\nstring texture_resource\n"
    "sensor_msgs/CompressedImage texture\nvisualization_msgs/UVCoordinate[] uv_coordinates\nstring text\n"
    "string mesh_resource\nvisualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n"};
std::string join(std::string_view root, std::initializer_list<Definition> parts) {
  std::string text(root);
  for (const Definition& part : parts) text += format("{:=>80}\nMSG: {}\n{}", "", part.type, part.fields);
  return text;
}

}  // namespace

std::string definition_of(std::string_view type) {
  if (type == kPointCloud2) {
    return join(
        "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool "
        "is_bigendian\n"
        "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
        {kHeader, kTime, kPointField});
  }
  if (type == kOdometry) {
    return join(
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
        "geometry_msgs/TwistWithCovariance twist\n",
        {kHeader, kTime, kPoseWithCovariance, kPose, kPoint, kQuaternion, kTwistWithCovariance, kTwistOnly,
         kVector3});
  }
  if (type == kImu) {
    return join(
        "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
        "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
        "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
        {kHeader, kTime, kQuaternion, kVector3});
  }
  if (type == kPath) {
    return join("std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
                {kHeader, kTime, kPoseStamped, kPose, kPoint, kQuaternion});
  }
  if (type == kMarkers) {
    return join("visualization_msgs/Marker[] markers\n",
                {kMarker, kHeader, kTime, kDuration, kPose, kPoint, kQuaternion, kVector3, kColor,
                 kCompressedImage, kUvCoordinate, kMeshFile});
  }
  ADIT_CHECK(type == kTransforms, "no definition of this type");
  return join("geometry_msgs/TransformStamped[] transforms\n",
              {kTransformStamped, kHeader, kTime, kTransform, kVector3, kQuaternion});
}

}  // namespace adit::ros
