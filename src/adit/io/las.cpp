// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/las.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "adit/core/version.hpp"
#include "adit/io/atomic_file.hpp"

namespace adit {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers stand in the file as they do in memory");

constexpr std::uint16_t kHeaderSize = 375;
constexpr std::uint16_t kVlrHeaderSize = 54;
constexpr std::uint8_t kPointFormat = 6;
constexpr std::uint16_t kPointSize = 30;
constexpr double kScale = 0.001;  // metres

double in_steps(double metres) { return std::round(metres / kScale) * kScale; }

class Bytes {
 public:
  template <class T>
  void number(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  /// Padded with zeros, or cut.
  void text(std::string value, std::size_t size) {
    value.resize(size, '\0');
    bytes_ += value;
  }
  void zeros(std::size_t size) { bytes_.append(size, '\0'); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string header_of(std::size_t num_points, const Vector3& low, const Vector3& high, std::size_t wkt_size) {
  constexpr std::uint16_t kWkt = 1U << 4U;  // the coordinate system is a WKT
  Bytes out;
  out.text("LASF", 4);
  out.number(std::uint16_t{0});  // file source
  out.number(kWkt);
  out.zeros(16);  // project id
  out.number(std::uint8_t{1});
  out.number(std::uint8_t{4});
  out.text("adit", 32);
  out.text("adit " + std::string(version()), 32);
  out.number(std::uint16_t{0});  // no date: the same map gives the same file
  out.number(std::uint16_t{0});
  out.number(kHeaderSize);
  out.number(static_cast<std::uint32_t>(kHeaderSize + kVlrHeaderSize + wkt_size));
  out.number(std::uint32_t{1});  // records before the points
  out.number(kPointFormat);
  out.number(kPointSize);
  out.zeros(4 + 20);  // counts of LAS 1.3 and before
  for (int i = 0; i < 3; ++i) out.number(kScale);
  for (int i = 0; i < 3; ++i) out.number(std::floor(low[i]));
  for (int i = 0; i < 3; ++i) {
    out.number(in_steps(high[i]));  // as the points are stored
    out.number(in_steps(low[i]));
  }
  out.zeros(8 + 8 + 4);  // no waveforms, no records behind the points
  out.number(static_cast<std::uint64_t>(num_points));
  out.number(static_cast<std::uint64_t>(num_points));  // all of them first returns
  out.zeros(std::size_t{14} * 8);
  return out.bytes();
}

std::string crs_record(const std::string& wkt, std::size_t size) {
  constexpr std::uint16_t kCoordinateSystem = 2112;
  Bytes out;
  out.zeros(2);
  out.text("LASF_Projection", 16);
  out.number(kCoordinateSystem);
  out.number(static_cast<std::uint16_t>(size));
  out.text("OGC coordinate system WKT", 32);
  out.text(wkt, size);
  return out.bytes();
}

}  // namespace

Result<> write_las(const std::filesystem::path& path, const std::vector<LasPoint>& points,
                   const std::string& crs_wkt) {
  constexpr double kFarthest = 2e6;  // metres: what 32 bits hold in millimetres
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 high = -low;
  for (const LasPoint& point : points) {
    if (!point.position.allFinite()) return fail(path.string() + ": a coordinate is not finite");
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  if (points.empty()) low = high = Vector3::Zero();
  if (!((high - low).maxCoeff() < kFarthest))
    return fail(path.string() + ": coordinates are too far apart for a LAS file in millimetres");
  const std::size_t wkt_size = crs_wkt.size() + 1;  // with a zero at the end
  if (wkt_size > std::numeric_limits<std::uint16_t>::max())
    return fail(path.string() + ": the coordinate system takes more than 64 kB");
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  file->stream() << header_of(points.size(), low, high, wkt_size) << crs_record(crs_wkt, wkt_size);
  Bytes body;
  for (const LasPoint& point : points) {
    for (int i = 0; i < 3; ++i)
      body.number(static_cast<std::int32_t>(std::llround((point.position[i] - std::floor(low[i])) / kScale)));
    body.number(point.intensity);
    body.number(std::uint8_t{0x11});  // return 1 of 1
    body.zeros(1);                    // flags
    body.number(std::uint8_t{1});     // unclassified
    body.zeros(1 + 2);                // user data, scan angle
    body.number(point.source);
    body.zeros(8);  // GPS time: unknown underground
  }
  file->stream() << body.bytes();
  return file->commit();
}

}  // namespace adit
