// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/pcd.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/stated_pose.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

struct PcdField {
  std::string name;
  ScalarType type = ScalarType::float32;
  std::size_t count = 1;
  [[nodiscard]] std::size_t size() const { return count * size_of(type); }
};

/// The words of the header's lines, by key, checked one by one as they come.
struct PcdHeader {
  std::vector<PcdField> fields;
  std::vector<std::size_t> sizes;
  std::size_t width = 0;
  std::size_t height = 1;
  std::optional<std::size_t> points;
  std::optional<Pose> viewpoint;
  std::string data;

  [[nodiscard]] std::size_t num_points() const { return points.value_or(width * height); }
  [[nodiscard]] std::size_t row_size() const {
    std::size_t size = 0;
    for (const PcdField& field : fields) size += field.size();
    return size;
  }
};

std::optional<ScalarType> scalar_type(std::string_view letter, std::size_t size) {
  if (letter == "F")
    return size == 4   ? std::optional(ScalarType::float32)
           : size == 8 ? std::optional(ScalarType::float64)
                       : std::nullopt;
  const bool is_signed = letter == "I";
  if (!is_signed && letter != "U") return std::nullopt;
  switch (size) {
    case 1:
      return is_signed ? ScalarType::int8 : ScalarType::uint8;
    case 2:
      return is_signed ? ScalarType::int16 : ScalarType::uint16;
    case 4:
      return is_signed ? ScalarType::int32 : ScalarType::uint32;
    case 8:
      return is_signed ? ScalarType::int64 : ScalarType::uint64;
    default:
      return std::nullopt;
  }
}

using Words = std::vector<std::string_view>;

Result<std::size_t> whole_number(std::string_view word) {
  const std::optional<std::size_t> number = parse_size(word);
  // Bounds the products taken later, far above any cloud.
  if (!number || *number > (std::size_t{1} << 40U)) return fail(format("'{}' is not a valid number", word));
  return *number;
}

Result<std::vector<std::size_t>> whole_numbers(const Words& values, std::size_t needed) {
  if (values.size() != needed) return fail(format("{} values for {} fields", values.size(), needed));
  std::vector<std::size_t> numbers;
  for (const std::string_view value : values) {
    const Result<std::size_t> number = whole_number(value);
    if (!number) return tl::unexpected(number.error());
    numbers.push_back(*number);
  }
  return numbers;
}

Result<> set_types(PcdHeader& header, const Words& letters) {
  if (letters.size() != header.fields.size() || header.sizes.size() != header.fields.size()) {
    return fail(
        format("{} values for {} fields; FIELDS and SIZE come before", letters.size(), header.fields.size()));
  }
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const std::optional<ScalarType> type = scalar_type(letters[i], header.sizes[i]);
    if (!type)
      return fail(format("no type {}{}; F4 F8 I1 I2 I4 I8 U1 U2 U4 U8 exist", letters[i], header.sizes[i]));
    header.fields[i].type = *type;
  }
  return {};
}

Result<> set_counts(PcdHeader& header, const Words& values) {
  return whole_numbers(values, header.fields.size())
      .and_then([&](const std::vector<std::size_t>& counts) -> Result<> {
        for (std::size_t i = 0; i < counts.size(); ++i) {
          if (counts[i] > 65536) return fail(format("a field of {} elements", counts[i]));
          header.fields[i].count = counts[i];
        }
        return {};
      });
}

/// tx ty tz qw qx qy qz. The identity is every writer's default and says nothing.
Result<> set_viewpoint(PcdHeader& header, const Words& values) {
  std::vector<double> numbers;
  for (const std::string_view value : values) {
    const std::optional<double> number = parse_double(value);
    if (!number || !std::isfinite(*number)) return fail(format("'{}' is not a finite number", value));
    numbers.push_back(*number);
  }
  if (numbers.size() != 7) return fail(format("{} values; tx ty tz qw qx qy qz are needed", numbers.size()));
  const Vector3 position(numbers[0], numbers[1], numbers[2]);
  const Eigen::Quaterniond rotation(numbers[3], numbers[4], numbers[5], numbers[6]);
  const Result<Pose> viewpoint = stated_pose(position, rotation);
  if (!viewpoint) return tl::unexpected(viewpoint.error());
  if (!position.isZero(0.0) || !rotation.vec().isZero(0.0)) header.viewpoint = *viewpoint;
  return {};
}

/// One line "KEY value...".
Result<> set_entry(PcdHeader& header, std::string_view key, const Words& values) {
  const auto first = [&](auto& target) -> Result<> {
    if (values.size() != 1) return fail("one value is needed");
    return whole_number(values[0]).map([&](std::size_t number) { target = number; });
  };
  if (key == "FIELDS" || key == "COLUMNS") {
    for (const std::string_view name : values) header.fields.push_back({std::string(name)});
    return {};
  }
  if (key == "SIZE") {
    return whole_numbers(values, header.fields.size()).map([&](auto sizes) {
      header.sizes = std::move(sizes);
    });
  }
  if (key == "TYPE") return set_types(header, values);
  if (key == "COUNT") return set_counts(header, values);
  if (key == "WIDTH") return first(header.width);
  if (key == "HEIGHT") return first(header.height);
  if (key == "POINTS") return first(header.points);
  if (key == "DATA" && values.size() == 1) {
    header.data = values[0];
    return {};
  }
  if (key == "VIEWPOINT") return set_viewpoint(header, values);
  if (key == "VERSION") return {};
  return fail("is not a line of a PCD header");
}

Result<PcdHeader> read_pcd_header(LineReader& lines) {
  PcdHeader header;
  while (header.data.empty() && lines.next()) {
    const Words words = split_words(lines.line());
    if (words.empty() || words[0].starts_with('#')) continue;
    const Result<> entry = set_entry(header, words[0], Words(words.begin() + 1, words.end()));
    if (!entry)
      return fail(format("header line {}: {}", lines.number(), words[0].substr(0, 40)), entry.error());
  }
  if (header.data.empty())
    return fail("the header has no DATA line; the file is truncated or not a PCD file");
  if (header.fields.empty()) return fail("the header has no FIELDS line");
  if (header.sizes.empty()) return fail("the header has no SIZE line");
  if (header.num_points() == 0) return fail("the cloud has no points (POINTS 0)");
  return header;
}

/// The rows of an ascii file as binary ones.
Result<std::string> pack_ascii(const PcdHeader& header, LineReader& lines) {
  std::string rows;
  std::size_t num_columns = 0;
  for (const PcdField& field : header.fields) num_columns += field.count;
  for (std::size_t i = 0; i < header.num_points();) {
    if (!lines.next()) {
      return fail(format("line {}: ends after {} of {} points; the file is truncated", lines.number(), i,
                         header.num_points()));
    }
    const Words words = split_words(lines.line());
    if (words.empty()) continue;
    if (words.size() != num_columns) {
      return fail(format("line {}: {} values, {} needed", lines.number(), words.size(), num_columns));
    }
    auto word = words.begin();
    for (const PcdField& field : header.fields) {
      for (std::size_t k = 0; k < field.count; ++k, ++word) {
        if (append_scalar(rows, field.type, *word)) continue;
        return fail(format("line {}: '{}' is not a value of field '{}'", lines.number(), *word, field.name));
      }
    }
    ++i;
  }
  return rows;
}

Result<std::string> expand(const PcdHeader& header, std::string_view body, std::size_t body_offset) {
  if (body.size() < 8)
    return fail(format("byte {}: ends inside the compressed sizes", body_offset + body.size()));
  const auto number = [&](std::size_t at) {
    return static_cast<std::size_t>(load_scalar(ScalarType::uint32, body.data() + at, std::endian::little));
  };
  const std::size_t compressed = number(0);
  const std::size_t size = number(4);
  body.remove_prefix(8);
  if (compressed > body.size()) {
    return fail(format("byte {}: {} compressed bytes announced, {} there; the file is truncated",
                       body_offset + 8, compressed, body.size()));
  }
  if (size != header.num_points() * header.row_size()) {
    return fail(format("byte {}: {} bytes announced for {} points of {} bytes", body_offset + 4, size,
                       header.num_points(), header.row_size()));
  }
  Result<std::string> columns = decompress_lzf(body.substr(0, compressed), size);
  if (!columns) return fail(format("from byte {}", body_offset + 8), columns.error());
  return columns;
}

/// Rows hold all fields of a point one after the other; columns (compressed files) one field of all points.
enum class Order { rows, columns };

Result<CloudFile> unpack_fields(const PcdHeader& header, std::string_view bytes, Order order,
                                const KnownTimes& known) {
  PackedCloud packed;
  packed.known_times = known;
  packed.bytes = bytes;
  packed.num_points = header.num_points();
  std::size_t offset = 0;
  for (const PcdField& field : header.fields) {
    const bool by_rows = order == Order::rows;
    if (field.count > 0)
      assign_field(packed, field.name, {field.type, offset, by_rows ? header.row_size() : field.size()});
    offset += by_rows ? field.size() : field.size() * header.num_points();
  }
  return unpack_file(packed).map([&](CloudFile file) {
    file.viewpoint = header.viewpoint;
    return file;
  });
}

}  // namespace

Result<CloudFile> read_pcd(std::string_view bytes, const KnownTimes& known) {
  LineReader lines(bytes);
  const Result<PcdHeader> header = read_pcd_header(lines);
  if (!header) return tl::unexpected(header.error());
  const std::string_view body = bytes.substr(lines.offset());
  if (header->data == "ascii") {
    return pack_ascii(*header, lines).and_then([&](const std::string& rows) {
      return unpack_fields(*header, rows, Order::rows, known);
    });
  }
  if (header->data == "binary") {
    const std::size_t rows_there = body.size() / std::max<std::size_t>(header->row_size(), 1);
    if (rows_there < header->num_points()) {
      return fail(format("byte {}: ends after {} of {} points; the file is truncated", bytes.size(),
                         rows_there, header->num_points()));
    }
    return unpack_fields(*header, body, Order::rows, known);
  }
  if (header->data == "binary_compressed") {
    return expand(*header, body, lines.offset()).and_then([&](const std::string& columns) {
      return unpack_fields(*header, columns, Order::columns, known);
    });
  }
  return fail(format("header line {}: DATA {}: ascii, binary and binary_compressed exist", lines.number(),
                     header->data));
}

namespace {

std::string viewpoint_text(const Pose& viewpoint) {
  const Vector3& t = viewpoint.translation();
  const Eigen::Quaterniond& q = viewpoint.rotation();
  return format("VIEWPOINT {} {} {} {} {} {} {}\n", t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z());
}

std::string header_text(const PointCloud& cloud, const Pose& viewpoint, std::string_view data,
                        const std::string& comment) {
  const bool has_intensity = !cloud.intensities.empty();
  const auto line = [&](std::string_view key, std::string_view xyz, std::string_view intensity,
                        std::string_view t) {
    return format("{} {}{}{}\n", key, xyz, has_intensity ? intensity : "", cloud.has_times() ? t : "");
  };
  return "# .PCD v0.7 - Point Cloud Data file format\n" + (comment.empty() ? "" : "# " + comment + "\n") +
         "VERSION 0.7\n" + line("FIELDS", "x y z", " intensity", " t") + line("SIZE", "4 4 4", " 4", " 4") +
         line("TYPE", "F F F", " F", " I") + line("COUNT", "1 1 1", " 1", " 1") +
         format("WIDTH {}\nHEIGHT 1\n", cloud.size()) + viewpoint_text(viewpoint) +
         format("POINTS {}\nDATA {}\n", cloud.size(), data);
}

std::string rows_text(const PointCloud& cloud) {
  std::string rows;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f& p = cloud.points[i];
    rows += format("{} {} {}", p.x(), p.y(), p.z());
    if (!cloud.intensities.empty()) rows += format(" {}", cloud.intensities[i]);
    if (cloud.has_times()) rows += format(" {}", cloud.time_offsets_ns[i]);
    rows += '\n';
  }
  return rows;
}

std::string columns_of(const PointCloud& cloud) {
  std::string columns;
  for (int axis = 0; axis < 3; ++axis) {
    for (const Eigen::Vector3f& p : cloud.points) append_little_endian(columns, p[axis]);
  }
  for (const float intensity : cloud.intensities) append_little_endian(columns, intensity);
  for (const std::int32_t t : cloud.time_offsets_ns) append_little_endian(columns, t);
  return columns;
}

}  // namespace

std::string write_pcd(const PointCloud& cloud, PcdData data, const Pose& viewpoint,
                      const std::string& comment) {
  cloud.check();
  switch (data) {
    case PcdData::ascii:
      return header_text(cloud, viewpoint, "ascii", comment) + rows_text(cloud);
    case PcdData::binary:
      return header_text(cloud, viewpoint, "binary", comment) + packed_rows(cloud);
    case PcdData::binary_compressed:
      break;
  }
  const std::string columns = columns_of(cloud);
  const std::string stream = compress_lzf(columns);
  std::string bytes = header_text(cloud, viewpoint, "binary_compressed", comment);
  append_little_endian(bytes, static_cast<std::uint32_t>(stream.size()));
  append_little_endian(bytes, static_cast<std::uint32_t>(columns.size()));
  return bytes + stream;
}

}  // namespace adit
