// Drives the base by hand, within the limits of the collision guard, and halts it: channel `drive`.
//
// A base that reports its state holds itself. The stop of any other base, for example one of ROS,
// is kept here: it outlives this process, ends all driving by hand, and is passed to each navigator
// that connects. Zeros are repeated until the release, because a base or a bridge may start
// meanwhile.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/navigation/drawn_limits.hpp"
#include "topogeo/service/operator_stop.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/stamp_clock.hpp"

#include "orders/manual_drive.hpp"
#include "orders/unconfirmed_release.hpp"
#include "server/channel_hub.hpp"
#include "server/tally.hpp"

namespace topogeo::web {

class EventLog;

/// Lives in a loop of its own, so that orders are carried out at once, whatever the other threads
/// of the service do.
class ManualDriveSender {
 public:
  using OnRelease = std::function<void(UnconfirmedRelease::Outcome)>;
  enum class Release : std::uint8_t {
    kSent,      ///< the base hears it; its outcome follows
    kHeldHere,  ///< no base reports a stop: the one that was kept here has ended
    kUnheard    ///< no base hears it, and no stop was kept here
  };
  struct Hooks {
    /// Called when a drive by hand begins; the robot may have a goal. keep_off() follows.
    std::function<void()> on_first;
    /// A message was not sent because its readers are slow.
    std::function<void(const char* message)> on_blocked;
  };

  /// Keeps a stop that no base reports in the file `memory` (empty: none). Throws like
  /// service::OperatorStop.
  ManualDriveSender(messaging::EventLoop& loop, const service::Service& service, ChannelHub& hub,
                    EventLog& events, Tally& tally, Hooks hooks,
                    const std::filesystem::path& memory = {});
  ManualDriveSender(const ManualDriveSender&) = delete;
  ManualDriveSender& operator=(const ManualDriveSender&) = delete;
  /// Sends a command to stand still.
  ~ManualDriveSender();

  /// An order received at `came_ns` of the steady clock. Refused if it is old, and from stop() or
  /// the stop of another program to the release.
  void drive(std::uint64_t viewer, const geometry::Velocity& wanted, std::int64_t came_ns);
  void release(std::uint64_t viewer);
  /// Sets the drawn walls and no-go zones. Until they are known, the robot does not move.
  void keep_off(std::shared_ptr<const navigation::DrawnLimits> limits);
  /// Halts the base until release_stop(). Returns false when no base hears it. A base that connects
  /// or starts again before release_stop() is then halted, too, unless another operator has
  /// released it.
  [[nodiscard]] bool stop();
  /// Lets the base move again after a stop. `done` is called once with the outcome of kSent.
  [[nodiscard]] Release release_stop(OnRelease done = {});
  /// Drops the handler of a release that waits for its outcome.
  void forget_release() { on_release_ = nullptr; }
  /// Whether a navigator gets the orders to the base, too: it holds a robot whose base does not.
  [[nodiscard]] bool navigator_hears() const {
    return navigator_ && orders_.connected_with(*navigator_);
  }
  /// Whether anybody drives by hand. Thread-safe.
  [[nodiscard]] bool is_held() const { return held_; }

 private:
  void listen();
  void on_pose(const msg::LivePose& pose);
  void on_odometry(const msg::Odometry& odometry);
  void on_scan(const msg::Scan& scan);
  void on_laser(const msg::LaserStatus& laser);
  void on_base(const msg::BaseStatus& base, const messaging::Handle& writer);
  /// An order of another program to the base.
  void on_order(const msg::BaseCommand& message, const messaging::Handle& writer);
  /// Passes the stop, or its release, to a navigator that is connected anew.
  void on_navigator(const messaging::Handle& navigator);
  void tick();
  void end_release(std::optional<UnconfirmedRelease::Outcome> outcome);
  void keep_off_drawn();
  void command(const geometry::Velocity& velocity, std::int64_t stamp_ns);
  /// `number`: of the stop that the order means. Returns whether the base hears it.
  bool order(msg::BaseCommandKind kind, std::uint64_t number);
  [[nodiscard]] bool base_hears() const;
  /// Whether a stop holds that no connected base reports, as with a base of ROS.
  [[nodiscard]] bool stopped_alone() const {
    return !base_hears() && (stop_wanted_ || kept_stop_.holds());
  }
  /// Shows that nobody drives by hand, and whether such a stop forbids it.
  void show_rest();
  void show(const navigation::GuardVerdict& verdict, bool held);
  /// Subscribes to messages of the own robot.
  template <class T, class Handler>
  void subscribe(Handler handler);

  messaging::EventLoop& loop_;
  const service::Service& service_;
  ChannelHub& hub_;
  EventLog& events_;
  Tally& tally_;
  Hooks hooks_;
  std::string client_id_;
  service::StampClock clock_;
  navigation::CollisionGuard guard_;
  std::shared_ptr<const navigation::DrawnLimits> limits_;  // null: unknown since the first order
  std::optional<navigation::PoseFix> pose_;                // the newest reliable one, until used
  ManualDrive drive_;
  std::atomic<bool> held_ = false;
  bool commanding_ = false;
  std::uint64_t commands_sent_ = 0;
  std::uint64_t orders_sent_ = 0;
  messaging::Writer<msg::MotionCommand> commands_;
  messaging::Writer<msg::BaseCommand> orders_;
  service::OperatorStop kept_stop_;             // the stop until a base reports it
  std::optional<messaging::Handle> base_;       // writer of the base's status
  std::optional<messaging::Handle> navigator_;  // writer of its status; has the stop or its release
  std::uint64_t stop_count_ = 0;                // of the base's newest status; 0: none
  bool stop_unheard_ = false;
  bool shows_stop_ = false;                          // channel `drive` shows stopped_alone()
  bool stop_wanted_ = kept_stop_.holds();            // from stop() to release_stop()
  std::uint64_t stop_number_ = kept_stop_.number();  // of the last stop() or its release
  std::int64_t zero_due_ns_ = 0;                     // by the steady clock
  std::optional<messaging::Handle> stopped_base_;    // writer that has reported the stop since then
  bool base_held_ = false;                           // in the base's newest status
  std::string releasing_;  // another program that has asked a held base for its release
  UnconfirmedRelease release_;
  OnRelease on_release_;  // empty: answered
};

}  // namespace topogeo::web
