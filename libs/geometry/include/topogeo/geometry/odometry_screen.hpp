// Finds odometry that cannot be, in a sequence of readings: readings that jump away and back are
// cut out; where the odometry goes on elsewhere, for instance at zero because its board has
// restarted, another epoch begins, whose poses are unrelated to those before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::geometry {

/// Whether a robot can have moved from `a` to `b`, in any order of time. Half a metre and a radian
/// are always possible, because stamps jitter. Only a restart of the odometry leads to its origin
/// (5 cm, 0.05 rad) by a shorter step that is faster than an indoor robot.
bool is_possible_step(const OdometrySample& a, const OdometrySample& b);

class OdometryScreen {
 public:
  /// Readings elsewhere that follow each other for so long are odometry; fewer are outliers.
  static constexpr std::size_t kLeastReadings = 10;
  static constexpr std::int64_t kLeast_ns = 2'000'000'000;

  struct Reading {
    OdometrySample sample;
    std::uint64_t epoch = 0;   ///< from 0
    std::uint64_t number = 0;  ///< of its add(), from 0
  };

  /// Takes the next reading, in approximate order of time. It waits for the following ones while it
  /// is unclear whether it can be.
  void add(const OdometrySample& sample);
  /// Decides about the readings that wait. Nothing may be added later.
  void finish();

  /// The good readings that were decided since the last call, in order.
  std::vector<Reading> take();
  /// Readings with a smaller number are decided.
  [[nodiscard]] std::uint64_t decided() const;

  /// Number of readings that were cut out.
  [[nodiscard]] std::size_t cut() const { return cut_; }
  [[nodiscard]] std::uint64_t epochs() const { return epochs_; }
  /// For people, a line for the readings that were cut out and one for each further epoch.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  struct Waiting {
    OdometrySample sample;
    std::uint64_t number = 0;
  };
  using Run = std::vector<Waiting>;  // each is possible after the one before

  void accept(const Waiting& reading);
  void begin_epoch(const Run& run);
  void cut_runs();
  [[nodiscard]] Run* run_before(const OdometrySample& sample);
  [[nodiscard]] bool comes_back(const OdometrySample& sample, const Run* run) const;

  std::vector<Reading> good_;
  std::optional<OdometrySample> last_;  // of the current epoch
  std::vector<Run> runs_;               // impossible after it
  std::optional<std::int64_t> first_ns_;
  std::uint64_t added_ = 0;
  std::uint64_t epochs_ = 0;
  std::size_t cut_ = 0;
  double farthest_cut_m_ = 0.0;
  std::vector<std::string> breaks_;  // notes
  std::uint64_t more_breaks_ = 0;    // without a note
};

}  // namespace topogeo::geometry
