// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/raycaster.hpp"

#ifdef ADIT_EMBREE_4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/pose.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/simd.hpp"
#include "adit/geometry/triangle_distance.hpp"

namespace adit {
namespace {

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, ReleaseDevice>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, ReleaseScene>;

// All that the exact hit of a triangle needs: a corner and the unit normal.
struct FacePlane {
  Eigen::Vector3f corner;
  Eigen::Vector3f normal;
};

std::vector<FacePlane> planes_of(const TriangleMesh& mesh) {
  std::vector<FacePlane> planes;
  planes.reserve(mesh.triangles.size());
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto corner = [&](int i) { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
    const Vector3 a = corner(0).cast<double>();
    const Vector3 normal = (corner(1).cast<double>() - a).cross(corner(2).cast<double>() - a);
    planes.push_back({corner(0), normal.normalized().cast<float>()});
  }
  return planes;
}

template <class T, class Item>
void fill_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, const std::vector<Item>& items) {
  static_assert(sizeof(Item) == 3 * sizeof(T));
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(Item), items.size());
  ADIT_CHECK(buffer != nullptr, "Embree has memory for the mesh");
  T* out = static_cast<T*>(buffer);
  for (const Item& item : items) out = std::copy_n(item.data(), 3, out);
}

// `observer` is the caller's: Embree's own threads have none in scope.
bool goes_on(void* observer, double) {
  return observer == nullptr || !static_cast<const ProgressObserver*>(observer)->cancelled();
}

EmbreeScene embree_scene(RTCDevice device, const TriangleMesh& mesh, EdgeRule edges) {
  EmbreeScene scene(rtcNewScene(device));
  if (edges == EdgeRule::watertight) {
    // Built once and cast at for a few seconds: compact rather than fast.
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT);
  }
  rtcSetSceneProgressMonitorFunction(scene.get(), goes_on, progress_context().observer);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  fill_buffer<float>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.vertices);
  fill_buffer<unsigned>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  throw_if_cancelled();
  ADIT_CHECK(rtcGetDeviceError(device) == RTC_ERROR_NONE, "Embree built its tree");
  return scene;
}

// In place: a query returned by value would be copied right after it was written, which stalls (a sixth of
// all time).
void aim(RTCRayHit& query, const Ray& ray, float max_distance) {
  query.ray.org_x = ray.origin.x();
  query.ray.org_y = ray.origin.y();
  query.ray.org_z = ray.origin.z();
  query.ray.dir_x = ray.direction.x();
  query.ray.dir_y = ray.direction.y();
  query.ray.dir_z = ray.direction.z();
  query.ray.tnear = 0.0F;
  query.ray.tfar = max_distance;
  query.ray.time = 0.0F;
  query.ray.mask = ~0U;
  query.ray.flags = 0;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}

// What Embree needs of a block of rays besides origins and directions, and its answers.
struct Query {
  RayBlock::Numbers near{};
  RayBlock::Numbers times{};
  std::array<unsigned, RayBlock::kCapacity> masks;
  std::array<unsigned, RayBlock::kCapacity> flags{};
  RayBlock::Numbers far;
  RayBlock::Vectors normals;
  RayBlock::Numbers u;
  RayBlock::Numbers v;
  std::array<unsigned, RayBlock::kCapacity> triangles;
  std::array<unsigned, RayBlock::kCapacity> geometries;
  std::array<unsigned, RayBlock::kCapacity> instances;

  explicit Query(float max_distance) {
    masks.fill(~0U);
    far.fill(max_distance);
    geometries.fill(RTC_INVALID_GEOMETRY_ID);
    instances.fill(RTC_INVALID_GEOMETRY_ID);
  }
};

#ifdef ADIT_EMBREE_4

RTCIntersectArguments arguments_of(RTCRayQueryFlags flags) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = flags;
  return arguments;
}

void intersect(RTCScene scene, RTCRayHit& query) {
  RTCIntersectArguments arguments = arguments_of(RTC_RAY_QUERY_FLAG_INCOHERENT);
  rtcIntersect1(scene, &query, &arguments);
}

constexpr std::size_t kPacket = 16;

/// Rays `begin` to `end` of the block; what lies beyond is repeated, and masked.
void fill(RTCRayHit16& packet, const RayBlock& block, const Query& query, std::size_t begin,
          std::size_t end) {
  for (std::size_t k = 0; k < kPacket; ++k) {
    const std::size_t i = std::min(begin + k, end - 1);
    packet.ray.org_x[k] = block.origins.x[i];
    packet.ray.org_y[k] = block.origins.y[i];
    packet.ray.org_z[k] = block.origins.z[i];
    packet.ray.dir_x[k] = block.directions.x[i];
    packet.ray.dir_y[k] = block.directions.y[i];
    packet.ray.dir_z[k] = block.directions.z[i];
    packet.ray.tnear[k] = 0.0F;
    packet.ray.tfar[k] = query.far[i];
    packet.ray.time[k] = 0.0F;
    packet.ray.mask[k] = ~0U;
    packet.ray.flags[k] = 0;
    packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
  }
}

/// Embree 4 has no streams of rays.
void intersect(RTCScene scene, RayBlock& block, Query& query) {
  RTCIntersectArguments arguments = arguments_of(RTC_RAY_QUERY_FLAG_COHERENT);
  for (std::size_t begin = 0; begin < block.size; begin += kPacket) {
    const std::size_t end = std::min(begin + kPacket, block.size);
    RTCRayHit16 packet;
    fill(packet, block, query, begin, end);
    alignas(64) std::array<int, kPacket> valid{};
    std::fill_n(valid.begin(), end - begin, -1);
    rtcIntersect16(valid.data(), scene, &packet, &arguments);
    for (std::size_t i = begin; i < end; ++i) {
      query.far[i] = packet.ray.tfar[i - begin];
      query.triangles[i] = packet.hit.primID[i - begin];
      query.geometries[i] = packet.hit.geomID[i - begin];
    }
  }
}

#else

RTCIntersectContext context_of(RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

void intersect(RTCScene scene, RTCRayHit& query) {
  RTCIntersectContext context = context_of(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcIntersect1(scene, &context, &query);
}

RTCRayHitNp stream_of(RayBlock& block, Query& query) {
  RTCRayHitNp out;
  out.ray = {block.origins.x.data(),    block.origins.y.data(),    block.origins.z.data(),
             query.near.data(),         block.directions.x.data(), block.directions.y.data(),
             block.directions.z.data(), query.times.data(),        query.far.data(),
             query.masks.data(),        query.flags.data(),        query.flags.data()};
  out.hit = {query.normals.x.data(),  query.normals.y.data(),  query.normals.z.data(),
             query.u.data(),          query.v.data(),          query.triangles.data(),
             query.geometries.data(), {query.instances.data()}};
  return out;
}

void intersect(RTCScene scene, RayBlock& block, Query& query) {
  RTCRayHitNp rays = stream_of(block, query);
  RTCIntersectContext context = context_of(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcIntersectNp(scene, &context, &rays, static_cast<unsigned>(block.size));
}

#endif

// The planes of the triangles that a block of rays met.
struct PlaneBlock {
  RayBlock::Vectors corners;
  RayBlock::Vectors normals;
};

// A plane's own distance; Embree's is used only where the ray is so nearly parallel to the triangle that the
// plane equation is ill-conditioned.
ADIT_WIDE_VECTORS void measure(const PlaneBlock& planes, const RayBlock::Vectors& origins,
                               const RayBlock::Vectors& directions, const RayBlock::Numbers& embree_distances,
                               RayBlock::Numbers& distances, RayBlock::Numbers& cosines, std::size_t size) {
  const auto& [nx, ny, nz] = planes.normals;
  const auto& [cx, cy, cz] = planes.corners;
  const auto& [ox, oy, oz] = origins;
  const auto& [dx, dy, dz] = directions;
  for (std::size_t i = 0; i < size; ++i) {
    const double to_plane =
        double{nx[i]} * (double{cx[i]} - double{ox[i]}) +
        (double{ny[i]} * (double{cy[i]} - double{oy[i]}) + double{nz[i]} * (double{cz[i]} - double{oz[i]}));
    const double approach =
        double{nx[i]} * double{dx[i]} + (double{ny[i]} * double{dy[i]} + double{nz[i]} * double{dz[i]});
    const auto exact = static_cast<float>(to_plane / approach);
    const float embree = embree_distances[i];
    distances[i] = std::abs(exact - embree) < 1e-3F * (1.0F + embree) ? exact : embree;
    cosines[i] = std::abs(nx[i] * dx[i] + (ny[i] * dy[i] + nz[i] * dz[i]));
  }
}

// Of a search for the nearest triangle: the mesh as Embree holds it, and what was found.
struct Nearest {
  const float* vertices;
  const unsigned* triangles;
  Vector3 point;
  double squared_distance;
};

// Embree calls it for each triangle that may be nearer than the best one so far.
bool compare_triangle(RTCPointQueryFunctionArguments* arguments) {
  Nearest& nearest = *static_cast<Nearest*>(arguments->userPtr);
  std::array<Vector3, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const float* vertex = nearest.vertices + 3UL * nearest.triangles[3UL * arguments->primID + i];
    corners[i] = Vector3(vertex[0], vertex[1], vertex[2]);
  }
  const double squared = squared_distance_to_triangle(nearest.point, corners);
  if (squared >= nearest.squared_distance) return false;
  nearest.squared_distance = squared;
  // A little more than the distance, which was rounded to a float: what is nearer by less is looked at, too.
  arguments->query->radius = static_cast<float>(std::sqrt(squared) * (1.0 + 1e-6));
  return true;
}

}  // namespace

struct Raycaster::Scene {
  Device device;
  EmbreeScene embree;
  std::vector<FacePlane> planes;

  // Embree's own distance is used only where the ray is nearly parallel to the triangle.
  [[nodiscard]] RayHit hit_of(const RTCRayHit& answer, const Ray& ray) const {
    if (answer.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    const FacePlane& plane = planes[answer.hit.primID];
    const Vector3 normal = plane.normal.cast<double>();
    const Vector3 to_corner = plane.corner.cast<double>() - ray.origin.cast<double>();
    const auto exact = static_cast<float>(normal.dot(to_corner) / normal.dot(ray.direction.cast<double>()));
    const float embree_distance = answer.ray.tfar;
    const bool agree = std::abs(exact - embree_distance) <= 1e-3F * (1.0F + embree_distance);
    return {agree ? exact : embree_distance, plane.normal};
  }
};

Result<Raycaster> Raycaster::build(const TriangleMesh& mesh, EdgeRule edges) {
  if (const Result<> checked = check_mesh(mesh); !checked) return tl::unexpected(checked.error());
  auto scene = std::make_shared<Scene>();
  // No thread limit here: Embree would put it on the TBB of the whole process for as long as the device
  // lives.
  scene->device = Device(rtcNewDevice(nullptr));
  ADIT_CHECK(scene->device != nullptr, "Embree starts");
  scene->embree = embree_scene(scene->device.get(), mesh, edges);
  scene->planes = planes_of(mesh);
  return Raycaster(std::move(scene));
}

RayHit Raycaster::cast(const Ray& ray, float max_distance) const {
  RTCRayHit query;
  aim(query, ray, max_distance);
  intersect(scene_->embree.get(), query);
  return scene_->hit_of(query, ray);
}

float Raycaster::distance(const Eigen::Vector3f& point, float max_distance) const {
  const RTCGeometry geometry = rtcGetGeometry(scene_->embree.get(), 0);
  Nearest nearest{static_cast<const float*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0)),
                  static_cast<const unsigned*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_INDEX, 0)),
                  point.cast<double>(), std::numeric_limits<double>::infinity()};
  RTCPointQuery query{point.x(), point.y(), point.z(), 0.0F, max_distance};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene_->embree.get(), &query, &context, compare_triangle, &nearest);
  const auto distance = static_cast<float>(std::sqrt(nearest.squared_distance));
  return distance <= max_distance ? distance : RayHit::kMiss;
}

void Raycaster::cast(RayBlock& block, float max_distance) const {
  Query query(max_distance);
  intersect(scene_->embree.get(), block, query);
  PlaneBlock planes;
  for (std::size_t i = 0; i < block.size; ++i) {
    const bool hit = query.geometries[i] != RTC_INVALID_GEOMETRY_ID;
    const FacePlane& plane = scene_->planes[hit ? query.triangles[i] : 0];
    planes.corners.x[i] = plane.corner.x();
    planes.corners.y[i] = plane.corner.y();
    planes.corners.z[i] = plane.corner.z();
    planes.normals.x[i] = plane.normal.x();
    planes.normals.y[i] = plane.normal.y();
    planes.normals.z[i] = plane.normal.z();
    if (!hit) query.far[i] = RayHit::kMiss;
  }
  measure(planes, block.origins, block.directions, query.far, block.distances, block.cosines, block.size);
}

}  // namespace adit
