// Odometry from the scans alone, for lasers without wheels. A track follows the scans until one
// does not match; then a second track begins there, while the first one waits for a scan that it
// knows. The scans between get their poses by the second track if the first one finds such a scan;
// otherwise the odometry begins anew, in another epoch, and the map finds the place again. It also
// does so behind bare walls that were in view for so long that their scans do not show the
// distance.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::localization {

class LaserTrack;
struct LaserStep;
struct TimedFeatures;

struct LaserOdometryCounts {
  std::uint64_t scans = 0;
  std::uint64_t unplaced = 0;   ///< that match neither those before nor those after them
  std::uint64_t unseen = 0;     ///< left out: between bare walls, for too long to know the place
  std::uint64_t breaks = 0;     ///< further epochs
  std::vector<double> steps_m;  ///< between successive placed scans of one epoch
};

class LaserOdometry {
 public:
  /// Mounting of the laser, and the range in metres up to which scans count.
  LaserOdometry(const geometry::Pose2& T_robot_laser, double points_range_m);
  LaserOdometry(LaserOdometry&&) noexcept;
  LaserOdometry& operator=(LaserOdometry&&) noexcept;
  ~LaserOdometry();

  /// Takes the next scan, in order of time; its odometry is ignored. Where the times of its beams
  /// are known, the motion during the scan is taken out by the velocity of the track.
  void add(scan::Scan scan);
  /// The log has ended.
  void finish();

  /// The scans placed since the last call, in order, with sequence, odometry and its epoch.
  std::vector<scan::Scan> take();

  [[nodiscard]] const LaserOdometryCounts& counts() const { return counts_; }

 private:
  struct Waiting {
    scan::Scan scan;
    geometry::Pose2 T_second_robot;  // by the second track
  };
  /// The track that the newest scans follow; null before there is one.
  [[nodiscard]] const LaserTrack* moving_track() const;
  void take_out_motion(scan::Scan& scan) const;
  void place(scan::Scan scan, const geometry::Pose2& T_odom_robot);
  /// Begins the first track at a scan, if it shows enough.
  void begin(scan::Scan scan, const TimedFeatures& seen);
  /// Places a scan that the first track follows, or holds it back between bare walls.
  void follow_first(scan::Scan scan, const TimedFeatures& seen, const LaserStep& step);
  /// Places what was held back; false if its distance is not known, which it then forgets.
  bool place_held();
  /// Begins another epoch.
  void begin_anew();
  void lose(scan::Scan scan, const TimedFeatures& seen);
  /// Whether the first track has found the last scan of the second, twice in the same place.
  bool find_again(const TimedFeatures& seen);
  void follow_second(scan::Scan scan, const TimedFeatures& seen);
  /// Places what waits; T_odom_second: the frame of the second track.
  void place_waiting(const geometry::Pose2& T_odom_second);
  [[nodiscard]] bool is_lost() const;

  geometry::Pose2 T_robot_laser_;
  double points_range_m_;
  std::unique_ptr<LaserTrack> track_;
  std::unique_ptr<LaserTrack> second_;
  geometry::Pose2 T_odom_track_;                  // frame of the track
  std::vector<scan::Scan> held_;                  // placed between bare walls, not yet passed on
  double held_m_ = 0.0;                           // that the robot may have driven meanwhile
  std::vector<Waiting> waiting_;                  // that the second track has placed
  std::optional<geometry::Pose2> T_second_last_;  // of the newest scan, if it is placed
  std::int64_t newest_ns_ = 0;
  std::optional<geometry::Pose2> T_track_second_;  // by the last scan that the track found
  std::vector<scan::Scan> ready_;
  std::optional<geometry::Pose2> T_odom_last_;
  std::uint64_t epoch_ = 0;
  std::uint64_t sequence_ = 0;
  LaserOdometryCounts counts_;
};

}  // namespace topogeo::localization
