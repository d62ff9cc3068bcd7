// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Scan Context: describing a scan, comparing two, and asking 100,000 keyframes of simulated tunnels for the
/// nearest.
#include <algorithm>
#include <fstream>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"
#include "adit/geometry/oriented_box.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/keyframes/alignability.hpp"
#include "adit/place/place_index.hpp"
#include "harness/bench_case.hpp"
#include "tunnel_inputs.hpp"

namespace adit::bench {
namespace {

// As they come from the sensor, and thinned to the 8,400 points of the peer's own example.
PointCloud scan_of(std::size_t place) {
  const Tunnel tunnel("zab", 1, "os2-128");
  const std::vector<Pose> poses = poses_along(tunnel.ways().front(), 1.0);
  return tunnel.seen_from(poses[4 * poses.size() / 6 + place], place);
}
PointCloud full_scan() { return scan_of(0); }
PointCloud thin_scan() { return voxel_downsample(full_scan(), 0.184); }

template <class Make>
Prepare describing(Make make, int times) {
  return [=]() -> Work {
    set_num_threads(1);
    return [cloud = make(), times] {
      double sum = 0.0;
      for (int k = 0; k < times; ++k) sum += static_cast<double>(describe(cloud, {}).ring_key.front());
      return Figures{{"points", static_cast<double>(cloud.size())}, {"ring_key_m", sum / times}};
    };
  };
}

const Case describe_thin({"place/describe_8k", "Scan Context of a thinned scan", "scan-context", 3.0,
                          "12 bytes and about 30 operations a point, a fifth of them in one lane", 500,
                          "scan"});
const Side describe_thin_adit("place/describe_8k", "adit", describing(thin_scan, 500));
const Case describe_full({"place/describe_122k", "Scan Context of a full scan", "scan-context", 3.0,
                          "12 bytes and about 30 operations a point, a fifth of them in one lane", 100,
                          "scan"});
const Side describe_full_adit("place/describe_122k", "adit", describing(full_scan, 100));

Work compare_two() {
  set_num_threads(1);
  return [a = describe(scan_of(0), {}), b = describe(scan_of(3), {})] {
    double sum = 0.0;
    for (int k = 0; k < 5000; ++k) sum += compare(a, b).distance;
    return Figures{{"distance", sum / 5000}};
  };
}
const Case pair({"place/compare", "distance of two contexts at the aligned shift and three to either side",
                 "scan-context", 3.0, "60 x 60 + 7 x 1,200 products", 5000, "pair"});
const Side pair_adit("place/compare", "adit", compare_two);

const Case box({"keyframes/oriented_box", "the tunnel filter's box around a full scan", "", 0.0, "", 20,
                "scan"});
const Side box_adit("keyframes/oriented_box", "adit", []() -> Work {
  set_num_threads(1);
  return [cloud = full_scan()] {
    double sum = 0.0;
    for (int k = 0; k < 20; ++k) sum += oriented_box(cloud.points)->extents.x();
    return Figures{{"length_m", sum / 20}};
  };
});
const Case alignable({"keyframes/alignability", "how well a full scan can be aligned", "", 0.0, "", 20,
                      "scan"});
const Side alignable_adit("keyframes/alignability", "adit", []() -> Work {
  set_num_threads(1);
  return [cloud = full_scan()] {
    double sum = 0.0;
    for (int k = 0; k < 20; ++k) sum += alignability_of_points(cloud.points)->weakest();
    return Figures{{"weakest", sum / 20}};
  };
});

/// Contexts along the ways of tunnels of three kinds. A robot passes each place eight times, up to 0.4 m to
/// the side and turned by up to 6 degrees, as often the other way round.
std::vector<ScanContext> contexts_along_tunnels(std::size_t wanted) {
  constexpr double kSpacing = 0.5;
  constexpr std::size_t kPasses = 8;
  std::vector<ScanContext> contexts;
  for (std::uint64_t seed = 1; contexts.size() < wanted; ++seed) {
    for (const char* kind : {"zab", "metro", "mine"}) {
      const Tunnel tunnel(kind, seed, "os2-32");
      for (const Trajectory& way : tunnel.ways()) {
        const std::vector<Pose> poses = poses_along(way, kSpacing);
        const std::size_t begin = contexts.size();
        contexts.resize(begin + kPasses * poses.size());
        parallel_for_each(poses.size(), [&](std::size_t i) {
          const PointCloud cloud = tunnel.seen_from(poses[i], i);
          for (std::size_t pass = 0; pass < kPasses; ++pass) {
            Rng rng(mix64(seed, mix64(i, pass)));
            const double turn = rng.uniform(-0.1, 0.1) + (rng.uniform() < 0.5 ? std::numbers::pi : 0.0);
            const Pose T_base_here = Pose::planar(0.0, rng.uniform(-0.4, 0.4), turn);
            contexts[begin + pass * poses.size() + i] =
                describe(transformed(T_base_here.inverse(), cloud), {});
          }
        });
      }
    }
  }
  contexts.resize(wanted);
  return contexts;
}

/// Other scans of places that the keyframes are of.
std::vector<ScanContext> queries_along_tunnels() {
  constexpr std::size_t kQueriesAWay = 3;
  std::vector<ScanContext> queries;
  const Tunnel tunnel("zab", 1, "os2-32");
  for (const Trajectory& way : tunnel.ways()) {
    const std::vector<Pose> poses = poses_along(way, 0.7);
    for (std::size_t k = 1; k <= kQueriesAWay; ++k) {
      const Pose T_world_base = poses[k * poses.size() / (kQueriesAWay + 1)] * Pose::planar(0.0, 0.2, 3.0);
      queries.push_back(describe(tunnel.seen_from(T_world_base, 1000 + k), {}));
    }
  }
  return queries;
}

/// Asks for the next few queries each time.
class Asker {
 public:
  static constexpr std::size_t kQueriesARun = 3;

  explicit Asker(std::vector<ScanContext> queries) : queries_(std::move(queries)) {}
  template <class Ask>
  void run(const Ask& ask) {
    for (std::size_t k = 0; k < kQueriesARun; ++k) ask(next_++ % queries_.size());
  }
  [[nodiscard]] const std::vector<ScanContext>& queries() const { return queries_; }

 private:
  std::vector<ScanContext> queries_;
  std::size_t next_ = 0;
};

struct Nearest {
  std::uint32_t index = 0;
  double distance = 2.0;
  bool operator==(const Nearest&) const = default;
};

Nearest nearest_of_all(const ScanContext& query, const std::vector<ScanContext>& contexts) {
  Nearest nearest;
  for (std::uint32_t i = 0; i < contexts.size(); ++i) {
    const double distance = compare_all_shifts(query, contexts[i]).distance;
    if (distance < nearest.distance) nearest = {i, distance};
  }
  return nearest;
}

PlaceIndex index_of(const std::vector<ScanContext>& contexts) {
  PlaceIndexConfig config;
  config.search = "every_shift";
  config.max_distance = 1.0;
  PlaceIndex index(config);
  for (std::uint32_t i = 0; i < contexts.size(); ++i) index.add({{1}, i}, contexts[i]);
  return index;
}

Work ask_index() {
  const std::vector<ScanContext> contexts = contexts_along_tunnels(100000);
  const auto asker = std::make_shared<Asker>(queries_along_tunnels());
  std::vector<Nearest> expected(asker->queries().size());
  parallel_for_each(expected.size(),
                    [&](std::size_t k) { expected[k] = nearest_of_all(asker->queries()[k], contexts); });
  set_num_threads(1);
  return [index = index_of(contexts), asker, expected] {
    double num_right = 0.0;
    asker->run([&](std::size_t k) {
      const auto found = index.best_match({{0}, 0}, asker->queries()[k], {1});
      if (found && Nearest{found->match.index, found->distance} == expected[k]) num_right += 1.0;
    });
    return Figures{{"recall", num_right / Asker::kQueriesARun}};
  };
}

Work ask_all() {
  const auto asker = std::make_shared<Asker>(queries_along_tunnels());
  const std::vector<ScanContext> contexts = contexts_along_tunnels(100000);
  set_num_threads(1);
  return [asker, contexts] {
    double sum = 0.0;
    asker->run([&](std::size_t k) { sum += nearest_of_all(asker->queries()[k], contexts).distance; });
    return Figures{{"recall", 1.0}, {"distance", sum / Asker::kQueriesARun}};
  };
}

const Case ask({"place/query_100k", "nearest of 100,000 keyframes at any shift, all compared or as if",
                "brute-force", 100.0,
                "96 bytes and 80 products a keyframe and frequency looked at, about 150,000 of them",
                Asker::kQueriesARun, "query"});
const Side ask_adit("place/query_100k", "adit", ask_index);
const Side ask_brute_force("place/query_100k", "brute-force", ask_all);

Work ask_some(double num_keyframes) {
  const auto asker = std::make_shared<Asker>(queries_along_tunnels());
  PlaceIndex index = index_of(contexts_along_tunnels(static_cast<std::size_t>(num_keyframes)));
  set_num_threads(1);
  return [asker, index] {
    for (int k = 0; k < 4; ++k)
      asker->run([&](std::size_t q) { (void)index.best_match({{0}, 0}, asker->queries()[q], {1}); });
    return Figures{};
  };
}
const Growth growth("place/keyframes", "Twelve queries for the nearest keyframe at any shift, one thread",
                    "keyframes", {1000, 3000, 10000, 30000, 100000}, ask_some);

// describe_8k.bin, describe_122k.bin, compare_0.bin, compare_1.bin: KITTI format, in the base frame.
void write_scans(const std::filesystem::path& folder) {
  (void)write_cloud(folder / "describe_8k.bin", thin_scan());
  (void)write_cloud(folder / "describe_122k.bin", full_scan());
  (void)write_cloud(folder / "compare_0.bin", scan_of(0));
  (void)write_cloud(folder / "compare_1.bin", scan_of(3));
}
const Export inputs("place", write_scans);

}  // namespace
}  // namespace adit::bench
