// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/atomic_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <string>
#include <vector>

#include "support/files.hpp"

namespace {

/// What this program asked of the disk, in order; and whether the disk is to refuse.
struct Disk {
  std::vector<std::string> log;
  bool is_broken = false;
  bool cannot_exchange = false;
};
Disk disk;

std::string name_of(const std::string& path) { return std::filesystem::path(path).filename().string(); }

}  // namespace

// Take the place of the C library's in this program, and pass on to the system.
extern "C" int fsync(int descriptor) {
  std::array<char, 4096> path{};
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  if (readlink(link.c_str(), path.data(), path.size() - 1) > 0)
    disk.log.push_back("sync " + name_of(path.data()));
  if (disk.is_broken) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(syscall(SYS_fsync, descriptor));
}

extern "C" int rename(const char* from, const char* to) {
  disk.log.push_back("rename to " + name_of(to));
  return static_cast<int>(syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to));
}

extern "C" int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  disk.log.push_back("exchange " + name_of(to));
  if (disk.cannot_exchange) {
    errno = EINVAL;
    return -1;
  }
  return static_cast<int>(syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}

namespace adit {
namespace {

using test::get_file;
using test::num_entries;
using test::put_file;
using Log = std::vector<std::string>;

class OnDisk : public ::testing::Test {
 protected:
  void SetUp() override { disk = {}; }
  void TearDown() override { disk = {}; }

  [[nodiscard]] static std::string partial(const std::string& name) {
    return name + ".partial-" + std::to_string(getpid());
  }
  [[nodiscard]] std::string folder_name() const { return folder_.path().filename().string(); }
  [[nodiscard]] std::filesystem::path at(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::filesystem::path folder() const { return folder_.path(); }
  /// A file of the user's.
  void put(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories(at(name).parent_path());
    put_file(at(name), bytes);
  }
  /// A folder with one file.
  [[nodiscard]] Result<> write(const std::string& kind, const std::string& bytes,
                               const std::string& name = "out", const std::string& file = "data") const {
    return OutputDir::create(at(name), kind).and_then([&](OutputDir output) {
      std::filesystem::create_directories((output.path() / file).parent_path());
      return write_bytes(output.path() / file, bytes).and_then([&] { return output.commit(); });
    });
  }

 private:
  test::TemporaryFolder folder_;
};
using AtomicFileTest = OnDisk;
using OutputDirTest = OnDisk;

TEST_F(AtomicFileTest, ReplacesOnlyAtTheEnd) {
  put_file(at("a"), "old");
  {
    Result<AtomicFile> file = AtomicFile::create(at("a"));
    ASSERT_TRUE(file);
    file->stream() << "half";
  }
  EXPECT_EQ(get_file(at("a")), "old");
  EXPECT_EQ(num_entries(folder()), 1U);
  ASSERT_TRUE(write_bytes(at("a"), "new"));
  EXPECT_EQ(get_file(at("a")), "new");
  EXPECT_EQ(num_entries(folder()), 1U);
}

TEST_F(AtomicFileTest, RefusesFoldersAndNamesWhatIsMissing) {
  EXPECT_ERROR(write_bytes(at("absent/a"), ""), "does not exist");
  EXPECT_ERROR(write_bytes(folder(), ""), "is a folder");
}

TEST_F(AtomicFileTest, BytesReachTheDiskBeforeTheNameDoes) {
  ASSERT_TRUE(write_bytes(at("a"), "new"));
  EXPECT_EQ(disk.log, (Log{"sync " + partial("a"), "rename to a", "sync " + folder_name()}));
}

TEST_F(AtomicFileTest, ADiskThatFailsLeavesTheOldFile) {
  put_file(at("a"), "old");
  disk.is_broken = true;
  EXPECT_ERROR(write_bytes(at("a"), "new"), "does not reach the disk");
  EXPECT_EQ(get_file(at("a")), "old");
  EXPECT_EQ(num_entries(folder()), 1U);
}

TEST_F(OutputDirTest, ReplacesItsOwnKindOnly) {
  ASSERT_TRUE(write("session", "1"));
  ASSERT_TRUE(write("session", "2"));
  EXPECT_EQ(get_file(at("out/data")), "2");
  EXPECT_ERROR(write("study", "3"), "is left alone");
  EXPECT_EQ(get_file(at("out/data")), "2");
  EXPECT_EQ(num_entries(folder()), 1U);
}

TEST_F(OutputDirTest, LeavesTheUsersFilesAlone) {
  std::filesystem::create_directories(at("mine"));
  ASSERT_TRUE(OutputDir::create(at("mine")));  // empty: free to take, but untouched without commit
  EXPECT_TRUE(std::filesystem::exists(at("mine")));
  put_file(at("mine/thesis.tex"), "years of work");
  EXPECT_ERROR(OutputDir::create(at("mine")), "is left alone");
  put_file(at("file"), "");
  EXPECT_ERROR(OutputDir::create(at("file")), "is a file");
  EXPECT_ERROR(OutputDir::create(at("absent/out")), "does not exist");
  put_file(at("mine/session.toml"), "");  // a session of a version that did not mark its folders
  EXPECT_TRUE(OutputDir::create(at("mine") / ""));
}

TEST_F(OutputDirTest, KeepsWhatTheUserPutIntoIt) {
  ASSERT_TRUE(write("session", "1"));
  put_file(at("out/points.csv"), "surveyed");
  put_file(at("out/georeference.toml"), "of the old maps");
  for (const bool cannot_exchange : {false, true}) {
    disk.cannot_exchange = cannot_exchange;
    ASSERT_TRUE(write("session", "2"));
    EXPECT_EQ(get_file(at("out/data")), "2");
    EXPECT_EQ(get_file(at("out/points.csv")), "surveyed");
  }
  EXPECT_FALSE(std::filesystem::exists(at("out/georeference.toml")));
  EXPECT_EQ(num_entries(folder()), 1U);
}

TEST_F(OutputDirTest, AFileOfAnOrdinaryNameMakesNoOutput) {
  put("out/metrics.json", "of the user's own experiment");
  EXPECT_ERROR(write("study", "1"), "is left alone");
  // Nor is a session a study, although it has a metrics.json, too.
  ASSERT_TRUE(write("session", "1", "s"));
  put("s/metrics.json", "of the session");
  EXPECT_ERROR(write("study", "2", "s"), "is left alone");
  EXPECT_EQ(get_file(at("s/data")), "1");
}

TEST_F(OutputDirTest, KeepsWhatTheUserPutIntoItsFolders) {
  for (const bool cannot_exchange : {false, true}) {
    disk.cannot_exchange = cannot_exchange;
    ASSERT_TRUE(write("session", "1", "out", "robot/map"));
    put("out/robot/notes.txt", "of the drive");
    put("out/c/metadata.yaml", "of a recording");
    std::filesystem::create_directories(at("out/later"));
    ASSERT_TRUE(write("session", "2", "out", "c/map"));  // a robot called like the folder of its recording
    EXPECT_EQ(get_file(at("out/c/map")), "2");
    EXPECT_EQ(get_file(at("out/c/metadata.yaml")), "of a recording");
    EXPECT_EQ(get_file(at("out/robot/notes.txt")), "of the drive");
    EXPECT_TRUE(std::filesystem::is_directory(at("out/later")));
    EXPECT_FALSE(std::filesystem::exists(at("out/robot/map")));
    EXPECT_EQ(num_entries(folder()), 1U);
    std::filesystem::remove_all(at("out"));
  }
}

TEST_F(OutputDirTest, WhatHasTheNameOfSomethingNewIsLeftBesideAndSaid) {
  ASSERT_TRUE(write("session", "1"));
  put("out/c", "a recording");
  EXPECT_ERROR(write("session", "2", "out", "c/map"), "out.old now, the first: c;");
  EXPECT_EQ(get_file(at("out/c/map")), "2");
  EXPECT_EQ(get_file(at("out.old/c")), "a recording");
  put("out/d/map", "drawn by hand");
  EXPECT_ERROR(write("session", "3", "out", "d/map"), "out.old-2 now, the first: d/map;");
  EXPECT_EQ(get_file(at("out.old/c")), "a recording");
  EXPECT_EQ(get_file(at("out.old-2/d/map")), "drawn by hand");
}

TEST_F(OutputDirTest, WhatEarlierVersionsDidNotListIsLeftBeside) {
  put("none/session.toml", "");
  put("none/c.mcap", "a recording");
  ASSERT_TRUE(write("session", "2", "none"));
  EXPECT_EQ(get_file(at("none.old/c.mcap")), "a recording");
  put("names/.adit-session", ".adit-session\nrobot\n");
  put("names/points.csv", "surveyed");
  put("names/robot/notes.txt", "of the drive");
  ASSERT_TRUE(write("session", "2", "names"));
  EXPECT_EQ(get_file(at("names/points.csv")), "surveyed");
  EXPECT_EQ(get_file(at("names.old/robot/notes.txt")), "of the drive");
}

TEST_F(OutputDirTest, RemovesWhatWasNotCommitted) {
  put_file(at("neighbour"), "");
  {
    const Result<OutputDir> output = OutputDir::create(at("out"));
    ASSERT_TRUE(output);
    put_file(output->path() / "half", "");
    EXPECT_EQ(num_entries(folder()), 2U);
  }
  EXPECT_EQ(num_entries(folder()), 1U);
}

TEST_F(OutputDirTest, AllOfItReachesTheDiskBeforeTheNameDoes) {
  Result<OutputDir> output = OutputDir::create(at("out"));
  ASSERT_TRUE(output);
  std::filesystem::create_directory(output->path() / "robot");
  ASSERT_TRUE(write_bytes(output->path() / "robot" / "map", "points"));
  disk.log.clear();
  ASSERT_TRUE(output->commit());
  const auto renamed = std::ranges::find(disk.log, "rename to out");
  ASSERT_NE(renamed, disk.log.end());
  for (const std::string& name : {std::string("map"), std::string("robot"), partial("out")}) {
    EXPECT_LT(std::ranges::find(disk.log, "sync " + name), renamed) << name;
  }
  EXPECT_EQ(disk.log.back(), "sync " + folder_name());
}

TEST_F(OutputDirTest, ChangesPlacesWithTheOldFolderInOneStep) {
  ASSERT_TRUE(write("session", "old"));
  disk.log.clear();
  ASSERT_TRUE(write("session", "new"));
  EXPECT_EQ(std::ranges::count(disk.log, "exchange out"), 1);
  EXPECT_EQ(std::ranges::count(disk.log, "rename to out"), 0);
  EXPECT_EQ(get_file(at("out/data")), "new");
  disk.cannot_exchange = true;  // as on some network file systems
  ASSERT_TRUE(write("session", "newer"));
  EXPECT_EQ(get_file(at("out/data")), "newer");
  EXPECT_EQ(num_entries(folder()), 1U);
}

TEST_F(OutputDirTest, ADiskThatFailsLeavesTheOldFolder) {
  ASSERT_TRUE(write("session", "old"));
  disk.is_broken = true;
  EXPECT_ERROR(write("session", "new"), "does not reach the disk");
  EXPECT_EQ(get_file(at("out/data")), "old");
  EXPECT_EQ(num_entries(folder()), 1U);
}

}  // namespace
}  // namespace adit
