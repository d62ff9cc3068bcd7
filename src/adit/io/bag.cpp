// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/bag.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/io/mcap_reader.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

std::optional<std::map<std::string, std::string>> own_metadata(const mcap::Contents& contents) {
  for (const mcap::Metadata& metadata : contents.metadata)
    if (metadata.name == "adit") return metadata.entries;
  return std::nullopt;
}

Bag bag_of(const std::shared_ptr<const mcap::Reader>& reader) {
  const mcap::Contents& contents = reader->contents();
  Bag bag;
  bag.storage = "mcap";
  bag.profile = contents.header.profile;
  bag.num_chunks = contents.chunks.size();
  bag.own = own_metadata(contents);
  if (!contents.torn.empty())
    bag.warnings.push_back(format(
        "{}; {} messages in front of the cut are read{}", contents.torn, contents.messages.size(),
        contents.cut_chunk ? ", those of the chunk that is cut not verified, as its checksum is of all of it"
                           : ""));
  if (!contents.summary_fault.empty())
    bag.warnings.push_back(index_warning(contents.summary_fault, contents.messages.size(), "mcap recover"));
  TopicIndex topics;
  std::map<std::uint16_t, std::size_t> topic_of_channel;
  for (const auto& [id, channel] : contents.channels) {
    const auto schema = contents.schemas.find(channel.schema_id);
    const std::string type = schema == contents.schemas.end() ? "" : schema->second.name;
    topic_of_channel[id] = topics.of({channel.topic, type, channel.message_encoding}, bag.topics);
  }
  for (std::size_t i = 0; i < contents.messages.size(); ++i) {
    const mcap::MessageRef& message = contents.messages[i];
    bag.messages.push_back({topic_of_channel.at(message.channel_id), usable_log_time(message.log_time), i});
  }
  bag.read = [reader](const BagMessage& message) {
    return reader->read(reader->contents().messages.at(message.where)).map([](mcap::Message&& found) {
      return std::move(found.data);
    });
  };
  return bag;
}

}  // namespace

std::size_t TopicIndex::of(const BagTopic& topic, std::vector<BagTopic>& topics) {
  const auto [known, is_new] = known_.emplace(std::pair(topic.name, topic.type), topics.size());
  if (is_new) topics.push_back(topic);
  return known->second;
}

std::string index_warning(std::string_view fault, std::size_t num_messages, std::string_view tool) {
  return format(
      "its index cannot be used ({}); the file was gone through instead, and its {} messages are read; '{}' "
      "writes a new index",
      fault, num_messages, tool);
}

Stamp usable_log_time(Stamp time) { return {std::clamp(time.ns, -kLargestStamp.ns, kLargestStamp.ns)}; }

Result<Bag> open_mcap_bag(ByteSource source) {
  const std::uint64_t num_bytes = source.size;
  return mcap::Reader::open(std::move(source)).map([&](mcap::Reader reader) {
    Bag bag = bag_of(std::make_shared<const mcap::Reader>(std::move(reader)));
    bag.num_bytes = num_bytes;
    return bag;
  });
}

Bag beginning_of(Bag bag, double seconds) {
  if (bag.messages.empty()) return bag;
  constexpr std::size_t kOfEach = 3;  // a sensor may begin late
  const Stamp first = bag.messages.front().log_time;
  std::vector<std::size_t> num_before(bag.topics.size());
  std::erase_if(bag.messages, [&](const BagMessage& message) {
    const bool is_early = to_seconds(message.log_time - first) <= seconds;
    const bool is_first = num_before[message.topic]++ < kOfEach;
    return !is_early && !is_first && !bag.topics[message.topic].name.ends_with("_static");
  });
  return bag;
}

Bag joined(std::vector<Bag> parts) {
  ADIT_CHECK(!parts.empty(), "a bag has at least one file");
  if (parts.size() == 1) return std::move(parts.front());
  struct Place {
    std::size_t part = 0;
    BagMessage message;  ///< As the part has it.
  };
  Bag all;
  all.storage = parts.front().storage;
  all.num_files = parts.size();
  all.profile = parts.front().profile;
  TopicIndex topics;
  auto places = std::make_shared<std::vector<Place>>();
  auto readers = std::make_shared<std::vector<std::function<Result<std::string>(const BagMessage&)>>>();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    Bag& part = parts[p];
    all.num_bytes += part.num_bytes;
    all.num_chunks += part.num_chunks;
    if (!all.own) all.own = std::move(part.own);
    std::ranges::move(part.warnings, std::back_inserter(all.warnings));
    readers->push_back(std::move(part.read));
    std::vector<std::size_t> topic_of;
    for (const BagTopic& topic : part.topics) topic_of.push_back(topics.of(topic, all.topics));
    for (const BagMessage& message : part.messages) {
      all.messages.push_back({topic_of[message.topic], message.log_time, places->size()});
      places->push_back({p, message});
    }
  }
  std::ranges::stable_sort(all.messages, {}, &BagMessage::log_time);
  all.read = [places, readers](const BagMessage& message) {
    const Place& place = places->at(message.where);
    return readers->at(place.part)(place.message);
  };
  return all;
}

}  // namespace adit
