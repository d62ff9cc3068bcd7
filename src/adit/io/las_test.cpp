// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/las.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "support/files.hpp"

namespace adit {
namespace {

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

// Places of the specification, written out.
TEST(Las, IsLaidOutAsTheSpecificationSays) {
  const test::TemporaryFolder folder;
  const std::vector<LasPoint> points = {{{1.2345, -7.5, 3.0}, 100, 1}, {{-2000.001, 8.25, 4.5}, 65535, 2}};
  ASSERT_TRUE(write_las(folder / "a.las", points));
  const std::string bytes = test::get_file(folder / "a.las");
  EXPECT_EQ(bytes.substr(0, 4), "LASF");
  EXPECT_EQ(number_at<std::uint16_t>(bytes, 6), 16) << "WKT";
  EXPECT_EQ(bytes[24], 1);
  EXPECT_EQ(bytes[25], 4);
  EXPECT_EQ(number_at<std::uint16_t>(bytes, 94), 375);
  const auto begin = number_at<std::uint32_t>(bytes, 96);
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 100), 1U);
  EXPECT_EQ(bytes[104], 6);
  EXPECT_EQ(number_at<std::uint16_t>(bytes, 105), 30);
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 107), 0U) << "counts of format 6 stand at 247";
  EXPECT_EQ(number_at<std::uint64_t>(bytes, 247), 2U);
  EXPECT_EQ(number_at<std::uint64_t>(bytes, 255), 2U);
  EXPECT_NEAR(number_at<double>(bytes, 179), 1.2345, 0.0006) << "max x, then min x";
  EXPECT_NEAR(number_at<double>(bytes, 187), -2000.001, 1e-9);
  EXPECT_EQ(bytes.substr(377, 15), "LASF_Projection");
  EXPECT_EQ(number_at<std::uint16_t>(bytes, 393), 2112);
  EXPECT_EQ(bytes.substr(429, std::strlen(kLocalCrs)), kLocalCrs);
  EXPECT_EQ(begin, 429 + std::strlen(kLocalCrs) + 1);
  ASSERT_EQ(bytes.size(), begin + 60);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t at = begin + 30 * i;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double scale = number_at<double>(bytes, 131 + 8 * axis);
      const double offset = number_at<double>(bytes, 155 + 8 * axis);
      EXPECT_NEAR(scale * number_at<std::int32_t>(bytes, at + 4 * axis) + offset,
                  points[i].position[static_cast<Eigen::Index>(axis)], 0.0005 + 1e-9);
    }
    EXPECT_EQ(number_at<std::uint16_t>(bytes, at + 12), points[i].intensity);
    EXPECT_EQ(bytes[at + 14], 0x11);
    EXPECT_EQ(number_at<std::uint16_t>(bytes, at + 20), points[i].source);
  }
}

TEST(Las, NoPointsAreAFileAndPointsTooFarApartAnError) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(write_las(folder / "none.las", {}));
  EXPECT_EQ(number_at<std::uint64_t>(test::get_file(folder / "none.las"), 247), 0U);
  EXPECT_ERROR(write_las(folder / "far.las", {{{0.0, 0.0, 0.0}}, {{1e7, 0.0, 0.0}}}), "too far apart");
  EXPECT_FALSE(std::filesystem::exists(folder / "far.las"));
  EXPECT_ERROR(write_las(folder / "nan.las", {{{0.0, std::nan(""), 0.0}}}), "not finite");
}

}  // namespace
}  // namespace adit
