#include "stamp_repair.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <utility>

namespace topogeo::recording {
namespace {

/// Two topics on one clock differ by less, between the times of stamps and of recording.
constexpr std::int64_t kSameClock_ns = 1'000'000'000;
constexpr std::size_t kLeastShare = 10;  // of the messages, for a clock that the others follow

double seconds_of(std::int64_t time_ns) {
  return static_cast<double>(time_ns) * 1e-9;
}

/// The sum, or the nearest number to it: only hostile recordings have such times.
std::int64_t plus(std::int64_t a, std::int64_t b) {
  std::int64_t sum = 0;
  if (!__builtin_add_overflow(a, b, &sum)) return sum;
  return a > 0 ? std::numeric_limits<std::int64_t>::max()
               : std::numeric_limits<std::int64_t>::min() + 1;
}

std::string text_with(const char* format, double value, double other = 0.0) {
  char text[200];
  std::snprintf(text, sizeof(text), format, value, other);
  return text;
}

/// One topic.
class StampedTopic {
 public:
  StampedTopic(const char* name, std::span<const StampedMessage> messages)
      : name_(name), messages_(messages.begin(), messages.end()) {
    use_log_times_without_stamps();
    ClockRuns found = divide_by_clock(messages_);
    runs_ = std::move(found.runs);
    shifts_ns_.assign(runs_.size(), 0);
    if (found.odd > 0) {
      notes_.push_back(std::to_string(found.odd) + " of the " + name_ +
                       text_with(" have odd times (up to %.1f s off): they are left out",
                                 seconds_of(found.farthest_odd_ns)));
    }
    repeated_.assign(messages_.size(), false);
    for (const std::size_t number : found.repeated) repeated_[number] = true;
    index_by_log_time();
  }

  [[nodiscard]] const std::vector<ClockRun>& runs() const { return runs_; }
  [[nodiscard]] std::vector<std::string>& notes() { return notes_; }

  /// Lets the runs follow each other.
  void join_runs() {
    const std::size_t first = first_large_run();
    for (std::size_t run = first + 1; run < runs_.size(); ++run) join(run, run - 1);
    for (std::size_t run = first; run > 0; --run) join(run - 1, run);
  }

  /// Shifts the runs as the other topic's on the same clock.
  void join_runs_as(const StampedTopic& other) {
    join_runs();
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      const std::vector<std::size_t>& members = runs_[run].members;
      for (const std::size_t place : {std::size_t{0}, members.size() / 2, members.size() - 1}) {
        const StampedMessage& message = messages_[members[place]];
        const std::optional<std::size_t> near = other.nearest_by_log_time(message.log_ns);
        if (!near) continue;
        const StampedMessage& beside = other.messages_[*near];
        const std::int64_t apart_ns =
            (message.stamp_ns - message.log_ns) - (beside.stamp_ns - beside.log_ns);
        if (std::llabs(apart_ns) > kSameClock_ns) continue;
        shifts_ns_[run] = other.shifts_ns_[other.run_of_[*near]];
        break;
      }
    }
  }

  void note_steps() {
    if (runs_.empty()) return;
    const StampedMessage& first = messages_[runs_.front().members.front()];
    for (std::size_t run = 1; run < runs_.size(); ++run) {
      const StampedMessage& begin = messages_[runs_[run].members.front()];
      notes_.push_back(
          text_with("the clock is set by %.1f s, %.1f s after the beginning: times go on as before",
                    -seconds_of(shifts_ns_[run] - shifts_ns_[run - 1]),
                    seconds_of(begin.log_ns - first.log_ns)));
    }
  }

  std::vector<std::optional<std::int64_t>> times() {
    std::vector<std::optional<std::int64_t>> times_ns(messages_.size());
    std::size_t equal = 0;
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      equal += put_times(runs_[run], shifts_ns_[run], times_ns);
    }
    const auto repeated = std::ranges::count(repeated_, true);
    if (repeated > 0) {
      notes_.push_back(std::to_string(repeated) + " of the " + name_ +
                       " came before: they are left out");
    }
    if (equal > 0) {
      notes_.push_back(std::to_string(equal) + " of the " + name_ +
                       " have the time of the one before: they get times from their order");
    }
    return times_ns;
  }

  [[nodiscard]] std::vector<bool>& repeated() { return repeated_; }

  /// Time of the message on the clock of the first run, minus that of recording.
  [[nodiscard]] std::int64_t offset_of(std::size_t number) const {
    return plus(time_of(number), -messages_[number].log_ns);
  }
  [[nodiscard]] std::optional<std::size_t> nearest_by_log_time(std::int64_t log_ns) const {
    if (by_log_time_.empty()) return std::nullopt;
    auto after = std::ranges::lower_bound(by_log_time_, std::pair(log_ns, std::size_t{0}));
    if (after == by_log_time_.end()) --after;
    if (after != by_log_time_.begin() &&
        log_ns - std::prev(after)->first < std::llabs(after->first - log_ns)) {
      --after;
    }
    return after->second;
  }
  /// Messages in runs, by their times of recording.
  [[nodiscard]] const std::vector<std::pair<std::int64_t, std::size_t>>& by_log_time() const {
    return by_log_time_;
  }
  /// Times of the first and the last message; empty without one.
  [[nodiscard]] std::optional<std::pair<std::int64_t, std::int64_t>> range() const {
    if (runs_.empty()) return std::nullopt;
    return std::pair(time_of(runs_.front().members.front()),
                     plus(runs_.back().last_stamp_ns, shifts_ns_.back()));
  }
  [[nodiscard]] std::int64_t time_of(std::size_t number) const {
    return plus(messages_[number].stamp_ns, shifts_ns_[run_of_[number]]);
  }
  void shift_all(std::int64_t by_ns) {
    for (std::int64_t& shift_ns : shifts_ns_) shift_ns = plus(shift_ns, by_ns);
  }

 private:
  void use_log_times_without_stamps() {
    const auto without = std::ranges::count(messages_, 0, &StampedMessage::stamp_ns);
    if (2 * static_cast<std::size_t>(without) <= messages_.size()) return;
    for (StampedMessage& message : messages_) {
      if (message.stamp_ns == 0) message.stamp_ns = message.log_ns;
    }
    notes_.push_back(std::string("the ") + name_ +
                     " have no time stamps: the times of recording are used");
  }

  void index_by_log_time() {
    run_of_.assign(messages_.size(), 0);
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      for (const std::size_t number : runs_[run].members) {
        run_of_[number] = static_cast<std::uint8_t>(run);
        by_log_time_.emplace_back(messages_[number].log_ns, number);
      }
    }
    std::ranges::sort(by_log_time_);
  }

  [[nodiscard]] std::size_t first_large_run() const {
    std::size_t all = 0;
    for (const ClockRun& run : runs_) all += run.members.size();
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      if (runs_[run].members.size() * kLeastShare >= all) return run;
    }
    return 0;
  }

  /// Puts a run before or after one beside it, as far apart as their times of recording.
  void join(std::size_t run, std::size_t beside) {
    const std::size_t earlier = std::min(run, beside);
    constexpr std::int64_t kFarthest_ns = 1'000'000'000'000'000;  // 12 days
    const std::int64_t apart_ns =
        std::clamp<std::int64_t>(messages_[runs_[earlier + 1].members.front()].log_ns -
                                     messages_[runs_[earlier].members.back()].log_ns,
                                 1, kFarthest_ns);
    const std::int64_t begin_ns = messages_[runs_[earlier + 1].members.front()].stamp_ns;
    const std::int64_t end_ns = runs_[earlier].last_stamp_ns;
    const std::int64_t step_ns = end_ns + apart_ns - begin_ns;
    shifts_ns_[run] = plus(shifts_ns_[beside], run > beside ? step_ns : -step_ns);
  }

  /// Mean time from one message to the next, of those before the last stamp.
  [[nodiscard]] std::int64_t period_of(const ClockRun& run) const {
    const auto at_end = std::ranges::count_if(run.members, [&](std::size_t number) {
      return messages_[number].stamp_ns == run.last_stamp_ns;
    });
    const auto before = static_cast<std::int64_t>(run.members.size()) - at_end;
    const std::int64_t lasts_ns = run.last_stamp_ns - messages_[run.members.front()].stamp_ns;
    return before > 0 ? lasts_ns / before : 0;
  }

  /// Returns the number of messages that had the time of the one before.
  std::size_t put_times(const ClockRun& run, std::int64_t shift_ns,
                        std::vector<std::optional<std::int64_t>>& times_ns) {
    const std::vector<std::size_t>& members = run.members;
    const std::int64_t period_ns = period_of(run);
    std::size_t equal = 0;
    for (std::size_t begin = 0; begin < members.size();) {
      const StampedMessage& first = messages_[members[begin]];
      std::vector<std::size_t> same = {members[begin]};
      std::size_t end = begin + 1;
      for (; end < members.size(); ++end) {
        const StampedMessage& next = messages_[members[end]];
        if (next.stamp_ns != first.stamp_ns) break;
        if (next.content == messages_[same.back()].content) {
          repeated_[members[end]] = true;
        } else {
          same.push_back(members[end]);
        }
      }
      std::int64_t step_ns = period_ns;
      const auto count = static_cast<std::int64_t>(same.size());
      if (end < members.size() && messages_[members[end]].stamp_ns > first.stamp_ns) {
        step_ns = std::min(step_ns, (messages_[members[end]].stamp_ns - first.stamp_ns) / count);
      }
      for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t time_ns = plus(first.stamp_ns + i * step_ns, shift_ns);
        if (time_ns >= 0) times_ns[same[static_cast<std::size_t>(i)]] = time_ns;
      }
      equal += same.size() - 1;
      begin = end;
    }
    return equal;
  }

  const char* name_;
  std::vector<StampedMessage> messages_;
  std::vector<ClockRun> runs_;
  std::vector<std::int64_t> shifts_ns_;                            // of the runs
  std::vector<std::uint8_t> run_of_;                               // of the messages
  std::vector<std::pair<std::int64_t, std::size_t>> by_log_time_;  // of messages in runs
  std::vector<bool> repeated_;                                     // of the messages
  std::vector<std::string> notes_;
};

std::int64_t median_of(std::vector<std::int64_t> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Joins the clocks of two computers by the times of recording, if no times are common.
void join_clocks(StampedTopic& scans, StampedTopic& odometry) {
  const auto range = odometry.range();
  if (!range || scans.by_log_time().empty()) return;
  const std::int64_t first_log_ns = odometry.by_log_time().front().first;
  const std::int64_t last_log_ns = odometry.by_log_time().back().first;
  std::size_t common = 0;
  std::vector<std::int64_t> apart_ns;
  std::vector<std::int64_t> offsets_ns;
  for (const auto& [log_ns, number] : scans.by_log_time()) {
    const std::int64_t time_ns = scans.time_of(number);
    if (time_ns >= plus(range->first, -kSameClock_ns) &&
        time_ns <= plus(range->second, kSameClock_ns)) {
      ++common;
    }
    if (log_ns < first_log_ns || log_ns > last_log_ns) continue;
    const std::size_t near = *odometry.nearest_by_log_time(log_ns);
    apart_ns.push_back(plus(odometry.offset_of(near), -scans.offset_of(number)));
    offsets_ns.push_back(scans.offset_of(number));
  }
  if (common * kLeastShare >= scans.by_log_time().size() || last_log_ns <= first_log_ns ||
      2 * apart_ns.size() < scans.by_log_time().size()) {
    return;
  }
  const std::int64_t shift_ns = median_of(std::move(apart_ns));
  const std::int64_t offset_ns = median_of(std::move(offsets_ns));
  // On the clock that is nearer to that of the recorder.
  if (std::llabs(plus(offset_ns, shift_ns)) <= std::llabs(offset_ns)) {
    scans.shift_all(shift_ns);
  } else {
    odometry.shift_all(-shift_ns);
  }
  scans.notes().push_back(
      text_with("scans and odometry have the times of two clocks (%.1f s apart): the times of "
                "recording join them",
                seconds_of(shift_ns)));
}

}  // namespace

RepairedStamps repair_stamps(std::span<const StampedMessage> scans,
                             std::span<const StampedMessage> odometry) {
  StampedTopic of_odometry("odometry messages", odometry);
  StampedTopic of_scans("scans", scans);
  of_odometry.join_runs();
  of_scans.join_runs_as(of_odometry);
  of_odometry.note_steps();
  if (of_scans.runs().size() != of_odometry.runs().size()) of_scans.note_steps();
  join_clocks(of_scans, of_odometry);
  RepairedStamps repaired;
  repaired.scans_ns = of_scans.times();
  repaired.odometry_ns = of_odometry.times();
  repaired.scans_repeated = std::move(of_scans.repeated());
  repaired.notes = std::move(of_odometry.notes());
  repaired.notes.insert(repaired.notes.end(), of_scans.notes().begin(), of_scans.notes().end());
  return repaired;
}

}  // namespace topogeo::recording
