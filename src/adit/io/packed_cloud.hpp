// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Clouds as binary files and messages hold them: fields of any numeric type at fixed strides.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/recording_config.hpp"
#include "adit/core/records.hpp"
#include "adit/core/time.hpp"
#include "adit/io/cloud_files.hpp"

namespace adit {

/// How a number is stored; the names end in its bits.
enum class ScalarType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
/// In bytes.
[[nodiscard]] std::size_t size_of(ScalarType type);
/// "float64"
[[nodiscard]] std::string_view to_string(ScalarType type);
/// Whether it is stored as a floating-point number of either size.
[[nodiscard]] bool is_float(ScalarType type);

/// The number at `bytes`, which must hold size_of(type) bytes.
[[nodiscard]] double load_scalar(ScalarType type, const char* bytes, std::endian order);
/// Appends the number that `word` spells as little-endian bytes of that type; false when it is not a number
/// or out of range.
bool append_scalar(std::string& bytes, ScalarType type, std::string_view word);
/// Appends the bytes of a number, least significant first.
template <class T>
void append_little_endian(std::string& bytes, T value);

/// Point i's value of the field lies at offset + i * stride.
struct PackedField {
  ScalarType type = ScalarType::float32;  ///< Of each value.
  std::size_t offset = 0;                 ///< Of point 0, in bytes from the start of PackedCloud::bytes.
  std::size_t stride = 0;                 ///< Bytes from a point's value to the next point's.
};

/// Where in some bytes the numbers of a cloud lie.
struct PackedCloud {
  std::string_view bytes;                   ///< Of somebody else, who keeps them until the cloud is unpacked.
  std::size_t num_points = 0;               ///< Those that are not finite included.
  std::endian order = std::endian::little;  ///< Of all fields.
  std::optional<Stamp> stamp;               ///< Of the scan, where known: the origin of absolute point times.
  /// Coordinates in the unit of the file. `unpack` needs all three.
  ///@{
  std::optional<PackedField> x;
  std::optional<PackedField> y;
  std::optional<PackedField> z;
  ///@}
  std::optional<PackedField> intensity;     ///< In any unit, which is kept.
  std::optional<PackedField> reflectivity;  ///< The intensity where there is none.
  std::optional<PackedField> time;          ///< Of each point: from the stamp, or absolute.
  std::string time_name = {};               ///< Of the field `time`.
  KnownTimes known_times = {};              ///< None: as `unpack` finds it.
  std::vector<std::string> names = {};      ///< Of all fields that assign_field was shown, for errors.
};

/// Takes the field when its name is one that clouds use (see pcd.hpp), of times the one that `known_times`
/// states, and its place is still free; keeps its name in any case.
void assign_field(PackedCloud& cloud, std::string_view name, PackedField field);

/// Where the unit of point times is not known, it is the one that makes the sweep last 2 ms to 2 s; where
/// none does, or a hundred times are not there to tell, floats are seconds and integers nanoseconds. Signed
/// integers are nanoseconds. Times count from the stamp where they lie within two sweeps, or a quarter of a
/// second, of zero; else they are absolute. Absolute ones that lie further from the stamp than 2.1 s, as by
/// another clock, or have no stamp, count from the earliest point. Under stamps that holds for all clouds if
/// it does for the first; where the first one's did not, later ones that are so far away are an error. A
/// first cloud of a hundred points or more that have one time has no times, nor have those after it. Fails
/// when x, y or z is absent, or the field that is stated for times (where these are taken), a field reaches
/// past the bytes, or times span more than 2.1 s. Where no point is finite, the cloud is empty.
Result<CloudFile> unpack(PackedCloud packed);
/// `unpack` of a file: fails where it has no finite point, too.
Result<CloudFile> unpack_file(const PackedCloud& packed);

/// Whether `config.stamp_at` is one of its values.
Result<> check_stamp_at(const RecordingConfig& config);
/// For times that count from the start of the sweep under a stamp of its end: the last point gets the stamp.
/// Fails when times span more than 2.1 s.
Result<> put_stamp_at_end(Scan& scan);

/// x y z float32, [intensity float32], [t int32 ns], point after point, little-endian: what adit writes
/// everywhere.
[[nodiscard]] std::string packed_rows(const PointCloud& cloud);

template <class T>
void append_little_endian(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little, "adit runs on little-endian machines");
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

}  // namespace adit
