// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/scan_folder.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/text.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

struct ScanFile {
  std::size_t number = 0;
  fs::path path;
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "scan_0017.pcd" -> 17.
std::optional<std::size_t> last_number(const std::string& stem) {
  const auto end = std::find_if(stem.rbegin(), stem.rend(), is_digit);
  const auto begin = std::find_if_not(end, stem.rend(), is_digit);
  return parse_size(std::string(begin.base(), end.base()));
}

Result<std::vector<ScanFile>> list_scans(const fs::path& folder) {
  std::vector<ScanFile> scans;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string extension = lower_case(entry.path().extension().string());
    if (extension != ".pcd" && extension != ".ply" && extension != ".bin") continue;
    const std::optional<std::size_t> number = last_number(entry.path().stem().string());
    if (!number) {
      return fail(format("{}: the name {} holds no number to order it by", folder.string(),
                         entry.path().filename().string()));
    }
    scans.push_back({*number, entry.path()});
  }
  if (error) return fail(format("{}: cannot be listed: {}", folder.string(), error.message()));
  if (scans.empty()) return fail(folder.string() + ": no clouds in it (.pcd, .ply, .bin)");
  std::ranges::sort(scans, {}, [](const ScanFile& scan) { return std::pair(scan.number, scan.path); });
  return scans;
}

Result<> check_scans(const fs::path& folder, const std::vector<ScanFile>& scans) {
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const std::string pair =
        scans[i - 1].path.filename().string() + " and " + scans[i].path.filename().string();
    if (scans[i].path.extension() != scans[i - 1].path.extension()) {
      return fail(format("{}: clouds of several kinds ({}); keep one robot's scans in a folder",
                         folder.string(), pair));
    }
    if (scans[i].number == scans[i - 1].number) {
      return fail(
          format("{}: {} have one number; keep one robot's scans in a folder", folder.string(), pair));
    }
  }
  return {};
}

Result<std::vector<Stamp>> read_stamps(const fs::path& path) {
  const Result<std::string> text = read_bytes(path);
  if (!text) return tl::unexpected(text.error());
  std::vector<Stamp> stamps;
  LineReader lines(*text);
  while (lines.next()) {
    const std::vector<std::string_view> words = split_words(lines.line());
    if (words.empty() || words[0].starts_with('#')) continue;
    const std::optional<Stamp> stamp = words.size() == 1 ? parse_stamp(words[0]) : std::nullopt;
    const std::string place = format("{}: line {}", path.string(), lines.number());
    if (!stamp) return fail(format("{}: '{}' is no stamp in seconds", place, lines.line()));
    if (!stamps.empty() && *stamp <= stamps.back()) {
      return fail(
          format("{}: stamp {} is not after the one before, {}", place, words[0], stamp_text(stamps.back())));
    }
    stamps.push_back(*stamp);
  }
  return stamps;
}

Result<std::vector<Stamp>> stamps_from_numbers(const fs::path& folder, const std::vector<ScanFile>& scans) {
  constexpr std::size_t kLargest = std::numeric_limits<std::int64_t>::max() / 1'000'000'000;
  std::vector<Stamp> stamps;
  for (const ScanFile& scan : scans) {
    if (scan.number > kLargest) {
      return fail(format("{}: the number in {} is too large for a stamp in seconds; add a stamps.txt",
                         folder.string(), scan.path.filename().string()));
    }
    stamps.push_back({static_cast<std::int64_t>(scan.number) * 1'000'000'000});
  }
  return stamps;
}

Result<std::vector<Stamp>> stamps_of(const fs::path& folder, const std::vector<ScanFile>& scans) {
  std::error_code ignored;
  if (!fs::exists(folder / "stamps.txt", ignored)) return stamps_from_numbers(folder, scans);
  return read_stamps(folder / "stamps.txt")
      .and_then([&](std::vector<Stamp> stamps) -> Result<std::vector<Stamp>> {
        if (stamps.size() == scans.size()) return stamps;
        return fail(format("{}: stamps.txt has {} stamps for {} scans", folder.string(), stamps.size(),
                           scans.size()));
      });
}

Result<Trajectory> read_optional(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) ? read_tum(path) : Trajectory{};
}

template <class T>
std::vector<T> select(const std::vector<T>& all, ScanSelection selection) {
  std::vector<T> selected;
  for (std::size_t i = selection.first; i < all.size(); i += selection.step) selected.push_back(all[i]);
  return selected;
}

/// The folder's own name, also of "." and "scans/".
std::string name_of(const fs::path& folder) {
  std::error_code ignored;
  const fs::path full = fs::weakly_canonical(folder, ignored);
  return full.filename().empty() ? folder.string() : full.filename().string();
}

Result<> check_recording(const fs::path& folder, const Recording& recording) {
  if (recording.num_scans() < 2) {
    return fail(format("{}: {} scan(s) taken; a recording needs two or more", folder.string(),
                       recording.num_scans()));
  }
  if (recording.wheel.empty()) return {};
  const Stamp first = recording.scan_stamps.front();
  const Stamp last = recording.scan_stamps.back();
  if (recording.wheel.front().stamp <= first && last <= recording.wheel.back().stamp) return {};
  return fail(format("{}: odometry.tum goes from {} to {} and does not cover the scans from {} to {}",
                     folder.string(), stamp_text(recording.wheel.front().stamp),
                     stamp_text(recording.wheel.back().stamp), stamp_text(first), stamp_text(last)));
}

/// Everything but the clouds.
Result<Recording> read_frame(const fs::path& folder, const std::vector<ScanFile>& scans,
                             ScanSelection selection) {
  const Result<std::vector<Stamp>> stamps = stamps_of(folder, scans);
  if (!stamps) return tl::unexpected(stamps.error());
  Result<Trajectory> wheel = read_optional(folder / "odometry.tum");
  if (!wheel) return tl::unexpected(wheel.error());
  Result<Trajectory> truth = read_optional(folder / "groundtruth.tum");
  if (!truth) return tl::unexpected(truth.error());
  Recording recording;
  recording.name = name_of(folder);
  recording.scan_stamps = select(*stamps, selection);
  recording.wheel = std::move(*wheel);
  recording.truth = std::move(*truth);
  return check_recording(folder, recording).map([&] { return std::move(recording); });
}

Result<> write_scans(const fs::path& folder, const Recording& recording,
                     const std::function<void(std::size_t)>& progress) {
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    const Result<Scan> scan = recording.read_scan(i);
    if (!scan) return fail(format("scan {}", i), scan.error());
    const PointCloud cloud = transformed(recording.T_base_lidar, scan->cloud);
    if (Result<> written = write_cloud(folder / format("{:06}.pcd", i), cloud); !written) return written;
    if (progress) progress(i + 1);
  }
  return {};
}

Result<> write_frame(const fs::path& folder, const Recording& recording) {
  std::string stamps;
  for (const Stamp stamp : recording.scan_stamps) stamps += stamp_text(stamp) + '\n';
  Result<> written = write_bytes(folder / "stamps.txt", stamps);
  if (written && !recording.wheel.empty()) written = write_tum(folder / "odometry.tum", recording.wheel);
  if (written && !recording.truth.empty()) written = write_tum(folder / "groundtruth.tum", recording.truth);
  return written;
}

}  // namespace

Result<Recording> read_scan_folder(const fs::path& folder, ScanSelection selection) {
  if (selection.step == 0) return fail(folder.string() + ": every 0-th scan; the step is 1 or more");
  const Result<std::vector<ScanFile>> scans = list_scans(folder);
  if (!scans) return tl::unexpected(scans.error());
  if (Result<> checked = check_scans(folder, *scans); !checked) return tl::unexpected(checked.error());
  return read_frame(folder, *scans, selection).map([&](Recording recording) {
    recording.read_scan = [files = select(*scans, selection), stamps = recording.scan_stamps](std::size_t i) {
      ADIT_CHECK(i < files.size(), "no scan of that index");
      return read_cloud(files[i].path).map([&](PointCloud cloud) {
        return Scan{stamps[i], std::move(cloud)};
      });
    };
    return recording;
  });
}

Result<> write_scan_folder(const fs::path& folder, const Recording& recording,
                           const std::function<void(std::size_t)>& progress) {
  if (recording.num_scans() == 0)
    return fail(folder.string() + ": the recording has no scans; nothing is written");
  Result<OutputDir> output = OutputDir::create(folder, "scans");
  if (!output) return tl::unexpected(output.error());
  return write_scans(output->path(), recording, progress)
      .and_then([&] { return write_frame(output->path(), recording); })
      .and_then([&] { return output->commit(); });
}

}  // namespace adit
