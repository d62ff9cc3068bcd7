// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whatever happens to the process of a command that writes, earlier output stays: Ctrl-C and SIGTERM in
/// every phase, a full disk, a folder that is read-only or cannot be made. Also, what a terminal shows
/// meanwhile.
#include <gtest/gtest.h>
#include <array>
#include <numbers>
#include <regex>

#include "adit/io/g2o.hpp"
#include "support/hall.hpp"
#include "support/process.hpp"
#include "support/program.hpp"
#include "support/small_disk.hpp"

namespace adit {
namespace {

using Words = std::vector<std::string>;
using test::Ended;
using test::put_file;
using test::tree_of;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double kSlowdown = 10.0;
#else
constexpr double kSlowdown = 1.0;
#endif

/// What the commands read: two robots that meet in a hall, the recording of one of them, graphs, and lists of
/// both.
class Inputs {
 public:
  explicit Inputs(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::string routes() const {
    test::put_hall(folder_);
    const auto drive = [](const std::string& name, double begin, double end) {
      Route route{.name = name, .speed_mps = 1.8, .waypoints = {}};
      const double step = begin < end ? 1.0 : -1.0;
      for (double x = begin; (end - x) * step >= 0.0; x += step) route.waypoints.emplace_back(x, 0.0, 0.0);
      return route;
    };
    EXPECT_TRUE(write_routes(at("routes.yaml"),
                             {"hall.ply", {drive("alpha", 3.0, 22.0), drive("beta", 37.0, 12.0)}}));
    return at("routes.yaml");
  }

  [[nodiscard]] std::string recording() const {
    test::expect_done("simulate --lidar vlp-16 --robot alpha --routes " + routes() + " --out " +
                      at("recordings"));
    return at("recordings/alpha.mcap");
  }

  /// A robot on a square that it drives around often, with a loop to each earlier lap.
  std::string graph(std::size_t num_nodes) const {
    constexpr std::size_t kLap = 400;
    PoseGraph graph;
    for (std::size_t i = 0; i < num_nodes; ++i) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / kLap;
      const double drift = 1e-5 * static_cast<double>(i);
      graph.nodes.push_back(
          {i, Pose::planar((50.0 + drift) * std::cos(angle), 50.0 * std::sin(angle), angle)});
      const auto link = [&](std::size_t from, const Pose& T_from_to, EdgeKind kind) {
        graph.edges.push_back({from, i, T_from_to, Matrix6::Identity(), kind});
      };
      if (i > 0) link(i - 1, graph.nodes[i - 1].pose.inverse() * graph.nodes[i].pose, EdgeKind::odometry);
      for (std::size_t lap = kLap; lap <= i && i % 4 == 0; lap += kLap) link(i - lap, Pose(), EdgeKind::loop);
    }
    std::ofstream file(at("graph.g2o"));
    write_g2o(file, graph);
    return at("graph.g2o");
  }

  [[nodiscard]] std::string list_of_worlds() const {
    routes();
    put_file(at("worlds.toml"), "[[world]]\nname = 'hall'\ngroup = 'check'\nroutes_file = 'routes.yaml'\n");
    return at("worlds.toml");
  }

  [[nodiscard]] std::string list_of_graphs() const {
    graph(2000);
    put_file(at("graphs.toml"), "[[graph]]\nname = 'laps'\npath = 'graph.g2o'\ninjection = 'random'\n");
    return at("graphs.toml");
  }

 private:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_;
};

/// A command that writes. Of its arguments, words in capitals name inputs, and the output follows last.
struct Writer {
  const char* name;
  const char* output;  ///< File or folder.
  const char* kind;    ///< Of the output folder: ".adit-KIND" marks it as adit's own. Empty for a file.
  const char* arguments;
};

std::ostream& operator<<(std::ostream& stream, const Writer& writer) { return stream << writer.name; }

constexpr std::array kWriters{
    Writer{"world", "out", "world", "world --preset tiles --out"},
    Writer{"simulate", "out", "", "simulate --lidar os2-32 --robot alpha --routes ROUTES --out"},
    Writer{"odometry", "out.tum", "", "odometry RECORDING --method kiss-icp --out"},
    Writer{"slam", "out", "session", "slam ROUTES --lidar vlp-16 --out"},
    Writer{"study", "out", "study", "study --routes ROUTES --lidar vlp-16 --keyframes all --out"},
    Writer{"merge_study", "out", "", "merge-study --worlds WORLDS --keyframes all --lidar vlp-16 --out"},
    Writer{"loop_study", "out", "", "loop-study --graphs GRAPHS --shares 50 --out"},
    Writer{"convert_to_scans", "out", "scans", "convert RECORDING"},
    Writer{"convert_to_mcap", "out.mcap", "", "convert RECORDING"},
    Writer{"solve", "out.g2o", "", "solve GRAPH --gnc --out"},
};

/// The arguments with their inputs made.
Words arguments_of(const Writer& writer, const Inputs& inputs) {
  Words words;
  std::istringstream text(writer.arguments);
  for (std::string word; text >> word; words.push_back(word)) {
    if (word == "ROUTES") word = inputs.routes();
    if (word == "RECORDING") word = inputs.recording();
    if (word == "WORLDS") word = inputs.list_of_worlds();
    if (word == "GRAPHS") word = inputs.list_of_graphs();
    if (word == "GRAPH") word = inputs.graph(12000);
  }
  return words;
}

class Writing : public ::testing::TestWithParam<Writer> {
 protected:
  Writing() { std::filesystem::create_directories(target_folder()); }

  /// Inputs are made before the output can be spoilt.
  [[nodiscard]] Words command(const std::filesystem::path& target) const {
    std::filesystem::create_directories(folder_ / "in");
    Words words = arguments_of(GetParam(), Inputs(folder_ / "in"));
    words.push_back(target.string());
    words.insert(words.begin(), {"--threads", "1"});
    return words;
  }

  /// What an earlier run has saved at the target.
  void put_old_output(const std::filesystem::path& target) const {
    if (target.has_extension()) return put_file(target, "saved before");
    std::filesystem::create_directories(target);
    put_file(target / "saved", "saved before");
    put_file(target / ("alpha.mcap"), "saved before");
    if (*GetParam().kind != '\0') put_file(target / (std::string(".adit-") + GetParam().kind), "");
  }

  /// All files of `before` are as they were, and nothing half-finished lies beside them.
  static void expect_kept(const std::filesystem::path& folder,
                          const std::map<std::string, std::string>& before) {
    const std::map<std::string, std::string> after = tree_of(folder);
    for (const auto& [name, bytes] : before) {
      const auto kept = after.find(name);
      ASSERT_NE(kept, after.end()) << name << " is lost";
      EXPECT_EQ(kept->second, bytes) << name;
    }
    for (const auto& [name, bytes] : after) EXPECT_EQ(name.find(".partial-"), std::string::npos) << name;
  }

  [[nodiscard]] std::filesystem::path target_folder() const { return folder_ / "target"; }
  [[nodiscard]] std::filesystem::path target() const { return target_folder() / GetParam().output; }
  [[nodiscard]] std::filesystem::path log() const { return folder_ / "log"; }

  /// Runs to its end with exit code 1 and one line that names the target.
  void expect_failure(const Words& words, const std::string& named) const {
    EXPECT_EQ(test::Process(words, log()).wait().exit_code, 1);
    const std::string message = test::get_file(log());
    EXPECT_NE(message.find(named), std::string::npos) << message;
    EXPECT_EQ(message.find("internal error"), std::string::npos) << message;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_P(Writing, IsInterruptedWithinASecondInEveryPhase) {
  const Words whole = command(target_folder() / (std::string("whole_") + GetParam().output));
  const Ended uninterrupted = test::Process(whole, log()).wait();
  ASSERT_EQ(uninterrupted.exit_code, 0) << test::get_file(log());
  Words words = whole;
  words.back() = target().string();
  double whole_s = uninterrupted.cpu_s;
  int num_interrupted = 0;
  // A run that ends before its share of the time was quicker than those before (warm caches, an idle machine;
  // merge-study keeps maps): the same share of its time is tried next.
  const auto interrupt = [&](double share, int signal) {
    for (int attempt = 0; attempt < 4; ++attempt) {
      std::filesystem::remove_all(target());
      put_old_output(target());
      const std::map<std::string, std::string> before = tree_of(target_folder());
      const Ended ended = test::Process(words, log()).signal_after(share * whole_s, signal);
      if (ended.exit_code == 0) {
        whole_s = std::min(whole_s, ended.cpu_s);
        continue;
      }
      if (ended.exit_code < 0) {  // ended by the signal itself: the program had not begun to listen
        expect_kept(target_folder(), before);
        return;
      }
      ++num_interrupted;
      EXPECT_EQ(ended.exit_code, 128 + signal) << "after " << share << ": " << test::get_file(log());
      EXPECT_LT(ended.cpu_after_signal_s, kSlowdown) << "after " << share;
      EXPECT_NE(test::get_file(log()).find("interrupted"), std::string::npos);
      expect_kept(target_folder(), before);
      return;
    }
  };
  for (const double share : {0.1, 0.3, 0.5, 0.7, 0.85}) interrupt(share, share == 0.5 ? SIGTERM : SIGINT);
  EXPECT_GE(num_interrupted, 3);
}

TEST_P(Writing, AFullDiskIsAnErrorAndKeepsWhatWasSaved) {
  const Words words = command(target());
  const test::SmallDisk disk(target_folder());
  if (!disk.is_mounted()) GTEST_SKIP() << "needs the right to mount a disk of 3 MB (root)";
  put_old_output(target());
  const std::filesystem::path filler = disk.fill();
  const std::map<std::string, std::string> before = tree_of(target_folder());
  expect_failure(words, target().string());
  expect_kept(target_folder(), before);
}

TEST_P(Writing, AReadOnlyFolderIsAnErrorAndKeepsWhatWasSaved) {
  const Words words = command(target());
  const test::SmallDisk disk(target_folder());
  if (!disk.is_mounted()) GTEST_SKIP() << "needs the right to mount a disk read-only (root)";
  put_old_output(target());
  ASSERT_TRUE(disk.make_read_only());
  const std::map<std::string, std::string> before = tree_of(target_folder());
  expect_failure(words, target().string());
  expect_kept(target_folder(), before);
}

TEST_P(Writing, AFolderThatCannotBeMadeIsAnError) {
  put_file(target_folder() / "file", "no folder");
  expect_failure(command(target_folder() / "file" / GetParam().output), (target_folder() / "file").string());
}

INSTANTIATE_TEST_SUITE_P(EveryCommand, Writing, ::testing::ValuesIn(kWriters),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(Simulate, InterruptedLeavesNoFolderBehind) {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  const Words words{
      "simulate", "--threads", "1", "--lidar", "os2-128", "--routes", Inputs(folder.path()).routes(),
      "--out",    out};
  const double soon_s = 0.3;  // of several seconds of work
  EXPECT_EQ(test::Process(words, folder / "log").signal_after(soon_s, SIGINT).exit_code, 130);
  EXPECT_FALSE(std::filesystem::exists(out));
}

/// The lines that overwrite one another on a terminal.
std::vector<std::string> drawn_lines(const std::string& output) {
  std::vector<std::string> lines;
  std::istringstream stream(output);
  for (std::string line; std::getline(stream, line, '\r');) lines.push_back(line);
  return lines;
}

TEST(Terminal, ShowsPhasesWithTheTimeLeft) {
  const test::TemporaryFolder folder;
  const std::string routes = Inputs(folder.path()).routes();
  const std::string output = test::output_on_terminal(
      {"slam", routes, "--threads", "1", "--lidar", "os2-128", "--out", (folder / "out").string()});
  const std::regex with_time(R"([a-z]+ \[#* *\] \d+ %, (\d+ min )?\d+ s left)");
  EXPECT_TRUE(std::ranges::any_of(drawn_lines(output), [&](const std::string& line) {
    return std::regex_search(line, with_time);
  })) << output;
  for (const std::string& line : drawn_lines(output)) {
    if (line.find(" [") == std::string::npos) continue;
    EXPECT_LT(line.size(), 120U + std::string_view("\033[K").size()) << line;
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "out/session.toml")) << output;
}

TEST(Terminal, NothingIsDrawnIntoAFile) {
  const test::TemporaryFolder folder;
  const std::string routes = Inputs(folder.path()).routes();
  const test::ProgramRun run =
      test::run_adit("slam " + routes + " --lidar vlp-16 --out " + (folder / "out").string());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
}

}  // namespace
}  // namespace adit
