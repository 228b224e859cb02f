#include "recording_facts.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"

#include "odometry_message.hpp"

namespace topogeo::recording {
namespace {

bool is_used(const Topic& topic) {
  return topic.encoding != Encoding::kOther &&
         (topic.type == kLaserScanType || topic.type == kTfType || states_pose(topic.type));
}

/// The facts of these frames. Null if there are more frames than any robot has.
FrameFacts* facts_of(std::vector<FrameFacts>& all, const std::string& frame,
                     const std::string& child) {
  constexpr std::size_t kMostFrames = 256;
  const auto known = std::ranges::find_if(
      all, [&](const FrameFacts& facts) { return facts.frame == frame && facts.child == child; });
  if (known != all.end()) return &*known;
  if (all.size() == kMostFrames) return nullptr;
  return &all.emplace_back(FrameFacts{frame, child, 0, {}, 0, {}});
}

void count_beams(std::vector<BeamKind>& kinds, const ros::LaserScan& scan) {
  constexpr std::size_t kMostKinds = 256;
  constexpr std::size_t kMostBeams = scan::CarmenLogReader::kMaxBeams;
  const ros::BeamPattern upright = ros::pattern_of(scan, false, kMostBeams);
  for (BeamKind& kind : kinds) {
    if (!ros::same_beams(kind.upright, upright)) continue;
    ++kind.scans;
    return;
  }
  if (kinds.size() < kMostKinds) {
    kinds.push_back({upright, ros::pattern_of(scan, true, kMostBeams), 1});
  }
}

}  // namespace

RecordingFacts::RecordingFacts(const std::filesystem::path& path) {
  const std::unique_ptr<MessageSource> source = open_messages(path, is_used);
  RawMessage message;
  while (source->next(message)) take(source->topics()[message.topic], message);
  all_topics_ = source->topics();
  damage_ = source->damage();
  for (auto& [name, facts] : topics_) {
    std::ranges::stable_sort(facts.frames, std::ranges::greater{}, &FrameFacts::messages);
  }
}

void RecordingFacts::take(const Topic& topic, const RawMessage& message) {
  TopicFacts& facts = topics_[topic.name];
  facts.topic = topic;
  ++facts.messages;
  try {
    if (topic.type == kTfType) {
      facts.transforms.add(decode<ros::TFMessage>(message.data, topic.encoding),
                           topic.name.ends_with("tf_static"));
    } else if (topic.type == kLaserScanType) {
      auto scan = decode<ros::LaserScan>(message.data, topic.encoding);
      const bool in_degrees = correct_degrees(scan);
      FrameFacts* found =
          facts_of(facts.frames, ros::frame_name(scan.header_().frame_id_()), std::string());
      if (found == nullptr) return;
      ++found->messages;
      if (in_degrees) ++found->scans_in_degrees;
      found->range_unit.add(scan);
      count_beams(found->beams, scan);
    } else {
      const OdometryMessage odometry = decode_odometry(topic.type, message.data, topic.encoding);
      FrameFacts* found = facts_of(facts.frames, ros::frame_name(odometry.header.frame_id_()),
                                   odometry.child_frame);
      if (found != nullptr) ++found->messages;
    }
  } catch (const DecodeError&) {
    // The log reader counts and explains them.
  } catch (const std::invalid_argument&) {  // NOLINT(bugprone-empty-catch): as those
  }
}

std::vector<const TopicFacts*> RecordingFacts::of_type(std::string_view type) const {
  std::vector<const TopicFacts*> found;
  for (const auto& [name, facts] : topics_) {
    if (facts.topic.type == type) found.push_back(&facts);
  }
  std::ranges::stable_sort(found, std::ranges::greater{}, &TopicFacts::messages);
  return found;
}

std::optional<Topic> RecordingFacts::any_of_type(std::string_view type) const {
  const auto found = std::ranges::find(all_topics_, type, &Topic::type);
  return found == all_topics_.end() ? std::nullopt : std::optional(*found);
}

const TopicFacts* RecordingFacts::find(const std::string& name) const {
  const auto found = topics_.find(name);
  return found == topics_.end() ? nullptr : &found->second;
}

std::string RecordingFacts::topics_text() const {
  std::string text;
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < std::min(all_topics_.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + all_topics_[i].name + " (" + all_topics_[i].type + ")";
  }
  if (all_topics_.size() > kMost) text += ", ...";
  if (text.empty()) text = "no topics";
  return damage_.empty() ? text : text + "; " + damage_;
}

}  // namespace topogeo::recording
