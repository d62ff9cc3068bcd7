// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/recording_files.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/bag_recording.hpp"
#include "adit/io/scan_folder.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

std::optional<ScanSelection> parse_selection(const std::string& text) {
  if (text == "even") return ScanSelection{0, 2};
  if (text == "odd") return ScanSelection{1, 2};
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return std::nullopt;
  const std::optional<std::size_t> first = parse_size(text.substr(0, colon));
  const std::optional<std::size_t> step = parse_size(text.substr(colon + 1));
  if (!first || !step || *step == 0) return std::nullopt;
  return ScanSelection{*first, *step};
}

/// For clouds of a folder; of a bag it is done where scans are read.
Recording with_stamps_at_end(Recording recording) {
  recording.read_scan = [read = std::move(recording.read_scan)](std::size_t i) {
    return read(i).and_then([i](Scan scan) -> Result<Scan> {
      if (Result<> moved = put_stamp_at_end(scan); !moved) return fail(format("scan {}", i), moved.error());
      return scan;
    });
  };
  return recording;
}

/// Beside a folder of clouds lies at most one file of each kind, so that there is nothing to choose.
Recording without_left_out(Recording recording, const RecordingConfig& config) {
  if (config.wheel == kNoWheel) recording.wheel.clear();
  if (config.truth == kNoTruth) recording.truth.clear();
  return recording;
}

/// What `adit slam` writes is no recording, although it has clouds in it.
Result<> check_no_session(const std::string& input) {
  std::error_code ignored;
  if (!std::filesystem::exists(std::filesystem::path(input) / "session.toml", ignored)) return {};
  const std::string name = shell_quoted(input);
  return fail(format(
      "{}: is a session, not a recording; adit slam --session {} RECORDING goes on from it, adit localize "
      "{} RECORDING finds a robot in it, adit merge joins it with others, and adit info {} shows what it "
      "holds",
      input, name, name, name));
}

/// A topic that is asked for and that no folder of clouds can have is not to be passed over.
Result<> check_no_topics(const std::string& input, const RecordingConfig& config) {
  struct Asked {
    const std::string& topic;
    const char* option;
    std::string_view none;  ///< What asks for no topic; "" where nothing does.
    const char* instead;
  };
  const std::array asked = {
      Asked{config.points, "--points", "", "its clouds are the files in it"},
      Asked{config.wheel, "--wheel", kNoWheel, "its wheels are odometry.tum beside the clouds"},
      Asked{config.imu, "--imu", kNoImu, "it holds no IMU"},
      Asked{config.truth, "--truth", kNoTruth, "its ground truth is groundtruth.tum beside the clouds"},
      Asked{config.tf, "--tf", "", "its mount is in recording.toml, or given by --mount"},
      Asked{config.topics_under, "--set recording.topics_under", "", "it is of one robot"}};
  for (const Asked& one : asked)
    if (!one.topic.empty() && one.topic != one.none)
      return fail(format("{}: there is no topic '{}', as this is a folder of clouds: {}; leave {} out", input,
                         one.topic, one.instead, one.option));
  return {};
}

Result<Recording> open_part(const std::filesystem::path& folder, const std::string& part,
                            const FolderReading& reading) {
  const std::optional<ScanSelection> selection = parse_selection(part);
  if (!selection)
    return fail(
        format("{}@{}: a part is @even, @odd or @FIRST:STEP, not '@{}'", folder.string(), part, part));
  return read_scan_folder(folder, *selection, reading).map([&](Recording recording) {
    recording.name += "_" + part;
    std::ranges::replace(recording.name, ':', '_');
    return recording;
  });
}

Result<Recording> open_folder(const std::string& input, const RecordingConfig& config) {
  const Result<std::optional<Pose>> mount = mount_of(config);
  if (!mount) return tl::unexpected(mount.error());
  const Result<CloudReading> clouds = stated_reading(config);
  if (!clouds) return tl::unexpected(clouds.error());
  const FolderReading reading{*mount, *clouds};
  std::error_code ignored;
  const std::size_t at = input.rfind('@');
  const bool is_whole = std::filesystem::is_directory(input, ignored);
  if (const Result<> recording = check_no_session(input); !recording)
    return tl::unexpected(recording.error());
  const bool is_part =
      !is_whole && at != std::string::npos && std::filesystem::is_directory(input.substr(0, at), ignored);
  if (is_whole || is_part)
    if (const Result<> none = check_no_topics(input, config); !none) return tl::unexpected(none.error());
  if (is_whole) return read_scan_folder(input, {}, reading);
  if (is_part) return open_part(input.substr(0, at), input.substr(at + 1), reading);
  if (const Result<> plain = check_not_packed(input); !plain) return tl::unexpected(plain.error());
  if (const Result<> whole = check_not_metadata(input); !whole) return tl::unexpected(whole.error());
  if (std::filesystem::exists(input, ignored))
    return fail(input + ": is not a recording; a bag (.mcap, .db3, .bag or folder) or a folder of clouds is");
  return fail(input +
              ": no such file or folder; a recording is a bag (.mcap, .db3, .bag or folder) or a folder "
              "of clouds");
}

}  // namespace

Result<Recording> open_recording(const std::string& input, const RecordingConfig& config) {
  if (is_bag_file(input) || is_bag_folder(input)) return read_recording(input, config);
  if (Result<> checked = check_stamp_at(config); !checked) return tl::unexpected(checked.error());
  return open_folder(input, config).map([&](Recording recording) {
    recording = without_left_out(std::move(recording), config);
    return config.stamp_at == "end" ? with_stamps_at_end(std::move(recording)) : std::move(recording);
  });
}

}  // namespace adit
