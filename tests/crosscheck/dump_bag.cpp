// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Prints what adit reads of a bag, one message a line: topic, time in nanoseconds, bytes, CRC-32 of its
// content. tools/crosscheck.sh compares it with what the readers of others say.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/crc32.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: adit_dump_bag BAG\n", stderr);
    return 2;
  }
  const adit::Result<adit::Bag> bag = adit::open_bag(argv[1]);
  if (!bag) {
    std::fprintf(stderr, "%s\n", bag.error().message.c_str());
    return 1;
  }
  std::vector<std::string> lines;
  for (const adit::BagMessage& message : bag->messages) {
    const adit::Result<std::string> content = bag->read(message);
    if (!content) {
      std::fprintf(stderr, "%s\n", content.error().message.c_str());
      return 1;
    }
    lines.push_back(adit::format("{} {} {} {:08x}", bag->topics[message.topic].name, message.log_time.ns,
                                 content->size(), adit::crc32(*content)));
  }
  std::ranges::sort(lines);
  for (const std::string& line : lines) std::puts(line.c_str());
  return 0;
}
