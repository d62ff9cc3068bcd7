// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/ros1_bag.hpp"
#include "adit/io/sqlite_bag.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadata = "metadata.yaml";
constexpr const char* kInformation = "rosbag2_bagfile_information";

std::string extension_of(const fs::path& path) { return lower_case(path.extension().string()); }

bool is_cloud_file(const fs::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".pcd" || extension == ".ply" || extension == ".bin";
}

std::vector<fs::path> files_in(const fs::path& folder, bool (*wanted)(const fs::path&)) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (entry.is_regular_file(ignored) && wanted(entry.path())) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

/// Where the file that metadata.yaml names lies. Bags of early versions name it with the bag's own folder.
Result<fs::path> file_named(const fs::path& folder, const std::string& name) {
  fs::path path = folder / name;
  if (!fs::exists(path)) path = folder / fs::path(name).filename();
  const bool is_packed = extension_of(path) == ".zstd" || extension_of(path) == ".zst";
  if (is_packed && fs::exists(fs::path(path).replace_extension())) return path.replace_extension();
  if (is_packed)
    return fail(format("'{}' is compressed as a whole, which cannot be read in parts; unpack it: zstd -d {}",
                       name, path.string()));
  if (!fs::exists(path)) return fail(format("names '{}', which is not there", name));
  return path;
}

Result<std::vector<fs::path>> files_of_metadata(const fs::path& folder) {
  const fs::path file = folder / kMetadata;
  try {
    std::vector<fs::path> files;
    for (const YAML::Node& name : YAML::LoadFile(file.string())[kInformation]["relative_file_paths"]) {
      Result<fs::path> found = file_named(folder, name.as<std::string>());
      if (!found) return fail(file.string(), found.error());
      files.push_back(std::move(*found));
    }
    if (files.empty()) return fail(format("{}: names no files (relative_file_paths)", file.string()));
    return files;
  } catch (const YAML::Exception& error) {
    return fail(format("{}: line {}: {}", file.string(), error.mark.line + 1, error.msg));
  }
}

Result<Bag> open_file(const fs::path& path) {
  if (extension_of(path) == ".db3") return open_sqlite_bag(path);
  if (!is_bag_file(path))
    return fail(
        format("{}: not a file of a bag that adit knows; .mcap, .db3 and .bag are known", path.string()));
  const Result<ByteSource> source = open_source(path);
  if (!source) return tl::unexpected(source.error());
  Result<Bag> bag = extension_of(path) == ".bag" ? open_ros1_bag(*source) : open_mcap_bag(*source);
  if (!bag) return fail(path.string(), bag.error());
  return bag;
}

/// A file that cannot be read, as one that was opened when power was cut, costs what it holds alone.
Result<Bag> open_files(const std::vector<fs::path>& files) {
  std::vector<Bag> parts;
  std::vector<Error> faults;
  for (const fs::path& file : files) {
    Result<Bag> part = open_file(file);
    if (part)
      parts.push_back(std::move(*part));
    else
      faults.push_back(part.error());
  }
  if (parts.empty()) return tl::unexpected(faults.front());
  Bag all = joined(std::move(parts));
  for (const Error& fault : faults)
    all.warnings.push_back(format("{}; this one of {} files is left out", fault.message, files.size()));
  return all;
}

/// No message in CDR begins as a zstd frame does.
Bag expanding(Bag bag) {
  bag.read = [read = std::move(bag.read)](const BagMessage& message) {
    return read(message).and_then([](std::string&& content) -> Result<std::string> {
      if (is_zstd(content)) return decompress_zstd_frame(content);
      return std::move(content);
    });
  };
  return bag;
}

}  // namespace

bool is_bag_file(const fs::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".mcap" || extension == ".db3" || extension == ".bag";
}

bool is_bag_folder(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return false;
  if (fs::exists(folder / kMetadata, ignored)) {
    try {
      return YAML::LoadFile((folder / kMetadata).string())[kInformation].IsDefined();
    } catch (const YAML::Exception&) {
      return !files_in(folder, is_bag_file).empty();  // opening it says what is wrong
    }
  }
  return !files_in(folder, is_bag_file).empty() && files_in(folder, is_cloud_file).empty();
}

Result<Bag> open_bag(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return open_file(path).map(expanding);
  if (!fs::exists(path / kMetadata, ignored)) return open_files(files_in(path, is_bag_file)).map(expanding);
  return files_of_metadata(path).and_then(open_files).map(expanding);
}

}  // namespace adit
