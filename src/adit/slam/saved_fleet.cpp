// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/saved_fleet.hpp"

#include <algorithm>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/robot_map_file.hpp"
#include "adit/transport/wire.hpp"

namespace adit {
namespace {

constexpr const char* kMapFile = "map.adit";
constexpr const char* kFindingsFile = "fleet.adit";
constexpr std::string_view kMagic = "adit fleet 1\n";

std::string bytes_of(const std::vector<MessageBody>& findings) {
  std::string file(kMagic);
  for (const MessageBody& finding : findings) {
    const std::vector<std::byte> message = encode({{}, {}, finding});
    const auto size = static_cast<std::uint64_t>(message.size());
    file.append(reinterpret_cast<const char*>(&size), sizeof(size));
    file.append(reinterpret_cast<const char*>(message.data()), message.size());
  }
  return file;
}

Result<std::vector<MessageBody>> findings_in(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) return fail("another layout");
  bytes.remove_prefix(kMagic.size());
  std::vector<MessageBody> findings;
  while (!bytes.empty()) {
    std::uint64_t size = 0;
    if (bytes.size() < sizeof(size)) return fail("the file ends early");
    std::memcpy(&size, bytes.data(), sizeof(size));
    bytes.remove_prefix(sizeof(size));
    if (bytes.size() < size) return fail("the file ends early");
    Result<Message> message = decode(std::as_bytes(std::span(bytes.substr(0, size))));
    if (!message) return tl::unexpected(message.error());
    findings.push_back(std::move(message->body));
    bytes.remove_prefix(size);
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

/// Whether a finding is about robots of the session alone.
struct IsAbout {
  const std::map<RobotId, RobotId>& robots;

  [[nodiscard]] bool knows(RobotId id) const { return robots.contains(id); }
  bool operator()(const Loops& part) const {
    return knows(part.author) && std::ranges::all_of(part.loops, [&](const LoopClosure& loop) {
             return knows(loop.from.robot) && knows(loop.to.robot);
           });
  }
  bool operator()(const MergeChecks& part) const {
    return knows(part.author) && std::ranges::all_of(part.checks, [&](const MergeCheck& check) {
             return knows(check.a) && knows(check.b);
           });
  }
  bool operator()(const auto& /*no finding*/) const { return false; }
};

}  // namespace

Result<> write_fleet(const std::filesystem::path& dir,
                     const std::vector<std::shared_ptr<const RobotMap>>& maps,
                     const std::vector<MessageBody>& findings) {
  const Phase phase("saving maps", maps.size());
  for (const auto& map : maps) {
    if (map->keyframes.empty()) continue;
    if (const Result<> done = write_robot_map(dir / map->name / kMapFile, *map); !done) return done;
    phase.advance();
  }
  return write_bytes(dir / kFindingsFile, bytes_of(findings));
}

Result<SavedFleet> read_fleet(const std::filesystem::path& dir) {
  Result<SavedSession> session = read_session(dir);
  if (!session) return tl::unexpected(session.error());
  SavedFleet fleet;
  fleet.provenance = std::move(session->provenance);
  std::vector<std::string> names;
  for (const std::string& name : session->robots)
    if (std::filesystem::exists(dir / name)) names.push_back(name);
  std::vector<Result<RobotMap>> maps(names.size(), fail("not read"));
  const Phase phase("reading maps", names.size());
  parallel_for_each(names.size(), [&](std::size_t i) {
    maps[i] = read_robot_map(dir / names[i] / kMapFile);
    phase.advance();
  });
  std::map<RobotId, RobotId> ids;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (!maps[i])
      return fail(format("{}: the session cannot go on without this map; make it again with adit slam",
                         maps[i].error().message));
    maps[i]->name = names[i];
    if (!ids.emplace(maps[i]->id, maps[i]->id).second)
      return fail(format("{}: two maps of robot {}", dir.string(), static_cast<int>(maps[i]->id.value)));
    fleet.maps.push_back(std::make_shared<RobotMap>(std::move(*maps[i])));
  }
  std::ranges::sort(fleet.maps, {}, [](const auto& map) { return map->id; });
  const std::string anew = "; its pairs are tested anew";
  const Result<std::string> bytes = read_bytes(dir / kFindingsFile);
  if (!bytes) {
    fleet.notes.push_back(bytes.error().message + anew);
    return fleet;
  }
  Result<std::vector<MessageBody>> findings = findings_in(*bytes);
  const bool are_its_own = findings && std::ranges::all_of(*findings, [&](const MessageBody& finding) {
                             return std::visit(IsAbout{ids}, finding);
                           });
  if (are_its_own)
    fleet.findings = std::move(*findings);
  else
    fleet.notes.push_back(format("{}: {}{}", (dir / kFindingsFile).string(),
                                 findings ? "about other robots" : findings.error().message, anew));
  return fleet;
}

void renumber(SavedFleet& fleet, const std::map<RobotId, RobotId>& ids) {
  for (const auto& map : fleet.maps) {
    map->id = ids.at(map->id);
    for (Keyframe& keyframe : map->keyframes) keyframe.id.robot = map->id;
  }
  for (MessageBody& finding : fleet.findings) std::visit(WithNewIds{ids}, finding);
}

}  // namespace adit
