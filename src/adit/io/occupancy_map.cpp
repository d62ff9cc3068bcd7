// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/occupancy_map.hpp"

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"

namespace adit {
namespace {

char pixel_of(CellState cell) {
  switch (cell) {
    case CellState::occupied:
      return 0;
    case CellState::free:
      return static_cast<char>(254);
    case CellState::unknown:
      break;
  }
  return static_cast<char>(205);
}

/// In single quotes, where nothing but the quote itself means anything.
std::string yaml_text(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

Result<> write_occupancy_map(const std::filesystem::path& path, const OccupancyGrid& grid) {
  std::string image = format("P5\n{} {}\n255\n", grid.width, grid.height);
  for (std::size_t row = grid.height; row-- > 0;)
    for (std::size_t column = 0; column < grid.width; ++column)
      image += pixel_of(grid.cells[row * grid.width + column]);
  if (const Result<> done = write_bytes(path, image); !done) return done;
  // 205 is a probability of 0.19608: with the thresholds of 0.196 and 0.65 it is neither free nor occupied.
  const std::string yaml = format(
      "image: {}\nmode: trinary\nresolution: {}\norigin: [{:.4f}, {:.4f}, 0]\nnegate: 0\noccupied_thresh: "
      "0.65\n"
      "free_thresh: 0.196\n",
      yaml_text(path.filename().string()), grid.resolution_m, grid.origin.x(), grid.origin.y());
  std::filesystem::path beside = path;
  return write_bytes(beside.replace_extension(".yaml"), yaml);
}

}  // namespace adit
