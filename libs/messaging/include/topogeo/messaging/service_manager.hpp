// Reports to systemd that a program works: sd_notify(3).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/messaging/event_loop.hpp"

namespace topogeo::messaging {

/// If systemd started the program (Type=notify), reports READY with the first turn of the loop,
/// signs of life from a timer of the loop (WatchdogSec) and STOPPING at the end. Otherwise it does
/// nothing. Must not outlive the loop.
class ServiceManager {
 public:
  explicit ServiceManager(EventLoop& loop);
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;
  ~ServiceManager();

  /// Sets the text that `systemctl status` shows; sent when it has changed.
  void show(const std::string& text);

 private:
  EventLoop& loop_;
  bool present_;
  std::string shown_;
  std::optional<std::uint64_t> timer_;
};

}  // namespace topogeo::messaging
