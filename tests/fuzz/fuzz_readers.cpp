// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Gives bytes to the readers of one kind of file: tools/fuzz.sh. ADIT_FUZZ_AS is the extension ("mcap"),
// which says which; texts whose names end in .csv or .toml like others' have extensions of their own here.
// Readers take any bytes without a fault of memory, without undefined behaviour and without a contract
// violation, and take no more memory than the bytes warrant; what they make of them is for other tests.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/io/compression.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/io/crc32.hpp"
#include "adit/io/file_info.hpp"
#include "adit/io/georeference.hpp"
#include "adit/io/loops_csv.hpp"
#include "adit/io/ply.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/robot_map_file.hpp"
#include "adit/io/session_toml.hpp"
#include "adit/io/trajectory_files.hpp"
#include "adit/transport/wire.hpp"

namespace {

namespace fs = std::filesystem;

const std::string& extension() {
  static const std::string name = [] {
    const char* value = std::getenv("ADIT_FUZZ_AS");
    if (value == nullptr) {
      std::fputs("ADIT_FUZZ_AS has to name the extension of the files\n", stderr);
      std::exit(2);
    }
    return std::string(value);
  }();
  return name;
}

/// A folder of this process's own, gone at its end.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "adit-fuzz-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] fs::path file() const { return path_ / ("input." + extension()); }

 private:
  fs::path path_;
};

void read_as_recording(const fs::path& path, const adit::RecordingConfig& config) {
  constexpr std::size_t kScans = 4;
  const adit::Result<adit::Recording> recording = adit::open_recording(path.string(), config);
  if (!recording) return;
  for (std::size_t i = 0; i < std::min(kScans, recording->num_scans()); ++i)
    static_cast<void>(recording->read_scan(i));
}

void put(const fs::path& path, std::string_view bytes) { std::ofstream(path, std::ios::binary) << bytes; }

/// Readers of what lies beside other files, in a folder of its own.
const std::map<std::string, void (*)(const fs::path& folder, std::string_view text)> kBeside = {
    // Of a split bag, one file of which is there and damaged.
    {"metadata",
     [](const fs::path& folder, std::string_view text) {
       put(folder / "metadata.yaml", text);
       put(folder / "a_0.mcap", "no bag");
       static_cast<void>(adit::file_info(folder.string(), {}));
       static_cast<void>(adit::open_recording(folder.string(), {}));
     }},
    {"georeference",
     [](const fs::path& folder, std::string_view text) {
       put(folder / "georeference.toml", text);
       static_cast<void>(adit::read_georeferences(folder));
     }},
    // Of two clouds: the parts of the text, which a line of "==" ends, in this order; an empty one is no
    // file.
    {"beside",
     [](const fs::path& folder, std::string_view text) {
       for (const char* name : {"000000.bin", "000001.bin"}) put(folder / name, std::string(16, 0));
       for (const char* name : {"stamps.txt", "times.txt", "poses.txt", "calib.txt", "odometry.tum",
                                "groundtruth.tum", "recording.toml"}) {
         const std::size_t end = std::min(text.find("==\n"), text.size());
         fs::remove(folder / name);
         if (end > 0) put(folder / name, text.substr(0, end));
         text.remove_prefix(std::min(end + 3, text.size()));
       }
       read_as_recording(folder, {});
     }},
};

/// Readers that take a text.
const std::map<std::string, void (*)(std::string_view)> kTexts = {
    {"loops", [](std::string_view text) { static_cast<void>(adit::parse_loops_csv(text)); }},
    {"control", [](std::string_view text) { static_cast<void>(adit::parse_control_points(text)); }},
    {"config",
     [](std::string_view text) {
       adit::RecordingConfig config;
       static_cast<void>(adit::parse_config(fields_of(config), text));
     }},
    // A message between robots, of which fleet.adit holds some, without the checksum at its end.
    {"wire",
     [](std::string_view text) {
       const auto content = std::as_bytes(std::span(text));
       std::vector<std::byte> bytes(content.begin(), content.end());
       const std::uint64_t sum = adit::checksum(bytes);
       const auto end = std::as_bytes(std::span(&sum, 1));
       bytes.insert(bytes.end(), end.begin(), end.end());
       static_cast<void>(adit::decode(bytes));
     }},
    {"session",
     [](std::string_view text) {
       static_cast<void>(adit::parse_session_toml(text));
       static_cast<void>(adit::parse_session_merges(text));
     }},
};

// A map.adit: one line, the number of bytes and the checksum of the content, the content compressed.
const std::size_t kMapLine = adit::robot_map_bytes({}).find('\n') + 1;
constexpr std::size_t kSize = sizeof(std::uint64_t);
constexpr std::size_t kSum = sizeof(std::uint32_t);

std::optional<std::string> content_of_map(std::string_view file) {
  if (file.size() < kMapLine + kSize + kSum) return {};
  std::uint64_t size = 0;
  std::memcpy(&size, file.data() + kMapLine, kSize);
  adit::Result<std::string> content = adit::decompress(file.substr(kMapLine + kSize + kSum), "zstd", size);
  return content ? std::optional(std::move(*content)) : std::nullopt;
}

std::string map_of(std::string_view line, std::string_view content) {
  const std::uint64_t size = content.size();
  const std::uint32_t sum = adit::crc32(content);
  std::string file(line);
  file.append(reinterpret_cast<const char*>(&size), kSize);
  file.append(reinterpret_cast<const char*>(&sum), kSum);
  return file + adit::compress_zstd(content);
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t size, std::size_t max_size);

// Of maps the content is changed, mostly: its checksum would refuse it before anything is read.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  const std::string file(reinterpret_cast<const char*>(bytes), size);
  std::optional<std::string> content;
  if (extension() == "adit" && seed % 8 != 0) content = content_of_map(file);
  if (!content) return LLVMFuzzerMutate(bytes, size, max_size);
  const std::size_t before = content->size();
  content->resize(before + 64);
  content->resize(
      LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(content->data()), before, content->size()));
  const std::string changed = map_of(std::string_view(file).substr(0, kMapLine), *content);
  if (changed.size() > max_size) return LLVMFuzzerMutate(bytes, size, max_size);
  std::memcpy(bytes, changed.data(), changed.size());
  return changed.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const Folder folder;
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  if (const auto reader = kTexts.find(extension()); reader != kTexts.end()) {
    reader->second(text);
    return 0;
  }
  if (const auto reader = kBeside.find(extension()); reader != kBeside.end()) {
    reader->second(folder.path(), text);
    return 0;
  }
  const fs::path path = folder.file();
  put(path, text);
  static_cast<void>(adit::file_info(path.string(), {}));
  if (extension() == "mcap" || extension() == "bag" || extension() == "db3") {
    read_as_recording(path, {});
    read_as_recording(path, {.mount = "0,0,1", .wheel = "/twist"});
    const adit::JointDriveConfig drive{
        .left = "left_wheel", .right = "right_wheel", .wheel_radius = 0.1, .track_width = 0.5};
    read_as_recording(path, {.wheel = "/joint_states", .drive = drive});
  }
  if (extension() == "ply") static_cast<void>(adit::read_ply_mesh(text));
  if (extension() == "csv" || extension() == "tum") static_cast<void>(adit::read_trajectory(path));
  return 0;
}
