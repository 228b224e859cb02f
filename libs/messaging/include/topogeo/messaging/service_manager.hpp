// Reports to systemd that a program works: sd_notify(3).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/messaging/event_loop.hpp"

namespace topogeo::messaging {

/// Where systemd has started the program (Type=notify): READY with the first turn of the loop,
/// signs of life from a timer of the loop (WatchdogSec), STOPPING at the end. Elsewhere it does
/// nothing. Must not outlive the loop.
class ServiceManager {
 public:
  explicit ServiceManager(EventLoop& loop);
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;
  ~ServiceManager();

  /// What `systemctl status` shows; sent when it has changed.
  void show(const std::string& text);

 private:
  EventLoop& loop_;
  bool present_;
  std::string shown_;
  std::optional<std::uint64_t> timer_;
};

}  // namespace topogeo::messaging
