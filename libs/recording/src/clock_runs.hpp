// Messages of one topic, divided by the clocks of their stamps: a clock that is set, a glitch of a
// few messages, a second publisher, a recording that was played twice. A stamp is judged by its
// neighbours in the order of arrival and by the times of recording.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace topogeo::recording {

/// Times are within [0, kLatest_ns], so that differences of differences do not overflow.
struct StampedMessage {
  std::int64_t stamp_ns = 0;  ///< of the header
  std::int64_t log_ns = 0;    ///< time of recording
  std::uint64_t content = 0;  ///< equal for equal messages

  static constexpr std::int64_t kLatest_ns = 4'400'000'000'000'000'000;
};

/// Messages whose stamps go on as one clock does.
struct ClockRun {
  std::vector<std::size_t> members;  ///< numbers of messages, in the order of arrival
  std::int64_t last_stamp_ns = 0;    ///< the greatest
};

struct ClockRuns {
  std::vector<ClockRun> runs;         ///< in the order of arrival, one after the other
  std::size_t odd = 0;                ///< messages amid a run with another clock: in no run
  std::vector<std::size_t> repeated;  ///< numbers of messages that came before: in no run
  std::int64_t farthest_odd_ns = 0;   ///< of an odd message from the stamp before it
};

/// A stamp that is late by up to 0.2 s, one up to 60 s ahead, and one as far ahead as its time of
/// recording belong to the clock of the previous message.
ClockRuns divide_by_clock(std::span<const StampedMessage> messages);

}  // namespace topogeo::recording
