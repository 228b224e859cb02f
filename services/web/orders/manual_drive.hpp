// Driving by hand with a dead man's handle: the robot moves as long as the page sends commands,
// within the limits of the collision guard. The caller supplies the time and sends the result.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/navigation/follower_config.hpp"

namespace topogeo::web {

class ManualDrive {
 public:
  static constexpr std::int64_t kPatience_ns = 300'000'000;  ///< longer silence stops the robot
  static constexpr std::int64_t kStopTail_ns =
      1'000'000'000;  ///< zeros are repeated for this time, because one may be lost

  explicit ManualDrive(const navigation::FollowerConfig& limits) : limits_(limits) {}

  /// Gives the handle to a viewer; false if another one holds it. Speeds are clamped to the limits.
  bool hold(std::uint64_t viewer, const geometry::Velocity& wanted, std::int64_t steady_ns);
  /// Releases the handle; does nothing for a viewer without it.
  void release(std::uint64_t viewer, std::int64_t steady_ns);
  /// Releases the handle for any viewer that holds it.
  void let_go(std::int64_t steady_ns);

  /// Whether a viewer holds the handle.
  [[nodiscard]] bool held(std::int64_t steady_ns) const;

  /// The motion to send to the base now; empty if no command is due. `sensors_ns`: time of the
  /// guard's sensor clock.
  std::optional<navigation::GuardVerdict> step(const navigation::CollisionGuard& guard,
                                               std::int64_t steady_ns, std::int64_t sensors_ns);

 private:
  navigation::FollowerConfig limits_;
  std::optional<std::uint64_t> holder_;
  geometry::Velocity wanted_;
  std::int64_t heard_ns_ = 0;        // last command of the holder, steady clock
  std::int64_t zeros_until_ns_ = 0;  // end of the repeated zeros, steady clock
};

}  // namespace topogeo::web
