// Drives the base by hand, in what the collision guard allows: channel `drive`.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/navigation/drawn_limits.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/stamp_clock.hpp"

#include "orders/manual_drive.hpp"
#include "server/board.hpp"

namespace topogeo::web {

class EventLog;

/// Lives in the loop of its service.
class HandSender {
 public:
  /// The map of now, or null; asked for while somebody drives.
  using MapSource = std::function<std::shared_ptr<const planning::HybridMap>()>;

  /// `on_odometry` gets it, too; may be empty.
  HandSender(service::Service& service, Board& board, EventLog& events, MapSource map,
             std::function<void(const msg::Odometry&)> on_odometry = {});
  HandSender(const HandSender&) = delete;
  HandSender& operator=(const HandSender&) = delete;
  /// The last command is to stand still.
  ~HandSender();

  /// Calls `on_first` when the robot was left alone before: it may have a goal.
  void drive(std::uint64_t viewer, const geometry::Velocity& wanted,
             const std::function<void()>& on_first);
  void release(std::uint64_t viewer);
  /// The base stops at once and holds until release_stop(). False: no base hears it; one that comes
  /// before release_stop() is stopped then.
  [[nodiscard]] bool stop();
  /// False: no base hears it.
  [[nodiscard]] bool release_stop();

  /// The writer of the status of the robot's base: its program is to be connected.
  void note_base(const messaging::Handle& base);

  // Sensors of the guard, and where drawn walls and no-go zones are.
  void take(const msg::LivePose& pose);
  void take(const navigation::ScanPoints& scan);
  void take(const msg::LaserStatus& laser);

 private:
  void tick();
  void keep_off_drawn();
  void command(const geometry::Velocity& velocity, std::int64_t stamp_ns);
  /// Whether the base hears it.
  bool order(msg::BaseCommandKind kind);
  [[nodiscard]] bool base_hears() const;
  void show(const navigation::GuardVerdict& verdict, bool held);

  service::Service& service_;
  Board& board_;
  EventLog& events_;
  MapSource map_source_;
  std::string client_id_;
  service::StampClock clock_;
  navigation::CollisionGuard guard_;
  std::shared_ptr<const planning::HybridMap> map_;  // that limits_ are of
  navigation::DrawnLimits limits_;
  std::optional<navigation::PoseFix> pose_;  // the last one that is sure, unless it was used
  ManualDrive drive_;
  bool commanding_ = false;
  std::uint64_t commands_sent_ = 0;
  std::uint64_t orders_sent_ = 0;
  messaging::Writer<msg::MotionCommand> commands_;
  messaging::Writer<msg::BaseCommand> orders_;
  std::optional<messaging::Handle> base_;
  bool stop_unheard_ = false;
};

}  // namespace topogeo::web
