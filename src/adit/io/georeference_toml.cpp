// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <sstream>
#include <system_error>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/georeference.hpp"
#include "adit/io/stated_pose.hpp"
#include "adit/io/toml_depth.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

constexpr const char* kGeoreferenceFile = "georeference.toml";
constexpr std::array kControlUses = {ControlUse::used, ControlUse::rejected, ControlUse::check,
                                     ControlUse::failed_check};

toml::array numbers(std::span<const double> values) {
  toml::array out;
  for (const double value : values) out.push_back(value);
  return out;
}

toml::table point_table(const JudgedControl& judged) {
  const ControlPoint& point = judged.point;
  toml::table out{{"name", point.name},
                  {"target", numbers({point.target.data(), 3})},
                  {"sigma", point.sigma_xy},
                  {"sigma_z", point.sigma_z},
                  {"robot", point.mark.robot},
                  {"mark", numbers({point.mark.position.data(), 3})},
                  {"mark_sigma", point.mark.sigma},
                  {"use", std::string(to_string(judged.use))},
                  {"residual_m", numbers({judged.residual.data(), 3})}};
  if (point.mark.stamp) out.insert("stamp", stamp_text(*point.mark.stamp));
  if (judged.misfit) out.insert("misfit", *judged.misfit);
  return out;
}

toml::table map_table(const Georeference& map) {
  toml::array robots;
  for (const std::string& robot : map.robots) robots.push_back(robot);
  toml::array points;
  for (const JudgedControl& point : map.points) points.push_back(point_table(point));
  const Pose& T = map.T_target_map;
  return toml::table{{"robots", robots},
                     {"crs", map.crs},
                     {"translation", numbers({T.translation().data(), 3})},
                     {"rotation_xyzw", numbers({T.rotation().coeffs().data(), 4})},
                     {"covariance", numbers({map.covariance.data(), 36})},
                     {"chi2", map.chi2},
                     {"redundancy", static_cast<std::int64_t>(map.redundancy)},
                     {"scale_ppm", map.scale_ppm},
                     {"scale_sigma_ppm", map.scale_sigma_ppm},
                     {"far_end", toml::table{{"robot", map.far_end.robot},
                                             {"stamp", stamp_text(map.far_end.stamp)},
                                             {"sigma_xy_m", map.far_end.sigma_xy},
                                             {"sigma_z_m", map.far_end.sigma_z}}},
                     {"points", points}};
}

/// What a table holds; what is missing or of another kind makes it bad.
class TableReader {
 public:
  TableReader(const toml::node* node, bool& is_bad)
      : table_(node == nullptr ? nullptr : node->as_table()), is_bad_(is_bad) {
    is_bad_ |= table_ == nullptr;
  }

  template <class T>
  T value(const char* key) {
    const std::optional<T> found = table_ == nullptr ? std::nullopt : (*table_)[key].value<T>();
    is_bad_ |= !found;
    return found.value_or(T{});
  }
  /// Not `value`: toml++ would cast a fraction, whatever its size.
  std::int64_t integer(const char* key) {
    const toml::node* node = table_ == nullptr ? nullptr : table_->get(key);
    is_bad_ |= node == nullptr || !node->is_integer();
    return is_bad_ ? 0 : node->as_integer()->get();
  }
  template <std::size_t N>
  std::array<double, N> numbers(const char* key) {
    std::array<double, N> out{};
    const toml::array* array = this->array(key);
    is_bad_ |= array == nullptr || array->size() != N;
    for (std::size_t i = 0; !is_bad_ && i < N; ++i) {
      const std::optional<double> number = (*array)[i].value<double>();
      is_bad_ |= !number || !std::isfinite(*number);
      out[i] = number.value_or(0.0);
    }
    return out;
  }
  Vector3 vector(const char* key) { return Eigen::Map<const Vector3>(numbers<3>(key).data()); }
  Stamp stamp(const char* key) {
    const std::optional<Stamp> stamp = parse_stamp(value<std::string>(key));
    is_bad_ |= !stamp;
    return stamp.value_or(Stamp{});
  }
  [[nodiscard]] bool has(const char* key) const { return table_ != nullptr && table_->contains(key); }
  [[nodiscard]] const toml::node* node(const char* key) const {
    return table_ == nullptr ? nullptr : table_->get(key);
  }
  [[nodiscard]] const toml::array* array(const char* key) const {
    const toml::node* found = node(key);
    return found == nullptr ? nullptr : found->as_array();
  }
  [[nodiscard]] bool is_bad() const { return is_bad_; }

 private:
  const toml::table* table_;
  bool& is_bad_;
};

JudgedControl point_in(const toml::node& node, bool& is_bad) {
  TableReader table(&node, is_bad);
  JudgedControl out;
  ControlPoint& point = out.point;
  point.name = table.value<std::string>("name");
  point.target = table.vector("target");
  point.sigma_xy = table.value<double>("sigma");
  point.sigma_z = table.value<double>("sigma_z");
  point.mark = {table.value<std::string>("robot"), table.stamp("stamp"), table.vector("mark"),
                table.value<double>("mark_sigma")};
  for (const double sigma : {point.sigma_xy, point.sigma_z, point.mark.sigma}) is_bad |= !(sigma > 0.0);
  const auto use = table.value<std::string>("use");
  const auto known = std::ranges::find(kControlUses, use, [](ControlUse one) { return to_string(one); });
  is_bad |= known == kControlUses.end();
  if (!is_bad) out.use = *known;
  point.is_check = out.use == ControlUse::check || out.use == ControlUse::failed_check;
  out.residual = table.vector("residual_m");
  if (table.has("misfit")) out.misfit = table.value<double>("misfit");
  return out;
}

Result<Georeference> georeference_in(const toml::node& node) {
  bool is_bad = false;
  TableReader table(&node, is_bad);
  Georeference map;
  if (const toml::array* robots = table.array("robots"))
    for (const toml::node& robot : *robots) map.robots.push_back(robot.value_or(std::string()));
  map.crs = table.value<std::string>("crs");
  const auto q = table.numbers<4>("rotation_xyzw");
  const Result<Pose> T_target_map = stated_pose(table.vector("translation"), {q[3], q[0], q[1], q[2]}, 1e-6);
  map.covariance = Eigen::Map<const Matrix6>(table.numbers<36>("covariance").data());
  map.chi2 = table.value<double>("chi2");
  map.redundancy = static_cast<int>(table.integer("redundancy"));
  map.scale_ppm = table.value<double>("scale_ppm");
  map.scale_sigma_ppm = table.value<double>("scale_sigma_ppm");
  TableReader far_end(table.node("far_end"), is_bad);
  map.far_end = {far_end.value<std::string>("robot"), far_end.stamp("stamp"),
                 far_end.value<double>("sigma_xy_m"), far_end.value<double>("sigma_z_m")};
  if (const toml::array* points = table.array("points"))
    for (const toml::node& point : *points) map.points.push_back(point_in(point, is_bad));
  if (is_bad || !T_target_map || map.robots.empty() || map.points.empty())
    return fail("an entry is missing or damaged; delete the file and run adit georeference again");
  map.T_target_map = *T_target_map;
  return map;
}

}  // namespace

std::string_view to_string(ControlUse use) {
  switch (use) {
    case ControlUse::used:
      return "used";
    case ControlUse::rejected:
      return "rejected";
    case ControlUse::check:
      return "check";
    case ControlUse::failed_check:
      break;
  }
  return "failed check";
}

Result<> write_georeferences(const std::filesystem::path& session, const std::vector<Georeference>& maps) {
  toml::array array;
  for (const Georeference& map : maps) array.push_back(map_table(map));
  std::ostringstream text;
  text << "# Written by adit georeference. p_target = R p_map + translation, metres.\n"
       << toml::table{{"maps", array}} << "\n";
  return write_bytes(session / kGeoreferenceFile, text.str());
}

Result<std::vector<Georeference>> read_georeferences(const std::filesystem::path& session) {
  const std::filesystem::path path = session / kGeoreferenceFile;
  std::vector<Georeference> maps;
  std::error_code unreachable;
  const bool is_there = std::filesystem::exists(path, unreachable);
  if (unreachable) return fail(format("{}: cannot be looked for: {}", path.string(), unreachable.message()));
  if (!is_there) return maps;
  const Result<std::string> text = read_bytes(path);
  if (!text) return tl::unexpected(text.error());
  if (const Result<> checked = check_toml_depth(*text); !checked) return fail(path.string(), checked.error());
  try {
    const toml::table table = toml::parse(*text);
    const toml::array* array = table["maps"].as_array();
    if (array == nullptr) return fail(path.string() + ": no maps in it");
    for (const toml::node& node : *array) {
      Result<Georeference> map = georeference_in(node);
      if (!map) return fail(path.string(), map.error());
      maps.push_back(std::move(*map));
    }
  } catch (const toml::parse_error& error) {
    return fail(format("{}: line {}: {}", path.string(), error.source().begin.line, error.description()));
  }
  return maps;
}

const Georeference* georeference_of(const std::vector<Georeference>& maps, const std::string& robot) {
  for (const Georeference& map : maps)
    if (std::ranges::find(map.robots, robot) != map.robots.end()) return &map;
  return nullptr;
}

}  // namespace adit
