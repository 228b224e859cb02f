// Chooses scans and odometry that belong together among the topics of a recording: of one robot by
// namespace and frames, and of a laser that scans parallel to the floor.
#pragma once

#include <optional>
#include <string>

#include "topogeo/recording/survey.hpp"
#include "topogeo/ros_conversions/frame_tree.hpp"

#include "recording_facts.hpp"

namespace topogeo::recording {

/// Messages of one topic with the same frames.
struct Stream {
  const TopicFacts* topic = nullptr;
  const FrameFacts* frames = nullptr;  ///< null if none is readable
};

/// The scans of the chosen topic or, among those with odometry and half as many as the most
/// frequent, of a level laser, on /scan, that looks forward, with most messages. Empty if there are
/// none.
std::optional<Stream> choose_scans(const RecordingFacts& facts, const TopicChoice& choice);

/// The nav_msgs/Odometry of the chosen topic or of the robot with these scans: on `odom` in their
/// namespace, else /odom, else with most messages. Empty if there is none.
std::optional<Stream> choose_odometry(const RecordingFacts& facts, const TopicChoice& choice,
                                      const Stream& scans);

/// The topic of transforms to take odometry from: the chosen one, else `tf` in the namespace of
/// the scans, else /tf, else the one with most messages. Null if there is none.
const TopicFacts* choose_transforms(const RecordingFacts& facts, const TopicChoice& choice,
                                    const Stream& scans);

/// The transforms of all topics but those of other robots.
ros::FrameTree transforms_for(const RecordingFacts& facts, const Stream& scans);

/// "robot1" for topic "/robot1/scan" or frame "robot1/laser"; empty without a prefix.
std::string robot_of(const std::string& name);

/// "/scan (880), not /rear (440)": the messages of both, for people. `flag` chooses another topic.
std::string text_of(const RecordingFacts& facts, const Stream& used, const std::string& flag);

}  // namespace topogeo::recording
