// The scans of a recording with the odometry at their times, each readable, not yet in order of
// time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/recording/message_source.hpp"
#include "topogeo/recording/survey.hpp"
#include "topogeo/scan/repeated_readings.hpp"
#include "topogeo/scan/scan_sequence.hpp"

#include "timeline.hpp"

namespace topogeo::recording {

class RosScans {
 public:
  enum class Beams : std::uint8_t {
    kOnePattern,  ///< motion of each sweep removed as chosen, all on the beams of most scans
    kAsMeasured
  };

  /// How the numbers of a scan are to be taken.
  struct Correction {
    double range_limit_m = 0.0;  ///< ranges at or above it, as they are recorded, are no echo
    double range_scale = 1.0;    ///< in metres, of a recorded range of 1
    std::int64_t delay_ns = 0;   ///< of the stamps of scans after those of odometry
  };

  /// `drive` is of the same file.
  RosScans(const std::filesystem::path& path, std::shared_ptr<const Drive> drive,
           ros::SweepOrder sweep, const Correction& correction, Beams beams,
           scan::ScanSequence::Skip skip);

  /// Its odometry epoch counts from 0.
  std::optional<scan::ScanSequence::Candidate> next();

  [[nodiscard]] const Survey& facts() const { return drive_->survey; }
  [[nodiscard]] double fraction_read() const { return source_->fraction_read(); }
  /// About times and odometry, for people.
  [[nodiscard]] std::vector<std::string> notes() const { return drive_->timeline.notes(); }
  [[nodiscard]] std::uint64_t messages() const { return scans_ + odometry_messages(); }
  [[nodiscard]] std::uint64_t scan_messages() const { return scans_; }
  [[nodiscard]] std::uint64_t odometry_messages() const {
    return drive_->timeline.odometry_messages();
  }

 private:
  using Candidate = scan::ScanSequence::Candidate;

  /// The scan of a message with its beams; empty if it is skipped.
  std::optional<Candidate> take(const RawMessage& message);
  /// Throws DecodeError, std::invalid_argument for a scan of another laser or with impossible
  /// beams.
  [[nodiscard]] ros::Sweep read_sweep(const RawMessage& message) const;
  void skip_without_pose(std::int64_t stamp_ns);
  /// Whether a laser that hangs has sent these readings before.
  bool is_repeated(const ros::Sweep& sweep, const ScreenedOdometry::Answer& pose);
  void put_beams(ros::Sweep sweep, scan::Scan& scan) const;

  std::shared_ptr<const Drive> drive_;
  ros::SweepOrder sweep_;
  Correction correction_;
  Beams beams_;
  scan::ScanSequence::Skip skip_;
  scan::RepeatedReadings repeated_;
  std::unique_ptr<MessageSource> source_;
  std::uint64_t scans_ = 0;
  bool ended_ = false;
};

}  // namespace topogeo::recording
