// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Two robots map on their own, meet, find out where they have both been, and share one map.
/// Usage: 03_two_robots_meet [RECORDING RECORDING]
#include <cstdio>

#include "adit/io/recording_files.hpp"
#include "adit/slam/slam.hpp"
#include "simulated.hpp"

namespace {

adit::Result<std::vector<adit::Recording>> input(int argc, char** argv) {
  if (argc < 3) return example::two_robots_of_zab();
  std::vector<adit::Recording> recordings;
  for (const char* path : {argv[1], argv[2]}) {
    auto recording = adit::open_recording(path);
    if (!recording) return tl::unexpected(recording.error());
    recordings.push_back(std::move(*recording));
  }
  return recordings;
}

int failed(const adit::Error& error) {
  std::fprintf(stderr, "error: %s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto recordings = input(argc, argv);
  if (!recordings) return failed(recordings.error());
  // The default configuration merges only what tested evidence supports; adit::SlamConfig has every field.
  const auto run = adit::slam(*recordings);
  if (!run) return failed(run.error());
  for (const std::string& note : run->notes) std::printf("note: %s\n", note.c_str());
  const adit::Session& session = run->session;
  if (session.maps.size() < 2) return failed({run->failed.front().reason});

  const adit::PairOutcome& pair = session.solution.pairs.front();
  const std::string& first = session.maps[0]->name;
  const std::string& second = session.maps[1]->name;
  if (!pair.merged) {
    std::printf("two maps, because %s\n", pair.refused_reason.c_str());
    return 0;
  }
  const adit::Vector3 start = session.solution.T_world_keyframe.at(pair.b).front().translation();
  std::printf("%s and %s share one map, by %zu loops whose claims were tested\n", first.c_str(),
              second.c_str(), pair.num_selected);
  std::printf("%s started at (%.1f, %.1f, %.1f) as %s sees it\n", second.c_str(), start.x(), start.y(),
              start.z(), first.c_str());
}
