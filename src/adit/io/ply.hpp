// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// PLY, the Stanford polygon format: point clouds and meshes in memory (cloud_files.hpp and mesh_files.hpp
/// read files).
#pragma once

#include <string>
#include <string_view>

#include "adit/geometry/triangle_mesh.hpp"
#include "adit/io/cloud_files.hpp"

namespace adit {

/// Reads the `vertex` element of a PLY file: ascii, binary_little_endian or binary_big_endian. Taken are the
/// scalar properties x, y, z (needed), intensity (also intensities, i, scalar_Intensity) and t (also time,
/// time_offset, offset_time, timestamp, time_stamp, or the one that is `known`; units as in pcd.hpp). Other
/// properties, list properties and elements are stepped over. Errors name the header line or the byte offset.
Result<CloudFile> read_ply(std::string_view bytes, const KnownTimes& known = {});

/// Reads the vertices and the polygons of a mesh: the lists `vertex_indices` (or `vertex_index`) of the
/// element `face`, each cut into the fan of triangles around its first corner, which is right for convex
/// polygons. Errors as above, also for a vertex that is not finite and a truncated list; `check_mesh` is the
/// caller's.
Result<TriangleMesh> read_ply_mesh(std::string_view bytes);

/// Whether the header announces faces, so that the file is a mesh rather than a cloud.
[[nodiscard]] bool ply_has_faces(std::string_view bytes);

/// How numbers are written, by the words of the header line `format`.
enum class PlyData { ascii, binary_little_endian, binary_big_endian };

/// The bytes of a PLY file with float x, y, z, and where the cloud has them float intensity and int t
/// (nanoseconds). `comment`: one line for the header.
[[nodiscard]] std::string write_ply(const PointCloud& cloud, PlyData data = PlyData::binary_little_endian,
                                    const std::string& comment = "");

/// The bytes of a binary little-endian PLY file with float vertices and triangles as `vertex_indices` lists.
[[nodiscard]] std::string write_ply(const TriangleMesh& mesh, const std::string& comment = "");

}  // namespace adit
