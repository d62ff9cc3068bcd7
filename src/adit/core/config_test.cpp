// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/config.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

enum class Loss { square, huber };
constexpr std::array kLosses{Loss::huber, Loss::square};  // not in the order of their values
std::string_view to_string(Loss loss) { return loss == Loss::square ? "square" : "huber"; }

struct SampleConfig {
  double voxel_size = 1.0;
  int max_iterations = 500;
  bool deskew = true;
  std::uint64_t seed = 1;
  std::string method = "kiss";
  Loss loss = Loss::square;
};
Fields fields_of(SampleConfig& c) {
  return {{"voxel_size", &c.voxel_size, "m", 0.01, 10.0, "edge of a voxel"},
          {"max_iterations", &c.max_iterations, "", 1, 10000, "at most"},
          {"deskew", &c.deskew, "", 0, 0, "undo the motion within the sweep"},
          {"seed", &c.seed, "", 0, 1e18, "of the noise"},
          {"method", &c.method, "", 0, 0, "which", {"kiss", "kinematic"}},
          enum_field("loss", &c.loss, kLosses, "how residuals count")};
}

std::string error_of(const Result<>& result) { return result ? "" : result.error().message; }

TEST(Config, SetsEachKindOfField) {
  SampleConfig config;
  const Fields fields = fields_of(config);
  EXPECT_TRUE(set_field(fields, "voxel_size", "0.25"));
  EXPECT_TRUE(set_field(fields, "max_iterations", "7"));
  EXPECT_TRUE(set_field(fields, "deskew", "false"));
  EXPECT_TRUE(set_field(fields, "seed", "123456789012345678"));
  EXPECT_TRUE(set_field(fields, "method", "kinematic"));
  EXPECT_TRUE(set_field(fields, "loss", "huber"));
  EXPECT_EQ(config.voxel_size, 0.25);
  EXPECT_EQ(config.max_iterations, 7);
  EXPECT_FALSE(config.deskew);
  EXPECT_EQ(config.seed, 123456789012345678U);
  EXPECT_EQ(config.method, "kinematic");
  EXPECT_EQ(config.loss, Loss::huber);
}

TEST(Config, AnEnumerationIsReadAndWrittenByName) {
  SampleConfig config;
  const Fields fields = fields_of(config);
  EXPECT_EQ(fields.back().choices, (std::vector<std::string>{"huber", "square"}));
  EXPECT_TRUE(fields.back().is_text());
  for (const Loss loss : kLosses) {
    EXPECT_TRUE(set_field(fields, "loss", to_string(loss)));
    EXPECT_EQ(config.loss, loss);
    EXPECT_EQ(value_text(fields.back()), to_string(loss));
  }
  EXPECT_NE(error_of(set_field(fields, "loss", "cubic")).find("huber, square"), std::string::npos);
  EXPECT_EQ(config.loss, Loss::square);
  EXPECT_TRUE(check_fields(fields));
}

TEST(Config, AKeyWithoutItsFirstPartsIsNearTheOnlyOneThatEndsInIt) {
  const std::vector<std::string> known = {"robot.odometry.method", "back_end.gnc.mu_step", "loops.mu_step"};
  EXPECT_EQ(nearest_key(known, "odometry.method"), "robot.odometry.method");
  EXPECT_EQ(nearest_key(known, "gnc.mu_step"), "back_end.gnc.mu_step");
}

TEST(Config, BadValuesChangeNothingAndSayWhatIsAllowed) {
  SampleConfig config;
  const Fields fields = fields_of(config);
  EXPECT_NE(error_of(set_field(fields, "voxel_size", "20")).find("0.01 to 10 m"), std::string::npos);
  for (const char* text : {"", "x", "1.0x", "nan", "inf", "-1", " 1", "1e99"}) {
    EXPECT_FALSE(set_field(fields, "voxel_size", text)) << text;
  }
  for (const char* text : {"1.5", "0", "-3", "99999999999999", "true"}) {
    EXPECT_FALSE(set_field(fields, "max_iterations", text)) << text;
  }
  for (const char* text : {"1", "True", "yes", ""}) EXPECT_FALSE(set_field(fields, "deskew", text)) << text;
  EXPECT_FALSE(set_field(fields, "seed", "-1"));
  EXPECT_NE(error_of(set_field(fields, "method", "icp")).find("kiss, kinematic"), std::string::npos);
  const SampleConfig defaults;
  EXPECT_EQ(config.voxel_size, defaults.voxel_size);
  EXPECT_EQ(config.max_iterations, defaults.max_iterations);
  EXPECT_EQ(config.deskew, defaults.deskew);
  EXPECT_EQ(config.seed, defaults.seed);
  EXPECT_EQ(config.method, defaults.method);
}

TEST(Config, UnknownKeysNameTheNearest) {
  SampleConfig config;
  Fields fields;
  append(fields, "odometry", fields_of(config));
  EXPECT_NE(error_of(set_field(fields, "odometry.voxl_size", "1")).find("'odometry.voxel_size'"),
            std::string::npos);
  EXPECT_NE(error_of(set_field(fields, "voxel_size", "1")).find("'odometry.voxel_size'"), std::string::npos);
  EXPECT_NE(error_of(set_field(fields, "odometry.max_iteration", "1")).find("max_iterations"),
            std::string::npos);
  EXPECT_EQ(error_of(set_field(fields, "quite_something_else", "1")).find("did you mean"), std::string::npos);
  EXPECT_FALSE(set_field(fields, "", "1"));
}

TEST(Config, ValuesAreReadBackExactly) {
  SampleConfig config;
  config.voxel_size = 0.1 + 0.2;
  config.seed = 987654321987654321U;
  SampleConfig copy;
  const Fields fields = fields_of(config);
  const Fields copies = fields_of(copy);
  for (const Field& field : fields) EXPECT_TRUE(set_field(copies, field.key, value_text(field))) << field.key;
  EXPECT_EQ(copy.voxel_size, config.voxel_size);
  EXPECT_EQ(copy.seed, config.seed);
}

TEST(Config, ChecksStructsThatCodeFilled) {
  SampleConfig config;
  EXPECT_TRUE(check_fields(fields_of(config)));
  config.max_iterations = 0;
  EXPECT_NE(error_of(check_fields(fields_of(config))).find("max_iterations"), std::string::npos);
  config = {};
  config.voxel_size = std::nan("");
  EXPECT_FALSE(check_fields(fields_of(config)));
  config = {};
  config.method = "none";
  EXPECT_FALSE(check_fields(fields_of(config)));
}

}  // namespace
}  // namespace adit
