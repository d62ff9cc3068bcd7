// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Logs that are made to overflow the stack, a number or the reader's patience.
#include <gtest/gtest.h>

#include <string>

#include "adit/core/format.hpp"
#include "adit/io/jrl.hpp"
#include "adit/io/json_depth.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

constexpr std::size_t kDeep = 200'000;

/// A step along x as a robot logs it.
std::string step(std::string_view from, std::string_view to, double x, double y = 0.0) {
  return format(
      R"({{"type":"BetweenFactorPose2","key1":{},"key2":{},"measurement":{{"type":"Pose2","x":{},"y":{},"theta":0}},)"
      R"("covariance":[1,0,0,0,1,0,0,0,1]}})",
      from, to, x, y);
}
/// Robots a and b, whose only entries hold such measurements.
std::string log_of(const std::string& of_a, const std::string& of_b, const std::string& more = "") {
  return format(
      R"({{"robots":["a","b"],"measurements":{{"a":[{{"measurements":[{}]}}],"b":[{{"measurements":[{}]}}]}}{}}})",
      of_a, of_b, more);
}

TEST(JrlLimits, NestedCborIsRefusedBeforeItOverflowsTheStack) {
  const std::string start = "\xA1\x61\x61";  // {"a": ...
  const std::string lists = start + std::string(kDeep, '\x81') + '\0';
  EXPECT_ERROR(parse_jrl(lists, "deep.cbor"), "deep.cbor: byte 102: lists and objects more than 100 deep");
  for (const char open : {'\x9F', '\xBF', '\x5F', '\x7F', '\xC1'})
    EXPECT_ERROR(parse_jrl(start + std::string(kDeep, open), "deep.cbor"), "more than 100 deep");
  // As the key of an object, behind items of all lengths.
  const std::string items("\x84\x18\x20\x19\x01\x02\xFA\x01\x02\x03\x04\x42zz", 14);
  EXPECT_ERROR(parse_jrl(start + '\x82' + items + '\xA1' + std::string(kDeep, '\x7F'), "deep.cbor"),
               "more than 100 deep");
  // Lists that end do not add up.
  std::string flat = "\x9F";
  for (int i = 0; i < 300; ++i) flat += "\x81\x80\x9F\xFF";
  EXPECT_TRUE(check_cbor_depth(flat + '\xFF'));
}

TEST(JrlLimits, NestedJsonIsRefusedWhereverItIs) {
  const std::string nest = std::string(kDeep, '[') + std::string(kDeep, ']');
  EXPECT_ERROR(parse_jrl(R"({"robots":[)" + nest + R"(],"measurements":{}})", "deep.jrl"),
               "deep.jrl: byte 109: lists and objects more than 100 deep");
  const std::string ids = R"({"robots":["a"],"measurements":{},"outlier_factors":)";
  EXPECT_ERROR(parse_jrl(ids + nest + "}", "deep.jrl"), "more than 100 deep");
  EXPECT_TRUE(check_json_depth(R"({"name":"\"[[)" + std::string(kDeep, '[') + R"("})"));
  EXPECT_ERROR(parse_jrl(R"({"robots":[[1,2]],"measurements":{}})", "a.jrl"),
               "robots: array is not one letter");
  EXPECT_ERROR(parse_jrl(R"({"robots":["ab"],"measurements":{}})", "a.jrl"),
               "robots: \"ab\" is not one letter");
}

TEST(JrlLimits, AFolderIsNamedAsOne) {
  const test::TemporaryFolder folder;
  EXPECT_ERROR(read_jrl(folder.path()), "is a folder, a file is needed");
  EXPECT_ERROR(read_jrl(folder / "absent.jrl"), "absent.jrl: no such file");
}

TEST(JrlLimits, PosesThatOverflowWhenComposedAreRefused) {
  EXPECT_ERROR(parse_jrl(log_of(step("0", "1", 1.7e308), ""), "far.jrl"),
               "measurements.a[0].measurements[0]: 'measurement': 'x' and 'y': 1.7e+308 is not a coordinate");
  const std::string value = R"(,"initialization":{"a":[{"type":"Pose3","key":0,"translation":[0,0,-2e9],)"
                            R"("rotation":[1,0,0,0]}]})";
  EXPECT_ERROR(parse_jrl(log_of(step("0", "1", 1), "", value), "far.jrl"),
               "initialization.a[0]: -2000000000 is not a coordinate");
}

TEST(JrlLimits, ManyMeasurementsBetweenTwoNodesTakeNoSquareOfTheTime) {
  constexpr int kNum = 15'000;
  std::string of_a;
  std::string of_b;
  for (int i = 0; i < kNum; ++i) {
    const char* comma = i == 0 ? "" : ",";
    of_a += comma + step("0", "1", 1.0 + 1e-3 * i, 2.0);
    of_b += comma + step("0", "1", 1.0 + 1e-3 * i, i % 3 == 0 ? 2.0 : 3.0);
  }
  const auto file = parse_jrl(log_of(of_a, of_b), "many.jrl");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(std::get<JrlGraph<Pose2>>(file->content).graph.edges.size(), 2 * kNum - kNum / 3U);
}

}  // namespace
}  // namespace adit
