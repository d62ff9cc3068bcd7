// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/occupancy_map.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace adit {
namespace {

TEST(OccupancyMap, AnyNameOfTheImageIsOneTextOfYaml) {
  const test::TemporaryFolder folder;
  OccupancyGrid grid;
  grid.width = 1;
  grid.height = 1;
  grid.cells = {CellState::free};
  ASSERT_TRUE(write_occupancy_map(folder / "Ann's level #2: east.pgm", grid));
  const std::string yaml = test::get_file(folder / "Ann's level #2: east.yaml");
  EXPECT_TRUE(yaml.starts_with("image: 'Ann''s level #2: east.pgm'\nmode: trinary\n")) << yaml;
}

}  // namespace
}  // namespace adit
