// Notices that this process stood still: stopped by a signal, a debugger or a control group, or
// asleep with its machine.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <thread>

namespace topogeo::messaging {

class FreezeWatch {
 public:
  using Duration = std::chrono::nanoseconds;

  /// Starts a thread that wakes up twice a second.
  explicit FreezeWatch(Duration longest);
  FreezeWatch(const FreezeWatch&) = delete;
  FreezeWatch& operator=(const FreezeWatch&) = delete;
  ~FreezeWatch();

  /// How long it stood still at a stretch, once that was `longest` or more.
  [[nodiscard]] std::optional<Duration> stood_still() const;

 private:
  void watch();

  const Duration longest_;
  std::atomic<std::int64_t> stood_still_ns_ = 0;
  std::mutex mutex_;
  std::condition_variable ending_;
  bool ends_ = false;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace topogeo::messaging
