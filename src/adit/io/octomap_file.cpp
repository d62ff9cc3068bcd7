// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/octomap_file.hpp"

#include <octomap/OcTree.h>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/atomic_file.hpp"

namespace adit {
namespace {

octomap::point3d point_of(const Vector3& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

/// As OcTree::writeBinary does, which besides prints " done." on stderr, where the library was built with its
/// debug output.
void write_binary(const octomap::OcTree& tree, std::ostream& out) {
  out << "# Octomap OcTree binary file\n"
         "# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
      << "id " << tree.getTreeType() << "\nsize " << tree.size() << "\nres " << tree.getResolution()
      << "\ndata\n";
  tree.writeBinaryData(out);
}

}  // namespace

Result<> write_octomap(const std::filesystem::path& path, const std::vector<PlacedScan>& scans,
                       const OctomapConfig& config) {
  if (scans.empty()) return fail(path.string() + ": there are no scans to map");
  octomap::OcTree tree(config.resolution_m);
  const Phase phase("filling the octree", scans.size());
  for (const PlacedScan& scan : scans) {
    // Coordinates outside of the tree would come out at its other side.
    octomap::OcTreeKey key;
    bool fits = true;
    const auto placed = [&](const Vector3& p_base) {
      const octomap::point3d p = point_of(scan.T_world_base * p_base);
      fits = fits && tree.coordToKeyChecked(p, key);
      return p;
    };
    const octomap::point3d sensor = placed(scan.viewpoint);
    octomap::Pointcloud cloud;
    cloud.reserve(scan.cloud_base->size());
    for (const Eigen::Vector3f& point : scan.cloud_base->points)
      cloud.push_back(placed(point.cast<double>()));
    if (!fits) {
      return fail(
          format("{}: the map is larger than a tree of {} m cells can hold; give a larger "
                 "maps.octomap.resolution_m",
                 path.string(), config.resolution_m));
    }
    constexpr bool kLazy = true;        // inner nodes once, at the end
    constexpr bool kDiscretize = true;  // one ray a cell
    tree.insertPointCloud(cloud, sensor, config.reach_m, kLazy, kDiscretize);
    phase.advance();
  }
  tree.updateInnerOccupancy();
  tree.toMaxLikelihood();  // the format has occupied and free alone
  tree.prune();
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  write_binary(tree, file->stream());
  return file->commit();
}

}  // namespace adit
