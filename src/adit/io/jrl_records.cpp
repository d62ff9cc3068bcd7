// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/jrl_records.hpp"
#include "adit/core/json_text.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/far_out.hpp"
#include "adit/io/json_depth.hpp"
#include "adit/io/stated_pose.hpp"

namespace adit {
namespace jrl {
namespace {

using Json = nlohmann::json;

// Bytes with which a CBOR map begins (RFC 8949, major type 5).
constexpr unsigned char kFirstCborMap = 0xA0;
constexpr unsigned char kLastCborMap = 0xBF;

constexpr std::array<std::string_view, 12> kFactorsLeftOut{
    "RangeFactorPose2",        "RangeFactorPose3",        "RangeFactor2D",        "RangeFactor3D",
    "BearingRangeFactorPose2", "BearingRangeFactorPose3", "BearingRangeFactor2D", "BearingRangeFactor3D",
    "PriorFactorPoint2",       "PriorFactorPoint3",       "BetweenFactorPoint2",  "BetweenFactorPoint3"};

// The member of an object, or null.
const Json& member(const Json& object, const std::string& name) {
  static const Json nothing;
  if (!object.is_object()) return nothing;
  const auto found = object.find(name);
  return found == object.end() ? nothing : *found;
}

Result<double> number(const Json& object, const char* name) {
  const Json& value = member(object, name);
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    return fail(format("'{}' is not a finite number", name));
  return value.get<double>();
}

Result<std::vector<double>> numbers(const Json& object, const char* name, std::size_t count) {
  const Json& list = member(object, name);
  if (!list.is_array() || list.size() != count)
    return fail(format("'{}' needs {} numbers and has {}", name, count, list.is_array() ? list.size() : 0));
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) {
    if (!list[i].is_number() || !std::isfinite(list[i].get<double>()))
      return fail(format("number {} of '{}' is not a finite number", i + 1, name));
    out.push_back(list[i].get<double>());
  }
  return out;
}

Result<std::uint64_t> key_of(const Json& object, const char* name) {
  const Json& value = member(object, name);
  if (!value.is_number_unsigned())
    return fail(format("'{}' is not a key (a whole number of at most 64 bits)", name));
  return value.get<std::uint64_t>();
}

Result<std::string> type_of(const Json& object) {
  const Json& type = member(object, "type");
  if (!type.is_string()) return fail("there is no 'type'");
  return type.get<std::string>();
}

Result<JrlPose> pose3_of(const Json& value) {
  const auto t = numbers(value, "translation", 3);
  if (!t) return tl::unexpected(t.error());
  const auto q = numbers(value, "rotation", 4);
  if (!q) return tl::unexpected(q.error());
  return stated_pose({(*t)[0], (*t)[1], (*t)[2]}, {(*q)[0], (*q)[1], (*q)[2], (*q)[3]});  // w first
}

Result<JrlPose> pose2_of(const Json& value) {
  std::array<double, 3> v{};
  constexpr std::array kNames{"x", "y", "theta"};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Result<double> n = number(value, kNames[i]);
    if (!n) return tl::unexpected(n.error());
    v[i] = *n;
  }
  if (const Result<> checked = check_not_far_out(Eigen::Vector2d(v[0], v[1])); !checked)
    return fail("'x' and 'y'", checked.error());
  return Pose2(v[0], v[1], v[2]);
}

// A pose of this type, Pose2 or Pose3.
Result<JrlPose> pose_of(const Json& value, const std::string& type) {
  const Result<std::string> given = type_of(value);
  if (!given || *given != type) return fail("not a " + type);
  return type == "Pose3" ? pose3_of(value) : pose2_of(value);
}

Result<std::set<JrlFactorId>> factor_ids(const Json& list) {
  std::set<JrlFactorId> ids;
  if (list.is_null()) return ids;
  if (!list.is_array()) return fail("not a list of pairs [entry, measurement]");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Json& id = list[i];
    if (!id.is_array() || id.size() != 2 || !id[0].is_number_unsigned() || !id[1].is_number_unsigned())
      return fail(format("item {} is not a pair [entry, measurement]", i));
    ids.emplace(id[0].get<std::size_t>(), id[1].get<std::size_t>());
  }
  return ids;
}

Result<JrlFactorIds> ids_by_robot(const Json& file, const char* name,
                                  const std::vector<std::string>& robots) {
  const Json& ids = member(file, name);
  if (ids.is_null()) return JrlFactorIds();
  // The first version of the format, for one robot, had the list alone.
  const bool is_list = ids.is_array() && robots.size() == 1;
  if (!ids.is_object() && !is_list)
    return fail(format("'{}' is not an object with one list per robot", name));
  const Json by_robot = is_list ? Json{{robots.front(), ids}} : ids;
  std::map<std::string, std::set<JrlFactorId>> out;
  for (const auto& [robot, list] : by_robot.items()) {
    const auto parsed = factor_ids(list);
    if (!parsed) return fail(format("{}.{}", name, robot), parsed.error());
    out.emplace(robot, *parsed);
  }
  return JrlFactorIds(std::move(out));
}

// The letters, which the library writes as numbers.
Result<std::vector<std::string>> robots_of(const Json& file) {
  const Json& list = member(file, "robots");
  if (!list.is_array() || list.empty()) return fail("there is no list 'robots'");
  std::vector<std::string> robots;
  for (const Json& robot : list) {
    if (robot.is_number_unsigned() && robot.get<std::uint64_t>() < 128) {
      robots.emplace_back(1, static_cast<char>(robot.get<std::uint64_t>()));
    } else if (robot.is_string() && robot.get<std::string>().size() == 1) {
      robots.push_back(robot.get<std::string>());
    } else {
      const std::string text = robot.is_structured() ? robot.type_name() : json_text(robot).substr(0, 40);
      return fail(format("robots: {} is not one letter or its code", text));
    }
    if (std::ranges::count(robots, robots.back()) > 1)
      return fail(format("robots: '{}' comes twice", robots.back()));
  }
  return robots;
}

Result<> check_lists(const Json& file, const char* name, const std::vector<std::string>& robots) {
  for (const auto& [robot, list] : member(file, name).items()) {
    if (std::ranges::count(robots, robot) == 0)
      return fail(format("{}.{}: '{}' is not in the list 'robots'", name, robot, robot));
    if (!list.is_array() && !list.is_null()) return fail(format("{}.{}: not a list", name, robot));
  }
  return {};
}

class RecordsReader {
 public:
  explicit RecordsReader(const Json& file) : file_(file) {}

  Result<JrlRecords> read() {
    for (auto step :
         {&RecordsReader::read_header, &RecordsReader::read_measurements, &RecordsReader::check_ids}) {
      if (const Result<> done = (this->*step)(); !done) return tl::unexpected(done.error());
    }
    for (auto [name, values] :
         {std::pair("initialization", &out_.initialization), std::pair("groundtruth", &out_.truth)}) {
      if (const Result<> done = read_values(name, *values); !done) return tl::unexpected(done.error());
    }
    return std::move(out_);
  }

 private:
  Result<> read_header() {
    if (!file_.is_object()) return fail("not a JSON object: is this a JSON Robot Log?");
    if (file_.contains("solutions"))
      return fail("these are results (JRR), not a data set; give the .jrl file that they solve");
    if (const Json& name = member(file_, "name"); name.is_string()) out_.name = name.get<std::string>();
    const auto robots = robots_of(file_);
    if (!robots) return tl::unexpected(robots.error());
    out_.robots = *robots;
    if (!member(file_, "measurements").is_object())
      return fail("there is no object 'measurements' with a list of entries per robot");
    for (const char* name : {"measurements", "initialization", "groundtruth"})
      if (const Result<> checked = check_lists(file_, name, out_.robots); !checked) return checked;
    for (auto [name, ids] : {std::pair("potential_outlier_factors", &out_.potential),
                             std::pair("outlier_factors", &out_.outliers)}) {
      auto parsed = ids_by_robot(file_, name, out_.robots);
      if (!parsed) return tl::unexpected(parsed.error());
      *ids = std::move(*parsed);
    }
    return {};
  }

  Result<> read_measurements() {
    for (std::size_t r = 0; r < out_.robots.size(); ++r) {
      const Json& entries = member(file_["measurements"], out_.robots[r]);
      for (std::size_t e = 0; e < entries.size(); ++e) {
        throw_if_cancelled();
        const Json& list = member(entries[e], "measurements");
        const std::string entry = format("measurements.{}[{}]", out_.robots[r], e);
        if (!list.is_array() && !list.is_null()) return fail(entry + ": 'measurements' is not a list");
        for (std::size_t m = 0; m < list.size(); ++m) {
          JrlFactor factor{{}, {}, {}, r, {e, m}, format("{}.measurements[{}]", entry, m)};
          const std::string place = factor.place;
          if (const Result<> done = measurement(list[m], std::move(factor)); !done)
            return fail(place, done.error());
        }
      }
    }
    return {};
  }

  Result<> measurement(const Json& json, JrlFactor factor) {
    const Result<std::string> type = type_of(json);
    if (!type) return tl::unexpected(type.error());
    const bool is_prior = *type == "PriorFactorPose2" || *type == "PriorFactorPose3";
    const bool is_between = *type == "BetweenFactorPose2" || *type == "BetweenFactorPose3";
    ids_[out_.robots[factor.robot]].insert(factor.id);
    if (!is_prior && !is_between) {
      ++out_.left_out[*type];
      if (std::ranges::count(kFactorsLeftOut, *type) > 0) return {};
      return fail(
          format("unknown factor type '{}'; adit reads PriorFactor and BetweenFactor of Pose2 or Pose3, and "
                 "leaves out factors of points, ranges and bearings",
                 type->substr(0, 40)));
    }
    using Names = std::vector<const char*>;
    for (const char* name : is_prior ? Names{"key"} : Names{"key1", "key2"}) {
      const Result<std::uint64_t> key = key_of(json, name);
      if (!key) return tl::unexpected(key.error());
      factor.keys.push_back(*key);
    }
    const char* name = is_prior ? "prior" : "measurement";
    const Result<JrlPose> pose = pose_of(member(json, name), type->substr(type->size() - 5));
    if (!pose) return fail(format("'{}'", name), pose.error());
    factor.pose = *pose;
    auto covariance = numbers(json, "covariance", std::holds_alternative<Pose>(*pose) ? 36 : 9);
    if (!covariance) return tl::unexpected(covariance.error());
    factor.covariance = std::move(*covariance);
    out_.factors.push_back(std::move(factor));
    return {};
  }

  // Values of other types, such as landmarks, are passed over.
  Result<> read_values(const char* name, std::vector<JrlValue>& values) {
    for (std::size_t r = 0; r < out_.robots.size(); ++r) {
      const Json& list = member(member(file_, name), out_.robots[r]);
      for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string place = format("{}.{}[{}]", name, out_.robots[r], i);
        const Result<std::string> type = type_of(list[i]);
        if (!type) return fail(place, type.error());
        if (*type != "Pose2" && *type != "Pose3") continue;
        const Result<std::uint64_t> key = key_of(list[i], "key");
        if (!key) return fail(place, key.error());
        const Result<JrlPose> pose = pose_of(list[i], *type);
        if (!pose) return fail(place, pose.error());
        values.push_back({*key, *pose, r, place});
      }
    }
    return {};
  }

  // A mark on what does not exist is a mistake somewhere.
  Result<> check_ids() {
    for (const auto& [name, marks] : {std::pair("potential_outlier_factors", &out_.potential),
                                      std::pair("outlier_factors", &out_.outliers)}) {
      if (!*marks) continue;
      for (const auto& [robot, ids] : **marks) {
        const auto known = ids_.find(robot);
        for (const auto& id : ids) {
          if (known == ids_.end() || !known->second.contains(id))
            return fail(format("{}.{}: there is no measurement [{}, {}]", name, robot, id.first, id.second));
        }
      }
    }
    return {};
  }

  const Json& file_;
  JrlRecords out_;
  std::map<std::string, std::set<JrlFactorId>> ids_;  // of all measurements
};

Json json_of(const JrlPose& pose) {
  if (const Pose2* plane = std::get_if<Pose2>(&pose)) {
    return {{"type", "Pose2"},
            {"x", plane->translation().x()},
            {"y", plane->translation().y()},
            {"theta", plane->theta()}};
  }
  const Pose& space = std::get<Pose>(pose);
  const Vector3& t = space.translation();
  const Eigen::Quaterniond& q = space.rotation();
  return {
      {"type", "Pose3"}, {"translation", {t.x(), t.y(), t.z()}}, {"rotation", {q.w(), q.x(), q.y(), q.z()}}};
}

Json json_of(const JrlFactor& factor) {
  const std::string dimension = std::holds_alternative<Pose>(factor.pose) ? "Pose3" : "Pose2";
  Json out{{"covariance", factor.covariance}};
  if (factor.keys.size() == 1) {
    out["type"] = "PriorFactor" + dimension;
    out["key"] = factor.keys[0];
    out["prior"] = json_of(factor.pose);
  } else {
    out["type"] = "BetweenFactor" + dimension;
    out["key1"] = factor.keys[0];
    out["key2"] = factor.keys[1];
    out["measurement"] = json_of(factor.pose);
  }
  return out;
}

Json json_of(const std::vector<JrlValue>& values, const std::vector<std::string>& robots) {
  Json out = Json::object();
  for (const std::string& robot : robots) out[robot] = Json::array();
  for (const JrlValue& value : values) {
    Json json = json_of(value.pose);
    json["key"] = value.key;
    out[robots[value.robot]].push_back(std::move(json));
  }
  return out;
}

Json json_of(const std::map<std::string, std::set<JrlFactorId>>& ids) {
  Json out = Json::object();
  for (const auto& [robot, list] : ids) {
    out[robot] = Json::array();
    for (const auto& [entry, measurement] : list)
      out[robot].push_back(Json::array({Json(entry), Json(measurement)}));
  }
  return out;
}

}  // namespace
}  // namespace jrl

std::string jrl_text(const JrlRecords& records) {
  jrl::Json file{{"name", records.name}};
  file["robots"] = jrl::Json::array();
  for (const std::string& robot : records.robots) {
    file["robots"].push_back(static_cast<unsigned>(static_cast<unsigned char>(robot.front())));
    file["measurements"][robot] = jrl::Json::array();
  }
  for (const JrlFactor& factor : records.factors) {
    jrl::Json& entries = file["measurements"][records.robots[factor.robot]];
    while (entries.size() <= factor.id.first)
      entries.push_back({{"stamp", entries.size()}, {"measurements", jrl::Json::array()}});
    entries[factor.id.first]["measurements"].push_back(jrl::json_of(factor));
  }
  file["initialization"] = jrl::json_of(records.initialization, records.robots);
  if (!records.truth.empty()) file["groundtruth"] = jrl::json_of(records.truth, records.robots);
  if (records.potential) file["potential_outlier_factors"] = jrl::json_of(*records.potential);
  if (records.outliers) file["outlier_factors"] = jrl::json_of(*records.outliers);
  return json_text(file) + "\n";
}

Result<JrlRecords> parse_jrl_records(const std::string& bytes) {
  const auto first = static_cast<unsigned char>(bytes.empty() ? '\0' : bytes.front());
  const bool is_cbor = first >= jrl::kFirstCborMap && first <= jrl::kLastCborMap;
  const Result<> checked = is_cbor ? check_cbor_depth(bytes) : check_json_depth(bytes);
  if (!checked) return tl::unexpected(checked.error());
  jrl::Json file;
  try {
    file = is_cbor ? jrl::Json::from_cbor(bytes) : jrl::Json::parse(bytes);
  } catch (const jrl::Json::exception& error) {
    return fail(format("not JSON, or cut off: {}", error.what()));
  }
  return jrl::RecordsReader(file).read();
}

}  // namespace adit
