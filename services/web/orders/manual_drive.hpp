// Driving by hand, by a dead man's handle: the robot moves as long as the page sends, in what the
// collision guard allows. No clock, no transport.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/navigation/follower_config.hpp"

namespace topogeo::web {

class ManualDrive {
 public:
  static constexpr std::int64_t kPatience_ns = 300'000'000;  ///< without a message: it stops
  static constexpr std::int64_t kStopTail_ns =
      1'000'000'000;  ///< zeros go on that long: one may be lost

  explicit ManualDrive(const navigation::FollowerConfig& limits) : limits_(limits) {}

  /// A viewer holds the handle. False: another one does. Faster than the limits it does not go.
  bool hold(std::uint64_t viewer, const geometry::Velocity& wanted, std::int64_t steady_ns);
  /// Lets go; nothing for one who does not hold it.
  void release(std::uint64_t viewer, std::int64_t steady_ns);

  /// Somebody holds it.
  [[nodiscard]] bool held(std::int64_t steady_ns) const;

  /// What the base is to do now; nothing: it is left alone. `sensors_ns`: of the clock of the
  /// guard's sensors.
  std::optional<navigation::GuardVerdict> step(const navigation::CollisionGuard& guard,
                                               std::int64_t steady_ns, std::int64_t sensors_ns);

 private:
  void let_go(std::int64_t steady_ns);

  navigation::FollowerConfig limits_;
  std::optional<std::uint64_t> holder_;
  geometry::Velocity wanted_;
  std::int64_t heard_ns_ = 0;        // the holder, by the steady clock
  std::int64_t zeros_until_ns_ = 0;  // the same
};

}  // namespace topogeo::web
