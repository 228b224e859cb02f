// Drives the base by hand, in what the collision guard allows, and halts it: channel `drive`.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/navigation/drawn_limits.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/stamp_clock.hpp"

#include "orders/manual_drive.hpp"
#include "server/board.hpp"
#include "server/tally.hpp"

namespace topogeo::web {

/// Now, by the steady clock.
std::int64_t steady_ns();

class EventLog;

/// Lives in the loop that it is given, which has nothing else to do: what it is ordered is done at
/// once, whatever the other threads of the service do.
class HandSender {
 public:
  struct Hooks {
    /// The robot was left alone before and may have a goal. keep_off() follows.
    std::function<void()> on_first;
    /// A message was not sent because its readers are slow.
    std::function<void(const char* message)> on_blocked;
  };

  HandSender(messaging::EventLoop& loop, const service::Service& service, Board& board,
             EventLog& events, Tally& tally, Hooks hooks);
  HandSender(const HandSender&) = delete;
  HandSender& operator=(const HandSender&) = delete;
  /// The last command is to stand still.
  ~HandSender();

  /// An order that was received at `came_ns` of the steady clock; one that is old is refused.
  void drive(std::uint64_t viewer, const geometry::Velocity& wanted, std::int64_t came_ns);
  void release(std::uint64_t viewer);
  /// Where drawn walls and no-go zones are. Until it is known who takes the controls does not move.
  void keep_off(std::shared_ptr<const navigation::DrawnLimits> limits);
  /// The base stops at once and holds until release_stop(). False: no base hears it; one that comes
  /// before release_stop() is stopped then.
  [[nodiscard]] bool stop();
  /// False: no base hears it.
  [[nodiscard]] bool release_stop();
  /// Somebody drives. For any thread.
  [[nodiscard]] bool is_held() const { return held_; }

 private:
  void listen();
  void on_pose(const msg::LivePose& pose);
  void on_odometry(const msg::Odometry& odometry);
  void on_scan(const msg::Scan& scan);
  void on_laser(const msg::LaserStatus& laser);
  void tick();
  void keep_off_drawn();
  void command(const geometry::Velocity& velocity, std::int64_t stamp_ns);
  /// Whether the base hears it.
  bool order(msg::BaseCommandKind kind);
  [[nodiscard]] bool base_hears() const;
  void show(const navigation::GuardVerdict& verdict, bool held);
  /// Takes the messages of the own robot.
  template <class T, class Handler>
  void subscribe(Handler handler);

  messaging::EventLoop& loop_;
  const service::Service& service_;
  Board& board_;
  EventLog& events_;
  Tally& tally_;
  Hooks hooks_;
  std::string client_id_;
  service::StampClock clock_;
  navigation::CollisionGuard guard_;
  std::shared_ptr<const navigation::DrawnLimits> limits_;  // null: not known since the first order
  std::optional<navigation::PoseFix> pose_;  // the last one that is sure, unless it was used
  ManualDrive drive_;
  std::atomic<bool> held_ = false;
  bool commanding_ = false;
  std::uint64_t commands_sent_ = 0;
  std::uint64_t orders_sent_ = 0;
  messaging::Writer<msg::MotionCommand> commands_;
  messaging::Writer<msg::BaseCommand> orders_;
  std::optional<messaging::Handle> base_;  // the writer of the status of the robot's base
  bool stop_unheard_ = false;
};

}  // namespace topogeo::web
