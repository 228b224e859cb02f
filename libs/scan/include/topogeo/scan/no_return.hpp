// The range that a laser reports if no echo has returned, found in its readings: one value at the
// top of its ranges, seen from many places, much more often than all values near it.
//
// Walls do not look like this. Their ranges change with the place of the robot, so that readings
// from a place, however long the robot stands there, count once; a quantised laser has many
// readings of one value, but as many of the values beside it. Only few readings may lie above.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::scan {

struct NoReturn {
  double range_m = 0.0;  ///< the most frequent of the values that mean "no echo"
  double least_m = 0.0;  ///< readings at or above it are no echo; > 0
  double share = 0.0;    ///< of all readings, in (0, 1]
};
/// "a reading of 8.187 m means no echo (6.5 % of the readings)".
std::string text_of(const NoReturn& no_return);

class NoReturnFinder {
 public:
  /// Distance between two places whose readings count, by odometry.
  static constexpr double kPlace_m = 0.2;
  /// Places that must have seen the value.
  static constexpr std::uint32_t kLeastPlaces = 10;
  /// Share of the readings that must have the value.
  static constexpr double kLeastShare = 0.001;
  /// Values of one laser that mean "no echo" lie within this distance; some report several.
  static constexpr double kWindow_m = 0.02;
  /// Readings of the value, divided by those in any other window below it, or by all above it. On
  /// logs at hand the real values reach 14 and more, the best others 0.07; with ranges cut at 1 to
  /// 20 m and rounded to up to 0.1 m, a value that stands for all that was cut reaches 6 and more,
  /// and the top of the others at most 2.2 (docs/decisions/no_return.md).
  static constexpr double kDominance = 4.0;
  /// The windows below the value that are compared begin at this share of it.
  static constexpr double kCompared = 0.75;
  /// More places do not change the answer; the work on a long log is bounded.
  static constexpr std::uint32_t kMostPlaces = 4000;

  /// Takes a scan, in order of time. Readings that are not finite or not above 0 count as readings
  /// without a value.
  void add(std::span<const float> ranges_m, const geometry::Pose2& T_odom_robot);
  /// The same without odometry: the place is another one if a third of the readings have changed by
  /// more than kChanged_m.
  void add_without_odometry(std::span<const float> ranges_m);
  /// Half of the beams of a laser that moves by kPlace_m change by more.
  static constexpr float kChanged_m = 0.1F;

  /// Whether enough places have been added.
  [[nodiscard]] bool is_full() const { return places_ >= kMostPlaces; }
  [[nodiscard]] std::uint32_t places() const { return places_; }

  /// Empty if no value means "no echo", or too few places were seen to tell.
  [[nodiscard]] std::optional<NoReturn> find() const;

 private:
  struct Bin {
    std::uint64_t readings = 0;
    std::uint32_t places = 0;
    std::uint32_t last_place = 0;  // that counted, from 1
  };

  void count(std::span<const float> ranges_m);

  std::optional<geometry::Pose2> T_odom_last_;  // where readings counted last
  std::vector<float> last_m_;                   // without odometry: these readings
  std::map<std::int64_t, Bin> bins_;            // by range in millimetres
  std::uint64_t readings_ = 0;                  // with and without a value
  std::uint32_t places_ = 0;
};

/// Looks for the value in a whole log, whose odometry may be missing or stand.
class NoReturnSearch {
 public:
  /// Takes a scan, in order of time, like NoReturnFinder.
  void add(std::span<const float> ranges_m, const geometry::Pose2& T_odom_robot);
  /// Whether no further scan changes the answer.
  [[nodiscard]] bool is_full() const { return by_odometry_.is_full(); }
  /// The answer by the places of the odometry, or by those of the views if it has never moved.
  [[nodiscard]] std::optional<NoReturn> find() const;

 private:
  [[nodiscard]] bool has_moved() const { return by_odometry_.places() > 1; }

  NoReturnFinder by_odometry_;
  NoReturnFinder by_views_;
};

/// Looks for the value while the robot drives.
class NoReturnWatch {
 public:
  /// Places of the first search; the next ones follow at twice, four times ... as many.
  static constexpr std::uint32_t kFirstPlaces = 30;

  /// Takes a scan, like NoReturnFinder. Returns whether the value was found with it; it stays.
  bool add(std::span<const float> ranges_m, const geometry::Pose2& T_odom_robot);
  [[nodiscard]] const std::optional<NoReturn>& found() const { return found_; }

 private:
  NoReturnFinder finder_;
  std::uint32_t next_search_ = kFirstPlaces;
  std::optional<NoReturn> found_;
};

}  // namespace topogeo::scan
