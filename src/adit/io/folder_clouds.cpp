// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/folder_clouds.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/kitti.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

Result<> read_offsets(const fs::path& path, const CloudFile& file, PointCloud& cloud) {
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  if (file.num_skipped_nan > 0 || bytes->size() != sizeof(std::int32_t) * cloud.size()) {
    return fail(format("{}: {} bytes for {} points ({} more not finite); 4 bytes per point are needed",
                       path.string(), bytes->size(), cloud.size(), file.num_skipped_nan));
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.time_offsets_ns.push_back(static_cast<std::int32_t>(
        load_scalar(ScalarType::int32, bytes->data() + 4 * i, std::endian::little)));
  }
  return {};
}

/// The first cloud that can be read; fails as the first of all does where none can, and as the first without
/// the field that is stated for times.
Result<CloudFile> first_readable(const std::vector<fs::path>& clouds, const CloudReading& known) {
  Result<CloudFile> first;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    Result<CloudFile> cloud = read_cloud_file(clouds[i], known);
    const bool lacks_field = !cloud && lacks_stated_field(known.times, [&](const KnownTimes& untimed) {
      return read_cloud_file(clouds[i], {untimed, known.bin_columns});
    });
    if (cloud || lacks_field) return cloud;
    if (i == 0) first = std::move(cloud);
  }
  return first;
}

/// What is to be said of columns that are not used.
void note_columns(Recording& recording, const CloudReading& known) {
  constexpr std::array kNumbers = {"five", "six", "seven", "eight"};
  constexpr std::size_t kUsed = 4;
  if (!known.bin_columns || *known.bin_columns <= kUsed) return;
  const std::size_t num_unused = *known.bin_columns - kUsed;
  recording.assumptions.push_back(
      format("clouds: .bin with {} columns, of which {} not used{}; times count in clouds of .pcd or .ply",
             kNumbers.at(num_unused - 1),
             num_unused == 1 ? "the fifth (a ring, or times) is" : "those behind the fourth are",
             known.are_columns_stated ? "" : " (--bin-columns states how many there are)"));
}

/// What is to be said of clouds without times, unless recording.toml has it already.
void note_no_times(Recording& recording, const CloudFile& first, bool is_kitti) {
  const auto is_known = [](const std::string& note) { return note.starts_with("point times: "); };
  if (std::ranges::any_of(recording.assumptions, is_known)) return;
  recording.assumptions.push_back(no_point_times_note(first.times) +
                                  (is_kitti ? "; clouds of KITTI are already corrected" : ""));
}

/// What is to be said of the times of points. `stated`: their unit.
void note_times_of_clouds(Recording& recording, const CloudFile& first, std::optional<TimeUnit> stated) {
  const PointTimes& times = first.times;
  if (!times.unit || !first.cloud.has_times()) return;
  const UnitSource source = stated ? UnitSource::stated : UnitSource::found;
  if (!times.has_usual_unit) recording.assumptions.push_back(point_times_note(*times.unit, source));
  if (source == UnitSource::found) return;
  if (auto warning = stated_unit_warning(*times.unit, first.cloud))
    recording.warnings.push_back(std::move(*warning));
}

}  // namespace

fs::path offsets_beside(const fs::path& cloud) { return fs::path(cloud).replace_extension(".offsets"); }

std::string offsets_text(const PointCloud& cloud) {
  std::string bytes;
  for (const std::int32_t offset : cloud.time_offsets_ns) append_little_endian(bytes, offset);
  return bytes;
}

Result<CloudReading> reading_of(const std::vector<fs::path>& clouds, const CloudReading& stated) {
  const bool are_bin = lower_case(clouds.front().extension().string()) == extension_of(CloudFormat::kitti);
  if (!are_bin) return CloudReading{stated.times};
  if (const Result<> checked = check_bin_reading(stated); !checked)
    return fail(clouds.front().filename().string(), checked.error());
  if (stated.bin_columns) return check_kitti_columns(clouds, *stated.bin_columns).map([&] { return stated; });
  return kitti_columns(clouds).map([&](std::size_t columns) { return CloudReading{stated.times, columns}; });
}

Result<CloudReading> read_as_first(CloudReading known, Recording& recording,
                                   const std::vector<fs::path>& clouds, bool is_kitti) {
  const Result<CloudFile> first = first_readable(clouds, known);
  if (!first) return tl::unexpected(first.error());
  note_columns(recording, known);
  note_times_of_clouds(recording, *first, known.times.unit);
  std::error_code ignored;
  if (!first->cloud.has_times() && !fs::exists(offsets_beside(clouds.front()), ignored))
    note_no_times(recording, *first, is_kitti && known.bin_columns);
  known.times = known_after(first->times, known.times);
  return known;
}

Result<PointCloud> read_points(const fs::path& path, const CloudReading& known) {
  Result<CloudFile> file = read_cloud_file(path, known);
  if (!file) return tl::unexpected(file.error());
  PointCloud cloud = std::move(file->cloud);
  // A column of zeros is what KITTI's format makes of clouds without intensities.
  if (std::ranges::all_of(cloud.intensities, [](float intensity) { return intensity == 0.0F; }))
    cloud.intensities.clear();
  std::error_code ignored;
  const fs::path offsets = offsets_beside(path);
  if (cloud.has_times() || !fs::exists(offsets, ignored)) return cloud;
  return read_offsets(offsets, *file, cloud).map([&] { return std::move(cloud); });
}

}  // namespace adit
