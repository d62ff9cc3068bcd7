// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/ply.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::float32;
  std::optional<ScalarType> count_type;  ///< Of the length in front of a list; scalars have none.
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  [[nodiscard]] bool has_lists() const {
    return std::ranges::any_of(properties, [](const PlyProperty& p) { return p.count_type.has_value(); });
  }
};

struct PlyHeader {
  std::optional<PlyData> data;
  std::vector<PlyElement> elements;
};

std::optional<ScalarType> scalar_type(std::string_view name) {
  static constexpr std::pair<std::string_view, ScalarType> kNames[] = {
      {"char", ScalarType::int8},       {"int8", ScalarType::int8},       {"uchar", ScalarType::uint8},
      {"uint8", ScalarType::uint8},     {"short", ScalarType::int16},     {"int16", ScalarType::int16},
      {"ushort", ScalarType::uint16},   {"uint16", ScalarType::uint16},   {"int", ScalarType::int32},
      {"int32", ScalarType::int32},     {"uint", ScalarType::uint32},     {"uint32", ScalarType::uint32},
      {"float", ScalarType::float32},   {"float32", ScalarType::float32}, {"double", ScalarType::float64},
      {"float64", ScalarType::float64}, {"int64", ScalarType::int64},     {"uint64", ScalarType::uint64}};
  const auto found = std::ranges::find(kNames, name, [](const auto& entry) { return entry.first; });
  return found == std::end(kNames) ? std::nullopt : std::optional(found->second);
}

using Words = std::vector<std::string_view>;

Result<> add_property(PlyHeader& header, const Words& words) {
  if (header.elements.empty()) return fail("a property before the first element");
  const bool is_list = words.size() == 5 && words[1] == "list";
  if (!is_list && words.size() != 3)
    return fail("neither 'property TYPE NAME' nor 'property list TYPE TYPE NAME'");
  PlyProperty property;
  property.name = words.back();
  const std::optional<ScalarType> type = scalar_type(words[words.size() - 2]);
  if (!type) return fail(format("unknown type '{}'", words[words.size() - 2]));
  property.type = *type;
  if (is_list) {
    property.count_type = scalar_type(words[2]);
    if (!property.count_type || is_float(*property.count_type))
      return fail("a list's length is a whole number");
  }
  header.elements.back().properties.push_back(property);
  return {};
}

Result<> add_element(PlyHeader& header, const Words& words) {
  const std::optional<std::size_t> count = words.size() == 3 ? parse_size(words[2]) : std::nullopt;
  if (!count || *count > (std::size_t{1} << 40U)) return fail("not 'element NAME COUNT'");
  header.elements.push_back({std::string(words[1]), *count, {}});
  return {};
}

Result<> set_format(PlyHeader& header, const Words& words) {
  const std::string_view name = words.size() > 1 ? words[1] : "";
  if (name == "ascii") header.data = PlyData::ascii;
  if (name == "binary_little_endian") header.data = PlyData::binary_little_endian;
  if (name == "binary_big_endian") header.data = PlyData::binary_big_endian;
  if (header.data) return {};
  return fail("ascii, binary_little_endian and binary_big_endian exist");
}

Result<> set_entry(PlyHeader& header, const Words& words) {
  if (words[0] == "format") return set_format(header, words);
  if (words[0] == "element") return add_element(header, words);
  if (words[0] == "property") return add_property(header, words);
  if (words[0] == "comment" || words[0] == "obj_info") return {};
  return fail("is not a line of a PLY header");
}

Result<PlyHeader> read_ply_header(LineReader& lines) {
  PlyHeader header;
  if (!lines.next() || lines.line() != "ply") return fail("the first line is not 'ply': not a PLY file");
  bool has_end = false;
  while (!has_end && lines.next()) {
    const Words words = split_words(lines.line());
    has_end = !words.empty() && words[0] == "end_header";
    if (words.empty() || has_end) continue;
    const Result<> entry = set_entry(header, words);
    if (!entry)
      return fail(format("header line {}: '{}'", lines.number(), lines.line().substr(0, 60)), entry.error());
  }
  if (!has_end)
    return fail(format("line {}: the header has no end_header; the file is truncated", lines.number()));
  if (!header.data) return fail("the header has no format line");
  return header;
}

/// Steps through the values of the body in the order they are stored.
class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, std::size_t offset, std::endian order)
      : bytes_(bytes), offset_(offset), order_(order) {}
  [[nodiscard]] std::size_t offset() const { return offset_; }
  bool skip(std::size_t count, std::size_t size) {
    if (size != 0 && count > (bytes_.size() - offset_) / size) return false;
    offset_ += count * size;
    return true;
  }
  /// The next value as little-endian bytes, added to `rows`.
  bool append_next(std::string& rows, ScalarType type) {
    const std::size_t begin = offset_;
    if (!skip(1, size_of(type))) return false;
    const std::size_t end = rows.size();
    rows.append(bytes_, begin, size_of(type));
    if (order_ == std::endian::big) std::reverse(rows.begin() + static_cast<std::ptrdiff_t>(end), rows.end());
    return true;
  }
  bool read_list(std::vector<double>& values, const PlyProperty& list) {
    const std::size_t begin = offset_;
    if (!skip(1, size_of(*list.count_type))) return false;
    const double count = load_scalar(*list.count_type, bytes_.data() + begin, order_);
    const std::size_t first = offset_;
    // Before the cast, which has no meaning for 2^64 and for what is less than nothing.
    const bool is_count = count >= 0.0 && count <= static_cast<double>(bytes_.size());
    if (!is_count || !skip(static_cast<std::size_t>(count), size_of(list.type))) return false;
    values.clear();
    for (std::size_t at = first; at < offset_; at += size_of(list.type))
      values.push_back(load_scalar(list.type, bytes_.data() + at, order_));
    return true;
  }
  [[nodiscard]] std::string place() const { return format("byte {}", offset_); }
  static bool end_row() { return true; }

 private:
  std::string_view bytes_;
  std::size_t offset_;
  std::endian order_;
};

/// The same for ascii: one line a row.
class AsciiBody {
 public:
  explicit AsciiBody(LineReader lines) : lines_(lines) {}
  bool append_next(std::string& rows, ScalarType type) {
    return start_row() && next_ < words_.size() && append_scalar(rows, type, words_[next_++]);
  }
  bool read_list(std::vector<double>& values, const PlyProperty& /*list*/) {
    if (!start_row() || next_ >= words_.size()) return false;
    const std::optional<std::size_t> count = parse_size(words_[next_++]);
    if (!count || *count > words_.size() - next_) return false;
    values.clear();
    for (const std::size_t end = next_ + *count; next_ < end; ++next_) {
      const std::optional<double> value = parse_double(words_[next_]);
      if (!value) return false;
      values.push_back(*value);
    }
    return true;
  }
  [[nodiscard]] std::string place() const { return format("line {}", lines_.number()); }
  bool end_row() { return next_ == std::exchange(words_, {}).size(); }

 private:
  bool start_row() {
    while (words_.empty() && lines_.next()) {
      words_ = split_words(lines_.line());
      next_ = 0;
    }
    return !words_.empty();
  }

  LineReader lines_;
  Words words_;
  std::size_t next_ = 0;
};

/// The scalars of all rows of the element as little-endian bytes; each list goes to `on_list(property,
/// values)`.
template <class Body, class OnList>
Result<std::string> pack_element(Body& body, const PlyElement& element, const OnList& on_list) {
  if (element.count > 0 && element.properties.empty())
    return fail(format("element {} has no properties", element.name));
  std::string rows;
  std::vector<double> values;
  for (std::size_t i = 0; i < element.count; ++i) {
    throw_if_cancelled();
    for (const PlyProperty& property : element.properties) {
      const bool read =
          property.count_type ? body.read_list(values, property) : body.append_next(rows, property.type);
      if (!read) {
        return fail(format("{}: {} {} of {}: no value for '{}'; the file is truncated or damaged",
                           body.place(), element.name, i, element.count, property.name));
      }
      if (property.count_type) on_list(property, std::as_const(values));
    }
    if (!body.end_row()) {
      return fail(format("{}: {} {} of {}: more values than properties", body.place(), element.name, i,
                         element.count));
    }
  }
  return rows;
}

/// Names the fields in the packed rows of an element, which must outlive the result.
PackedCloud packed_cloud(std::string_view rows, const PlyElement& element, const KnownTimes& known = {}) {
  PackedCloud packed;
  packed.known_times = known;
  packed.bytes = rows;
  packed.num_points = element.count;
  const std::size_t stride = element.count == 0 ? 0 : rows.size() / element.count;
  std::size_t offset = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.count_type) continue;
    assign_field(packed, property.name, {property.type, offset, stride});
    offset += size_of(property.type);
  }
  return packed;
}

constexpr std::string_view kNoVertices = "the header has no element 'vertex'";

/// Reads through the elements up to `vertex` and unpacks that.
template <class Body>
Result<CloudFile> read_vertices(Body body, const PlyHeader& header, const KnownTimes& known) {
  for (const PlyElement& element : header.elements) {
    const Result<std::string> rows = pack_element(body, element, [](const auto&, const auto&) {});
    if (!rows) return tl::unexpected(rows.error());
    if (element.name != "vertex") continue;
    return unpack_file(packed_cloud(*rows, element, known));
  }
  return fail(std::string(kNoVertices));
}

/// Cuts a polygon into the fan of triangles around its first corner; a point or a line adds nothing.
void append_polygon(TriangleMesh& mesh, const std::vector<double>& corners) {
  // What is not an index of a vertex becomes -1, which check_mesh refuses.
  const auto index = [&](std::size_t k) {
    const bool is_int = corners[k] >= 0.0 && corners[k] <= std::numeric_limits<int>::max();
    return is_int ? static_cast<int>(corners[k]) : -1;
  };
  for (std::size_t k = 2; k < corners.size(); ++k)
    mesh.triangles.emplace_back(index(0), index(k - 1), index(k));
}

Result<std::vector<Eigen::Vector3f>> unpack_vertices(std::string_view rows, const PlyElement& element) {
  PackedCloud packed = packed_cloud(rows, element);
  packed.intensity.reset();
  packed.time.reset();
  return unpack_file(packed).and_then([](CloudFile file) -> Result<std::vector<Eigen::Vector3f>> {
    // Left out as in a cloud, they would shift the indices of the faces.
    if (file.num_skipped_nan > 0) return fail(format("{} vertices are not finite", file.num_skipped_nan));
    return std::move(file.cloud.points);
  });
}

template <class Body>
Result<TriangleMesh> read_polygons(Body body, const PlyHeader& header) {
  TriangleMesh mesh;
  bool has_vertices = false;
  for (const PlyElement& element : header.elements) {
    const auto on_list = [&](const PlyProperty& list, const std::vector<double>& values) {
      const bool is_polygon = list.name == "vertex_indices" || list.name == "vertex_index";
      if (is_polygon && element.name == "face") append_polygon(mesh, values);
    };
    const Result<std::string> rows = pack_element(body, element, on_list);
    if (!rows) return tl::unexpected(rows.error());
    if (element.name != "vertex") continue;
    Result<std::vector<Eigen::Vector3f>> vertices = unpack_vertices(*rows, element);
    if (!vertices) return tl::unexpected(vertices.error());
    mesh.vertices = std::move(*vertices);
    has_vertices = true;
  }
  if (!has_vertices) return fail(std::string(kNoVertices));
  return mesh;
}

/// Calls `use(body, header)` with the body that the header announces.
template <class T, class Use>
Result<T> read_body(std::string_view bytes, const Use& use) {
  LineReader lines(bytes);
  const Result<PlyHeader> header = read_ply_header(lines);
  if (!header) return tl::unexpected(header.error());
  if (header->data == PlyData::ascii) return use(AsciiBody(lines), *header);
  const std::endian order =
      header->data == PlyData::binary_big_endian ? std::endian::big : std::endian::little;
  return use(BinaryBody(bytes, lines.offset(), order), *header);
}

std::string_view name_of(PlyData data) {
  switch (data) {
    case PlyData::ascii:
      return "ascii";
    case PlyData::binary_little_endian:
      return "binary_little_endian";
    case PlyData::binary_big_endian:
      break;
  }
  return "binary_big_endian";
}

std::string header_text(const PointCloud& cloud, PlyData data, const std::string& comment) {
  return format(
             "ply\nformat {} 1.0\n{}element vertex {}\nproperty float x\nproperty float y\nproperty float "
             "z\n{}{}",
             name_of(data), comment.empty() ? "" : "comment " + comment + "\n", cloud.size(),
             cloud.intensities.empty() ? "" : "property float intensity\n",
             cloud.has_times() ? "property int t\n" : "") +
         "end_header\n";
}

std::string ascii_rows(const PointCloud& cloud) {
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

}  // namespace

Result<CloudFile> read_ply(std::string_view bytes, const KnownTimes& known) {
  return read_body<CloudFile>(
      bytes, [&](auto body, const PlyHeader& header) { return read_vertices(body, header, known); });
}

Result<TriangleMesh> read_ply_mesh(std::string_view bytes) {
  return read_body<TriangleMesh>(
      bytes, [](auto body, const PlyHeader& header) { return read_polygons(body, header); });
}

bool ply_has_faces(std::string_view bytes) {
  LineReader lines(bytes);
  const Result<PlyHeader> header = read_ply_header(lines);
  return header && std::ranges::any_of(header->elements, [](const PlyElement& element) {
           return element.name == "face" && element.count > 0;
         });
}

std::string write_ply(const PointCloud& cloud, PlyData data, const std::string& comment) {
  cloud.check();
  if (data == PlyData::ascii) return header_text(cloud, data, comment) + ascii_rows(cloud);
  std::string rows = packed_rows(cloud);
  if (data == PlyData::binary_big_endian) {
    // Every property is four bytes wide.
    for (auto word = rows.begin(); word != rows.end(); word += 4) std::reverse(word, word + 4);
  }
  return header_text(cloud, data, comment) + rows;
}

std::string write_ply(const TriangleMesh& mesh, const std::string& comment) {
  std::string bytes = format(
      "ply\nformat binary_little_endian 1.0\n{}element vertex {}\nproperty float x\nproperty float "
      "y\nproperty "
      "float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      comment.empty() ? "" : "comment " + comment + "\n", mesh.vertices.size(), mesh.triangles.size());
  bytes.reserve(bytes.size() + mesh.vertices.size() * 12 + mesh.triangles.size() * 13);
  for (const Eigen::Vector3f& v : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) append_little_endian(bytes, v[axis]);
  }
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    append_little_endian(bytes, std::uint8_t{3});
    for (int corner = 0; corner < 3; ++corner) append_little_endian(bytes, std::int32_t{triangle[corner]});
  }
  return bytes;
}

}  // namespace adit
