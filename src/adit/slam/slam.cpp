// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/slam.hpp"

#include <algorithm>
#include <cctype>
#include <exception>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/robot_ids.hpp"
#include "adit/core/robot_name.hpp"
#include "adit/fleet/joint/merge_accuracy.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/slam/meeting.hpp"
#include "adit/slam/naming.hpp"
#include "adit/slam/repeated_robots.hpp"
#include "adit/slam/session_pages.hpp"

namespace adit {
namespace {

const std::string& name_of(const std::shared_ptr<RobotMap>& map) { return map->name; }

Provenance provenance_of(const std::vector<SavedFleet>& saved, const Mapping& mapping,
                         const std::vector<RepeatedRobot>& repeated, SlamConfig config) {
  Provenance provenance;
  provenance.command = "adit::slam";
  provenance.configuration = to_toml(fields_of(config));
  for (const SavedFleet& fleet : saved) {
    for (RobotProvenance robot : fleet.provenance.robots) {
      // No part of this session, where another robot may have its name.
      if (robot.failure.empty() && std::ranges::find(fleet.maps, robot.name, name_of) == fleet.maps.end())
        robot.failure = robot.name + ": no keyframe was left of it";
      provenance.robots.push_back(std::move(robot));
    }
  }
  for (const MappedRobot& robot : mapping.robots)
    provenance.robots.push_back(
        {robot.map->name, robot.odometry, robot.lidar, robot.map->odometry.size(), "", robot.T_base_lidar});
  for (const FailedRobot& robot : mapping.failed)
    provenance.robots.push_back({robot.name, "", "", 0, robot.reason});
  for (const RepeatedRobot& robot : repeated)  // saved ones have theirs
    if (!robot.was_saved) provenance.robots.push_back({robot.name, "", "", 0, robot.sentence});
  return provenance;
}

/// The text with whole names replaced, the longest first where several fit.
std::string with_names(const std::string& text, const std::map<std::string, std::string>& new_names) {
  const auto is_part_of_a_name = [&](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) != 0 || text[i] == '_');
  };
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::pair<const std::string, std::string>* longest = nullptr;
    for (const auto& name : new_names) {
      const bool fits = text.compare(i, name.first.size(), name.first) == 0 &&
                        !(i > 0 && is_part_of_a_name(i - 1)) && !is_part_of_a_name(i + name.first.size());
      if (fits && (longest == nullptr || name.first.size() > longest->first.size())) longest = &name;
    }
    out += longest == nullptr ? text.substr(i, 1) : longest->second;
    i += longest == nullptr ? 1 : longest->first.size();
  }
  return out;
}

/// Begins the reasons of all rulings, whatever robots are called.
constexpr std::string_view kByAPerson = "a person ";

/// The sentences of merge checks name robots.
void rename_in(std::vector<MessageBody>& findings, const std::map<std::string, std::string>& new_names) {
  if (new_names.empty()) return;
  for (MessageBody& finding : findings)
    if (auto* part = std::get_if<MergeChecks>(&finding))
      for (MergeCheck& check : part->checks) {
        const std::size_t begin = check.reason.starts_with(kByAPerson) ? kByAPerson.size() : 0;
        check.reason = check.reason.substr(0, begin) + with_names(check.reason.substr(begin), new_names);
      }
}

/// Georeferences name robots.
void rename_in(std::vector<Georeference>& maps, const std::map<std::string, std::string>& new_names) {
  const auto rename = [&](std::string& name) {
    if (const auto found = new_names.find(name); found != new_names.end()) name = found->second;
  };
  for (Georeference& map : maps) {
    std::ranges::for_each(map.robots, rename);
    for (JudgedControl& judged : map.points) rename(judged.point.mark.robot);
    rename(map.far_end.robot);
  }
}

/// What to say of a robot that got another name.
struct Renamed {
  std::string name;  ///< The new one; "" where it does not matter.
  std::string note;
};

/// Distinct names for all, those of the sessions first. What the sessions say of robots that were taken out
/// is said of those that have their maps.
std::vector<Renamed> name_all(std::vector<SavedFleet>& saved, std::vector<Recording>& recordings,
                              const std::vector<TakenOut>& taken_out) {
  std::vector<Renamed> notes;
  std::vector<std::string> names;
  for (const SavedFleet& fleet : saved)
    for (const auto& map : fleet.maps) names.push_back(map->name);
  const std::size_t num_saved = names.size();
  if (num_saved == 0) {
    for (std::string& note : name_robots(recordings)) notes.push_back({"", std::move(note)});
    return notes;
  }
  for (const Recording& recording : recordings) names.push_back(robot_name(recording.name));
  names = distinct_names(names);
  std::size_t next = 0;
  const auto rename = [&](std::string& name) {
    const std::string& distinct = names[next++];
    if (distinct != name)
      notes.push_back(
          {distinct, format("the robot '{}' is called {} here, as that name is taken or can be no folder "
                            "(NAME=FILE chooses another name)",
                            printable(name), distinct)});
    return std::exchange(name, distinct);
  };
  for (std::size_t s = 0; s < saved.size(); ++s) {
    SavedFleet& fleet = saved[s];
    std::map<std::string, std::string> new_names;
    for (const auto& map : fleet.maps) {
      const std::string was = rename(map->name);
      if (was == map->name) continue;
      new_names[was] = map->name;
      const auto of_map = std::ranges::find_if(
          fleet.provenance.robots, [&](const RobotProvenance& robot) { return robot.is_of_map(was); });
      if (of_map != fleet.provenance.robots.end()) of_map->name = map->name;
    }
    for (const TakenOut& robot : taken_out)
      if (robot.session == s) new_names[robot.name] = robot.same->name;
    rename_in(fleet.findings, new_names);
    rename_in(fleet.georeferences, new_names);
  }
  for (Recording& recording : recordings) rename(recording.name);
  return notes;
}

/// Ids 0, 1, 2, ... over all sessions.
Result<> number_all(std::vector<SavedFleet>& saved) {
  std::size_t num = 0;
  for (const SavedFleet& fleet : saved) num += fleet.maps.size();
  const Result<std::vector<RobotId>> ids = robot_ids(num);
  if (!ids) return tl::unexpected(ids.error());
  std::size_t next = 0;
  for (SavedFleet& fleet : saved) {
    std::map<RobotId, RobotId> new_ids;
    for (const auto& map : fleet.maps) new_ids[map->id] = (*ids)[next++];
    renumber(fleet, new_ids);
  }
  return {};
}

Result<> check_comparable(const std::vector<std::shared_ptr<const RobotMap>>& maps) {
  for (const auto& map : maps) {
    ScanContextConfig first = maps.front()->scan_context;
    ScanContextConfig other = map->scan_context;
    if (to_toml(fields_of(first)) != to_toml(fields_of(other)))
      return fail(
          format("{} and {} described places in different ways (fields robot.scan_context.*), so that they "
                 "cannot be compared; map one of them again with the configuration of the other",
                 maps.front()->name, map->name));
  }
  return {};
}

Result<RobotId> robot_called(const FleetGraph& fleet, const std::string& name) {
  std::string names;
  for (const auto& [id, robot] : fleet.robots) {
    if (robot.name == name) return id;
    names += " " + robot.name;
  }
  return fail(format("no robot is called {}; there are:{}", printable(name), names));
}

constexpr std::string_view kQuoting = "; the test had said: ";
constexpr std::string_view kLeftOut = "a person left out the loop of ";

/// What the test had said, to be quoted; a ruling that went before is taken back, not quoted.
std::string quote_of_test(const std::string& reason) {
  std::string_view said = reason;
  while (said.starts_with(kLeftOut)) said.remove_prefix(std::min(said.size(), said.find("; ") + 2));
  if (const std::size_t at = said.find(kQuoting); at != std::string_view::npos)
    said.remove_prefix(at + kQuoting.size());
  return said.empty() ? "" : std::string(kQuoting) + std::string(said);
}

/// The robots of a ruling, and its loop with the keyframe of the first one first.
struct RuledOver {
  RobotPair robots;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> loop;
};
Result<RuledOver> ruled_over(const Ruling& ruling, const FleetGraph& fleet) {
  const Result<RobotId> one = robot_called(fleet, ruling.a);
  if (!one) return tl::unexpected(one.error());
  const Result<RobotId> other = robot_called(fleet, ruling.b);
  if (!other) return tl::unexpected(other.error());
  if (*one == *other) return fail("a ruling is about two robots, not twice about " + ruling.a);
  RuledOver out{std::minmax(*one, *other), {}};
  if (ruling.loop)
    out.loop = *one < *other ? std::pair(ruling.loop->of_a, ruling.loop->of_b)
                             : std::pair(ruling.loop->of_b, ruling.loop->of_a);
  return out;
}

/// "ahead:12 and behind:40"
std::string name_of_loop(const Ruling& ruling) {
  return format("{}:{} and {}:{}", ruling.a, ruling.loop->of_a, ruling.b, ruling.loop->of_b);
}

/// One loop less joins the two.
Result<MergeCheck> without_loop(MergeCheck check, const Ruling& ruling,
                                std::pair<std::uint32_t, std::uint32_t> loop) {
  if (!check.accepted || std::erase(check.loops, loop) == 0)
    return fail(format("the loop of {} joins nothing that could be kept apart; loops.csv lists those in use",
                       name_of_loop(ruling)));
  check.accepted = !check.loops.empty();
  if (!check.accepted) {
    check.refused_kind = RefusalKind::vetoed;
    if (!check.hypotheses.empty()) check.hypotheses.front().outcome = HypothesisOutcome::vetoed;
  }
  check.reason = format("{}{}{}; {}", kLeftOut, name_of_loop(ruling), check.accepted ? "" : ", the last one",
                        check.reason);
  return check;
}

MergeCheck kept_apart(MergeCheck check) {
  check.accepted = false;
  check.refused_kind = RefusalKind::vetoed;
  check.reason = "a person keeps these maps apart" + quote_of_test(check.reason);
  if (!check.hypotheses.empty()) check.hypotheses.front().outcome = HypothesisOutcome::vetoed;
  return check;
}

/// By the best alignment, or by the one that the loop belongs to.
Result<MergeCheck> confirmed(MergeCheck check, const Ruling& ruling, const RuledOver& over) {
  auto hypothesis = check.hypotheses.begin();
  if (over.loop) {
    hypothesis = std::ranges::find_if(check.hypotheses, [&](const MergeHypothesis& one) {
      return std::ranges::find(one.loops, *over.loop) != one.loops.end();
    });
    if (hypothesis == check.hypotheses.end())
      return fail(
          format("the loop of {} belongs to no alignment that could be confirmed; loops.csv lists the "
                 "hypothesis of each",
                 name_of_loop(ruling)));
  }
  if (hypothesis == check.hypotheses.end() || hypothesis->loops.empty())
    return fail(format("{} and {}: no alignment was found that could be confirmed", ruling.a, ruling.b));
  // What a check says of loops and evidence is of the first one.
  HypothesisOutcome& of_first = check.hypotheses.front().outcome;
  if (of_first == HypothesisOutcome::accepted) of_first = HypothesisOutcome::behind;
  if (of_first == HypothesisOutcome::vetoed) of_first = HypothesisOutcome::unsure;
  std::rotate(check.hypotheses.begin(), hypothesis, hypothesis + 1);
  MergeHypothesis& best = check.hypotheses.front();
  best.outcome = HypothesisOutcome::accepted;
  check.accepted = true;
  check.loops = best.loops;
  check.evidence = best.evidence;
  check.num_checked = best.num_checked;
  check.num_passed = best.num_passed;
  check.reason = (over.loop ? "a person confirmed this merge by the loop of " + name_of_loop(ruling)
                            : std::string("a person confirmed this merge")) +
                 quote_of_test(check.reason);
  return check;
}

/// The last verdict of the test itself, among all that were found.
Result<MergeCheck> of_the_test(const Ruling& ruling, const RobotPair& robots,
                               const std::vector<MessageBody>& findings) {
  std::optional<MergeCheck> tested;
  bool is_ruled = false;
  for (const MessageBody& finding : findings) {
    const auto* part = std::get_if<MergeChecks>(&finding);
    if (part == nullptr) continue;
    for (const MergeCheck& check : part->checks) {
      if (RobotPair(check.a, check.b) != robots) continue;
      is_ruled = check.reason.starts_with(kByAPerson);
      if (!is_ruled) tested = check;
    }
  }
  if (!is_ruled)
    return fail(
        format("{} and {}: nobody has ruled over them; there is nothing to withdraw", ruling.a, ruling.b));
  if (!tested)
    return fail(format("{} and {}: the test has said nothing of them that could count in place of the ruling",
                       ruling.a, ruling.b));
  return *tested;
}

/// The verdict that takes the place of the test's, or of a ruling.
Result<MergeCheck> verdict_by(const Ruling& ruling, const Agent& agent) {
  const FleetGraph& fleet = agent.known();
  const Result<RuledOver> over = ruled_over(ruling, fleet);
  if (!over) return tl::unexpected(over.error());
  if (ruling.kind == Ruling::Kind::withdraw) return of_the_test(ruling, over->robots, agent.findings());
  const auto tested = fleet.checks.find(over->robots);
  MergeCheck check;
  if (tested != fleet.checks.end()) check = tested->second;
  check.a = over->robots.first;
  check.b = over->robots.second;
  check.advice.reset();
  if (ruling.kind == Ruling::Kind::confirm) return confirmed(std::move(check), ruling, *over);
  return over->loop ? without_loop(std::move(check), ruling, *over->loop) : kept_apart(std::move(check));
}

Result<> rule(Agent& agent, const std::vector<Ruling>& rulings) {
  if (!rulings.empty() && agent.known().policy != MergePolicy::adaptive)
    return fail(
        "a person rules over merge checks, and this session's keyframe policy makes none; map it with "
        "--keyframes adaptive");
  for (const Ruling& ruling : rulings) {
    Result<MergeCheck> verdict = verdict_by(ruling, agent);
    if (!verdict) return tl::unexpected(verdict.error());
    agent.overrule(std::move(*verdict));
  }
  return {};
}

/// What one robot knows, with the whole graph of each that it heard of in part or not at all, as messages
/// were lost: every robot has its own map, and the session keeps it.
FleetGraph with_all_maps(FleetGraph known, const std::vector<std::shared_ptr<const RobotMap>>& maps,
                         std::vector<std::string>& notes) {
  for (const auto& map : maps) {
    RobotGraph& graph = known.robots[map->id];
    const std::size_t num_lost = map->keyframes.size() - graph.nodes.size();
    if (num_lost == 0 && !graph.name.empty()) continue;
    graph = graph_of(*map);
    if (num_lost > 0)
      notes.push_back(format(
          "{}: of {} of its {} keyframes {} did not hear, as messages were lost (bus.loss): its map is "
          "complete, but loops with others may be missing",
          map->name, num_lost, map->keyframes.size(), maps.front()->name));
  }
  return known;
}

/// The first robot's estimate, brought up to date, beside the solution of all.
EstimateDifference online_difference(Agent& first, const BackEndConfig& config, const FleetSolution& solution,
                                     std::vector<std::string>& notes) {
  try {
    for (const std::string& problem : first.update_estimate(config).problems)
      notes.push_back("online estimate: " + problem);
    return difference(first.estimate(), solution);
  } catch (const std::exception& failure) {  // the session does not need it
    notes.push_back(format("online estimate: {}", failure.what()));
    return {};
  }
}

void append(std::vector<std::string>& to, const std::vector<std::string>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

/// Says first which robots are called otherwise or are there twice. The new name of one that is left out is
/// of no interest.
void note_robots(const std::vector<Renamed>& renamed, SlamRun& run) {
  std::vector<std::string> notes;
  for (const auto& [name, note] : renamed)
    if (name.empty() || std::ranges::find(run.repeated, name, &RepeatedRobot::name) == run.repeated.end())
      notes.push_back(note);
  for (const RepeatedRobot& robot : run.repeated) notes.push_back(robot.sentence);
  run.notes.insert(run.notes.begin(), notes.begin(), notes.end());
}

}  // namespace

Result<SlamRun> slam(std::vector<Recording> recordings, const SlamConfig& config) {
  return slam_on({}, std::move(recordings), config);
}

Result<SlamRun> slam_on(std::vector<SavedFleet> saved, std::vector<Recording> recordings,
                        const SlamConfig& config, const std::vector<Ruling>& rulings) {
  SlamRun run;
  const std::vector<TakenOut> taken_out = take_out_repeated(saved);
  const std::vector<Renamed> renamed = name_all(saved, recordings, taken_out);
  for (const TakenOut& robot : taken_out)
    run.repeated.push_back({robot.name, robot.same->name, true, robot.sentence});
  if (const Result<> done = number_all(saved); !done) return tl::unexpected(done.error());
  std::vector<std::shared_ptr<const RobotMap>> maps;
  std::vector<MetBefore> met_before;
  for (SavedFleet& fleet : saved) {
    append(run.notes, fleet.notes);
    run.georeferences.push_back({fleet.read_from, std::move(fleet.georeferences)});
    maps.insert(maps.end(), fleet.maps.begin(), fleet.maps.end());
    if (fleet.findings.empty()) continue;  // its pairs are tested anew
    met_before.push_back({{}, std::move(fleet.findings)});
    for (const auto& map : fleet.maps) met_before.back().robots.push_back(map->id);
  }
  Mapping mapping;
  if (maps.empty() || !recordings.empty()) {
    Result<Mapping> mapped = map_robots(recordings, config, maps.size());
    if (!mapped) return tl::unexpected(mapped.error());
    mapping = std::move(*mapped);
  }
  run.num_mapped = mapping.robots.size();
  std::ranges::move(leave_out_repeated(maps, mapping.robots), std::back_inserter(run.repeated));
  note_robots(renamed, run);
  for (const MappedRobot& robot : mapping.robots) maps.push_back(robot.map);
  if (const Result<> done = check_comparable(maps); !done) return tl::unexpected(done.error());
  Result<Meeting> meeting = hold_meeting(std::move(maps), config, met_before);
  if (!meeting) return tl::unexpected(meeting.error());
  Agent& first = meeting->agents.front();
  if (const Result<> done = rule(first, rulings); !done) return tl::unexpected(done.error());
  run.session.provenance = provenance_of(saved, mapping, run.repeated, config);
  run.session.fleet = with_all_maps(first.known(), meeting->maps, run.notes);
  {
    const Phase phase("solving");
    run.session.solution = solve(run.session.fleet, config.back_end);
    measure_merges(run.session.solution);
    run.online = online_difference(first, config.back_end, run.session.solution, run.notes);
  }
  run.findings = first.findings();
  run.session.maps = std::move(meeting->maps);
  run.bytes_sent = std::move(meeting->bytes_sent);
  run.failed = std::move(mapping.failed);
  append(run.notes, mapping.notes);
  append(run.notes, meeting->failures);
  return run;
}

Result<> write_slam(const std::filesystem::path& dir, const SlamRun& run) {
  Result<> done = write_session(dir, run.session, MapFiles::write);
  if (done) done = write_fleet(dir, run.session.maps, run.findings);
  if (done) done = write_bytes(dir / "metrics.json", session_metrics(run));
  if (done) done = write_bytes(dir / "report.html", session_page(run.session));
  return done;
}

}  // namespace adit
