// Waits of tests: for an event, however long it takes on a slow machine. No verdict depends on the
// limit: it only ends a test that hangs.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>

#include "time_factor.hpp"

namespace topogeo::test {

/// A longer wait is a hang: five minutes, times TOPOGEO_TIME_FACTOR of the environment (how much
/// slower this machine is than the reference machine, measured when CMake configures), times the
/// factor of a sanitizer.
inline std::chrono::seconds hang_limit() {
  const char* text =
      std::getenv("TOPOGEO_TIME_FACTOR");  // NOLINT(concurrency-mt-unsafe): never set here
  const double factor = text == nullptr ? 1.0 : std::strtod(text, nullptr);
  return std::chrono::seconds(std::lround(300.0 * std::max(1.0, factor) * kTimeFactor));
}

/// One wait. Reports every ten seconds on standard error what it waits for.
class Wait {
 public:
  explicit Wait(std::string what) : what_(std::move(what)) {}

  /// False once the wait is a hang.
  bool goes_on() {
    using std::chrono::steady_clock;
    const auto now = steady_clock::now();
    const auto passed_s = std::chrono::floor<std::chrono::seconds>(now - start_).count();
    if (now >= limit_start_ + limit_) {
      std::fprintf(stderr, "gave up after %lld s: %s\n", static_cast<long long>(passed_s),
                   what_.c_str());
      return false;
    }
    if (now >= report_at_) {
      report_at_ = now + kReportEvery;
      std::fprintf(stderr, "%lld s: still waiting for %s\n", static_cast<long long>(passed_s),
                   what_.c_str());
    }
    return true;
  }
  /// There was progress: the limit counts from now on.
  void renew() { limit_start_ = std::chrono::steady_clock::now(); }

 private:
  static constexpr std::chrono::seconds kReportEvery{10};

  std::string what_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point limit_start_ = start_;
  std::chrono::steady_clock::time_point report_at_ = start_ + kReportEvery;
  std::chrono::seconds limit_ = hang_limit();
};

/// Checks `condition` until it holds, and calls `between` between two checks, for example one turn
/// of an event loop; `between` may renew the wait. False: it did not hold before a hang.
template <class Condition, class Between>
[[nodiscard]] bool wait_for(Wait& wait, const Condition& condition, const Between& between) {
  while (!condition()) {
    if (!wait.goes_on()) return false;
    between();
  }
  return true;
}

/// The same within hang_limit(). `what` completes "waiting for ...".
template <class Condition, class Between>
[[nodiscard]] bool wait_for(std::string what, const Condition& condition, const Between& between) {
  Wait wait(std::move(what));
  return wait_for(wait, condition, between);
}

/// The same when another thread or process causes the event: checks every few milliseconds.
template <class Condition>
[[nodiscard]] bool wait_for(std::string what, const Condition& condition) {
  return wait_for(std::move(what), condition, [] {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // between two checks
  });
}

/// The same while the handlers of an event loop run in this thread.
template <class Loop, class Condition>
[[nodiscard]] bool wait_in_loop(Loop& loop, std::string what, const Condition& condition) {
  return wait_for(std::move(what), condition,
                  [&] { static_cast<void>(loop.run_for(std::chrono::milliseconds(5))); });
}

/// The same for a call that waits itself, at most for the given time: repeats it until it returns
/// true.
template <class Call>
[[nodiscard]] bool wait_by(std::string what, const Call& call) {
  return wait_for(
      std::move(what), [&] { return call(std::chrono::seconds(1)); }, [] {});
}

}  // namespace topogeo::test
