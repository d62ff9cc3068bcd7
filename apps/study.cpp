// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "adit/core/format.hpp"
#include "adit/core/version.hpp"
#include "adit/evaluation/tables.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/io/tum.hpp"
#include "adit/report/html_report.hpp"
#include "adit/report/metrics_json.hpp"
#include "adit/report/plots.hpp"
#include "adit/report/png.hpp"
#include "adit/report/text_tables.hpp"
#include "inputs.hpp"
#include "joint_pictures.hpp"
#include "progress.hpp"
#include "study_run.hpp"

namespace adit::app {
namespace {

constexpr int kFigureWidthPx = 1400;
constexpr double kFigureMapVoxel = 0.4;

struct Options {
  std::string world;
  std::string routes;
  std::string out;
  std::string lidar = "os2-128";
  std::vector<std::string> keyframes = {"all", "tunnel_filter", "tunnel_filter_keep", "adaptive"};
};

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

Result<World> world_of(const Options& options, const WorldConfig& built_in) {
  if (options.routes.empty() && options.world.empty()) return make_world(built_in);
  if (options.routes.empty()) usage_error("--world needs --routes FILE: where do the robots drive in it?");
  return load_world(options.world, options.routes);
}

/// The two solutions of a pair under one policy, without and with PCM, and the folder of the latter.
Result<> study_pair(const std::vector<const RobotRun*>& runs, KeyframeSelection selection,
                    const RunConfig& given, const std::filesystem::path& dir, StudyResult& study) {
  const RunConfig config = studied_under(selection, given);
  const Result<Meeting> meeting = hold_meeting(selected_maps(runs, selection), config);
  if (!meeting) return tl::unexpected(meeting.error());
  for (const bool pcm_on : {false, true}) {
    BackEndConfig back_end = config.back_end;
    back_end.pcm_on = pcm_on;
    const Result<JudgedSolution> judged = judge(runs, *meeting, meeting->agents.front().solve(back_end));
    if (!judged) return tl::unexpected(judged.error());
    PairResult result = pair_result(runs, *meeting, *judged);
    result.keyframes = to_string(selection);
    result.pcm = pcm_on;
    study.pairs.push_back(std::move(result));
    if (!pcm_on) continue;
    const Session session{{"adit study", {study.world}, config.simulation.seed, study.configuration},
                          meeting->maps,
                          meeting->agents.front().known(),
                          judged->solution,
                          judged->loop_classes};
    const std::filesystem::path folder = dir / "pairs" /
                                         format("{}-{}", runs[0]->result.name, runs[1]->result.name) /
                                         std::string(to_string(selection));
    std::filesystem::create_directories(folder);
    if (const Result<> written = write_session(folder, session, MapFiles::leave_out); !written)
      return written;
  }
  return {};
}

Result<> study_joint(const std::vector<const RobotRun*>& runs, KeyframeSelection selection,
                     const RunConfig& given, const std::filesystem::path& dir, StudyResult& study) {
  const RunConfig config = studied_under(selection, given);
  const Result<Meeting> meeting = hold_meeting(selected_maps(runs, selection), config);
  if (!meeting) return tl::unexpected(meeting.error());
  const Result<JudgedSolution> judged = judge(runs, *meeting, meeting->agents.front().solve(config.back_end));
  if (!judged) return tl::unexpected(judged.error());
  study.joint = joint_result(runs, *meeting, *judged);
  study.joint->keyframes = to_string(selection);
  study.joint->loop_map = loop_map(meeting->agents.front().known(), judged->solution);
  study.joint->merges = merge_pictures(meeting->agents.front().known(), judged->solution);
  for (const auto& map : meeting->maps) {
    study.joint->maps.push_back(
        merged_cloud(*map, judged->solution.T_world_keyframe.at(map->id), kFigureMapVoxel));
  }
  const Session session{{"adit study", {study.world}, config.simulation.seed, study.configuration},
                        meeting->maps,
                        meeting->agents.front().known(),
                        judged->solution,
                        judged->loop_classes};
  std::filesystem::create_directories(dir / "joint");
  return write_session(dir / "joint", session, MapFiles::write);
}

Result<> write_trajectories(const std::vector<RobotRun>& runs, const std::filesystem::path& dir) {
  for (const RobotRun& run : runs) {
    const std::filesystem::path folder = dir / "robots" / run.result.name;
    std::filesystem::create_directories(folder);
    Result<> done = write_tum(folder / "odometry.tum", run.map->odometry);
    if (done && !run.truth.empty()) done = write_tum(folder / "truth.tum", run.truth);
    if (!done) return done;
  }
  return {};
}

Result<> write_figures(const std::vector<Figure>& figures, const std::filesystem::path& dir) {
  std::filesystem::create_directories(dir);
  for (const Figure& figure : figures) {
    if (const Result<> done = write_bytes(dir / (figure.name + ".svg"), figure.svg); !done) return done;
    const Result<std::string> png = png_from_svg(figure.svg, kFigureWidthPx);
    if (!png) return fail(figure.name, png.error());
    if (const Result<> done = write_bytes(dir / (figure.name + ".png"), *png); !done) return done;
  }
  return {};
}

Result<> write_report(const StudyResult& study, const std::vector<Table>& tables,
                      const std::filesystem::path& dir) {
  const std::vector<Figure> figures = study_figures(study);
  std::string markdown;
  for (const Table& table : tables) markdown += markdown_of(table) + "\n";
  Result<> done = write_figures(figures, dir / "figures");
  if (done) done = write_bytes(dir / "tables.md", markdown);
  if (done) done = write_bytes(dir / "metrics.json", metrics_json(study));
  if (done) done = write_bytes(dir / "report.html", html_report(study, tables, figures));
  return done;
}

Result<> run_pairs(const std::vector<RobotRun>& runs, const std::vector<KeyframeSelection>& selections,
                   const RunConfig& config, const std::filesystem::path& dir, StudyResult& study) {
  Progress progress("robot pairs", runs.size() * (runs.size() - 1) / 2 * selections.size());
  for (std::size_t a = 0; a < runs.size(); ++a) {
    for (std::size_t b = a + 1; b < runs.size(); ++b) {
      for (const KeyframeSelection selection : selections) {
        if (interrupted()) return fail("interrupted");
        const Result<> done = study_pair({&runs[a], &runs[b]}, selection, config, dir, study);
        if (!done) return done;
        progress.advance();
      }
    }
  }
  return {};
}

Result<> study(const Options& options, const Common& common) {
  const auto start = std::chrono::steady_clock::now();
  RunConfig config = study_config();
  WorldConfig built_in;
  if (const Result<> chosen = choose_lidar(options.lidar, config.simulation); !chosen)
    usage_error(chosen.error().message);
  const Result<std::vector<KeyframeSelection>> selections = selections_of(options.keyframes);
  if (!selections) usage_error(selections.error().message);
  Fields fields = fields_of(config);
  append(fields, "world", fields_of(built_in));
  if (const Result<> configured = configure(fields, common); !configured) return configured;

  const Result<World> world = world_of(options, built_in);
  if (!world) return tl::unexpected(world.error());
  const Result<std::vector<Recording>> recordings = simulate(*world, config.simulation);
  if (!recordings) return tl::unexpected(recordings.error());
  Result<OutputDir> out = OutputDir::create(options.out, "study");
  if (!out) return tl::unexpected(out.error());
  catch_interrupts();
  const Result<std::vector<RobotRun>> runs = run_robots(*recordings, config);
  if (!runs) return tl::unexpected(runs.error());

  StudyResult study;
  study.version = version();
  study.world = world->name;
  study.lidar = config.simulation.lidar.name;
  study.seed = config.simulation.seed;
  study.configuration = to_toml(fields);
  study.command = "adit study --lidar " + options.lidar;
  study.world_plan = plan_of(world->mesh);
  for (const RobotRun& run : *runs) study.robots.push_back(run.result);
  Result<> done = write_trajectories(*runs, out->path());
  if (done) done = run_pairs(*runs, *selections, config, out->path(), study);
  if (done && runs->size() > 1) {
    std::vector<const RobotRun*> all;
    for (const RobotRun& run : *runs) all.push_back(&run);
    done = study_joint(all, selections->back(), config, out->path(), study);
  }
  if (!done) return done;
  study.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  study.peak_rss_mb = peak_rss_mb();

  const bool like_the_paper = study.world == "zab" && study.robots.size() == 4;
  const std::vector<Table> tables =
      study_tables(study, like_the_paper ? PaperFigures::show : PaperFigures::hide);
  if (done = write_report(study, tables, out->path()); !done) return done;
  if (interrupted()) return fail("interrupted");
  if (done = out->commit(); !done) return done;
  if (common.json) {
    std::printf("%s\n", metrics_json(study).c_str());
    return {};
  }
  for (const Table& table : tables) std::printf("%s\n", text_of(table).c_str());
  std::printf("%.0f s, %.0f MB at most; report: %s\n", study.wall_s, study.peak_rss_mb,
              (std::filesystem::path(options.out) / "report.html").c_str());
  return {};
}

}  // namespace

void add_study(Program& program) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_command("study", "The paper's whole experiment on one world",
                          [options](const Common& common) { return study(*options, common); });
  command->add_option("--world", options->world,
                      "Mesh (PLY, OBJ, STL, DAE, GLB); default: the built-in zab preset");
  command->add_option("--routes", options->routes, "routes.yaml of that world");
  command->add_option("--out", options->out, "Directory to write")->required();
  command->add_option("--lidar", options->lidar, "Simulated LiDAR")->capture_default_str();
  command->add_option("--keyframes", options->keyframes, "Keyframe policies, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
}

}  // namespace adit::app
