// Notices that this process stood still: stopped by a signal, a debugger or a control group, or
// asleep with its machine.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace topogeo::messaging {

/// The longest time between two moments at which a thread of a process ran. Time spent waiting for
/// a CPU counts half: an overloaded machine delays all of its programs alike, so no peer forgets
/// one of them before its lease is over.
class Standstill {
 public:
  using Duration = std::chrono::nanoseconds;

  struct Moment {
    Duration now;     ///< since any moment, by a clock that runs while the machine sleeps
    Duration waited;  ///< for a CPU, by the thread since it began
  };
  explicit Standstill(const Moment& moment) : last_(moment) {}

  /// Records that the thread runs. Returns the longest time so far.
  Duration awake(const Moment& moment);

 private:
  Moment last_;
  Duration longest_{0};
};

class FreezeWatch {
 public:
  using Duration = Standstill::Duration;

  /// Starts a thread that wakes up twice a second.
  explicit FreezeWatch(Duration longest);
  FreezeWatch(const FreezeWatch&) = delete;
  FreezeWatch& operator=(const FreezeWatch&) = delete;
  ~FreezeWatch();

  /// The longest standstill, once it is at least `longest`.
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

/// How long a participant may stand still, or wait twice as long for a CPU: half of the `lease`
/// after which its peers forget it. A non-empty `text` replaces this: seconds (> 0), or 0 for no
/// limit. Throws std::runtime_error that names TOPOGEO_LONGEST_FREEZE_S for any other text.
[[nodiscard]] std::chrono::nanoseconds longest_freeze(std::chrono::nanoseconds lease,
                                                      const std::string& text);

}  // namespace topogeo::messaging
