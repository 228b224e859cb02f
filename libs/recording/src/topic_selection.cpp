#include "topic_selection.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <tuple>
#include <vector>

#include "topogeo/recording/message_source.hpp"

#include "odometry_message.hpp"
#include "robot_frame.hpp"

namespace topogeo::recording {
namespace {

constexpr double kEnoughScans = 0.5;  // share of the most frequent
constexpr double kEnoughOdometry = 0.1;

/// Streams of a type, or of one topic, most messages first. No robot has more than the limit.
std::vector<Stream> streams_of(const RecordingFacts& facts, std::string_view type,
                               const std::optional<std::string>& topic) {
  constexpr std::size_t kMostStreams = 64;
  std::vector<Stream> streams;
  for (const TopicFacts* found : facts.of_type(type)) {
    if (topic && found->topic.name != *topic) continue;
    if (found->frames.empty()) streams.push_back({found, nullptr});
    for (const FrameFacts& frames : found->frames) streams.push_back({found, &frames});
    if (streams.size() >= kMostStreams) break;
  }
  if (streams.size() > kMostStreams) streams.resize(kMostStreams);
  return streams;
}

double messages_of(const Stream& stream) {
  return stream.frames == nullptr ? 0.0 : static_cast<double>(stream.frames->messages);
}

double most_messages(const std::vector<Stream>& streams) {
  double most = 0.0;
  for (const Stream& stream : streams) most = std::max(most, messages_of(stream));
  return most;
}

/// "/robot1/odom" for topic "/robot1/scan".
std::string beside(const std::string& topic, const std::string& name) {
  return topic.substr(0, topic.rfind('/') + 1) + name;
}

bool differ(const std::string& a, const std::string& b) {
  return !a.empty() && !b.empty() && a != b;
}

/// Whether a topic belongs to another robot: one in another namespace, with scans of its own.
bool is_of_other_robot(const RecordingFacts& facts, const std::string& topic, const Stream& scans) {
  const std::string robot = robot_of(topic);
  if (!differ(robot, robot_of(scans.topic->topic.name))) return false;
  return std::ranges::any_of(facts.of_type(kLaserScanType), [&](const TopicFacts* other) {
    return robot_of(other->topic.name) == robot;
  });
}

/// Whether the frames of odometry have the prefix of another robot: one with a laser of its own.
bool has_frames_of_other_robot(const RecordingFacts& facts, const Stream& odometry,
                               const Stream& scans) {
  if (odometry.frames == nullptr || scans.frames == nullptr) return false;
  const std::string child = robot_of(odometry.frames->child);
  const std::string robot = child.empty() ? robot_of(odometry.frames->frame) : child;
  if (!differ(robot, robot_of(scans.frames->frame))) return false;
  return std::ranges::any_of(
      streams_of(facts, kLaserScanType, std::nullopt), [&](const Stream& other) {
        return other.frames != nullptr && robot_of(other.frames->frame) == robot;
      });
}

/// Level lasers rank before those of unknown mounting, and these before tilted and moving ones.
struct View {
  int level = 1;
  int forward = 0;  ///< tenths of the cosine of its direction
};

View view_of(const ros::FrameTree& transforms, const Stream& scans) {
  if (scans.frames == nullptr) return {};
  const RobotFrame robot = find_robot_frame(transforms, {}, scans.frames->frame);
  if (robot.laser_moves) return {0, 0};
  if (!robot.T_robot_laser) return {};
  const ros::LaserMounting mounting = ros::planar_mounting(*robot.T_robot_laser);
  if (mounting.tilt_rad > ros::kLargestTilt_rad) return {0, 0};
  return {2, static_cast<int>(std::lround(10.0 * std::cos(mounting.T_robot_laser.theta_rad)))};
}

}  // namespace

std::string robot_of(const std::string& name) {
  const std::size_t begin = name.starts_with('/') ? 1 : 0;
  const std::size_t end = name.find('/', begin);
  return end == std::string::npos ? std::string() : name.substr(begin, end - begin);
}

std::optional<Stream> choose_scans(const RecordingFacts& facts, const TopicChoice& choice) {
  const std::vector<Stream> streams = streams_of(facts, kLaserScanType, choice.scan);
  if (streams.empty()) return std::nullopt;
  const double enough = kEnoughScans * most_messages(streams);
  const bool has_odometry = !facts.of_type(kOdometryType).empty();
  std::map<std::string, ros::FrameTree> transforms_of;  // by robot
  const auto rank = [&](const Stream& stream) {
    const bool joined = !has_odometry || choose_odometry(facts, choice, stream).has_value();
    const std::string robot = robot_of(stream.topic->topic.name);
    if (!transforms_of.contains(robot)) transforms_of[robot] = transforms_for(facts, stream);
    const View view = view_of(transforms_of[robot], stream);
    return std::tuple(joined, messages_of(stream) >= enough && stream.frames != nullptr, view.level,
                      stream.topic->topic.name == "/scan", view.forward, messages_of(stream));
  };
  return *std::ranges::max_element(streams, {}, rank);
}

std::optional<Stream> choose_odometry(const RecordingFacts& facts, const TopicChoice& choice,
                                      const Stream& scans) {
  // Other poses than odometry serve only if they are named.
  const TopicFacts* const named = choice.odometry ? facts.find(*choice.odometry) : nullptr;
  const bool other_pose = named != nullptr && states_pose(named->topic.type);
  std::vector<Stream> streams =
      streams_of(facts, other_pose ? named->topic.type : kOdometryType, choice.odometry);
  if (!choice.odometry) {
    std::erase_if(streams, [&](const Stream& stream) {
      return is_of_other_robot(facts, stream.topic->topic.name, scans) ||
             has_frames_of_other_robot(facts, stream, scans);
    });
  }
  if (streams.empty()) return std::nullopt;
  const double enough = kEnoughOdometry * most_messages(streams);
  const std::string robot = robot_of(scans.topic->topic.name);
  const std::string laser = scans.frames == nullptr ? "" : robot_of(scans.frames->frame);
  const auto rank = [&](const Stream& stream) {
    const std::string& name = stream.topic->topic.name;
    const bool same_frames = stream.frames != nullptr && robot_of(stream.frames->child) == laser;
    return std::tuple(messages_of(stream) >= enough && stream.frames != nullptr,
                      !robot.empty() && robot_of(name) == robot, !laser.empty() && same_frames,
                      name == beside(scans.topic->topic.name, "odom"), name == "/odom",
                      messages_of(stream));
  };
  return *std::ranges::max_element(streams, {}, rank);
}

const TopicFacts* choose_transforms(const RecordingFacts& facts, const TopicChoice& choice,
                                    const Stream& scans) {
  std::vector<const TopicFacts*> topics = facts.of_type(kTfType);
  std::erase_if(topics, [&](const TopicFacts* topic) {
    if (choice.odometry) return topic->topic.name != *choice.odometry;
    return is_of_other_robot(facts, topic->topic.name, scans);
  });
  if (topics.empty()) return nullptr;
  return *std::ranges::max_element(topics, {}, [&](const TopicFacts* topic) {
    const std::string& name = topic->topic.name;
    return std::tuple(name == beside(scans.topic->topic.name, "tf"), name == "/tf",
                      topic->messages);
  });
}

ros::FrameTree transforms_for(const RecordingFacts& facts, const Stream& scans) {
  ros::FrameTree tree;
  for (const TopicFacts* topic : facts.of_type(kTfType)) {
    if (!is_of_other_robot(facts, topic->topic.name, scans)) tree.add(topic->transforms);
  }
  return tree;
}

std::string text_of(const RecordingFacts& facts, const Stream& used, const std::string& flag) {
  const auto name_of = [&](const Stream& stream) {
    std::string name = stream.topic->topic.name;
    if (stream.topic->frames.size() > 1) {
      name += " in frame ";
      name += stream.frames->child.empty() ? stream.frames->frame : stream.frames->child;
    }
    return name + " (" +
           std::to_string(stream.frames == nullptr ? stream.topic->messages
                                                   : stream.frames->messages) +
           ")";
  };
  std::string others;
  bool other_topics = false;
  for (const Stream& stream : streams_of(facts, used.topic->topic.type, std::nullopt)) {
    if (stream.topic == used.topic && stream.frames == used.frames) continue;
    others += (others.empty() ? ", not " : ", ") + name_of(stream);
    other_topics |= stream.topic != used.topic;
  }
  return name_of(used) + others + (other_topics ? "; " + flag + " chooses another" : "");
}

}  // namespace topogeo::recording
