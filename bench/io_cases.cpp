// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Reading recordings: decoding clouds, and what `adit info` does with a large file.
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "adit/core/check.hpp"
#include "adit/io/bag_recording.hpp"
#include "adit/io/file_info.hpp"
#include "harness/bench_case.hpp"
#include "made_bag.hpp"

namespace adit::bench {
namespace {

namespace fs = std::filesystem;

/// A file that goes with the process.
class TemporaryBag {
 public:
  explicit TemporaryBag(const MadeBag& bag) {
    std::string folder = (fs::temp_directory_path() / "adit-bench-XXXXXX").string();
    ADIT_CHECK(mkdtemp(folder.data()) != nullptr, "the folder of temporary files takes files");
    folder_ = folder;
    write_made_bag(path(), bag);
  }
  TemporaryBag(const TemporaryBag&) = delete;
  TemporaryBag& operator=(const TemporaryBag&) = delete;
  ~TemporaryBag() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  [[nodiscard]] fs::path path() const { return folder_ / "made.mcap"; }

 private:
  fs::path folder_;
};

constexpr std::size_t kScans = 100;
constexpr double kMegabytes = kScans * kMegabytesOfScan;

/// All clouds, as points in memory; the sum of the coordinates tells whether readers agree.
Figures decode_all(const fs::path& path) {
  const Result<Recording> recording = read_recording(path);
  ADIT_CHECK(recording.has_value(), "the made bag is a recording");
  double num = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < recording->num_scans(); ++i) {
    const Result<Scan> scan = recording->read_scan(i);
    ADIT_CHECK(scan.has_value(), "every scan of the made bag is whole");
    num += static_cast<double>(scan->cloud.size());
    for (std::size_t k = 0; k < scan->cloud.size(); k += 1000)
      sum += static_cast<double>(scan->cloud.points[k].sum());
  }
  return {{"points", num},
          {"coordinate_sum_m", sum},
          {"wheel_poses", static_cast<double>(recording->wheel.size())}};
}

Prepare decoding(const std::string& compression) {
  return [compression]() -> Work {
    const auto bag = std::make_shared<const TemporaryBag>(MadeBag{kScans, compression});
    decode_all(bag->path());  // from the page cache
    return [bag] { return decode_all(bag->path()); };
  };
}

const char* const kTimed =
    "opening, wheels and IMU, and every cloud from the page cache to points in memory, times in nanoseconds";

CaseInfo decoding_info(const std::string& name, const std::string& scene) {
  return {
      .name = name,
      .work = "opening a recording and decoding all of its clouds",
      .scene = scene,
      .peer = "mcap-core",
      .note =
          "each byte copied from the page cache, summed up, and taken apart: about 1 ms a megabyte at most",
      .per_run = kMegabytes,
      .unit = "megabyte of points"};
}
const Case plain(decoding_info("io/mcap_plain",
                               "100 clouds of 131,072 points of 20 bytes, 2,000 samples of an "
                               "IMU, 500 of wheels; uncompressed MCAP, 262 MB"));
const Side plain_adit("io/mcap_plain", "adit", decoding(""), {.timed = kTimed});
const Case zstd(decoding_info("io/mcap_zstd", "the same, chunks compressed by zstd at level 1"));
const Side zstd_adit("io/mcap_zstd", "adit", decoding("zstd"), {.timed = kTimed});

const Case info_large(
    {.name = "io/info_10gb",
     .work = "what adit info says of a recording",
     .scene = "3,815 clouds in 10 GB of MCAP with a summary (sparse file), 76,300 samples of an "
              "IMU, 19,075 of wheels"});
const Side info_large_adit("io/info_10gb", "adit", []() -> Work {
  const auto bag = std::make_shared<const TemporaryBag>(MadeBag{3815, "", true});
  return [bag] {
    const Result<std::string> info = file_info(bag->path().string(), {});
    ADIT_CHECK(info.has_value() && info->find("\"looked_at\"") != std::string::npos, "the made bag is large");
    return Figures{{"gigabytes", static_cast<double>(fs::file_size(bag->path())) * 1e-9}};
  };
});

/// Peak memory stands beside the times.
const Growth by_length(
    "io/by_length", "Decoding all clouds of a recording, a gigabyte", "GB", {0.5, 1, 2, 4},
    [](double gigabytes) -> Work {
      const auto num_scans = static_cast<std::size_t>(gigabytes * 1000.0 / kMegabytesOfScan);
      const auto bag = std::make_shared<const TemporaryBag>(MadeBag{num_scans, "", true});
      return [bag] { return decode_all(bag->path()); };
    },
    [](double gigabytes) { return gigabytes; });

// For readers outside this repository.
const Export made_bags("io", [](const fs::path& folder) {
  write_made_bag(folder / "mcap_plain.mcap", {kScans, ""});
  write_made_bag(folder / "mcap_zstd.mcap", {kScans, "zstd"});
});

}  // namespace
}  // namespace adit::bench
