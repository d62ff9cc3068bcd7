// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/scan_folder.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/folder_clouds.hpp"
#include "adit/io/folder_mount.hpp"
#include "adit/io/kitti.hpp"
#include "adit/io/mount.hpp"
#include "adit/io/recording_toml.hpp"
#include "adit/io/text.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

struct ScanFile {
  std::size_t number = 0;
  fs::path path;
  std::optional<Stamp> stamp = {};  ///< Where the name ends in one.
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "scan_0017.pcd" -> 17.
std::optional<std::size_t> last_number(const std::string& stem) {
  const auto end = std::find_if(stem.rbegin(), stem.rend(), is_digit);
  const auto begin = std::find_if_not(end, stem.rend(), is_digit);
  return parse_size(std::string(begin.base(), end.base()));
}

/// The stamp that a name ends in, as in "1271124904.505012000.pcd" of programs that take clouds out of bags.
/// To be one, it has nine digits before the point or nine behind it; "run2.0017.pcd" ends in the number 17.
std::optional<Stamp> stamp_in(const std::string& stem) {
  const std::size_t point = stem.rfind('.');
  if (point == std::string::npos) return std::nullopt;
  const auto end = stem.rend() - static_cast<std::ptrdiff_t>(point);
  const std::string seconds(std::find_if_not(end, stem.rend(), is_digit).base(), end.base());
  const std::string fraction = stem.substr(point + 1);
  const bool are_digits = !seconds.empty() && std::ranges::all_of(fraction, is_digit);
  if (!are_digits || (seconds.size() < 9 && fraction.size() != 9)) return std::nullopt;
  return parse_stamp(seconds + "." + fraction);
}

/// "; give one of what it holds: a, b, c", of folders where there are some.
std::string what_else_is_in(const fs::path& folder) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> folders;
  std::vector<std::string> files;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    (entry.is_directory(ignored) ? folders : files).push_back(entry.path().string());
  std::vector<std::string>& names = folders.empty() ? files : folders;
  if (names.empty()) return "; it is empty";
  std::ranges::sort(names);
  const bool are_more = names.size() > kMost;
  if (are_more) names.resize(kMost);
  return format("; give one of what it holds: {}{}", fmt::join(names, ", "), are_more ? ", ..." : "");
}

Result<std::vector<ScanFile>> list_scans(const fs::path& folder) {
  std::vector<ScanFile> scans;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string extension = lower_case(entry.path().extension().string());
    if (extension != ".pcd" && extension != ".ply" && extension != ".bin") continue;
    const std::optional<std::size_t> number = last_number(entry.path().stem().string());
    if (!number) {
      return fail(
          format("{0}: the name {1} has no number to order it by, as the scans of a recording have; a "
                 "cloud or mesh alone is given by its name: {2}",
                 folder.string(), entry.path().filename().string(), entry.path().string()));
    }
    scans.push_back({*number, entry.path(), stamp_in(entry.path().stem().string())});
  }
  if (error) return fail(format("{}: cannot be listed: {}", folder.string(), error.message()));
  if (scans.empty())
    return fail(format("{}: neither clouds (.pcd, .ply, .bin) nor bags (.mcap, .db3, .bag) in it{}",
                       folder.string(), what_else_is_in(folder)));
  if (std::ranges::all_of(scans, [](const ScanFile& scan) { return scan.stamp.has_value(); }))
    for (ScanFile& scan : scans) scan.number = static_cast<std::size_t>(scan.stamp->ns);
  else
    for (ScanFile& scan : scans) scan.stamp.reset();
  std::ranges::sort(scans, {}, [](const ScanFile& scan) { return std::pair(scan.number, scan.path); });
  return scans;
}

Result<> check_scans(const fs::path& folder, const std::vector<ScanFile>& scans) {
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const std::string pair =
        scans[i - 1].path.filename().string() + " and " + scans[i].path.filename().string();
    if (scans[i].path.extension() != scans[i - 1].path.extension()) {
      return fail(format("{}: clouds of several kinds ({}); keep the scans of one robot per folder",
                         folder.string(), pair));
    }
    if (scans[i].number == scans[i - 1].number) {
      return fail(format("{}: {} have the same number; keep the scans of one robot per folder",
                         folder.string(), pair));
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
    if (!stamp) return fail(format("{}: '{}' is not a stamp in seconds", place, lines.line()));
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
    if (scan.stamp) {
      stamps.push_back(*scan.stamp);
      continue;
    }
    if (scan.number > kLargest) {
      return fail(format("{}: the number in {} is too large for a stamp in seconds; add a stamps.txt",
                         folder.string(), scan.path.filename().string()));
    }
    stamps.push_back({static_cast<std::int64_t>(scan.number) * 1'000'000'000});
  }
  return stamps;
}

/// The sequence of a folder "velodyne", where KITTI keeps what belongs to it; else the folder itself.
fs::path sequence_of(const fs::path& folder) {
  const fs::path full = fs::weakly_canonical(folder);
  return full.filename().string().starts_with("velodyne") ? full.parent_path() : folder;
}

/// Of a sequence of KITTI the folder of its clouds; else the folder itself.
fs::path clouds_of(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder / "velodyne", ignored) || list_scans(folder)) return folder;
  return folder / "velodyne";
}

bool is_kitti(const fs::path& sequence) {
  std::error_code ignored;
  return fs::exists(sequence / "times.txt", ignored);
}

/// A file beside the clouds, or in their sequence.
fs::path beside_clouds(const fs::path& folder, const char* name) {
  std::error_code ignored;
  const fs::path beside = folder / name;
  return fs::exists(beside, ignored) ? beside : sequence_of(folder) / name;
}

/// stamps.txt, or the times.txt of KITTI, which lies beside the folder of its scans.
std::optional<fs::path> stamp_file(const fs::path& folder) {
  for (const char* name : {"stamps.txt", "times.txt"}) {
    std::error_code ignored;
    if (const fs::path file = beside_clouds(folder, name); fs::exists(file, ignored)) return file;
  }
  return std::nullopt;
}

Result<std::vector<Stamp>> read_stamps_for(const fs::path& file, std::size_t num_scans) {
  return read_stamps(file).and_then([&](std::vector<Stamp> stamps) -> Result<std::vector<Stamp>> {
    if (stamps.size() == num_scans) return stamps;
    return fail(
        format("{}: {} stamps for {} scans; it needs one per scan", file.string(), stamps.size(), num_scans));
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
  if (recording.wheel.front().stamp <= last && first <= recording.wheel.back().stamp) return {};
  return fail(
      format("{}: odometry.tum goes from {} to {} and covers none of the scans from {} to {}; are its "
             "stamps of the same clock?",
             folder.string(), stamp_text(recording.wheel.front().stamp),
             stamp_text(recording.wheel.back().stamp), stamp_text(first), stamp_text(last)));
}

/// Stamps, wheels and ground truth.
Result<Recording> read_tracks(const fs::path& folder, const std::vector<ScanFile>& scans,
                              ScanSelection selection) {
  Recording recording;
  const std::optional<fs::path> file = stamp_file(folder);
  if (!file) {
    recording.assumptions.push_back(format(
        "stamps: the {} in each name counts as seconds, as neither stamps.txt nor times.txt is there{}",
        scans.front().stamp ? "decimal number" : "number",
        scans.front().stamp ? ""
                            : "; where scans came at another rate, put a stamps.txt beside them, with the "
                              "time of each scan in seconds, one a line"));
  }
  const auto stamps = file ? read_stamps_for(*file, scans.size()) : stamps_from_numbers(folder, scans);
  if (!stamps) return tl::unexpected(stamps.error());
  Result<Trajectory> wheel = read_optional(beside_clouds(folder, "odometry.tum"));
  if (!wheel) return tl::unexpected(wheel.error());
  Result<Trajectory> truth = read_optional(beside_clouds(folder, "groundtruth.tum"));
  if (!truth) return tl::unexpected(truth.error());
  recording.scan_stamps = select(*stamps, selection);
  recording.wheel = std::move(*wheel);
  recording.truth = std::move(*truth);
  return check_recording(folder, recording).map([&] { return std::move(recording); });
}

/// KITTI's poses of a sequence: poses.txt in it, or poses/07.txt beside the folder of the sequences.
std::optional<fs::path> kitti_poses_of(const fs::path& sequence) {
  const fs::path full = fs::weakly_canonical(sequence);
  const fs::path of_set = full.parent_path().parent_path() / "poses" / (full.filename().string() + ".txt");
  for (const fs::path& file : {full / "poses.txt", of_set}) {
    std::error_code ignored;
    if (fs::exists(file, ignored)) return file;
  }
  return std::nullopt;
}

/// T_world_lidar of each scan of the folder, from KITTI's poses, which are the camera's.
Result<std::vector<Pose>> kitti_truth(const fs::path& file, const fs::path& sequence, std::size_t num_scans) {
  Result<std::vector<Pose>> poses = read_bytes(file).and_then(read_kitti_poses);
  if (!poses) return fail(file.string(), poses.error());
  if (poses->size() != num_scans)
    return fail(format("{}: {} poses for {} scans", file.string(), poses->size(), num_scans));
  const fs::path calibration = sequence / "calib.txt";
  const Result<std::string> text = read_bytes(calibration);  // its errors name the file
  if (!text) return tl::unexpected(text.error());
  const Result<Pose> T_camera_lidar = read_kitti_calibration(*text);
  if (!T_camera_lidar) return fail(calibration.string(), T_camera_lidar.error());
  for (Pose& pose : *poses) pose = pose * *T_camera_lidar;
  return poses;
}

/// Ground truth of a sequence of KITTI, where nothing else is there.
void take_kitti_truth(Recording& recording, const fs::path& sequence, std::size_t num_scans,
                      ScanSelection selection) {
  if (!recording.truth.empty() || !is_kitti(sequence)) return;
  const std::optional<fs::path> file = kitti_poses_of(sequence);
  if (!file) return;
  const Result<std::vector<Pose>> T_world_lidar = kitti_truth(*file, sequence, num_scans);
  if (!T_world_lidar) {
    recording.assumptions.push_back("ground truth: it is left out; " + T_world_lidar.error().message);
    return;
  }
  const Pose T_lidar_base = recording.T_base_lidar.inverse();
  const std::vector<Pose> selected = select(*T_world_lidar, selection);
  for (std::size_t i = 0; i < selected.size(); ++i)
    recording.truth.push_back({recording.scan_stamps[i], selected[i] * T_lidar_base});
}

/// Reads scan i in the LiDAR's frame. Clouds that are in it already keep every bit.
std::function<Result<Scan>(std::size_t)> scan_reader(std::vector<fs::path> files, std::vector<Stamp> stamps,
                                                     const Pose& T_lidar_cloud, const CloudReading& known) {
  const bool is_moved = T_lidar_cloud.log().norm() > 0.0;
  return [=, files = std::move(files), stamps = std::move(stamps)](std::size_t i) {
    ADIT_CHECK(i < files.size(), "no scan of that index");
    return read_points(files[i], known).map([&](PointCloud cloud) {
      return Scan{stamps[i], is_moved ? transformed(T_lidar_cloud, std::move(cloud)) : std::move(cloud)};
    });
  };
}

// Writing.

/// Formats of clouds have none without points: false where the scan has none.
Result<bool> write_scan(const fs::path& folder, const Recording& recording, CloudFormat format_of_clouds,
                        std::size_t i) {
  const Result<Scan> scan = recording.read_scan(i);
  if (!scan) return fail(format("scan {}", i), scan.error());
  if (scan->cloud.empty()) return false;
  const fs::path path = folder / format("{:06}{}", i, extension_of(format_of_clouds));
  Result<> written = write_cloud(path, scan->cloud, recording.T_base_lidar);
  if (written && format_of_clouds == CloudFormat::kitti && scan->cloud.has_times())
    written = write_bytes(offsets_beside(path), offsets_text(scan->cloud));
  return written.map([] { return true; });
}

/// All but the clouds, of which those of `scan_stamps` were written.
Result<> write_tracks(const fs::path& folder, const Recording& recording,
                      const std::vector<Stamp>& scan_stamps) {
  std::string stamps;
  for (const Stamp stamp : scan_stamps) stamps += stamp_text(stamp) + '\n';
  Result<> written = write_bytes(folder / "stamps.txt", stamps);
  if (written && !recording.wheel.empty()) written = write_tum(folder / "odometry.tum", recording.wheel);
  if (written && !recording.truth.empty()) written = write_tum(folder / "groundtruth.tum", recording.truth);
  if (!written) return written;
  return write_recording_toml(folder / "recording.toml",
                              {recording.name, recording.lidar, mount_text(recording.T_base_lidar),
                               CloudFrame::lidar, format("{}", fmt::join(recording.assumptions, "\n"))});
}

}  // namespace

Result<Recording> read_scan_folder(const fs::path& given, ScanSelection selection,
                                   const FolderReading& reading) {
  const fs::path folder = clouds_of(given);
  if (selection.step == 0) return fail(folder.string() + ": every 0-th scan; the step is 1 or more");
  const Result<std::vector<ScanFile>> scans = list_scans(folder);
  if (!scans) return tl::unexpected(scans.error());
  if (Result<> checked = check_scans(folder, *scans); !checked) return tl::unexpected(checked.error());
  Result<Recording> recording = read_tracks(folder, *scans, selection);
  if (!recording) return recording;
  const Result<RecordingToml> file = read_recording_toml(beside_clouds(folder, "recording.toml"));
  if (!file) return tl::unexpected(file.error());
  std::vector<fs::path> clouds;
  for (const ScanFile& scan : select(*scans, selection)) clouds.push_back(scan.path);
  const Result<CloudReading> known = reading_of(clouds, reading.clouds);
  if (!known) return fail(folder.string(), known.error());
  const Wheels wheels = recording->wheel.empty() ? Wheels::absent : Wheels::present;
  const Result<FolderMount> mount = mount_of_folder(clouds, *file, reading.T_base_lidar, wheels, *known);
  if (!mount) return fail(folder.string(), mount.error());
  recording->name = file->robot.empty() ? name_of(given) : file->robot;
  recording->lidar = file->lidar;
  std::ranges::copy(lines_of(file->assumed), std::back_inserter(recording->assumptions));
  if (!mount->assumption.empty()) recording->assumptions.push_back(mount->assumption);
  if (reading.T_base_lidar) set_mount(*recording, mount->T_base_lidar);
  recording->T_base_lidar = mount->T_base_lidar;
  recording->mount_source = mount->source;
  recording->clouds_in_mount_frame = mount->T_lidar_cloud.log().isZero();
  take_kitti_truth(*recording, sequence_of(folder), scans->size(), selection);
  const Result<CloudReading> as_first =
      read_as_first(*known, *recording, clouds, is_kitti(sequence_of(folder)));
  if (!as_first) return tl::unexpected(as_first.error());
  recording->read_scan =
      scan_reader(std::move(clouds), recording->scan_stamps, mount->T_lidar_cloud, *as_first);
  return recording;
}

Result<std::size_t> write_scan_folder(const fs::path& folder, const Recording& recording,
                                      CloudFormat clouds) {
  if (recording.num_scans() == 0)
    return fail(folder.string() + ": the recording has no scans; nothing is written");
  Result<OutputDir> output = OutputDir::create(folder, "scans");
  if (!output) return tl::unexpected(output.error());
  const Phase phase("writing scans", recording.num_scans());
  std::vector<Stamp> kept;
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    const Result<bool> written = write_scan(output->path(), recording, clouds, i);
    if (!written) return tl::unexpected(written.error());
    if (*written) kept.push_back(recording.scan_stamps[i]);
    phase.advance();
  }
  if (kept.empty()) return fail(folder.string() + ": no scan has a point; nothing is written");
  return write_tracks(output->path(), recording, kept).and_then([&] { return output->commit(); }).map([&] {
    return recording.num_scans() - kept.size();
  });
}

}  // namespace adit
