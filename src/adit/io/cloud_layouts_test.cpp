// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Clouds as the drivers of LiDARs lay them out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "adit/io/ros_messages.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

constexpr std::size_t kNum = 400;
constexpr double kSweep = 0.1;  // seconds
const Stamp kStamp{1'700'000'000'123'456'789};

/// sensor_msgs/PointField's numbers.
enum class Datatype : std::uint8_t { uint8 = 2, uint16 = 4, int32 = 5, uint32 = 6, float32 = 7, float64 = 8 };

std::size_t size_of(Datatype type) {
  switch (type) {
    case Datatype::uint8:
      return 1;
    case Datatype::uint16:
      return 2;
    case Datatype::float64:
      return 8;
    default:
      return 4;
  }
}

/// A field, and the value of point i in it.
struct LaidField {
  std::string name;
  std::uint32_t offset = 0;
  Datatype type = Datatype::float32;
  double (*value)(std::size_t point) = nullptr;
};

struct Layout {
  std::string name;
  std::vector<LaidField> fields;
  std::uint32_t point_step = 0;
  bool is_big_endian = false;
  std::uint32_t height = 1;
  std::uint32_t row_padding = 0;
};

template <class T>
void put_number(std::string& bytes, std::size_t at, T value, bool is_big_endian) {
  std::string raw(sizeof(T), '\0');
  std::memcpy(raw.data(), &value, sizeof(T));
  if (is_big_endian) std::ranges::reverse(raw);
  bytes.replace(at, sizeof(T), raw);
}

void put_value(std::string& bytes, std::size_t at, Datatype type, double value, bool is_big_endian) {
  switch (type) {
    case Datatype::uint8:
      return put_number(bytes, at, static_cast<std::uint8_t>(value), is_big_endian);
    case Datatype::uint16:
      return put_number(bytes, at, static_cast<std::uint16_t>(value), is_big_endian);
    case Datatype::int32:
      return put_number(bytes, at, static_cast<std::int32_t>(value), is_big_endian);
    case Datatype::uint32:
      return put_number(bytes, at, static_cast<std::uint32_t>(value), is_big_endian);
    case Datatype::float32:
      return put_number(bytes, at, static_cast<float>(value), is_big_endian);
    case Datatype::float64:
      return put_number(bytes, at, value, is_big_endian);
  }
}

/// A PointCloud2 of `num` points; bytes that no field covers are filled with rubbish.
std::string message_of(const Layout& layout, Stamp stamp = kStamp, std::size_t num = kNum) {
  const auto width = static_cast<std::uint32_t>(num / layout.height);
  const std::uint32_t row_step = width * layout.point_step + layout.row_padding;
  std::string data(std::size_t{row_step} * layout.height, '\xAB');
  for (std::size_t i = 0; i < num; ++i)
    for (const LaidField& field : layout.fields)
      put_value(data, i / width * row_step + i % width * layout.point_step + field.offset, field.type,
                field.value(i), layout.is_big_endian);
  CdrWriter writer;
  writer.number(static_cast<std::int32_t>(stamp.ns / 1'000'000'000))
      .number(static_cast<std::uint32_t>(stamp.ns % 1'000'000'000))
      .text("lidar")
      .number(layout.height)
      .number(width)
      .number(static_cast<std::uint32_t>(layout.fields.size()));
  for (const LaidField& field : layout.fields)
    writer.text(field.name)
        .number(field.offset)
        .number(static_cast<std::uint8_t>(field.type))
        .number(std::uint32_t{1});
  return writer.number(static_cast<std::uint8_t>(layout.is_big_endian))
      .number(layout.point_step)
      .number(row_step)
      .blob(data)
      .number(std::uint8_t{0})
      .take();
}

double x_of(std::size_t i) { return 1.0 + 0.25 * static_cast<double>(i); }
double y_of(std::size_t i) { return -2.0 - 0.5 * static_cast<double>(i % 7); }
double z_of(std::size_t i) { return 0.125 * static_cast<double>(i % 5); }
double shine_of(std::size_t i) { return static_cast<double>(i % 200); }
double ring_of(std::size_t i) { return static_cast<double>(i % 16); }
double noise_of(std::size_t /*i*/) { return 77.0; }
/// Seconds from the start of the sweep.
double time_of(std::size_t i) { return kSweep * static_cast<double>(i) / kNum; }
double seconds_from_start(std::size_t i) { return time_of(i); }
double seconds_to_end(std::size_t i) { return time_of(i) - kSweep; }
double nanoseconds_from_start(std::size_t i) { return std::round(1e9 * time_of(i)); }
double microseconds_from_start(std::size_t i) { return std::round(1e6 * time_of(i)); }
double absolute_seconds(std::size_t i) { return 1'700'000'000.123456789 + time_of(i); }
double seconds_of_atoms(std::size_t i) { return absolute_seconds(i) + 37.0; }  // as PTP counts them
double seconds_since_switched_on(std::size_t i) { return 7200.0 + time_of(i); }
double seconds_of_one_packet(std::size_t i) { return 77.0 + 1e-3 * time_of(i); }
double absolute_nanoseconds(std::size_t i) { return 1'700'000'000'123'456'789.0 + 1e9 * time_of(i); }

std::vector<LaidField> with_xyz(std::vector<LaidField> further, Datatype type = Datatype::float32) {
  const auto step = static_cast<std::uint32_t>(size_of(type));
  std::vector<LaidField> fields = {
      {"x", 0, type, x_of}, {"y", step, type, y_of}, {"z", 2 * step, type, z_of}};
  fields.insert(fields.end(), further.begin(), further.end());
  return fields;
}

using enum Datatype;

/// Decodes and compares with what was laid out. `from` is the time of the first point about the stamp.
void expect_layout(const Layout& layout, double from, double tolerance) {
  SCOPED_TRACE(layout.name);
  const Result<ros::CloudMessage> message = ros::decode_cloud(message_of(layout));
  ASSERT_TRUE(message) << message.error().message;
  EXPECT_EQ(message->scan.stamp, kStamp);
  const PointCloud& cloud = message->scan.cloud;
  ASSERT_EQ(cloud.size(), kNum);
  ASSERT_EQ(cloud.intensities.size(), kNum);
  ASSERT_EQ(cloud.time_offsets_ns.size(), kNum);
  for (std::size_t i = 0; i < kNum; ++i) {
    EXPECT_EQ(cloud.points[i].cast<double>(), Vector3(x_of(i), y_of(i), z_of(i))) << i;
    EXPECT_EQ(cloud.intensities[i], shine_of(i)) << i;
    EXPECT_NEAR(1e-9 * cloud.time_offsets_ns[i], from + time_of(i), tolerance) << i;
  }
}

TEST(CloudLayouts, OfTheDriversThatPeopleUse) {
  expect_layout({"ouster",
                 with_xyz({{"intensity", 16, float32, shine_of},
                           {"t", 20, uint32, nanoseconds_from_start},
                           {"reflectivity", 24, uint16, noise_of},
                           {"ring", 26, uint16, ring_of},
                           {"ambient", 28, uint16, noise_of},
                           {"range", 32, uint32, noise_of}}),
                 48},
                0.0, 1e-9);
  expect_layout({"velodyne",
                 with_xyz({{"intensity", 12, float32, shine_of},
                           {"ring", 16, uint16, ring_of},
                           {"time", 18, float32, seconds_from_start}}),
                 22},
                0.0, 1e-8);
  expect_layout({"velodyne, times to the end",
                 with_xyz({{"intensity", 12, float32, shine_of}, {"time", 16, float32, seconds_to_end}}), 20},
                -kSweep, 1e-8);
  expect_layout({"hesai",
                 with_xyz({{"intensity", 16, float32, shine_of},
                           {"timestamp", 24, float64, absolute_seconds},
                           {"ring", 32, uint16, ring_of}}),
                 48},
                0.0, 5e-7);  // a double of 1.7e9 s
  expect_layout({"robosense",
                 with_xyz({{"intensity", 12, float32, shine_of},
                           {"ring", 16, uint16, ring_of},
                           {"timestamp", 18, float64, absolute_seconds}}),
                 26},
                0.0, 5e-7);
  expect_layout({"livox",
                 with_xyz({{"intensity", 12, float32, shine_of},
                           {"tag", 16, uint8, noise_of},
                           {"line", 17, uint8, ring_of},
                           {"timestamp", 18, float64, absolute_nanoseconds}}),
                 26},
                0.0, 5e-7);
  expect_layout({"nebula",
                 with_xyz({{"intensity", 12, uint8, shine_of},
                           {"return_type", 13, uint8, noise_of},
                           {"channel", 14, uint16, ring_of},
                           {"distance", 16, float32, noise_of},
                           {"time_stamp", 20, uint32, nanoseconds_from_start}}),
                 24},
                0.0, 1e-9);
  expect_layout(
      {"microseconds",
       with_xyz({{"intensity", 12, float32, shine_of}, {"t", 16, uint32, microseconds_from_start}}), 20},
      0.0, 1e-6);
}

TEST(CloudLayouts, AnyOrderOfFieldsAndBytesAndAnyPadding) {
  for (const bool is_big_endian : {false, true}) {
    Layout layout{"turned round",
                  {{"t", 3, uint32, nanoseconds_from_start},
                   {"z", 11, float64, z_of},
                   {"reflectivity", 20, uint8, shine_of},  // where there is no intensity
                   {"x", 21, float64, x_of},
                   {"y", 29, float32, y_of}},
                  40,
                  is_big_endian};
    expect_layout(layout, 0.0, 1e-9);
    layout.height = 20;
    layout.row_padding = 13;
    expect_layout(layout, 0.0, 1e-9);
  }
  expect_layout({"whole numbers",
                 {{"x", 0, float64, x_of},
                  {"y", 8, float64, y_of},
                  {"z", 16, float64, z_of},
                  {"i", 24, uint16, shine_of},
                  {"offset_time", 28, uint32, nanoseconds_from_start}},
                 32},
                0.0, 1e-9);
}

/// Every third pixel saw nothing; its time is rubbish, too.
double x_or_nothing(std::size_t i) { return i % 3 == 0 ? std::numeric_limits<double>::quiet_NaN() : x_of(i); }
double time_or_rubbish(std::size_t i) { return i % 3 == 0 ? 4e9 : nanoseconds_from_start(i); }

TEST(CloudLayouts, PixelsOfAnOrganisedCloudThatSawNothingAreLeftOut) {
  const Layout layout{"organised",
                      {{"x", 0, float32, x_or_nothing},
                       {"y", 4, float32, y_of},
                       {"z", 8, float32, z_of},
                       {"intensity", 16, float32, shine_of},
                       {"t", 20, uint32, time_or_rubbish}},
                      24,
                      false,
                      20,
                      0};
  const Result<ros::CloudMessage> message = ros::decode_cloud(message_of(layout));
  ASSERT_TRUE(message) << message.error().message;
  const PointCloud& cloud = message->scan.cloud;
  std::size_t at = 0;
  for (std::size_t i = 0; i < kNum; ++i) {
    if (i % 3 == 0) continue;
    ASSERT_LT(at, cloud.size());
    EXPECT_EQ(cloud.points[at].x(), static_cast<float>(x_of(i)));
    EXPECT_EQ(cloud.intensities[at], shine_of(i));
    EXPECT_EQ(cloud.time_offsets_ns[at], nanoseconds_from_start(i));
    ++at;
  }
  EXPECT_EQ(at, cloud.size());
}

Layout timed(double (*time)(std::size_t)) {
  return {"timed", with_xyz({{"intensity", 16, float32, shine_of}, {"timestamp", 24, float64, time}}), 32};
}

/// One cloud every 0.1 s, recorded some time after their stamps.
Result<Recording> recorded(const std::vector<std::string>& clouds, Duration delay,
                           const RecordingConfig& config = {}) {
  std::vector<std::pair<Stamp, std::string>> stamped;
  for (const std::string& cloud : clouds) stamped.emplace_back(ros::decode_stamp(cloud).value(), cloud);
  test::ForeignFile file;
  file.cloud_messages("/points", stamped, delay).links({test::link("base_link", "lidar", Pose())});
  return file.read(config);
}

Stamp stamp_of(int k) { return kStamp + std::chrono::milliseconds(100 * k); }

std::vector<std::string> three_of(const Layout& layout) {
  return {message_of(layout, stamp_of(0)), message_of(layout, stamp_of(1)), message_of(layout, stamp_of(2))};
}

std::pair<std::int32_t, std::int32_t> times_of(const Result<Recording>& recording, std::size_t i) {
  const Scan scan = recording->read_scan(i).value();
  const auto [earliest, latest] = std::ranges::minmax(scan.cloud.time_offsets_ns);
  return {earliest, latest};
}

TEST(CloudLayouts, AbsoluteTimesOfAnotherClockCountFromTheStartOfTheSweep) {
  expect_layout(timed(seconds_of_atoms), 0.0, 5e-7);
  expect_layout(timed(seconds_since_switched_on), 0.0, 5e-7);
  const std::vector<std::string> clouds = three_of(timed(seconds_of_atoms));
  constexpr const char* kApart =
      "point times: they are 37.000 s from the stamps, as by another clock, and count from the first point "
      "of "
      "the sweep";
  constexpr const char* kRemedy =
      ", taken for the time of the stamp; if that is of the sweep's end, --set recording.stamp_at=end";
  const Result<Recording> late = recorded(clouds, std::chrono::milliseconds(110));
  ASSERT_TRUE(late) << late.error().message;
  EXPECT_EQ(late->assumptions, std::vector{std::string(kApart) + kRemedy});
  // What is found or stated of the stamp is not contradicted.
  const Result<Recording> early = recorded(clouds, std::chrono::milliseconds(5));
  ASSERT_EQ(early->assumptions.size(), 2U);
  EXPECT_EQ(early->assumptions[0], kApart);
  EXPECT_NE(early->assumptions[1].find("the stamp is of its end"), std::string::npos);
  EXPECT_EQ(recorded(clouds, std::chrono::milliseconds(110), {.stamp_at = "end"})->assumptions,
            std::vector<std::string>{kApart});
}

TEST(CloudLayouts, TimesOfAnotherClockThatSpanNoSweepAreNoTimes) {
  EXPECT_ERROR(ros::decode_cloud(message_of(timed(seconds_of_one_packet))),
               "s and lie -1699999923.123 s from the scan's stamp");
  // In a recording the first scan has shown the unit, and sparse ones follow it.
  const Layout layout = timed(seconds_of_atoms);
  const Result<Recording> sparse = recorded(
      {message_of(layout, stamp_of(0)), message_of(layout, stamp_of(1), 1)}, std::chrono::seconds(1));
  ASSERT_TRUE(sparse) << sparse.error().message;
  EXPECT_EQ(sparse->read_scan(1).value().cloud.time_offsets_ns, std::vector<std::int32_t>{0});
}

/// Of a clock of 32 bits, which begins anew every 4.29 s; a sweep that begins after so many tenths of a
/// second.
template <int Tenths>
double nanoseconds_of_32_bits(std::size_t i) {
  return std::fmod(1e8 * Tenths + nanoseconds_from_start(i), 4294967296.0);
}

TEST(CloudLayouts, TheFirstScanDecidesWhatTheTimesOfAllCountFrom) {
  const auto cloud = [](int k, double (*time)(std::size_t)) {
    return message_of({"wraps", with_xyz({{"t", 12, uint32, time}}), 16}, stamp_of(k));
  };
  const Result<Recording> wraps =
      recorded({cloud(0, nanoseconds_of_32_bits<30>), cloud(1, nanoseconds_of_32_bits<41>),
                cloud(2, nanoseconds_of_32_bits<43>), cloud(3, nanoseconds_of_32_bits<50>)},
               std::chrono::milliseconds(110));
  ASSERT_TRUE(wraps) << wraps.error().message;
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(times_of(wraps, i), std::pair(0, static_cast<std::int32_t>(nanoseconds_from_start(kNum - 1))))
        << i;
  // Also where the first sweep begins soon after the clock began anew.
  const Result<Recording> soon =
      recorded({cloud(0, nanoseconds_of_32_bits<50>), cloud(1, nanoseconds_of_32_bits<30>)},
               std::chrono::milliseconds(110));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(times_of(soon, i).first, 0) << i;
  // All are looked at as they are read, also for when they were recorded.
  const Result<Recording> early =
      recorded({cloud(0, nanoseconds_of_32_bits<30>), cloud(1, nanoseconds_of_32_bits<44>)},
               std::chrono::milliseconds(5));
  EXPECT_EQ(times_of(early, 1).second, 0) << "the stamps are of the end";
  const Result<Recording> set =
      recorded({cloud(0, nanoseconds_from_start), cloud(1, nanoseconds_of_32_bits<30>)}, Duration(0));
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_ERROR(set->read_scan(1), "s from its stamp, those of the first scan do not; was a clock set?");
}

TEST(CloudLayouts, OneTimeForAllPointsIsNone) {
  const Result<Recording> recording = recorded(three_of(timed(noise_of)), Duration(0));
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(
      recording->assumptions,
      std::vector<std::string>{"point times: field 'timestamp' is the same for every point, so that scans "
                               "are not corrected for the motion during a sweep"});
  for (std::size_t i = 0; i < 3; ++i) EXPECT_FALSE(recording->read_scan(i).value().cloud.has_times());
}

/// Three sweeps whose times count from their start, recorded some time after their stamps.
Result<Recording> recorded_after(Duration delay, const RecordingConfig& config = {}) {
  std::vector<std::pair<Stamp, std::string>> clouds;
  for (std::size_t k = 0; k < 3; ++k) {
    Scan scan = test::make_scan(k, 200);
    for (std::size_t i = 0; i < scan.cloud.size(); ++i)
      scan.cloud.time_offsets_ns[i] = static_cast<std::int32_t>(500'000 * i);
    clouds.emplace_back(scan.stamp, ros::encode_cloud(scan, "lidar"));
  }
  test::ForeignFile file;
  file.cloud_messages("/points", clouds, delay).links({test::link("base_link", "lidar", Pose())});
  return file.read(config);
}

TEST(CloudLayouts, AStampOfTheEndIsFoundByWhenTheScanWasRecorded) {
  constexpr std::int32_t kLast = 500'000 * 199;
  const std::pair from_start{0, kLast};
  const std::pair to_end{-kLast, 0};
  const Result<Recording> late = recorded_after(std::chrono::milliseconds(110));
  ASSERT_TRUE(late) << late.error().message;
  EXPECT_EQ(times_of(late, 0), from_start);
  EXPECT_TRUE(late->assumptions.empty());
  const Result<Recording> early = recorded_after(std::chrono::milliseconds(5));
  ASSERT_TRUE(early) << early.error().message;
  EXPECT_EQ(times_of(early, 0), to_end);
  ASSERT_EQ(early->assumptions.size(), 1U);
  EXPECT_NE(early->assumptions[0].find("the stamp is of its end"), std::string::npos);
  // Clocks that differ tell nothing.
  EXPECT_EQ(times_of(recorded_after(std::chrono::seconds(-40)), 0), from_start);
  // What people say holds.
  EXPECT_EQ(times_of(recorded_after(std::chrono::milliseconds(5), {.stamp_at = "start"}), 0), from_start);
  EXPECT_EQ(times_of(recorded_after(std::chrono::milliseconds(110), {.stamp_at = "end"}), 0), to_end);
  EXPECT_ERROR(recorded_after(Duration(0), {.stamp_at = "middle"}), "'middle' is not start, end or auto");
}

TEST(CloudLayouts, AUnitThatIsStatedIsSaidToBe) {
  std::vector<std::pair<Stamp, std::string>> clouds;
  for (std::size_t k = 0; k < 3; ++k) {
    Scan scan = test::make_scan(k, 200);
    for (std::size_t i = 0; i < scan.cloud.size(); ++i)
      scan.cloud.time_offsets_ns[i] = static_cast<std::int32_t>(500 * i);  // microseconds: 0.1 s
    clouds.emplace_back(scan.stamp, ros::encode_cloud(scan, "lidar"));
  }
  test::ForeignFile file;
  file.cloud_messages("/points", clouds, std::chrono::milliseconds(110))
      .links({test::link("base_link", "lidar", Pose())});
  const Recording right = file.read({.point_times = "us"}).value();
  EXPECT_EQ(right.assumptions, std::vector<std::string>{"point times: in us, as stated by --point-times"});
  EXPECT_TRUE(right.warnings.empty());
  const Recording wrong = file.read({.point_times = "ns"}).value();
  EXPECT_TRUE(wrong.assumptions.empty()) << "that is their usual unit";
  ASSERT_EQ(wrong.warnings.size(), 1U);
  EXPECT_NE(wrong.warnings[0].find("the first sweep lasts 9.95e-05 s, where LiDARs take 0.05 to 0.2 s"),
            std::string::npos)
      << wrong.warnings[0];
}

TEST(CloudLayouts, ScansThatAClockCostAreCounted) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::string cloud_frame = "lidar";
  const auto recorded_at = [&](const std::vector<std::int64_t>& tenths) {
    test::ForeignFile file;
    Stamp arrived = test::make_scan(0, 0).stamp;
    for (std::size_t k = 0; k < tenths.size(); ++k) {
      Scan scan = test::make_scan(0, 10);
      scan.stamp.ns += tenths[k] * (kSecond / 10);
      arrived = arrived + Duration(kSecond / 10);
      file.cloud_messages("/points", {{scan.stamp, ros::encode_cloud(scan, cloud_frame)}},
                          arrived - scan.stamp);
    }
    file.links({test::link("base_link", cloud_frame, Pose())});
    return file.read().value();
  };
  const Recording set_back = recorded_at({0, 1, 2, 3, 4, 5, -40, -39, -38});
  EXPECT_EQ(set_back.num_scans(), 6U);
  EXPECT_EQ(set_back.num_scans_left_out, 3U);
  EXPECT_EQ(recorded_at({0, 1, 900, 3, 4}).num_scans_left_out, 1U);
  const Recording repeated = recorded_at({0, 0, 1, 1, 2, 2});
  EXPECT_EQ(repeated.num_scans(), 3U);
  EXPECT_EQ(repeated.num_scans_left_out, 0U) << "sent twice, none is lost";
  EXPECT_EQ(recorded_at({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2}).num_scans_left_out, 3U)
      << "of the same stamps, and not the same scans";
}

TEST(CloudLayouts, MissingTimesAreSaidOnce) {
  test::ForeignFile file;
  std::vector<std::pair<Stamp, std::string>> clouds;
  for (std::size_t k = 0; k < 3; ++k) {
    Scan scan = test::make_scan(k, 10);
    scan.cloud.time_offsets_ns.clear();
    clouds.emplace_back(scan.stamp, ros::encode_cloud(scan, "lidar"));
  }
  file.cloud_messages("/points", clouds, Duration(0)).links({test::link("base_link", "lidar", Pose())});
  const Result<Recording> recording = file.read();
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->assumptions.size(), 1U);
  EXPECT_NE(recording->assumptions[0].find("point times: none"), std::string::npos);
}

TEST(CloudLayouts, TheBeginningOfABagHasSomethingOfEachTopic) {
  test::ForeignFile file;
  file.clouds("/points").links({test::link("base_link", "os_lidar", Pose())});
  std::vector<ros::JointStateMessage> joints;
  for (int i = 0; i < 20; ++i)
    joints.push_back({test::make_scan(0, 0).stamp + Duration(10'000'000LL * i), {}, {}, {}});
  file.joints("/joint_states", joints);
  Bag bag = open_mcap_bag(memory_source(file.bytes())).value();
  EXPECT_EQ(bag.num_bytes, file.bytes().size());
  for (BagMessage& message : bag.messages)
    if (!bag.topics[message.topic].name.starts_with("/joint")) message.log_time.ns += 3'600'000'000'000;
  std::ranges::stable_sort(bag.messages, {}, &BagMessage::log_time);
  const Bag beginning = beginning_of(bag, 0.0501);
  EXPECT_EQ(beginning.messages.size(), 3U + 1U + 6U);  // scans and links, which begin late, joints until then
  EXPECT_TRUE(read_recording(beginning));
}

}  // namespace
}  // namespace adit
