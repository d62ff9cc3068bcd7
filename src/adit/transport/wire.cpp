// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/transport/wire.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <string>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "adit/transport/wire_bytes.hpp"
#include "adit/transport/wire_merge_checks.hpp"

namespace adit {
namespace wire {

constexpr double kFarthest = 1e7;     // metres in each direction, a quarter of the Earth's circumference
constexpr float kPointStep = 0.005F;  // metres
constexpr float kPointReach = kPointStep * 32767.0F;
// Intensities from 0.0011 to 93,000 in a byte, whatever their unit.
constexpr float kCodesPerTenfold = 32.0F;
constexpr float kCodeOfOne = 96.0F;

// One `put` and one `get` a type, side by side.

void put(Writer& out, std::uint8_t value) { out.scalar(value); }
void get(Reader& in, std::uint8_t& value) { value = in.scalar<std::uint8_t>(); }

void put(Writer& out, std::uint32_t value) { out.scalar(value); }
void get(Reader& in, std::uint32_t& value) { value = in.scalar<std::uint32_t>(); }

void put(Writer& out, const Pose& pose) {
  for (int i = 0; i < 3; ++i) out.scalar(pose.translation()[i]);
  for (int i = 0; i < 4; ++i) out.scalar(pose.rotation().coeffs()[i]);
}
void get(Reader& in, Pose& pose) {
  Vector3 t;
  Eigen::Quaterniond q;
  for (int i = 0; i < 3; ++i) t[i] = in.scalar<double>();
  for (int i = 0; i < 4; ++i) q.coeffs()[i] = in.scalar<double>();
  const bool is_finite = in.ok() && t.allFinite() && q.coeffs().allFinite();
  // No robot was farther away, and sums of squares of such poses would not be finite.
  const bool valid = is_finite && t.cwiseAbs().maxCoeff() <= kFarthest && std::abs(q.norm() - 1.0) < 1e-6;
  if (!valid) return in.refuse();
  pose = Pose(q, t);
}

void put(Writer& out, const Matrix6& symmetric) {
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) out.scalar(symmetric(row, column));
  }
}
void get(Reader& in, Matrix6& symmetric) {
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      symmetric(row, column) = symmetric(column, row) = in.scalar<double>();
    }
  }
  if (!symmetric.allFinite()) in.refuse();
}

void put(Writer& out, KeyframeId id) {
  out.scalar(id.robot.value);
  out.scalar(id.index);
}
void get(Reader& in, KeyframeId& id) {
  id.robot.value = in.scalar<std::uint8_t>();
  id.index = in.scalar<std::uint32_t>();
}

void put(Writer& out, const Eigen::Vector3f& point) {
  for (int i = 0; i < 3; ++i) out.scalar(static_cast<std::int16_t>(std::lround(point[i] / kPointStep)));
}
void get(Reader& in, Eigen::Vector3f& point) {
  for (int i = 0; i < 3; ++i) point[i] = static_cast<float>(in.scalar<std::int16_t>()) * kPointStep;
}

void put(Writer& out, const ScanContext& context) { out.vector(encode(context)); }
void get(Reader& in, ScanContext& context) {
  std::vector<std::uint8_t> bytes;
  in.vector(bytes);
  Result<ScanContext> decoded = decode(std::span<const std::uint8_t>(bytes));
  if (!in.ok() || !decoded) return in.refuse();
  context = std::move(*decoded);
}

void put(Writer& out, const Hello::Known& known) {
  out.scalar(known.robot.value);
  out.scalar(known.num_nodes);
  out.scalar(known.num_places);
  out.scalar(known.num_loops);
  out.scalar(known.num_checks);
}
void get(Reader& in, Hello::Known& known) {
  known.robot.value = in.scalar<std::uint8_t>();
  known.num_nodes = in.scalar<std::uint32_t>();
  known.num_places = in.scalar<std::uint32_t>();
  known.num_loops = in.scalar<std::uint32_t>();
  known.num_checks = in.scalar<std::uint32_t>();
}

void put(Writer& out, const GraphNode& node) {
  out.scalar(node.stamp.ns);
  put(out, node.T_odom_base);
  put(out, node.step_covariance);
}
void get(Reader& in, GraphNode& node) {
  node.stamp.ns = in.scalar<std::int64_t>();
  get(in, node.T_odom_base);
  get(in, node.step_covariance);
}

void put(Writer& out, const Places::Place& place) {
  out.scalar(place.index);
  put(out, place.context);
}
void get(Reader& in, Places::Place& place) {
  place.index = in.scalar<std::uint32_t>();
  get(in, place.context);
}

bool is_within_reach(const Eigen::Vector3f& point) { return point.cwiseAbs().maxCoeff() <= kPointReach; }
void put_within_reach(Writer& out, const std::vector<Eigen::Vector3f>& points) {
  std::vector<Eigen::Vector3f> near;
  std::ranges::copy_if(points, std::back_inserter(near), is_within_reach);
  out.vector(near);
}
/// Of the points within reach: its logarithm; 0 where it is not positive.
void put_intensities(Writer& out, const Clouds::Cloud& cloud) {
  ADIT_CHECK(cloud.intensities.empty() || cloud.intensities.size() == cloud.points.size(),
             "one intensity per point, or none at all");
  std::vector<std::uint8_t> codes;
  for (std::size_t i = 0; i < cloud.intensities.size(); ++i) {
    if (!is_within_reach(cloud.points[i])) continue;
    const float intensity = cloud.intensities[i];
    const float code = kCodeOfOne + kCodesPerTenfold * std::log10(std::max(intensity, 1e-9F));
    codes.push_back(intensity > 0.0F ? static_cast<std::uint8_t>(std::lround(std::clamp(code, 1.0F, 255.0F)))
                                     : 0);
  }
  out.vector(codes);
}
void get_intensities(Reader& in, Clouds::Cloud& cloud) {
  std::vector<std::uint8_t> codes;
  in.vector(codes);
  if (!codes.empty() && codes.size() != cloud.points.size()) return in.refuse();
  for (const std::uint8_t code : codes)
    cloud.intensities.push_back(
        code == 0 ? 0.0F : std::pow(10.0F, (static_cast<float>(code) - kCodeOfOne) / kCodesPerTenfold));
}
void put(Writer& out, const Clouds::Cloud& cloud) {
  out.scalar(cloud.index);
  put(out, cloud.viewpoint);
  put_share(out, cloud.unconfirmed);
  put_within_reach(out, cloud.points);
  put_within_reach(out, cloud.beside);
  put_intensities(out, cloud);
}
void get(Reader& in, Clouds::Cloud& cloud) {
  cloud.index = in.scalar<std::uint32_t>();
  get(in, cloud.viewpoint);
  get_share(in, cloud.unconfirmed);
  in.vector(cloud.points);
  in.vector(cloud.beside);
  get_intensities(in, cloud);
}

void put(Writer& out, const LoopClosure& loop) {
  put(out, loop.from);
  put(out, loop.to);
  put(out, loop.T_from_to);
  put(out, loop.information);
  out.scalar(loop.place_distance);
  out.scalar(loop.num_inliers);
  out.scalar(loop.overlap);
  out.scalar(loop.weak_axis);
  out.scalar(static_cast<std::uint8_t>(loop.verdict));
  put(out, loop.reason);
}
void get(Reader& in, LoopClosure& loop) {
  get(in, loop.from);
  get(in, loop.to);
  get(in, loop.T_from_to);
  get(in, loop.information);
  loop.place_distance = in.scalar<double>();
  loop.num_inliers = in.scalar<int>();
  loop.overlap = in.scalar<double>();
  loop.weak_axis = in.scalar<double>();
  for (const double value : {loop.place_distance, loop.overlap, loop.weak_axis})
    if (!std::isfinite(value)) in.refuse();
  loop.verdict = in.scalar<std::uint8_t>() == 0 ? LoopVerdict::accepted : LoopVerdict::rejected;
  get(in, loop.reason);
}

void put(Writer& out, const Hello& hello) {
  out.vector(hello.known);
  out.scalar(static_cast<std::uint8_t>(hello.answer ? 1 : 0));
}
void get(Reader& in, Hello& hello) {
  in.vector(hello.known);
  hello.answer = in.scalar<std::uint8_t>() != 0;
}

void put(Writer& out, const GraphPart& part) {
  out.scalar(part.owner.value);
  put(out, part.name);
  out.scalar(part.first_index);
  out.vector(part.nodes);
}
void get(Reader& in, GraphPart& part) {
  part.owner.value = in.scalar<std::uint8_t>();
  get(in, part.name);
  part.first_index = in.scalar<std::uint32_t>();
  in.vector(part.nodes, kNodesPerMessage);
}

void put(Writer& out, const Places& places) {
  out.scalar(places.first);
  out.vector(places.places);
  out.scalar(static_cast<std::uint8_t>(places.last ? 1 : 0));
}
void get(Reader& in, Places& places) {
  places.first = in.scalar<std::uint32_t>();
  in.vector(places.places, kPlacesPerMessage);
  places.last = in.scalar<std::uint8_t>() != 0;
}

void put(Writer& out, CloudKind kind) { out.scalar(kind); }
void get(Reader& in, CloudKind& kind) {
  kind = in.scalar<CloudKind>();
  if (kind > CloudKind::submap) in.refuse();
}

void put(Writer& out, const CloudRequest& request) {
  put(out, request.kind);
  out.vector(request.indices);
}
void get(Reader& in, CloudRequest& request) {
  get(in, request.kind);
  in.vector(request.indices, kCloudsPerMessage);
}

void put(Writer& out, const Clouds& clouds) {
  put(out, clouds.kind);
  out.vector(clouds.clouds);
}
void get(Reader& in, Clouds& clouds) {
  get(in, clouds.kind);
  in.vector(clouds.clouds, kCloudsPerMessage);
}

void put(Writer& out, const Loops& loops) {
  out.scalar(loops.author.value);
  out.scalar(loops.first);
  out.vector(loops.loops);
}
void get(Reader& in, Loops& loops) {
  loops.author.value = in.scalar<std::uint8_t>();
  loops.first = in.scalar<std::uint32_t>();
  in.vector(loops.loops, kLoopsPerMessage);
}

using Body = decltype(Message::body);

/// The body that `kind` (its index in the variant) names.
template <std::size_t Index = 0>
std::optional<Body> body_of(Reader& in, std::size_t kind) {
  if constexpr (Index == std::variant_size_v<Body>) {
    return std::nullopt;
  } else {
    if (kind != Index) return body_of<Index + 1>(in, kind);
    std::variant_alternative_t<Index, Body> body;
    get(in, body);
    return body;
  }
}

}  // namespace wire

std::vector<std::byte> encode(const Message& message) {
  wire::Writer out;
  out.scalar(kProtocolVersion);
  out.scalar(message.from.value);
  out.scalar(message.to.value);
  out.scalar(static_cast<std::uint8_t>(message.body.index()));
  std::visit([&](const auto& body) { put(out, body); }, message.body);
  std::vector<std::byte> bytes = out.take();
  const std::uint64_t hash = checksum(bytes);
  const auto* begin = reinterpret_cast<const std::byte*>(&hash);
  bytes.insert(bytes.end(), begin, begin + sizeof(hash));
  return bytes;
}

std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t hash = mix64(bytes.size());
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(hash)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min(sizeof(word), bytes.size() - at));
    hash = mix64(hash, word);
  }
  return hash;
}

Result<Message> decode(std::span<const std::byte> bytes) {
  if (bytes.empty()) return fail("message without bytes");
  const auto version = static_cast<std::uint8_t>(bytes.front());
  if (version < kOldestProtocolVersion || version > kProtocolVersion) {
    return fail(format("message of protocol version {}, this adit reads {} to {}", version,
                       kOldestProtocolVersion, kProtocolVersion));
  }
  constexpr std::size_t kTail = sizeof(std::uint64_t);
  const std::span<const std::byte> content = bytes.first(bytes.size() - std::min(bytes.size(), kTail));
  if (content.empty() ||
      wire::Reader(bytes.last(kTail), version).scalar<std::uint64_t>() != checksum(content)) {
    return fail(format("message of {} bytes is cut or damaged: its checksum does not fit", bytes.size()));
  }
  wire::Reader in(content.subspan(1), version);
  Message message;
  message.from.value = in.scalar<std::uint8_t>();
  message.to.value = in.scalar<std::uint8_t>();
  const std::size_t kind = in.scalar<std::uint8_t>();
  std::optional<wire::Body> body = wire::body_of(in, kind);
  if (!body) return fail(format("message of unknown kind {}", kind));
  if (!in.ok()) return fail(format("message of kind {} is malformed near byte {}", kind, in.at() + 1));
  if (!in.at_end()) return fail(format("message of kind {} has more bytes than it needs", kind));
  message.body = std::move(*body);
  return message;
}

}  // namespace adit
