// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Scan Context: describing a scan and comparing two; the tunnel filter's measures of a scan.
#include <fstream>
#include <string>
#include <vector>

#include "adit/geometry/oriented_box.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/place/scan_context.hpp"
#include "harness/bench_case.hpp"
#include "tunnel_inputs.hpp"

namespace adit::bench {
namespace {

// As they come from the sensor, and thinned to the 8,400 points of the peer's own example.
PointCloud scan_of(std::size_t place) {
  const Tunnel tunnel("zab", 1, "os2-128");
  const std::vector<Pose> poses = poses_along(tunnel.paths().front(), 1.0);
  return tunnel.seen_from(poses[4 * poses.size() / 6 + place], place);
}
PointCloud full_scan() { return scan_of(0); }
PointCloud thin_scan() { return voxel_downsample(full_scan(), 0.184); }

template <class Make>
Prepare describing(Make make, int times) {
  return [=]() -> Work {
    return [cloud = make(), times] {
      double sum = 0.0;
      for (int k = 0; k < times; ++k) sum += static_cast<double>(describe(cloud, {}).ring_key.front());
      return Figures{{"points", static_cast<double>(cloud.size())}, {"ring_key_m", sum / times}};
    };
  };
}

CaseInfo describing_info(const std::string& name, const std::string& scene, double times) {
  return {.name = name,
          .work = "Scan Context of one scan",
          .scene = scene,
          .peer = "scan-context",
          .aim = 3.0,
          .note = "12 bytes and about 30 operations per point, a fifth of them in one lane",
          .per_run = times,
          .unit = "scan"};
}
const Case describe_thin(describing_info("place/describe_8k", "a scan of zab, thinned to 8,000 points", 500));
const Side describe_thin_adit("place/describe_8k", "adit", describing(thin_scan, 500));
const Case describe_full(describing_info("place/describe_122k", "a scan of zab, 124,000 points", 100));
const Side describe_full_adit("place/describe_122k", "adit", describing(full_scan, 100));

Work compare_two() {
  return [a = describe(scan_of(0), {}), b = describe(scan_of(3), {})] {
    double sum = 0.0;
    for (int k = 0; k < 5000; ++k) sum += compare(a, b).distance;
    return Figures{{"distance", sum / 5000}};
  };
}
const Case pair({.name = "place/compare",
                 .work = "distance of two contexts at the aligned shift and three to either side",
                 .scene = "two scans of zab, 3 m apart",
                 .peer = "scan-context",
                 .aim = 3.0,
                 .note = "60 x 60 + 7 x 1,200 products",
                 .per_run = 5000,
                 .unit = "pair"});
const Side pair_adit("place/compare", "adit", compare_two);

const Case box({.name = "keyframes/oriented_box",
                .work = "the tunnel filter's box around one scan",
                .scene = "a scan of zab, 124,000 points",
                .per_run = 20,
                .unit = "scan"});
const Side box_adit("keyframes/oriented_box", "adit", []() -> Work {
  return [cloud = full_scan()] {
    double sum = 0.0;
    for (int k = 0; k < 20; ++k) sum += oriented_box(cloud.points)->extents.x();
    return Figures{{"length_m", sum / 20}};
  };
});
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
