// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Triangle meshes on disk.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "adit/core/result.hpp"
#include "adit/geometry/triangle_mesh.hpp"

namespace adit {

/// Reads a mesh (PLY, OBJ, STL, DAE, GLB, by extension): polygons become triangles, equal vertices become
/// one, points and lines are left out, the transforms of a scene's nodes are applied.
///
/// Axes and units: the mesh is to be z up, in metres.
///  - PLY, OBJ, STL say nothing about axes: taken as they are, z up.
///  - DAE states its up axis and unit; a y-up file is turned so that its up becomes +z, and its unit is
///  applied.
///  - GLB (and glTF) is y up and in metres by its standard; it is turned so that its up becomes +z: (x, y, z)
///  of the
///    file becomes (x, -z, y).
/// PLY is read by ply.hpp (assimp 5.2 does not return from some truncated ones), the other formats by assimp.
/// Text formats state no length: an OBJ or ascii STL file that is cut between two faces gives the faces
/// before. A missing, damaged or unknown file and a mesh without triangles are errors.
Result<TriangleMesh> read_mesh(const std::filesystem::path& path);

/// The same from bytes; `extension` says the format: "ply", "obj", "stl", "dae", "glb".
Result<TriangleMesh> read_mesh(std::string_view bytes, const std::string& extension);

/// Whether the file is a PLY whose header announces faces; false also when it cannot be read.
[[nodiscard]] bool is_ply_mesh(const std::filesystem::path& path);

/// Writes a binary PLY; the file appears whole or not at all. The mesh must pass `check_mesh`. `comment`: a
/// line for people in the header.
Result<> write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh,
                    const std::string& comment = "");

}  // namespace adit
