#include "freeze_watch.hpp"

#include <ctime>

namespace topogeo::messaging {

namespace {

constexpr FreezeWatch::Duration kWakePeriod = std::chrono::milliseconds(500);

/// Goes on while the machine sleeps, as the steady clock does not.
FreezeWatch::Duration since_boot() {
  timespec time{};
  clock_gettime(CLOCK_BOOTTIME, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

FreezeWatch::FreezeWatch(Duration longest) : longest_(longest), thread_([this] { watch(); }) {}

FreezeWatch::~FreezeWatch() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  ending_.notify_all();
  thread_.join();
}

std::optional<FreezeWatch::Duration> FreezeWatch::stood_still() const {
  const Duration still(stood_still_ns_.load());
  if (still < longest_) return {};
  return still;
}

void FreezeWatch::watch() {
  Duration last = since_boot();
  std::unique_lock lock(mutex_);
  while (!ending_.wait_for(lock, kWakePeriod, [this] { return ends_; })) {
    const Duration now = since_boot();
    const Duration still =
        now - last;  // half a second too long at most: rather too early than never
    if (still >= longest_) stood_still_ns_ = still.count();
    last = now;
  }
}

}  // namespace topogeo::messaging
