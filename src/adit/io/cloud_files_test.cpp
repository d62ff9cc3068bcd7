// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// All cloud formats: one property suite (round trip, truncation, garbage), then hand-made conformance cases
// of each.
#include "adit/io/cloud_files.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "adit/io/kitti.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/pcd.hpp"
#include "adit/io/ply.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

PointCloud random_cloud(std::size_t size, std::uint64_t seed) {
  Rng rng(seed);
  PointCloud cloud;
  for (std::size_t i = 0; i < size; ++i) {
    cloud.points.emplace_back(static_cast<float>(rng.uniform(-100, 100)), static_cast<float>(rng.normal()),
                              static_cast<float>(rng.uniform(-1e-6, 1e-6)));
    cloud.intensities.push_back(static_cast<float>(rng.uniform(0, 255)));
    cloud.time_offsets_ns.push_back(-static_cast<std::int32_t>(rng.below(100'000'000)));
  }
  return cloud;
}

struct CloudCase {
  const char* name;
  std::string (*write)(const PointCloud&);
  Result<CloudFile> (*read)(std::string_view);
  bool keeps_times;
  bool is_text;
};
void PrintTo(const CloudCase& c, std::ostream* out) { *out << c.name; }

class CloudFormats : public ::testing::TestWithParam<CloudCase> {};

TEST_P(CloudFormats, RoundTripIsExact) {
  const PointCloud cloud = random_cloud(57, 1);
  const Result<CloudFile> back = GetParam().read(GetParam().write(cloud));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->cloud.points, cloud.points);
  EXPECT_EQ(back->cloud.intensities, cloud.intensities);
  if (GetParam().keeps_times) {
    EXPECT_EQ(back->cloud.time_offsets_ns, cloud.time_offsets_ns);
  }
  EXPECT_EQ(back->num_skipped_nan, 0U);
}

TEST_P(CloudFormats, PointsAloneRoundTrip) {
  PointCloud cloud;
  cloud.points = random_cloud(3, 2).points;
  const Result<CloudFile> back = GetParam().read(GetParam().write(cloud));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->cloud.points, cloud.points);
  EXPECT_TRUE(back->cloud.time_offsets_ns.empty());
}

TEST_P(CloudFormats, PointsThatAreNotFiniteAreSkippedAndCounted) {
  PointCloud cloud = random_cloud(5, 3);
  cloud.points[1].y() = kNan;
  cloud.points[3].z() = std::numeric_limits<float>::infinity();
  const Result<CloudFile> back = GetParam().read(GetParam().write(cloud));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->num_skipped_nan, 2U);
  ASSERT_EQ(back->cloud.size(), 3U);
  EXPECT_EQ(back->cloud.points[1], cloud.points[2]);
  EXPECT_EQ(back->cloud.intensities[2], cloud.intensities[4]);
  back->cloud.check();
}

TEST_P(CloudFormats, NothingFiniteIsAnError) {
  PointCloud cloud;
  cloud.points.assign(4, Eigen::Vector3f(kNan, 0, 0));
  EXPECT_ERROR(GetParam().read(GetParam().write(cloud)), "none of the 4 points is finite");
}

TEST_P(CloudFormats, NoPointsIsAnError) {
  EXPECT_FALSE(GetParam().read(GetParam().write(PointCloud{})));
  EXPECT_FALSE(GetParam().read(""));
}

TEST_P(CloudFormats, EveryTruncationIsAnErrorOrShorterText) {
  const std::string bytes = GetParam().write(random_cloud(4, 4));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Result<CloudFile> read = GetParam().read(std::string_view(bytes).substr(0, size));
    if (!read) continue;
    // KITTI has no header: a cut between points leaves a shorter file. Text may lose digits of its last
    // number.
    const bool is_whole_rows = std::string_view(GetParam().name) == "kitti" && size % 16 == 0;
    const bool is_last_number = GetParam().is_text && bytes.size() - size < 12;
    EXPECT_TRUE(is_whole_rows || is_last_number) << "cut at byte " << size;
  }
}

TEST_P(CloudFormats, DamagedBytesAreAnErrorOrACloudOfFinitePoints) {
  constexpr std::size_t kNumPoints = 6;
  const std::string bytes = GetParam().write(random_cloud(kNumPoints, 5));
  Rng rng(6);
  int num_changed = 0;  // a damage to the coordinates themselves cannot be noticed
  for (int i = 0; i < 3000; ++i) {
    std::string damaged = bytes;
    for (int k = 0; k < 3; ++k) damaged[rng.below(damaged.size())] = static_cast<char>(rng.below(256));
    const Result<CloudFile> read = GetParam().read(damaged);
    num_changed += read && read->cloud.size() == kNumPoints ? 0 : 1;
    if (!read) {
      EXPECT_FALSE(read.error().message.empty());
      continue;
    }
    read->cloud.check();
    EXPECT_TRUE(
        std::ranges::all_of(read->cloud.points, [](const Eigen::Vector3f& p) { return p.allFinite(); }));
    EXPECT_LE(read->cloud.size() + read->num_skipped_nan, bytes.size() / 3);
  }
  // KITTI has nothing but coordinates.
  if (std::string_view(GetParam().name) != "kitti") {
    EXPECT_GT(num_changed, 10);
  }
}

Result<CloudFile> read_any_pcd(std::string_view bytes) { return read_pcd(bytes); }
Result<CloudFile> read_any_bin(std::string_view bytes) { return read_kitti(bytes); }
Result<CloudFile> read_any_ply(std::string_view bytes) { return read_ply(bytes); }

INSTANTIATE_TEST_SUITE_P(
    All, CloudFormats,
    ::testing::Values(
        CloudCase{"pcd_ascii", [](const PointCloud& c) { return write_pcd(c, PcdData::ascii); }, read_any_pcd,
                  true, true},
        CloudCase{"pcd_binary", [](const PointCloud& c) { return write_pcd(c); }, read_any_pcd, true, false},
        CloudCase{"pcd_compressed",
                  [](const PointCloud& c) { return write_pcd(c, PcdData::binary_compressed); }, read_any_pcd,
                  true, false},
        CloudCase{"ply_ascii", [](const PointCloud& c) { return write_ply(c, PlyData::ascii); }, read_any_ply,
                  true, true},
        CloudCase{"ply_little", [](const PointCloud& c) { return write_ply(c); }, read_any_ply, true, false},
        CloudCase{"ply_big", [](const PointCloud& c) { return write_ply(c, PlyData::binary_big_endian); },
                  read_any_ply, true, false},
        CloudCase{"kitti",
                  [](const PointCloud& c) {
                    PointCloud with_intensity = c;
                    with_intensity.intensities.resize(c.size(), 0.0F);
                    return write_kitti(with_intensity);
                  },
                  read_any_bin, false, false}),
    [](const auto& item) { return item.param.name; });

// Formats by hand.

std::string pcd_header(std::string_view fields, std::string_view sizes, std::string_view types, int points,
                       std::string_view data) {
  return "VERSION .7\nFIELDS " + std::string(fields) + "\nSIZE " + std::string(sizes) + "\nTYPE " +
         std::string(types) + "\nWIDTH " + std::to_string(points) + "\nHEIGHT 1\nPOINTS " +
         std::to_string(points) + "\nDATA " + std::string(data) + "\n";
}

TEST(Pcd, ForeignFieldsAndTypesAreSteppedOver) {
  const Result<CloudFile> file =
      read_pcd(pcd_header("rgb x _ y z ring i", "4 8 1 4 4 2 1", "U F U F F U U", 2, "ascii") +
               "7 1.5 0 2 3 12 200\n7 -1 0 nan 3 12 9\n");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->cloud.size(), 1U);
  EXPECT_EQ(file->cloud.points[0], Eigen::Vector3f(1.5F, 2, 3));
  EXPECT_EQ(file->cloud.intensities[0], 200.0F);
  EXPECT_EQ(file->num_skipped_nan, 1U);
}

TEST(Pcd, CountsOfSeveralElementsAndCommentsAndCarriageReturns) {
  const Result<CloudFile> file = read_pcd(
      "# comment\r\nVERSION 0.7\r\nFIELDS normal x y z\r\nSIZE 4 4 4 4\r\nTYPE F F F F\r\nCOUNT 3 1 1 "
      "1\r\nWIDTH 1\r\n"
      "HEIGHT 1\r\nVIEWPOINT 0 0 0 1 0 0 0\r\nPOINTS 1\r\nDATA ascii\r\n9 9 9 1 2 3\r\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->cloud.points[0], Eigen::Vector3f(1, 2, 3));
}

TEST(Pcd, TimesInSecondsNanosecondsAndAbsolute) {
  const auto times = [](std::string_view size, std::string_view type, std::string_view first,
                        std::string_view second) {
    return read_pcd(
               pcd_header("x y z t", "4 4 4 " + std::string(size), "F F F " + std::string(type), 2, "ascii") +
               "1 2 3 " + std::string(first) + "\n1 2 3 " + std::string(second) + "\n")
        .map([](const CloudFile& file) { return file.cloud.time_offsets_ns; });
  };
  using Times = std::vector<std::int32_t>;
  EXPECT_EQ(times("4", "F", "0.25", "-0.5"), Times({250'000'000, -500'000'000}));
  EXPECT_EQ(times("4", "U", "0", "99999999"), Times({0, 99'999'999}));
  // Absolute clocks: relative to the earliest point, to the nanosecond where the file has it.
  EXPECT_EQ(times("8", "U", "1700000000123456789", "1700000000123456799"), Times({0, 10}));
  EXPECT_EQ(times("8", "F", "1700000000.5", "1700000000.25"), Times({250'000'000, 0}));
  EXPECT_ERROR(
      times("8", "F", "0", "100"),
      "span 100.000 s, more than 2.1 s: another field (--point-time-field), or another unit than was taken "
      "(--point-times)");
}

// A sweep of 0.1 s, as drivers write it: the unit follows from how long a sweep lasts.
TEST(Pcd, TimesAreInTheUnitThatMakesASweepLastAsLongAsSweepsDo) {
  constexpr int kNum = 201;
  // `step`: of half a millisecond, in the unit.
  const auto sweep = [](std::string_view type, std::string_view size, auto step, auto start,
                        std::optional<TimeUnit> unit = {}) {
    // A point that was not seen, with a time that means nothing.
    std::string rows = "nan nan nan 0\n";
    for (int i = 0; i < kNum; ++i) rows += format("1 2 3 {}\n", start + i * step);
    return read_pcd(
        pcd_header("x y z t", "4 4 4 " + std::string(size), "F F F " + std::string(type), kNum + 1, "ascii") +
            rows,
        {.unit = unit});
  };
  const auto expect = [](const Result<CloudFile>& file, TimeUnit unit, int tolerance_ns) {
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(to_string(*file->times.unit), to_string(unit));
    const std::vector<std::int32_t>& offsets = file->cloud.time_offsets_ns;
    ASSERT_EQ(offsets.size(), static_cast<std::size_t>(kNum));
    for (int i = 0; i < kNum; ++i)
      ASSERT_NEAR(offsets[static_cast<std::size_t>(i)], 500'000 * i, tolerance_ns) << i;
  };
  using Int = std::int64_t;
  expect(sweep("F", "4", 0.0005, 0.0), TimeUnit::seconds, 10);              // Velodyne
  expect(sweep("U", "4", Int{500'000}, Int{0}), TimeUnit::nanoseconds, 0);  // Ouster
  expect(sweep("F", "8", 0.0005, 1.7e9), TimeUnit::seconds, 300);           // Hesai
  expect(sweep("F", "8", Int{500'000}, Int{1'700'000'000'000'000'000}), TimeUnit::nanoseconds, 300);  // Livox
  expect(sweep("U", "4", Int{500}, Int{0}), TimeUnit::microseconds, 0);
  expect(sweep("F", "4", 0.5, 0.0), TimeUnit::milliseconds, 10);
  EXPECT_FALSE(sweep("U", "4", Int{500}, Int{0})->times.has_usual_unit);
  EXPECT_TRUE(sweep("U", "4", Int{500'000}, Int{0})->times.has_usual_unit);
  // What is given counts; signed times, as adit writes them, are nanoseconds, and so is a sweep like no
  // other.
  const Result<CloudFile> given = sweep("U", "4", Int{500}, Int{0}, TimeUnit::nanoseconds);
  EXPECT_EQ(given->cloud.time_offsets_ns.back(), 100'000);
  EXPECT_EQ(sweep("I", "4", Int{500}, Int{0})->cloud.time_offsets_ns.back(), 100'000);
  EXPECT_EQ(sweep("U", "4", Int{5'000'000}, Int{0})->times.unit, TimeUnit::nanoseconds);
  EXPECT_EQ(sweep("U", "4", Int{5}, Int{0})->times.unit, std::nullopt);
  EXPECT_EQ(sweep("U", "4", Int{5}, Int{0})->cloud.time_offsets_ns.back(), 1000);
}

TEST(CloudFiles, UnitsOfTimesAreNamed) {
  EXPECT_EQ(*parse_time_unit(""), std::nullopt);
  EXPECT_EQ(*parse_time_unit("us"), TimeUnit::microseconds);
  EXPECT_ERROR(parse_time_unit("sec"), "'sec' is not a unit of point times; s, ms, us and ns are");
}

TEST(Pcd, TheViewpointIsThePoseOfTheSensor) {
  PointCloud cloud;
  cloud.points = {{1, 2, 3}};
  const Pose viewpoint = Pose::planar(0.1, -2, 0.7, 0.9);
  for (const PcdData data : {PcdData::ascii, PcdData::binary, PcdData::binary_compressed}) {
    const Result<CloudFile> file = read_pcd(write_pcd(cloud, data, viewpoint));
    ASSERT_TRUE(file) << file.error().message;
    ASSERT_TRUE(file->viewpoint);
    EXPECT_EQ(file->viewpoint->translation(), viewpoint.translation());
    EXPECT_EQ(file->viewpoint->rotation().coeffs(), viewpoint.rotation().coeffs());
    EXPECT_EQ(file->cloud.points, cloud.points);
  }
  EXPECT_FALSE(read_pcd(write_pcd(cloud))->viewpoint);  // the identity says nothing
  const std::string start = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nVIEWPOINT ";
  EXPECT_ERROR(read_pcd(start + "0 0 1 0 0 0\n"), "header line 5: VIEWPOINT: 6 values; tx ty tz qw qx qy qz");
  EXPECT_ERROR(read_pcd(start + "0 0 1 2 0 0 0\n"), "norm 2, not 1");
  EXPECT_ERROR(read_pcd(start + "0 0 nan 1 0 0 0\n"), "'nan' is not a finite number");
}

TEST(Pcd, ErrorsNameThePlace) {
  EXPECT_ERROR(read_pcd("FIELDS x y z\nSIZE 4 4\n"), "header line 2: SIZE: 2 values for 3 fields");
  EXPECT_ERROR(read_pcd("FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\n"), "header line 3: TYPE: no type F3");
  EXPECT_ERROR(read_pcd("solid cube\n"), "header line 1: solid");
  EXPECT_ERROR(read_pcd(pcd_header("x y", "4 4", "F F", 1, "ascii") + "1 2\n"),
               "no field 'z'; the fields are: x, y; points need x, y and z");
  EXPECT_ERROR(read_pcd(pcd_header("x y z", "4 4 4", "F F F", 2, "ascii") + "1 2 3\n1 2\n"),
               "line 10: 2 values, 3 needed");
  EXPECT_ERROR(read_pcd(pcd_header("x y z", "4 4 4", "F F F", 2, "ascii") + "1 2 3\n"), "1 of 2 points");
  EXPECT_ERROR(read_pcd(pcd_header("x y z", "4 4 4", "F F F", 1, "ascii") + "1 a 3\n"),
               "'a' is not a value of field 'y'");
  EXPECT_ERROR(read_pcd(pcd_header("x y z", "4 4 4", "F F F", 2, "binary") + std::string(23, 'x')),
               "1 of 2 points");
  EXPECT_ERROR(read_pcd(pcd_header("x y z", "4 4 4", "F F F", 0, "ascii")), "no points");
  EXPECT_ERROR(read_pcd(pcd_header("x y z", "4 4 4", "F F F", 1, "gzip")), "DATA gzip");
}

TEST(Ply, ListsAndOtherElementsAreSteppedOver) {
  const std::string header =
      "ply\nformat ascii 1.0\ncomment by hand\nelement camera 1\nproperty list uchar float view\nelement "
      "vertex 2\n"
      "property double x\nproperty list uchar int ids\nproperty float y\nproperty uchar red\nproperty float "
      "z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const Result<CloudFile> file = read_ply(header + "2 0.5 0.5\n1 3 7 7 7 2 255 3\n4 0 5 0 6\n3 0 1 1\n");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->cloud.size(), 2U);
  EXPECT_EQ(file->cloud.points[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(file->cloud.points[1], Eigen::Vector3f(4, 5, 6));
  EXPECT_ERROR(read_ply(header + "2 0.5 0.5\n1 3 7 7\n"), "vertex 0 of 2: no value for 'ids'");
  EXPECT_ERROR(read_ply(header + "2 0.5 0.5\n1 0 2 255 3 99\n4 0 5 0 6\n"), "more values than properties");
}

TEST(Ply, BinaryListsAreSteppedOver) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uchar ushort ids\nproperty "
      "float x\n"
      "property float y\nproperty float z\nend_header\n";
  bytes += '\2';
  append_little_endian(bytes, std::uint32_t{0});
  for (const float value : {1.0F, 2.0F, 3.0F}) append_little_endian(bytes, value);
  const Result<CloudFile> file = read_ply(bytes);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->cloud.points[0], Eigen::Vector3f(1, 2, 3));
}

TEST(Ply, ErrorsNameThePlace) {
  EXPECT_ERROR(read_ply("solid"), "the first line is not 'ply'");
  EXPECT_ERROR(read_ply("ply\nformat text 1.0\n"), "header line 2");
  EXPECT_ERROR(read_ply("ply\nformat ascii 1.0\nelement vertex -3\n"), "header line 3");
  EXPECT_ERROR(read_ply("ply\nformat ascii 1.0\nproperty float x\n"), "before the first element");
  EXPECT_ERROR(read_ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n"), "unknown type 'half'");
  EXPECT_ERROR(read_ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
               "no field 'y'");
  EXPECT_ERROR(read_ply("ply\nformat ascii 1.0\nelement face 0\nproperty float x\nend_header\n"),
               "no element 'vertex'");
}

TEST(Kitti, BytesAreFourFloatsAPoint) {
  EXPECT_ERROR(read_kitti(std::string(33, '\0')), "the last whole one ends at byte 32");
  PointCloud cloud;
  cloud.points = {{1, 2, 3}};
  EXPECT_EQ(write_kitti(cloud).size(), 16U);
}

TEST(Kitti, AFifthColumnOfWholeNumbersIsTheRing) {
  const auto rows = [](int num, int num_rings) {
    std::string bytes;
    for (int i = 0; i < num; ++i)
      for (const float value :
           {0.5F + static_cast<float>(i), 2.25F, -1.5F, 0.75F, static_cast<float>(i % num_rings)})
        append_little_endian(bytes, value);
    return bytes;
  };
  for (const int num : {7, 201, 200}) {  // 200 rows have a size of whole rows of four columns, too
    const Result<CloudFile> file = read_kitti(rows(num, 16));
    ASSERT_TRUE(file) << file.error().message;
    ASSERT_EQ(file->cloud.size(), static_cast<std::size_t>(num));
    EXPECT_EQ(file->cloud.points.back(), Eigen::Vector3f(static_cast<float>(num) - 0.5F, 2.25F, -1.5F));
    EXPECT_EQ(file->cloud.intensities.back(), 0.75F);
  }
  EXPECT_EQ(read_kitti(rows(8, 4))->cloud.size(), 10U) << "too few to tell";
  EXPECT_EQ(read_kitti(rows(8, 4), 5)->cloud.size(), 8U);
  EXPECT_ERROR(read_kitti(std::string_view(rows(8, 4)).substr(0, 150)), "not a whole number of points");
}

TEST(Kitti, AFifthColumnIsKnownByIntensitiesThatAreNotNegative) {
  const auto rows = [](int num, int num_columns, float y) {
    std::string bytes;
    for (int i = 0; i < num; ++i) {
      const float time = 0.001F * static_cast<float>(i) - 0.05F;
      const std::array row = {1.5F + static_cast<float>(i), y, 1.25F, 0.75F, time};
      for (int k = 0; k < num_columns; ++k) append_little_endian(bytes, row.at(static_cast<std::size_t>(k)));
    }
    return bytes;
  };
  for (const int num : {201, 200})  // the latter have a size of whole rows of four columns, too
    EXPECT_EQ(read_kitti(rows(num, 5, -2.0F))->cloud.size(), static_cast<std::size_t>(num));
  EXPECT_EQ(read_kitti(rows(200, 4, -2.0F))->cloud.size(), 200U);
  EXPECT_ERROR(read_kitti(rows(126, 4, -2.0F).substr(0, 2000 - 20)), "the last whole one ends at byte 1968");
}

TEST(CloudFiles, FormatFollowsTheExtension) {
  const test::TemporaryFolder folder;
  const PointCloud cloud = random_cloud(9, 8);
  for (const char* name : {"a.pcd", "a.PLY", "a.bin"}) {
    ASSERT_TRUE(write_cloud(folder / name, cloud));
    const Result<PointCloud> back = read_cloud(folder / name);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->points, cloud.points);
  }
  EXPECT_EQ(test::num_entries(folder.path()), 3U);  // nothing partial is left behind
  EXPECT_ERROR(write_cloud(folder / "a.xyz", cloud), "not an extension of point clouds");
  EXPECT_ERROR(write_cloud(folder / "empty.pcd", {}), "no points");
  EXPECT_ERROR(read_cloud(folder / "absent.pcd"), "absent.pcd: no such file");
  EXPECT_ERROR(write_cloud(folder / "absent" / "a.pcd", cloud), "does not exist");
  test::put_file(folder / "cut.pcd", test::get_file(folder / "a.pcd").substr(0, 250));
  EXPECT_ERROR(read_cloud(folder / "cut.pcd"), "cut.pcd: ");
}

TEST(CloudFiles, RealFiles) {
  ADIT_NEED_DATA("scans/nclt/0000.pcd");
  const auto size_of_cloud = [](const std::string& name) {
    const Result<CloudFile> file = read_cloud_file(test::shared_data(name));
    EXPECT_TRUE(file) << file.error().message;
    return file ? file->cloud.size() : 0;
  };
  EXPECT_EQ(size_of_cloud("scans/nclt/0000.pcd"), 18421U);
  EXPECT_GT(size_of_cloud("registration/kitti_pair/source.ply"), 60'000U);
  EXPECT_GT(size_of_cloud("registration/ndt_omp_pair/251370668.pcd"), 60'000U);
}

}  // namespace
}  // namespace adit
