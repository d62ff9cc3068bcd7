// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "recording_output.hpp"

#include <utility>

#include "adit/io/mcap.hpp"
#include "adit/io/scan_folder.hpp"
#include "adit/io/text.hpp"

namespace adit::app {

Result<> write_recording_to(const std::filesystem::path& path, Recording recording, Progress& progress,
                            CloudFormat clouds) {
  recording.read_scan = [read = std::move(recording.read_scan)](std::size_t i) -> Result<Scan> {
    if (interrupted()) return fail("interrupted; nothing was written");
    return read(i);
  };
  const auto count = [&](std::size_t) { progress.advance(); };
  const bool is_mcap = lower_case(path.extension().string()) == ".mcap";
  return is_mcap ? write_recording(path, recording, count)
                 : write_scan_folder(path, recording, clouds, count);
}

}  // namespace adit::app
