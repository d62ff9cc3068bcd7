// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/saved_fleet.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/crc32.hpp"
#include "adit/io/robot_map_file.hpp"
#include "adit/transport/wire.hpp"

namespace adit {
namespace {

constexpr const char* kMapFile = "map.adit";
constexpr const char* kFindingsFile = "fleet.adit";
constexpr std::string_view kMagic = "adit fleet 1\n";

/// The map that findings are about.
struct AboutMap {
  std::string name;
  RobotId id;
  std::uint64_t num_keyframes = 0;
  std::uint32_t sum = 0;  ///< Of the stamps and poses of its keyframes.
};
AboutMap about(const RobotMap& map) {
  std::string bytes;
  for (const Keyframe& keyframe : map.keyframes) {
    const Eigen::Matrix4d T = keyframe.T_odom_base.matrix();
    bytes.append(reinterpret_cast<const char*>(&keyframe.stamp.ns), sizeof(keyframe.stamp.ns));
    bytes.append(reinterpret_cast<const char*>(T.data()), sizeof(T));
  }
  return {map.name, map.id, map.keyframes.size(), crc32(bytes)};
}

struct SavedFindings {
  std::vector<AboutMap> maps;
  std::vector<std::string> messages;  ///< As the wire has them.
};

class Out {
 public:
  template <class T>
  void number(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void text(std::string_view value) {
    number(static_cast<std::uint64_t>(value.size()));
    bytes_ += value;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// After the bytes have ended everything is zero and `ok` is false.
class In {
 public:
  explicit In(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  T number() {
    T value{};
    const std::string_view part = take(sizeof(T));
    if (!part.empty()) std::memcpy(&value, part.data(), sizeof(T));
    return value;
  }
  std::string text() { return std::string(take(number<std::uint64_t>())); }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::string_view rest() const { return bytes_; }

 private:
  std::string_view take(std::uint64_t size) {
    ok_ = ok_ && size <= bytes_.size();
    if (!ok_) return {};
    const std::string_view part = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return part;
  }
  std::string_view bytes_;
  bool ok_ = true;
};

std::string bytes_of(const SavedFindings& saved) {
  Out content;
  content.number(static_cast<std::uint64_t>(saved.maps.size()));
  for (const AboutMap& map : saved.maps) {
    content.text(map.name);
    content.number(map.id.value);
    content.number(map.num_keyframes);
    content.number(map.sum);
  }
  content.number(static_cast<std::uint64_t>(saved.messages.size()));
  for (const std::string& message : saved.messages) content.text(message);
  Out file;
  file.number(crc32(content.bytes()));
  return std::string(kMagic) + file.bytes() + content.bytes();
}

Result<SavedFindings> parse_findings(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) return fail("written by another version of adit");
  In file(bytes.substr(kMagic.size()));
  const auto sum = file.number<std::uint32_t>();
  if (!file.ok() || crc32(file.rest()) != sum) return fail("damaged, or cut off");
  SavedFindings saved;
  for (auto num = file.number<std::uint64_t>(); num > 0 && file.ok(); --num) {
    AboutMap& map = saved.maps.emplace_back();
    map.name = file.text();
    map.id.value = file.number<std::uint8_t>();
    map.num_keyframes = file.number<std::uint64_t>();
    map.sum = file.number<std::uint32_t>();
  }
  for (auto num = file.number<std::uint64_t>(); num > 0 && file.ok(); --num)
    saved.messages.push_back(file.text());
  if (!file.ok()) return fail("damaged");
  return saved;
}

Result<std::vector<MessageBody>> decoded(const std::vector<std::string>& messages) {
  std::vector<MessageBody> findings;
  for (const std::string& bytes : messages) {
    Result<Message> message = decode(std::as_bytes(std::span(bytes)));
    if (!message) return tl::unexpected(message.error());
    findings.push_back(std::move(message->body));
  }
  return findings;
}

/// Loops and checks alone.
struct WithNewIds {
  const std::map<RobotId, RobotId>& ids;

  void operator()(Loops& part) const {
    part.author = ids.at(part.author);
    for (LoopClosure& loop : part.loops) {
      loop.from.robot = ids.at(loop.from.robot);
      loop.to.robot = ids.at(loop.to.robot);
    }
  }
  void operator()(MergeChecks& part) const {
    part.author = ids.at(part.author);
    for (MergeCheck& check : part.checks) {
      check.a = ids.at(check.a);
      check.b = ids.at(check.b);
    }
  }
  void operator()(auto& /*no finding*/) const {}
};

/// Loops and checks without those of one robot; an author's others are numbered anew.
class WithoutRobot {
 public:
  explicit WithoutRobot(RobotId robot) : robot_(robot) {}

  /// Whether anything is left of the finding.
  bool operator()(Loops& part) {
    std::erase_if(part.loops, [&](const LoopClosure& loop) {
      return loop.from.robot == robot_ || loop.to.robot == robot_;
    });
    return number(part, part.loops.size(), num_loops_);
  }
  bool operator()(MergeChecks& part) {
    std::erase_if(part.checks,
                  [&](const MergeCheck& check) { return check.a == robot_ || check.b == robot_; });
    return number(part, part.checks.size(), num_checks_);
  }
  bool operator()(auto& /*no finding*/) const { return true; }

 private:
  template <class Part>
  bool number(Part& part, std::size_t size, std::map<RobotId, std::uint32_t>& numbers) const {
    std::uint32_t& next = numbers[part.author];
    part.first = next;
    next += static_cast<std::uint32_t>(size);
    return part.author != robot_ && size > 0;
  }

  RobotId robot_;
  std::map<RobotId, std::uint32_t> num_loops_;  ///< By author.
  std::map<RobotId, std::uint32_t> num_checks_;
};

/// Whether a finding is about keyframes of these maps alone.
struct IsAbout {
  const std::map<RobotId, std::uint64_t>& num_keyframes;

  [[nodiscard]] bool knows(RobotId robot, std::uint64_t keyframe = 0) const {
    const auto known = num_keyframes.find(robot);
    return known != num_keyframes.end() && keyframe < known->second;
  }
  [[nodiscard]] bool knows(KeyframeId id) const { return knows(id.robot, id.index); }
  [[nodiscard]] bool knows(const MergeCheck& check) const {
    const auto knows_pair = [&](const auto& pair) {
      return knows(check.a, pair.first) && knows(check.b, pair.second);
    };
    return knows(check.a) && knows(check.b) && std::ranges::all_of(check.loops, knows_pair) &&
           std::ranges::all_of(check.hypotheses, [&](const MergeHypothesis& h) {
             return std::ranges::all_of(h.loops, knows_pair) &&
                    std::ranges::all_of(h.places, [&](const TestedPlace& place) {
                      return knows(check.a, place.a) && knows(check.b, place.b);
                    });
           });
  }
  bool operator()(const Loops& part) const {
    return knows(part.author) && std::ranges::all_of(part.loops, [&](const LoopClosure& loop) {
             return knows(loop.from) && knows(loop.to);
           });
  }
  bool operator()(const MergeChecks& part) const {
    return knows(part.author) &&
           std::ranges::all_of(part.checks, [&](const MergeCheck& check) { return knows(check); });
  }
  bool operator()(const auto& /*no finding*/) const { return false; }
};

/// What was found with exactly these maps.
Result<std::vector<MessageBody>> findings_about(const std::vector<std::shared_ptr<RobotMap>>& maps,
                                                const Result<SavedFindings>& saved) {
  if (!saved) return tl::unexpected(saved.error());
  std::map<RobotId, std::uint64_t> num_keyframes;
  for (const auto& map : maps) {
    const AboutMap now = about(*map);
    const auto then = std::ranges::find(saved->maps, now.id, &AboutMap::id);
    if (then == saved->maps.end() || then->num_keyframes != now.num_keyframes || then->sum != now.sum)
      return fail("found with another map of " + map->name);
    num_keyframes[now.id] = now.num_keyframes;
  }
  Result<std::vector<MessageBody>> findings = decoded(saved->messages);
  if (!findings) return findings;
  const bool are_about_them = std::ranges::all_of(
      *findings, [&](const MessageBody& finding) { return std::visit(IsAbout{num_keyframes}, finding); });
  if (!are_about_them) return fail("about keyframes that do not exist");
  return findings;
}

}  // namespace

Result<> write_fleet(const std::filesystem::path& dir,
                     const std::vector<std::shared_ptr<const RobotMap>>& maps,
                     const std::vector<MessageBody>& findings) {
  const Phase phase("saving maps", maps.size());
  SavedFindings saved;
  for (const auto& map : maps) {
    if (map->keyframes.empty()) continue;
    if (const Result<> done = write_robot_map(dir / map->name / kMapFile, *map); !done) return done;
    saved.maps.push_back(about(*map));
    phase.advance();
  }
  for (const MessageBody& finding : findings) {
    const std::vector<std::byte> message = encode({{}, {}, finding});
    saved.messages.emplace_back(reinterpret_cast<const char*>(message.data()), message.size());
  }
  return write_bytes(dir / kFindingsFile, bytes_of(saved));
}

Result<SavedFleet> read_fleet(const std::filesystem::path& dir) {
  Result<SavedSession> session = read_session(dir);
  if (!session) return tl::unexpected(session.error());
  SavedFleet fleet;
  fleet.read_from = dir;
  fleet.provenance = std::move(session->provenance);
  fleet.georeferences = std::move(session->georeferences);
  const Result<SavedFindings> saved = read_bytes(dir / kFindingsFile).and_then([](const std::string& bytes) {
    return parse_findings(bytes);
  });
  // Robots without keyframes have no map.
  std::vector<std::string> names;
  if (saved) {
    for (const AboutMap& map : saved->maps) names.push_back(map.name);
  } else {
    for (std::size_t i = 0; i < session->robots.size(); ++i)
      if (!session->optimized[i].empty()) names.push_back(session->robots[i]);
  }
  std::vector<Result<RobotMap>> maps(names.size(), fail("not read"));
  const Phase phase("reading maps", names.size());
  parallel_for_each(names.size(), [&](std::size_t i) {
    maps[i] = read_robot_map(dir / names[i] / kMapFile);
    phase.advance();
  });
  std::set<RobotId> ids;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (!maps[i])
      return fail(format("{}: the session cannot go on without this map; make it again with adit slam",
                         maps[i].error().message));
    maps[i]->name = names[i];
    if (!ids.insert(maps[i]->id).second)
      return fail(format("{}: two maps of robot {}", dir.string(), static_cast<int>(maps[i]->id.value)));
    fleet.maps.push_back(std::make_shared<RobotMap>(std::move(*maps[i])));
  }
  std::ranges::sort(fleet.maps, {}, [](const auto& map) { return map->id; });
  Result<std::vector<MessageBody>> findings = findings_about(fleet.maps, saved);
  if (findings)
    fleet.findings = std::move(*findings);
  else
    fleet.notes.push_back(format("{}: {}; its pairs are tested anew", (dir / kFindingsFile).string(),
                                 findings.error().message));
  return fleet;
}

void renumber(SavedFleet& fleet, const std::map<RobotId, RobotId>& ids) {
  for (const auto& map : fleet.maps) {
    map->id = ids.at(map->id);
    for (Keyframe& keyframe : map->keyframes) keyframe.id.robot = map->id;
  }
  for (MessageBody& finding : fleet.findings) std::visit(WithNewIds{ids}, finding);
}

void take_out(SavedFleet& fleet, RobotId robot) {
  std::erase_if(fleet.maps, [&](const auto& map) { return map->id == robot; });
  std::vector<MessageBody> left;
  WithoutRobot without(robot);
  for (MessageBody& finding : fleet.findings)
    if (std::visit(without, finding)) left.push_back(std::move(finding));
  fleet.findings = std::move(left);
}

}  // namespace adit
