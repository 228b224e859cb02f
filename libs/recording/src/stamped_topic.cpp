#include "stamped_topic.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <limits>

namespace topogeo::recording {
namespace {

constexpr std::size_t kLeastShare = 10;  // of the messages, for a clock that the others follow

double seconds_of(std::int64_t time_ns) {
  return static_cast<double>(time_ns) * 1e-9;
}

}  // namespace

std::int64_t saturated_sum(std::int64_t a, std::int64_t b) {
  std::int64_t sum = 0;
  if (!__builtin_add_overflow(a, b, &sum)) return sum;
  return a > 0 ? std::numeric_limits<std::int64_t>::max()
               : std::numeric_limits<std::int64_t>::min() + 1;
}

StampedTopic::StampedTopic(std::string name, std::span<const StampedMessage> messages)
    : name_(std::move(name)), messages_(messages.begin(), messages.end()) {
  use_log_times_without_stamps();
  ClockRuns found = divide_by_clock(messages_);
  runs_ = std::move(found.runs);
  shifts_ns_.assign(runs_.size(), 0);
  if (found.odd > 0) {
    char text[100];
    std::snprintf(text, sizeof(text), " have odd times (up to %.1f s off): they are left out",
                  seconds_of(found.farthest_odd_ns));
    notes_.push_back(std::to_string(found.odd) + " of the " + name_ + text);
  }
  repeated_.assign(messages_.size(), false);
  for (const std::size_t number : found.repeated) repeated_[number] = true;
  index_by_log_time();
}

void StampedTopic::join_runs() {
  const std::size_t first = first_large_run();
  for (std::size_t run = first + 1; run < runs_.size(); ++run) join(run, run - 1);
  for (std::size_t run = first; run > 0; --run) join(run - 1, run);
}

void StampedTopic::join_runs_as(const StampedTopic& other) {
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

void StampedTopic::shift_all(std::int64_t by_ns) {
  for (std::int64_t& shift_ns : shifts_ns_) shift_ns = saturated_sum(shift_ns, by_ns);
}

std::optional<std::size_t> StampedTopic::nearest_by_log_time(std::int64_t log_ns) const {
  if (by_log_time_.empty()) return std::nullopt;
  auto after = std::ranges::lower_bound(by_log_time_, std::pair(log_ns, std::size_t{0}));
  if (after == by_log_time_.end()) --after;
  if (after != by_log_time_.begin() &&
      log_ns - std::prev(after)->first < std::llabs(after->first - log_ns)) {
    --after;
  }
  return after->second;
}

std::int64_t StampedTopic::time_of(std::size_t number) const {
  return saturated_sum(messages_[number].stamp_ns, shifts_ns_[run_of_[number]]);
}

std::int64_t StampedTopic::offset_of(std::size_t number) const {
  return saturated_sum(time_of(number), -messages_[number].log_ns);
}

std::optional<std::pair<std::int64_t, std::int64_t>> StampedTopic::range() const {
  if (runs_.empty()) return std::nullopt;
  return std::pair(time_of(runs_.front().members.front()),
                   saturated_sum(runs_.back().last_stamp_ns, shifts_ns_.back()));
}

void StampedTopic::note_steps() {
  if (runs_.empty()) return;
  const StampedMessage& first = messages_[runs_.front().members.front()];
  for (std::size_t run = 1; run < runs_.size(); ++run) {
    const StampedMessage& begin = messages_[runs_[run].members.front()];
    char text[160];
    std::snprintf(text, sizeof(text),
                  "the clock is set by %.1f s, %.1f s after the beginning: times go on as before",
                  -seconds_of(shifts_ns_[run] - shifts_ns_[run - 1]),
                  seconds_of(begin.log_ns - first.log_ns));
    notes_.emplace_back(text);
  }
}

std::vector<std::optional<std::int64_t>> StampedTopic::put_times() {
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

void StampedTopic::use_log_times_without_stamps() {
  const auto without = std::ranges::count(messages_, 0, &StampedMessage::stamp_ns);
  if (2 * static_cast<std::size_t>(without) <= messages_.size()) return;
  for (StampedMessage& message : messages_) {
    if (message.stamp_ns == 0) message.stamp_ns = message.log_ns;
  }
  notes_.push_back("the " + name_ + " have no time stamps: the times of recording are used");
}

void StampedTopic::index_by_log_time() {
  run_of_.assign(messages_.size(), 0);
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    for (const std::size_t number : runs_[run].members) {
      run_of_[number] = static_cast<std::uint8_t>(run);
      by_log_time_.emplace_back(messages_[number].log_ns, number);
    }
  }
  std::ranges::sort(by_log_time_);
}

std::size_t StampedTopic::first_large_run() const {
  std::size_t all = 0;
  for (const ClockRun& run : runs_) all += run.members.size();
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    if (runs_[run].members.size() * kLeastShare >= all) return run;
  }
  return 0;
}

/// Puts a run before or after one beside it, as far apart as their times of recording.
void StampedTopic::join(std::size_t run, std::size_t beside) {
  const std::size_t earlier = std::min(run, beside);
  constexpr std::int64_t kFarthest_ns = 1'000'000'000'000'000;  // 12 days
  const std::int64_t apart_ns =
      std::clamp<std::int64_t>(messages_[runs_[earlier + 1].members.front()].log_ns -
                                   messages_[runs_[earlier].members.back()].log_ns,
                               1, kFarthest_ns);
  const std::int64_t begin_ns = messages_[runs_[earlier + 1].members.front()].stamp_ns;
  const std::int64_t end_ns = runs_[earlier].last_stamp_ns;
  const std::int64_t step_ns = end_ns + apart_ns - begin_ns;
  shifts_ns_[run] = saturated_sum(shifts_ns_[beside], run > beside ? step_ns : -step_ns);
}

/// Mean time from one message to the next, of those before the last stamp.
std::int64_t StampedTopic::period_of(const ClockRun& run) const {
  constexpr std::int64_t kLongest_ns = 60'000'000'000;
  const auto at_end = std::ranges::count_if(run.members, [&](std::size_t number) {
    return messages_[number].stamp_ns == run.last_stamp_ns;
  });
  const auto before = static_cast<std::int64_t>(run.members.size()) - at_end;
  const std::int64_t lasts_ns = run.last_stamp_ns - messages_[run.members.front()].stamp_ns;
  return before > 0 ? std::min(lasts_ns / before, kLongest_ns) : 0;
}

/// The different messages from `place` on with one stamp; `place` is then that of the next stamp.
std::vector<std::size_t> StampedTopic::same_stamps(const ClockRun& run, std::size_t& place) {
  const std::vector<std::size_t>& members = run.members;
  std::vector<std::size_t> same = {members[place]};
  for (++place; place < members.size(); ++place) {
    const StampedMessage& next = messages_[members[place]];
    if (next.stamp_ns != messages_[same.front()].stamp_ns) break;
    if (next.content == messages_[same.back()].content) {
      repeated_[members[place]] = true;
    } else {
      same.push_back(members[place]);
    }
  }
  return same;
}

/// Returns the number of messages that had the time of the one before.
std::size_t StampedTopic::put_times(const ClockRun& run, std::int64_t shift_ns,
                                    std::vector<std::optional<std::int64_t>>& times_ns) {
  const std::int64_t period_ns = period_of(run);
  std::size_t equal = 0;
  for (std::size_t place = 0; place < run.members.size();) {
    const std::vector<std::size_t> same = same_stamps(run, place);
    const std::int64_t stamp_ns = messages_[same.front()].stamp_ns;
    const auto count = static_cast<std::int64_t>(same.size());
    std::int64_t step_ns = period_ns;
    if (place < run.members.size()) {
      const std::int64_t next_ns = messages_[run.members[place]].stamp_ns;
      if (next_ns > stamp_ns) step_ns = std::min(step_ns, (next_ns - stamp_ns) / count);
    }
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t time_ns = saturated_sum(stamp_ns + i * step_ns, shift_ns);
      if (time_ns >= 0) times_ns[same[static_cast<std::size_t>(i)]] = time_ns;
    }
    equal += same.size() - 1;
  }
  return equal;
}

}  // namespace topogeo::recording
