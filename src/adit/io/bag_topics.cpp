// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/bag_topics.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

/// Whether "gt", "truth" or "groundtruth" is a whole word of the topic: "/robot_0/ground_truth" is ground
/// truth,
/// "/length/odom" is not.
bool is_truth(const std::string& topic) {
  std::string words = lower_case(topic);
  std::ranges::replace_if(
      words, [](unsigned char c) { return std::isalnum(c) == 0; }, ' ');
  return std::ranges::any_of(split_words(words), [](std::string_view word) {
    return word == "gt" || word == "truth" || word == "groundtruth";
  });
}

bool is_under(const std::string& topic, const std::string& name) {
  return name.empty() || topic.starts_with(name + "/");
}

/// Whether that is the last part of the topic's name.
bool is_called(const std::string& topic, std::string_view part) {
  return std::string_view(topic).substr(topic.rfind('/') + 1) == part;  // npos + 1 = 0: the whole name
}

/// Those of the robot.
BagTopics find_topics(const Bag& bag, const std::string& under) {
  BagTopics topics;
  for (std::size_t i = 0; i < bag.topics.size(); ++i) {
    const auto& [name, type, encoding] = bag.topics[i];
    if (encoding != "cdr" && encoding != "ros1") continue;
    const bool is_static = name.ends_with("tf_static");
    if (type == ros::kTransforms && (is_static || is_called(name, "tf"))) {
      const bool is_shared = name == "/tf" || name == "/tf_static";
      if (is_shared || is_under(name, under))
        (is_static ? topics.static_transforms : topics.transforms).push_back(i);
    }
    if (!is_under(name, under)) continue;
    if (type == ros::kJointState) topics.joints.push_back(i);
    if (ros::is_cloud(type)) topics.points.push_back(i);
    if (type == ros::kTwist) topics.twists.push_back(i);
    if (type == ros::kImu) topics.imu.push_back(i);
    if (type == ros::kOdometry) (is_truth(name) ? topics.truth : topics.wheel).push_back(i);
  }
  return topics;
}

std::size_t num_messages(const Bag& bag, std::size_t topic) {
  return static_cast<std::size_t>(std::ranges::count(bag.messages, topic, &BagMessage::topic));
}

/// Below `topics_under`, names without a slash at the front count from there.
std::string whole_name(const std::string& topic, const std::string& under) {
  const bool is_relative = !topic.empty() && !under.empty() && !topic.starts_with('/');
  return is_relative ? under + "/" + topic : topic;
}

/// How people choose one of several topics.
struct TopicChoice {
  std::string_view type;       ///< "clouds"
  std::string_view option;     ///< "--points"
  std::string topic;           ///< "": the only one.
  std::string under;           ///< RecordingConfig::topics_under.
  TopicIndices further = {};   ///< That may be asked for, too.
  std::string otherwise = {};  ///< What else may be meant, to be said after the choices.
};

/// How likely a topic is the one that is meant: by its name, then by its messages.
std::pair<int, std::size_t> likelihood(const Bag& bag, std::size_t topic) {
  constexpr std::array kOfTheRobot = {"lidar",  "velodyne", "ouster", "livox", "hesai",   "rslidar",
                                      "points", "wheel",    "base",   "robot", "odometry"};
  constexpr std::array kDerived = {"camera", "depth",    "filtered", "map",
                                   "ground", "obstacle", "visual",   "icp"};
  const std::string name = lower_case(bag.topics[topic].name);
  const auto in_name = [&](const char* word) { return name.find(word) != std::string::npos; };
  const int words = static_cast<int>(std::ranges::any_of(kOfTheRobot, in_name)) -
                    2 * static_cast<int>(std::ranges::any_of(kDerived, in_name));
  return {words, num_messages(bag, topic)};
}

TopicIndices likeliest_first(const Bag& bag, TopicIndices topics) {
  std::ranges::stable_sort(topics, std::ranges::greater(),
                           [&](std::size_t topic) { return likelihood(bag, topic); });
  return topics;
}

/// As options take it, below `under`.
std::string name_to_type(const Bag& bag, std::size_t topic, const std::string& under) {
  return bag.topics[topic].name.substr(under.empty() ? 0 : under.size() + 1);
}

/// "--points /lidar/points (120 messages) or --points /camera/points (40 messages)", the likeliest first.
std::string choices(const Bag& bag, const TopicIndices& topics, const TopicChoice& choice) {
  std::vector<std::string> texts;
  for (const std::size_t topic : likeliest_first(bag, topics))
    texts.push_back(format("{} {} ({} messages)", choice.option, name_to_type(bag, topic, choice.under),
                           num_messages(bag, topic)));
  return format("{}", fmt::join(texts, " or "));
}

tl::unexpected<Error> no_such_topic(const Bag& bag, std::string_view type, const std::string& name,
                                    const TopicIndices& known) {
  return fail(format("no topic of {} '{}'; there {}", type, name,
                     known.empty() ? "is none" : "are: " + names_of(bag, known)));
}

/// Leaves the topic asked for, where there is one asked for.
Result<> keep_named(const Bag& bag, TopicIndices& topics, const TopicChoice& choice) {
  if (choice.topic.empty()) return {};
  TopicIndices known = topics;
  std::ranges::copy(choice.further, std::back_inserter(known));
  std::erase_if(topics, [&](std::size_t topic) {
    return bag.topics[topic].name != whole_name(choice.topic, choice.under);
  });
  if (!topics.empty()) return {};
  return no_such_topic(bag, choice.type, choice.topic, known);
}

/// What there is to choose from; empty where there is one topic or none.
std::string several(const Bag& bag, const TopicIndices& topics, const TopicChoice& choice) {
  if (topics.size() < 2) return {};
  return format("several topics of {}; give one of them, the likeliest first: {}{}", choice.type,
                choices(bag, topics, choice), choice.otherwise);
}

/// What people call ground truth is no wheel odometry, whatever its name says.
void take_truth(const Bag& bag, BagTopics& topics, const RecordingConfig& config) {
  if (config.truth == kNoTruth) return topics.truth.clear();
  const std::string chosen = whole_name(config.truth, config.topics_under);
  const auto is_chosen = [&](std::size_t topic) { return bag.topics[topic].name == chosen; };
  std::ranges::copy_if(topics.wheel, std::back_inserter(topics.truth), is_chosen);
  std::erase_if(topics.wheel, is_chosen);
}

/// Twists may be measured or commands, and joints those of an arm, so that they count as wheels only where
/// people say so.
void take_wheels(const Bag& bag, BagTopics& topics, const RecordingConfig& config) {
  const std::string chosen = whole_name(config.wheel, config.topics_under);
  const auto is_chosen = [&](std::size_t topic) { return bag.topics[topic].name == chosen; };
  for (TopicIndices* others : {&topics.twists, &topics.joints}) {
    std::ranges::copy_if(*others, std::back_inserter(topics.wheel), is_chosen);
    std::erase_if(*others, is_chosen);
  }
}

/// The topics of links that `config.tf` names; with a /tf goes the /tf_static beside it.
Result<> take_transforms(const Bag& bag, BagTopics& topics, const RecordingConfig& config) {
  if (config.tf.empty()) return {};
  TopicIndices known;
  for (std::size_t i = 0; i < bag.topics.size(); ++i)
    if (bag.topics[i].type == ros::kTransforms) known.push_back(i);
  topics.transforms.clear();
  topics.static_transforms.clear();
  std::string blanks = config.tf;
  std::ranges::replace(blanks, ',', ' ');
  for (const std::string_view word : split_words(blanks)) {
    const std::string name = whole_name(std::string(word), config.topics_under);
    const auto is_named = [&](std::size_t topic) { return bag.topics[topic].name == name; };
    if (std::ranges::none_of(known, is_named))
      return no_such_topic(bag, "links between frames (TFMessage)", name, known);
    for (const std::size_t topic : known) {
      const std::string& other = bag.topics[topic].name;
      if (other.ends_with("_static") && (is_named(topic) || other == name + "_static"))
        topics.static_transforms.push_back(topic);
      else if (is_named(topic))
        topics.transforms.push_back(topic);
    }
  }
  return {};
}

/// Where several topics of clouds may be of several robots: how to take them. Where a robot itself has
/// several, --points has to say which, or the remedy would fail in turn.
std::string for_fleets(const Bag& bag, const RecordingConfig& config) {
  const std::vector<std::string> robots = namespaces_of(bag);
  if (!config.topics_under.empty() || robots.size() < 2) return "";
  const RecordingConfig likeliest = with_likeliest_topics(bag, config);
  const auto has_several = [&](const std::string& robot) {
    return find_topics(bag, robot).points.size() > 1;
  };
  const std::string robot = likeliest.topics_under.empty() ? robots.front() : likeliest.topics_under;
  std::string points;
  if (std::ranges::any_of(robots, has_several)) {
    const TopicIndices own = likeliest_first(bag, find_topics(bag, robot).points);
    points = " --points " + name_to_type(bag, own.front(), robot);
  }
  return format(
      "; if each namespace is another robot, adit slam --namespaces{0} takes them all, and --set "
      "recording.topics_under={1}{0} that one",
      points, robot);
}

/// The kinds of which at most one topic is taken, with their choices.
std::vector<std::pair<TopicIndices BagTopics::*, TopicChoice>> choices_in(const Bag& bag,
                                                                          const BagTopics& topics,
                                                                          const RecordingConfig& config) {
  const std::string& under = config.topics_under;
  std::vector<std::pair<TopicIndices BagTopics::*, TopicChoice>> all;
  all.push_back(
      {&BagTopics::points, {"clouds", "--points", config.points, under, {}, for_fleets(bag, config)}});
  all.push_back({&BagTopics::imu, {"IMUs", "--imu", config.imu == kNoImu ? "" : config.imu, under}});
  if (config.wheel != kNoWheel) {
    TopicIndices further = topics.twists;
    std::ranges::copy(topics.joints, std::back_inserter(further));
    all.push_back({&BagTopics::wheel, {"wheel odometry", "--wheel", config.wheel, under, further}});
  }
  all.push_back(
      {&BagTopics::truth, {"ground truth", "--truth", config.truth == kNoTruth ? "" : config.truth, under}});
  return all;
}

/// What may be chosen among.
Result<BagTopics> candidates(const Bag& bag, const RecordingConfig& config) {
  BagTopics topics = find_topics(bag, config.topics_under);
  if (config.imu == kNoImu) topics.imu.clear();
  take_truth(bag, topics, config);
  take_wheels(bag, topics, config);
  return take_transforms(bag, topics, config).map([&] { return std::move(topics); });
}

/// "/husky1/" is "/husky1".
RecordingConfig without_last_slash(RecordingConfig config) {
  while (config.topics_under.ends_with('/')) config.topics_under.pop_back();
  return config;
}

/// What makes clouds of a topic that has none; empty where nothing does.
std::string remedy_of(const std::string& name, const std::string& full_type) {
  const std::string type = lower_case(full_type.substr(full_type.rfind('/') + 1));
  const auto has = [&](const char* word) { return type.find(word) != std::string::npos; };
  if (has("compressedpointcloud"))
    return format(
        "{0} is compressed ({1}): record what 'ros2 run point_cloud_transport republish' makes of it, "
        "with in_transport as its name ends ({2}) and out_transport raw",
        name, full_type, name.substr(name.rfind('/') + 1));
  if (has("packet") || has("udpframe") || has("velodynescan") || has("pandarscan") || has("rslidarscan"))
    return format("{} has raw packets ({}): play it through the driver of the sensor and record its points",
                  name, full_type);
  return "";
}

/// What may have been meant by scans in a bag without clouds: clouds that can be made, else scans of a plane.
std::string instead_of_clouds(const Bag& bag, const std::string& under) {
  std::string of_one_plane;
  for (const auto& [name, type, encoding] : bag.topics) {
    if (!is_under(name, under)) continue;
    if (std::string remedy = remedy_of(name, type); !remedy.empty()) return remedy;
    if (of_one_plane.empty() && type.ends_with("/LaserScan"))
      of_one_plane = format(
          "{} is of a scanner of one plane ({}), of which adit maps nothing; it takes clouds of a 3-D LiDAR",
          name, type);
  }
  return of_one_plane.empty() ? "there are no scans to read" : of_one_plane;
}

}  // namespace

std::string names_of(const Bag& bag, const TopicIndices& topics) {
  std::vector<std::string> names;
  for (const std::size_t topic : topics) names.push_back(bag.topics[topic].name);
  return format("{}", fmt::join(names, ", "));
}

Result<BagTopics> choose_topics(const Bag& bag, const RecordingConfig& given) {
  const RecordingConfig config = without_last_slash(given);
  if (find_topics(bag, config.topics_under).points.empty())
    return fail(format("no topic of sensor_msgs/msg/PointCloud2 or of Livox's CustomMsg{}; {}",
                       config.topics_under.empty() ? "" : " under " + config.topics_under,
                       instead_of_clouds(bag, config.topics_under)));
  Result<BagTopics> topics = candidates(bag, config);
  if (!topics) return topics;
  std::vector<std::string> open;
  for (const auto& [kind, choice] : choices_in(bag, *topics, config)) {
    if (Result<> kept = keep_named(bag, *topics.*kind, choice); !kept) return tl::unexpected(kept.error());
    if (std::string choose = several(bag, *topics.*kind, choice); !choose.empty())
      open.push_back(std::move(choose));
  }
  if (open.empty()) return topics;
  return fail(format("{}; adit info prints the whole command", fmt::join(open, "; ")));
}

Result<> check_named_topics(const Bag& bag, const RecordingConfig& given) {
  const RecordingConfig config = without_last_slash(given);
  Result<BagTopics> topics = candidates(bag, config);
  if (!topics) return tl::unexpected(topics.error());
  for (const auto& [kind, choice] : choices_in(bag, *topics, config))
    if (Result<> there = keep_named(bag, *topics.*kind, choice); !there) return there;
  return {};
}

RecordingConfig with_likeliest_topics(const Bag& bag, RecordingConfig config) {
  config = without_last_slash(std::move(config));
  BagTopics topics = find_topics(bag, config.topics_under);
  if (config.topics_under.empty() && config.points.empty() && topics.points.size() > 1) {
    const std::string likeliest = bag.topics[likeliest_first(bag, topics.points).front()].name;
    for (const std::string& robot : namespaces_of(bag))  // a robot has wheels of its own
      if (likeliest.starts_with(robot + "/") && !find_topics(bag, robot).wheel.empty())
        config.topics_under = robot;
    topics = find_topics(bag, config.topics_under);
  }
  take_truth(bag, topics, config);
  take_wheels(bag, topics, config);
  const auto choose = [&](std::string& choice, const TopicIndices& among) {
    if (choice.empty() && among.size() > 1)
      choice = name_to_type(bag, likeliest_first(bag, among).front(), config.topics_under);
  };
  choose(config.points, topics.points);
  choose(config.wheel, topics.wheel);
  choose(config.imu, topics.imu);
  choose(config.truth, topics.truth);
  return config;
}

std::vector<std::string> namespaces_of(const Bag& bag) {
  std::vector<std::vector<std::string>> topics;  // of clouds, in their parts
  for (const std::size_t topic : find_topics(bag, "").points) {
    if (!bag.topics[topic].name.starts_with('/')) continue;
    std::vector<std::string> parts;
    std::string words = bag.topics[topic].name;
    std::ranges::replace(words, '/', ' ');
    for (const std::string_view part : split_words(words)) parts.emplace_back(part);
    topics.push_back(std::move(parts));
  }
  if (topics.empty()) return {};
  // What all begin with names no robot.
  std::size_t shared = 0;
  const auto all_share = [&] {
    return std::ranges::all_of(topics, [&](const std::vector<std::string>& parts) {
      return shared + 1 < parts.size() && parts[shared] == topics.front()[shared];
    });
  };
  while (topics.size() > 1 && all_share()) ++shared;
  std::vector<std::string> names;
  for (const std::vector<std::string>& parts : topics) {
    if (parts.size() < shared + 2) continue;  // no namespace, only a topic
    std::string name;
    for (std::size_t i = 0; i <= shared; ++i) name += "/" + parts[i];
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace adit
