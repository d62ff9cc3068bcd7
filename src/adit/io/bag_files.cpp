// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/byte_source.hpp"
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

/// The command that unpacks files of that ending; "" where they are not compressed as a whole.
std::string_view unpacker_of(const fs::path& path) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kUnpackers = {{{".zstd", "zstd -d"},
                                                                                        {".zst", "zstd -d"},
                                                                                        {".gz", "gzip -d"},
                                                                                        {".bz2", "bzip2 -d"},
                                                                                        {".xz", "xz -d"},
                                                                                        {".lz4", "lz4 -d"},
                                                                                        {".zip", "unzip"}}};
  const std::string extension = extension_of(path);
  for (const auto& [ending, unpacker] : kUnpackers)
    if (extension == ending) return unpacker;
  return "";
}

bool is_packed(const fs::path& path) { return !unpacker_of(path).empty(); }

std::string unpack_remedy(const std::string& name, const fs::path& path) {
  return format("'{}' is compressed as a whole, which cannot be read in parts; unpack it: {} {}", name,
                unpacker_of(path), shell_quoted(path.string()));
}

/// What the first bytes of a file say.
struct FileKind {
  std::string_view magic;     ///< Those bytes.
  std::string_view name;      ///< For people.
  std::string_view ending;    ///< That such a file of a bag has; "" of what is compressed as a whole.
  std::string_view unpacker;  ///< Of the latter: what writes the file that is in it to stdout.
};

/// Fails where a file of a bag is of another kind than its ending says. Passes what cannot be read or told:
/// opening it says what is wrong.
Result<> check_kind(const fs::path& path) {
  using namespace std::string_view_literals;
  constexpr std::array kKinds = {FileKind{"\x89MCAP0\r\n"sv, "an MCAP file"sv, ".mcap"sv, ""sv},
                                 FileKind{"#ROSBAG V"sv, "a bag of ROS 1"sv, ".bag"sv, ""sv},
                                 FileKind{"SQLite format 3\0"sv, "an SQLite file"sv, ".db3"sv, ""sv},
                                 FileKind{"\x28\xB5\x2F\xFD"sv, "zstd"sv, ""sv, "zstd -dc"sv},
                                 FileKind{"\x1F\x8B"sv, "gzip"sv, ""sv, "gzip -dc"sv},
                                 FileKind{"BZh"sv, "bzip2"sv, ""sv, "bzip2 -dc"sv},
                                 FileKind{"\xFD\x37zXZ\0"sv, "xz"sv, ""sv, "xz -dc"sv},
                                 FileKind{"\x04\x22\x4D\x18"sv, "LZ4"sv, ""sv, "lz4 -dc"sv},
                                 FileKind{"PK\x03\x04"sv, "zip"sv, ""sv, "unzip -p"sv}};
  constexpr std::uint64_t kLongestMagic = 16;
  const Result<ByteSource> source = open_source(path);
  if (!source) return {};
  const Result<std::string> start = source->read(0, std::min(source->size, kLongestMagic));
  if (!start) return {};
  const auto kind = std::ranges::find_if(
      kKinds, [&](const FileKind& one) { return std::string_view(*start).starts_with(one.magic); });
  if (kind == kKinds.end() || kind->ending == extension_of(path)) return {};
  const std::string name = shell_quoted(path.string());
  if (kind->ending.empty())
    return fail(
        format("{}: its content is compressed by {} as a whole, which cannot be read in parts; unpack it: "
               "{} {} > UNPACKED{}",
               path.string(), kind->name, kind->unpacker, name, extension_of(path)));
  return fail(format("{}: its content is that of {}; give it the ending of one: mv {} {}", path.string(),
                     kind->name, name,
                     shell_quoted(fs::path(path).replace_extension(kind->ending).string())));
}

/// Fails on a file that is too short to be of any kind, as of a recorder that was ended before it wrote.
Result<> check_not_empty(const fs::path& path) {
  constexpr std::uint64_t kShortest = 8;  // bytes: the magic of MCAP, the shortest that there is
  const Result<ByteSource> source = open_source(path);
  if (!source || source->size >= kShortest) return {};
  return fail(format("{}: {}: nothing was recorded, or it was not copied to its end; copy it again",
                     path.string(),
                     source->size == 0 ? "is empty" : format("has only {} bytes", source->size)));
}

/// A name that no file can have is of none.
bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// Where the file that metadata.yaml names lies, if it is there. Bags of early versions name it with the
/// bag's own folder.
Result<fs::path> file_named(const fs::path& folder, const std::string& name) {
  fs::path path = folder / name;
  if (!is_there(path)) path = folder / fs::path(name).filename();
  if (is_packed(path) && is_there(fs::path(path).replace_extension())) return path.replace_extension();
  if (is_packed(path)) return fail(unpack_remedy(name, path));
  return path;
}

/// What a bag folder consists of.
struct FolderFiles {
  std::vector<fs::path> files;
  std::vector<Error> faults;  ///< One for each file that is not there.
  std::vector<std::string> warnings;
  bool are_by_name = false;  ///< Nothing says that they are of one recording.
};

FolderFiles files_by_name(const fs::path& folder) { return {files_in(folder, is_bag_file), {}, {}, true}; }

/// A recorder whose power was cut leaves an empty metadata.yaml, or one of zeros, beside files that are
/// whole.
bool says_nothing(const fs::path& metadata) {
  const Result<ByteSource> source = open_source(metadata);
  const Result<std::string> text = source ? source->read(0, source->size) : std::string("unreadable");
  if (text && text->find_first_not_of('\0') == std::string::npos) return true;  // zeros are an error in YAML
  return !YAML::LoadFile(metadata.string())[kInformation].IsDefined();
}

Result<FolderFiles> files_of_metadata(const fs::path& folder) {
  const fs::path file = folder / kMetadata;
  try {
    if (says_nothing(file)) {
      FolderFiles found = files_by_name(folder);
      found.are_by_name = false;
      found.warnings.push_back(
          format("{}: has no {}, as after an interrupted recording; the files of the folder are read by "
                 "their names, and 'ros2 bag reindex' writes it anew",
                 file.string(), kInformation));
      return found;
    }
    FolderFiles named;
    std::set<fs::path> known;  // one that is named twice is read once
    for (const YAML::Node& name : YAML::LoadFile(file.string())[kInformation]["relative_file_paths"]) {
      Result<fs::path> found = file_named(folder, name.as<std::string>());
      if (!found) return fail(file.string(), found.error());
      if (!known.insert(found->lexically_normal()).second) continue;
      if (is_there(*found))
        named.files.push_back(std::move(*found));
      else
        named.faults.push_back({format(
            "{}: names '{}', which is not there; copy it beside that file, or let 'ros2 bag reindex' write "
            "metadata.yaml anew",
            file.string(), name.Scalar())});
    }
    if (known.empty()) return fail(format("{}: names no files (relative_file_paths)", file.string()));
    return named;
  } catch (const YAML::Exception& error) {
    return fail(format("{}: line {}: {}", file.string(), error.mark.line + 1, error.msg));
  }
}

Result<Bag> open_file(const fs::path& path) {
  if (!is_bag_file(path))
    return fail(
        format("{}: not a file of a bag that adit knows; .mcap, .db3 and .bag are known", path.string()));
  if (const Result<> content = check_not_empty(path); !content) return tl::unexpected(content.error());
  if (const Result<> kind = check_kind(path); !kind) return tl::unexpected(kind.error());
  if (extension_of(path) == ".db3") return open_sqlite_bag(path);
  const Result<ByteSource> source = open_source(path);
  if (!source) return tl::unexpected(source.error());
  Result<Bag> bag = extension_of(path) == ".bag" ? open_ros1_bag(*source) : open_mcap_bag(*source);
  if (!bag) return fail(path.string(), bag.error());
  return bag;
}

/// Of several files each says which it is.
Bag naming(const fs::path& file, Bag bag) {
  const std::string name = file.filename().string();
  for (std::string& warning : bag.warnings)
    if (warning.find(name) == std::string::npos) warning.insert(0, name + ": ");
  bag.read = [name, read = std::move(bag.read)](const BagMessage& message) {
    Result<std::string> content = read(message);
    return content ? std::move(content) : fail(name, content.error());
  };
  return bag;
}

/// Files that lie together by chance would be mapped as one drive: those of a split recording follow one
/// another within moments.
std::optional<std::string> warning_of_strangers(const std::vector<fs::path>& files,
                                                const std::vector<Bag>& parts) {
  constexpr double kApart = 60.0;    // seconds between the end of one file and the start of the next
  constexpr double kTogether = 5.0;  // seconds that both cover; at a cut some messages come late
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (!parts[i].messages.empty()) order.push_back(i);
  std::ranges::sort(order, {}, [&](std::size_t i) { return parts[i].messages.front().log_time; });
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Stamp end = parts[order[k - 1]].messages.back().log_time;
    const Stamp start = parts[order[k]].messages.front().log_time;
    const double gap = to_seconds(start - end);
    if (gap < kApart && gap > -kTogether) continue;
    const std::string a = files[order[k - 1]].string();
    const std::string b = files[order[k]].string();
    return format(
        "{} and {} are read as one recording, as they lie in one folder without a metadata.yaml; {} {}. "
        "Where "
        "they are drives or robots of their own, give each file with a name: adit slam a={} b={} --out "
        "SESSION",
        a, b, gap > 0 ? "between them are" : "both cover the same",
        gap < 7200.0 ? format("{:.0f} s", std::abs(gap)) : format("{:.1f} h", gap / 3600.0), shell_quoted(a),
        shell_quoted(b));
  }
  return std::nullopt;
}

/// A file that cannot be read or found, as one that was opened when power was cut, costs what it holds alone.
Result<Bag> open_files(FolderFiles folder) {
  const std::size_t num_files = folder.files.size() + folder.faults.size();
  std::vector<Bag> parts;
  std::vector<fs::path> names;  // of the parts
  for (const fs::path& file : folder.files) {
    Result<Bag> part = open_file(file);
    if (!part) {
      folder.faults.push_back(part.error());
      continue;
    }
    parts.push_back(num_files > 1 ? naming(file, std::move(*part)) : std::move(*part));
    names.push_back(file);
  }
  if (parts.empty()) return tl::unexpected(folder.faults.front());
  if (folder.are_by_name)
    if (auto warning = warning_of_strangers(names, parts)) folder.warnings.push_back(std::move(*warning));
  Bag all = joined(std::move(parts));
  std::ranges::move(folder.warnings, std::back_inserter(all.warnings));
  for (const Error& fault : folder.faults)
    all.warnings.push_back(format("{}; this one of {} files is left out", fault.message, num_files));
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

Result<> check_not_packed(const fs::path& path) {
  std::error_code ignored;
  if (!is_packed(path) || !fs::exists(path, ignored)) return {};
  return fail(unpack_remedy(path.string(), path));
}

bool is_bag_folder(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return false;
  const bool has_files = !files_in(folder, is_bag_file).empty();
  if (fs::exists(folder / kMetadata, ignored)) {
    try {
      if (!says_nothing(folder / kMetadata)) return true;
    } catch (const YAML::Exception&) {
      return has_files;  // opening it says what is wrong
    }
  }
  return has_files && files_in(folder, is_cloud_file).empty();
}

Result<> check_not_metadata(const fs::path& path) {
  std::error_code ignored;
  if (path.filename() != kMetadata || !fs::is_regular_file(path, ignored)) return {};
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!is_bag_folder(folder)) return {};
  return fail(format("{}: belongs to a bag and is no recording by itself; give the folder of the bag: {}",
                     path.string(), shell_quoted(folder.string())));
}

Result<Bag> open_bag(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return open_file(path).map(expanding);
  const Result<FolderFiles> found =
      fs::exists(path / kMetadata, ignored) ? files_of_metadata(path) : files_by_name(path);
  if (!found) return tl::unexpected(found.error());
  if (found->files.empty() && found->faults.empty())
    return fail(format("{}: no files of a bag in this folder (.mcap, .db3, .bag)", path.string()));
  return open_files(*found).map(expanding);
}

}  // namespace adit
