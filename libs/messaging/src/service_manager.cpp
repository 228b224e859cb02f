#include "topogeo/messaging/service_manager.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include <systemd/sd-daemon.h>

namespace topogeo::messaging {

namespace {

void notify(const std::string& state) {
  // Without a reader there is no receiver for the failure.
  static_cast<void>(::sd_notify(0, state.c_str()));
}

}  // namespace

ServiceManager::ServiceManager(EventLoop& loop)
    : loop_(loop), present_(std::getenv("NOTIFY_SOCKET") != nullptr) {
  if (!present_) return;
  loop_.post([] { notify("READY=1"); });
  std::uint64_t period_us = 0;
  if (::sd_watchdog_enabled(0, &period_us) > 0) {
    // A third of the limit, so that one late tick does not kill a service that works.
    const auto period =
        std::max(std::chrono::microseconds(period_us / 3), std::chrono::microseconds(1));
    timer_ = loop_.add_timer(period, [] { notify("WATCHDOG=1"); });
  }
}

ServiceManager::~ServiceManager() {
  if (timer_) loop_.cancel_timer(*timer_);
  if (present_) notify("STOPPING=1");
}

void ServiceManager::show(const std::string& text) {
  if (!present_ || text == shown_) return;
  notify("STATUS=" + text);
  shown_ = text;
}

}  // namespace topogeo::messaging
