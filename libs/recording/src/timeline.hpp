// The time of each scan of a recording and the odometry at all times, read before the scans
// themselves: so topics may come in any order, and odd stamps are judged by their neighbours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/recording/message_source.hpp"
#include "topogeo/recording/survey.hpp"

#include "screened_odometry.hpp"
#include "stamp_repair.hpp"

namespace topogeo::recording {

bool is_scan_topic(const Survey& survey, const Topic& topic);
bool is_odometry_topic(const Survey& survey, const Topic& topic);
/// Whether scans of this frame are those of the survey.
bool is_of_laser(const Survey& survey, const std::string& frame);

class Timeline {
 public:
  /// Reads the topics of the survey once. Takes 40 bytes of memory for each scan, and 100 for each
  /// pose of odometry. Throws like open_messages().
  Timeline(const std::filesystem::path& path, const Survey& survey);

  /// The time of a message of the scan topic, from 0 in the order of arrival; empty if its stamp is
  /// odd, it came before, or it is of another frame.
  [[nodiscard]] std::optional<std::int64_t> scan_ns(std::size_t number) const;
  /// Whether an equal message came before.
  [[nodiscard]] bool is_repeated(std::size_t number) const;
  [[nodiscard]] const ScreenedOdometry& odometry() const { return odometry_; }
  [[nodiscard]] std::uint64_t odometry_messages() const { return odometry_messages_; }

  /// Odometry that is no pose: the first ones as "message 12: expected ..., got ...".
  [[nodiscard]] const std::vector<std::string>& faults() const { return faults_; }
  [[nodiscard]] std::uint64_t fault_count() const { return fault_count_; }
  /// For people, about times and odometry that are not as they should be.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  struct Collected;

  void take_scan(const RawMessage& message, const Topic& topic, Collected& collected);
  void take_odometry(const RawMessage& message, const Topic& topic, Collected& collected);
  void take_transforms(const RawMessage& message, const Topic& topic, Collected& collected);
  void add_pose(const ros::Header& header, std::int64_t log_time_ns,
                const std::optional<geometry::Pose2>& T_odom_robot, Collected& collected);
  void found_fault(const std::string& text);
  void finish(const Collected& collected);

  const Survey& survey_;
  std::unique_ptr<MessageSource> source_;  // while reading
  std::vector<std::optional<std::int64_t>> scans_ns_;
  std::vector<bool> scans_repeated_;
  ScreenedOdometry odometry_;
  std::uint64_t odometry_messages_ = 0;
  std::vector<std::string> faults_;
  std::uint64_t fault_count_ = 0;
  std::vector<std::string> notes_;
};

/// Everything that is known of a recording before its scans are read.
struct Drive {
  Drive(const std::filesystem::path& path, const TopicChoice& choice)
      : survey(recording::survey(path, choice)), timeline(path, survey) {}
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  Survey survey;
  Timeline timeline;
};

}  // namespace topogeo::recording
