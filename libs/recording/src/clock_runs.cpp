#include "clock_runs.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <unordered_set>
#include <utility>

namespace topogeo::recording {
namespace {

/// Messages overtake each other by less.
constexpr std::int64_t kLate_ns = 200'000'000;
/// A pause of a driver, whatever the times of recording say.
constexpr std::int64_t kLongestPause_ns = 60'000'000'000;
/// Delays of a recorder; simulated time may also run at half or twice the speed.
constexpr std::int64_t kDelay_ns = 1'000'000'000;
constexpr std::size_t kMostRuns = 16;

class Divider {
 public:
  explicit Divider(std::span<const StampedMessage> messages) : messages_(messages) {
    for (std::size_t i = 0; i < messages.size(); ++i) take(i);
  }

  ClockRuns result() {
    keep_apart();
    leave_out_repeated();
    return std::move(found_);
  }

 private:
  struct Fit {
    bool fits = false;
    std::int64_t mismatch_ns = std::numeric_limits<std::int64_t>::max();
  };

  [[nodiscard]] Fit fit(std::size_t run, const StampedMessage& message) const {
    const ClockRun& clock = runs_[run];
    const std::int64_t ahead_ns = message.stamp_ns - clock.last_stamp_ns;
    const std::int64_t later_ns = message.log_ns - messages_[clock.members.back()].log_ns;
    const std::int64_t mismatch_ns = std::llabs(ahead_ns - later_ns);
    bool fits = mismatch_ns <= std::max(kDelay_ns, later_ns / 2);
    if (run == recent_) fits |= ahead_ns <= kLongestPause_ns;
    return {fits && ahead_ns >= -kLate_ns, mismatch_ns};
  }

  void take(std::size_t number) {
    const StampedMessage& message = messages_[number];
    std::size_t best = runs_.size();
    Fit best_fit;
    if (!runs_.empty()) {
      best_fit = fit(recent_, message);
      if (best_fit.fits) best = recent_;
    }
    if (best == runs_.size() || best_fit.mismatch_ns > kLate_ns) {
      const std::size_t first = runs_.size() > kMostRuns ? runs_.size() - kMostRuns : 0;
      for (std::size_t run = first; run < runs_.size(); ++run) {
        const Fit other = fit(run, message);
        if (!other.fits || (best != runs_.size() && other.mismatch_ns >= best_fit.mismatch_ns)) {
          continue;
        }
        best = run;
        best_fit = other;
      }
    }
    if (best == runs_.size()) runs_.push_back({{}, message.stamp_ns});
    runs_[best].members.push_back(number);
    runs_[best].last_stamp_ns = std::max(runs_[best].last_stamp_ns, message.stamp_ns);
    recent_ = best;
  }

  /// Keeps the largest runs that follow each other; those amid them are odd.
  void keep_apart() {
    constexpr std::size_t kMostKept = 64;
    std::ranges::stable_sort(runs_, std::ranges::greater{},
                             [](const ClockRun& run) { return run.members.size(); });
    for (ClockRun& run : runs_) {
      const bool apart = std::ranges::none_of(found_.runs, [&](const ClockRun& kept) {
        return run.members.front() < kept.members.back() &&
               kept.members.front() < run.members.back();
      });
      if (apart && found_.runs.size() < kMostKept) {
        found_.runs.push_back(std::move(run));
      } else {
        leave_out_odd(run);
      }
    }
    std::ranges::sort(found_.runs, {}, [](const ClockRun& run) { return run.members.front(); });
  }

  void leave_out_odd(const ClockRun& run) {
    found_.odd += run.members.size();
    const std::size_t first = run.members.front();
    if (first == 0) return;
    found_.farthest_odd_ns = std::max(
        found_.farthest_odd_ns, static_cast<std::int64_t>(std::llabs(
                                    messages_[first].stamp_ns - messages_[first - 1].stamp_ns)));
  }

  [[nodiscard]] std::uint64_t key_of(std::size_t number) const {
    constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15U;
    return messages_[number].content ^
           (static_cast<std::uint64_t>(messages_[number].stamp_ns) * kOdd);
  }

  /// A recording that was played again and again is recorded once.
  void leave_out_repeated() {
    if (found_.runs.size() < 2) return;
    std::unordered_set<std::uint64_t> seen;
    std::erase_if(found_.runs, [&](const ClockRun& run) {
      const auto repeated = static_cast<std::size_t>(std::ranges::count_if(
          run.members, [&](std::size_t number) { return seen.contains(key_of(number)); }));
      if (2 * repeated > run.members.size()) {
        found_.repeated.insert(found_.repeated.end(), run.members.begin(), run.members.end());
        return true;
      }
      for (const std::size_t number : run.members) seen.insert(key_of(number));
      return false;
    });
  }

  std::span<const StampedMessage> messages_;
  std::vector<ClockRun> runs_;
  std::size_t recent_ = 0;  // the run of the previous message
  ClockRuns found_;
};

}  // namespace

ClockRuns divide_by_clock(std::span<const StampedMessage> messages) {
  return Divider(messages).result();
}

}  // namespace topogeo::recording
