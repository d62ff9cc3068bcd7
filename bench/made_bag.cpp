// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "made_bag.hpp"

#include <cmath>
#include <fstream>
#include <map>
#include <vector>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/crc32.hpp"
#include "adit/io/mcap_records.hpp"
#include "adit/io/ros_messages.hpp"

namespace adit::bench {
namespace {

constexpr std::size_t kPoints = 131'072;
constexpr std::int64_t kInterval = 100'000'000;  // nanoseconds
const Stamp kStart{1'700'000'000'000'000'000};

enum Topic : std::uint16_t { points = 0, wheels = 1, imu = 2, links = 3 };

/// Walls of a tube, each point with noise, as real ranges have.
Scan made_scan(std::size_t index) {
  Rng rng(index % 8 + 1);
  Scan scan{kStart + Duration(kInterval * static_cast<std::int64_t>(index)), {}};
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double angle = 6.283 * static_cast<double>(i % 1024) / 1024.0;
    const double along = rng.uniform(-40.0, 40.0);
    const double radius = 3.0 + 0.01 * rng.normal();
    scan.cloud.points.emplace_back(static_cast<float>(along), static_cast<float>(radius * std::cos(angle)),
                                   static_cast<float>(radius * std::sin(angle)));
    scan.cloud.intensities.push_back(static_cast<float>(rng.below(256)));
    scan.cloud.time_offsets_ns.push_back(static_cast<std::int32_t>(i * 760));
  }
  return scan;
}

class BagWriter {
 public:
  BagWriter(const std::filesystem::path& path, MadeBag bag)
      : out_(path, std::ios::binary), bag_(std::move(bag)) {
    write(mcap::kMagic);
    write(framed(mcap::Opcode::header, encode(mcap::Header{"ros2", "made"})));
    std::uint16_t id = 0;
    for (const auto& [topic, type] : {std::pair{"/points", ros::kPointCloud2},
                                      {"/odom", ros::kOdometry},
                                      {"/imu", ros::kImu},
                                      {"/tf_static", ros::kTransforms}}) {
      const mcap::Schema schema{static_cast<std::uint16_t>(id + 1), std::string(type), "ros2msg",
                                ros::definition_of(type)};
      summary_ += framed(mcap::Opcode::schema, encode(schema));
      summary_ += framed(mcap::Opcode::channel, encode(mcap::Channel{id++, schema.id, topic, "cdr", {}}));
    }
    write(summary_);
  }

  /// Scan `index` with what was measured until the next one. `cloud` is its message; the last `hole` bytes of
  /// it are left out.
  void write_scan(std::size_t index, const std::string& cloud, std::uint64_t hole) {
    const Stamp begin = kStart + Duration(kInterval * static_cast<std::int64_t>(index));
    std::string records;
    std::map<std::uint16_t, mcap::MessageIndex> indexes;
    const auto add = [&](Topic topic, Stamp stamp, std::string data) {
      indexes[topic].channel_id = topic;
      indexes[topic].entries.emplace_back(stamp.ns, records.size());
      records +=
          framed(mcap::Opcode::message, encode(mcap::Message{topic, 0, stamp, stamp, std::move(data)}));
    };
    if (index == 0) add(links, begin, ros::encode_transforms({{"base_link", "lidar", {begin, Pose()}}}));
    for (int k = 0; k < 5; ++k) {
      const Stamp stamp = begin + Duration(kInterval / 5 * k);
      add(wheels, stamp,
          ros::encode_odometry(
              {{"odom",
                "base_link",
                {stamp, Pose::translation_of(1e-9 * static_cast<double>((stamp - kStart).count()), 0, 0)}},
               {}}));
    }
    for (int k = 0; k < 20; ++k) {
      ros::ImuMessage sample;
      sample.frame = "base_link";
      sample.sample = {begin + Duration(kInterval / 20 * k), Vector3::Zero(), {0, 0, 9.81}};
      add(imu, sample.sample.stamp, ros::encode_imu(sample));
    }
    // The cloud is last, so that its hole is at the end of the chunk.
    add(points, begin + Duration(kInterval), cloud);
    write_chunk(records, hole, indexes, begin, begin + Duration(kInterval));
  }

  void finish() {
    write(framed(mcap::Opcode::data_end, std::string(4, '\0')));
    const std::uint64_t summary_start = offset_;
    write(summary_);
    write(framed(mcap::Opcode::footer, encode(mcap::Footer{summary_start, 0, 0})));
    write(mcap::kMagic);
    ADIT_CHECK(out_.flush().good(), "the made bag fits the disk");
  }

 private:
  void write(std::string_view bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    offset_ += bytes.size();
  }

  void write_chunk(const std::string& records, std::uint64_t hole,
                   const std::map<std::uint16_t, mcap::MessageIndex>& indexes, Stamp begin, Stamp end) {
    const bool is_packed = bag_.compression == "zstd";
    const std::string packed = is_packed ? compress_zstd(records) : std::string();
    const std::string_view stored = is_packed ? packed : records;
    mcap::ChunkIndex index{begin, end, offset_, 0, {}, 0, bag_.compression, stored.size(), records.size()};
    const std::string chunk = framed(
        mcap::Opcode::chunk, encode(mcap::Chunk{begin, end, records.size(), hole > 0 ? 0 : crc32(records),
                                                bag_.compression, stored}));
    write(std::string_view(chunk).substr(0, chunk.size() - hole));
    out_.seekp(static_cast<std::streamoff>(hole), std::ios::cur);
    offset_ += hole;
    index.chunk_length = chunk.size();
    for (const auto& [channel, entries] : indexes) {
      index.message_index_offsets[channel] = offset_;
      write(framed(mcap::Opcode::message_index, encode(entries)));
    }
    index.message_index_length = offset_ - index.chunk_start - index.chunk_length;
    summary_ += framed(mcap::Opcode::chunk_index, encode(index));
  }

  std::ofstream out_;
  MadeBag bag_;
  std::string summary_;
  std::uint64_t offset_ = 0;
};

}  // namespace

void write_made_bag(const std::filesystem::path& path, const MadeBag& bag) {
  BagWriter writer(path, bag);
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < std::min<std::size_t>(bag.num_scans, bag.is_sparse ? 1 : 8); ++i)
    scans.push_back(made_scan(i));
  for (std::size_t i = 0; i < bag.num_scans; ++i) {
    Scan& scan = scans[i % scans.size()];
    scan.stamp = kStart + Duration(kInterval * static_cast<std::int64_t>(i));
    // A byte after the points says that all are finite; it is zero in the hole.
    writer.write_scan(i, ros::encode_cloud(scan, "lidar"), bag.is_sparse ? kPoints * 20 + 1 : 0);
  }
  writer.finish();
}

}  // namespace adit::bench
