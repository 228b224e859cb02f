// The scans of a recording with the odometry at their times, each readable, not yet in order of
// time.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/recording/message_source.hpp"
#include "topogeo/recording/survey.hpp"
#include "topogeo/scan/scan_sequence.hpp"

#include "screened_odometry.hpp"

namespace topogeo::recording {

class RosScans {
 public:
  enum class Beams : std::uint8_t {
    kOnePattern,  ///< motion of each sweep removed as chosen, all on the beams of most scans
    kAsMeasured
  };

  /// Ranges at or above `range_limit_m` are no echo.
  RosScans(const std::filesystem::path& path, const TopicChoice& choice, double range_limit_m,
           Beams beams, scan::ScanSequence::Skip skip);

  /// Its odometry epoch counts from 0.
  std::optional<scan::ScanSequence::Candidate> next();

  [[nodiscard]] const Survey& facts() const { return survey_; }
  [[nodiscard]] double fraction_read() const { return source_->fraction_read(); }
  /// About the odometry that was read so far, for people.
  [[nodiscard]] std::vector<std::string> notes() const { return track_.notes(); }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  [[nodiscard]] std::uint64_t scan_messages() const { return scans_; }
  [[nodiscard]] std::uint64_t odometry_messages() const { return odometry_; }

 private:
  using Candidate = scan::ScanSequence::Candidate;
  struct Waiting {
    std::uint64_t place = 0;
    std::int64_t stamp_ns = 0;
    ros::Sweep sweep;
  };

  [[nodiscard]] bool front_is_due() const;
  std::optional<Candidate> take_front();
  void take(const RawMessage& message);
  void put_beams(const Waiting& from, scan::Scan& scan) const;
  void take_scan(const RawMessage& message, const Topic& topic);
  void take_odometry(const RawMessage& message, const Topic& topic);
  void take_transforms(const RawMessage& message, const Topic& topic);
  void add_pose(const ros::Header& header, std::int64_t log_time_ns,
                const std::optional<geometry::Pose2>& T_odom_robot);
  void finish();

  Survey survey_;
  ros::SweepOrder sweep_;
  double range_limit_m_;
  Beams beams_;
  scan::ScanSequence::Skip skip_;
  std::unique_ptr<MessageSource> source_;
  ScreenedOdometry track_;
  std::deque<Waiting> waiting_;  // until odometry reaches their last beams
  std::uint64_t messages_ = 0;
  std::uint64_t scans_ = 0;
  std::uint64_t odometry_ = 0;
  bool ended_ = false;
};

}  // namespace topogeo::recording
