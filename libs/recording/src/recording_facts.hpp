// Content of the topics of a recording: the frames of scans and odometry, the beams of scans, the
// transforms.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/recording/message_source.hpp"
#include "topogeo/ros_conversions/frame_tree.hpp"
#include "topogeo/ros_conversions/laser_scan.hpp"

#include "scan_units.hpp"

namespace topogeo::recording {

/// Scans with one pattern of beams.
struct BeamKind {
  ros::BeamPattern upright;
  ros::BeamPattern upside_down;
  std::uint64_t scans = 0;
};

/// The messages of a topic with the same frames.
struct FrameFacts {
  std::string frame;  ///< of the laser, or of odometry or another pose
  std::string child;  ///< of odometry; empty for poses
  std::uint64_t messages = 0;
  std::vector<BeamKind> beams;         ///< of scans
  std::uint64_t scans_in_degrees = 0;  ///< see correct_degrees()
  RangeUnit range_unit;                ///< of scans
};

struct TopicFacts {
  Topic topic;
  std::uint64_t messages = 0;
  std::vector<FrameFacts> frames;  ///< of readable scans and odometry, most messages first
  ros::FrameTree transforms;       ///< of a topic of transforms
};

class RecordingFacts {
 public:
  /// Reads the whole recording once. Throws like open_messages().
  explicit RecordingFacts(const std::filesystem::path& path);

  /// The topics of one type, most messages first.
  [[nodiscard]] std::vector<const TopicFacts*> of_type(std::string_view type) const;
  /// A topic of a type, of which no message need be usable.
  [[nodiscard]] std::optional<Topic> any_of_type(std::string_view type) const;
  /// Null if no message of a topic with this name can be used.
  [[nodiscard]] const TopicFacts* find(const std::string& name) const;
  /// All topics with their types, for error messages.
  [[nodiscard]] std::string topics_text() const;

 private:
  void take(const Topic& topic, const RawMessage& message);

  std::map<std::string, TopicFacts> topics_;  // by name
  std::vector<Topic> all_topics_;
  std::string damage_;
};

}  // namespace topogeo::recording
