// The messages of one topic on a time axis of their own: runs of one clock each, shifted so that
// they follow each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clock_runs.hpp"

namespace topogeo::recording {

/// Two topics on one clock differ by less, between the times of stamps and of recording.
inline constexpr std::int64_t kSameClock_ns = 1'000'000'000;

/// The sum, or the nearest number to it: only hostile recordings have such times.
std::int64_t saturated_sum(std::int64_t a, std::int64_t b);

class StampedTopic {
 public:
  /// `name`: for notes, in the plural. Topics without stamps get the times of recording.
  StampedTopic(std::string name, std::span<const StampedMessage> messages);

  /// Shifts the runs so that they follow each other as the times of recording do, on the clock of
  /// the first run with a tenth of the messages.
  void join_runs();
  /// The same, but runs on the same clock as those of another topic are shifted as these.
  void join_runs_as(const StampedTopic& other);
  void shift_all(std::int64_t by_ns);

  [[nodiscard]] const std::vector<ClockRun>& runs() const { return runs_; }
  /// Messages in runs, by their times of recording: that time and the number.
  [[nodiscard]] const std::vector<std::pair<std::int64_t, std::size_t>>& by_log_time() const {
    return by_log_time_;
  }
  /// The message in a run that was recorded nearest to this time; empty without one.
  [[nodiscard]] std::optional<std::size_t> nearest_by_log_time(std::int64_t log_ns) const;

  /// The shifted time of a message in a run.
  [[nodiscard]] std::int64_t time_of(std::size_t number) const;
  /// That time minus the time of recording.
  [[nodiscard]] std::int64_t offset_of(std::size_t number) const;
  /// Times of the first and the last message; empty without one.
  [[nodiscard]] std::optional<std::pair<std::int64_t, std::int64_t>> range() const;

  /// Notes where the clock is set.
  void note_steps();
  /// Times of all messages, empty for those that are left out. Equal stamps of different messages
  /// are spread by their order. Call once, at the end.
  std::vector<std::optional<std::int64_t>> put_times();
  /// Whether an equal message came before each message; complete after put_times().
  [[nodiscard]] const std::vector<bool>& repeated() const { return repeated_; }
  /// For people; complete after put_times().
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  void use_log_times_without_stamps();
  void index_by_log_time();
  [[nodiscard]] std::size_t first_large_run() const;
  void join(std::size_t run, std::size_t beside);
  [[nodiscard]] std::int64_t period_of(const ClockRun& run) const;
  std::size_t put_times(const ClockRun& run, std::int64_t shift_ns,
                        std::vector<std::optional<std::int64_t>>& times_ns);
  std::vector<std::size_t> same_stamps(const ClockRun& run, std::size_t& place);

  std::string name_;
  std::vector<StampedMessage> messages_;
  std::vector<ClockRun> runs_;
  std::vector<std::int64_t> shifts_ns_;                            // of the runs
  std::vector<std::uint8_t> run_of_;                               // of the messages
  std::vector<std::pair<std::int64_t, std::size_t>> by_log_time_;  // of messages in runs
  std::vector<bool> repeated_;                                     // of the messages
  std::vector<std::string> notes_;
};

}  // namespace topogeo::recording
