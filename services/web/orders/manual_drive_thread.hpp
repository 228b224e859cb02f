// Stop, Release and driving by hand in a thread of their own, so that neither the topics of a large
// map nor many requests of pages delay them.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/service/service.hpp"

#include "orders/manual_drive_sender.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

class ManualDriveThread {
 public:
  /// The hooks are called in this thread. An exception in it ends the loop of the service.
  /// `memory`: see ManualDriveSender.
  ManualDriveThread(service::Service& service, ChannelHub& hub, EventLog& events, Tally& tally,
                    ManualDriveSender::Hooks hooks, const std::filesystem::path& memory = {});
  ManualDriveThread(const ManualDriveThread&) = delete;
  ManualDriveThread& operator=(const ManualDriveThread&) = delete;
  ~ManualDriveThread();

  // Thread-safe; see ManualDriveSender.
  void drive(std::uint64_t viewer, const geometry::Velocity& wanted);
  void release(std::uint64_t viewer);
  void stop(Respond respond);
  /// Number of calls of stop() so far.
  [[nodiscard]] std::uint64_t stops() const { return stops_; }
  /// Answered when the base has confirmed or refused it, after a second at the latest, and at once
  /// if no base reports the stop. Refused (409) if there was a stop after `stops`: a release that
  /// waited must not undo it.
  void release_stop(std::uint64_t stops, Respond respond);
  void keep_off(std::shared_ptr<const navigation::DrawnLimits> limits);
  [[nodiscard]] bool is_held() const { return hand_.is_held(); }

  /// Ends the thread; unanswered orders stay unanswered.
  void end();

 private:
  struct Order {
    std::optional<std::uint64_t> release;  ///< stops() when it was given; empty: stop
    Respond respond;
  };
  void carry_out(const Order& order);
  void run();
  void take(Order order);
  void work_off_orders();

  service::Service& service_;
  messaging::EventLoop loop_;
  ManualDriveSender hand_;
  std::mutex mutex_;
  std::deque<Order> orders_;  // here and not in the loop, because they hold connections
  bool ended_ = false;
  std::atomic<std::uint64_t> stops_ = 0;
  std::thread thread_;
};

}  // namespace topogeo::web
