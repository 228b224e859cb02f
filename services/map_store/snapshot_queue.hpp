// Answers to map requests: made one after the other, cut into pieces, and sent as fast as their
// readers take them.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "topogeo/msg/store.h"

namespace topogeo::map_store {

/// Keeps only one answer in memory at a time.
class SnapshotQueue {
 public:
  /// Largest number of waiting requests; more are refused.
  static constexpr std::size_t kMostRequests = 64;
  /// A reader that takes nothing for so long is dropped.
  static constexpr std::chrono::seconds kPatience{10};

  using Clock = std::chrono::steady_clock;
  using Sink = std::function<void(std::string_view)>;
  /// Writes the bytes of an answer. Throws std::exception when there is none.
  using Source = std::function<void(const msg::SnapshotRequest&, const Sink&)>;
  /// False when the piece cannot be sent now.
  using Send = std::function<bool(const msg::SnapshotPiece&)>;

  SnapshotQueue(std::string robot_id, Source source, Send send);

  /// Adds a request; a repeated one is answered once.
  void add(const msg::SnapshotRequest& request);

  /// Sends pieces for about `slice`. True when nothing is left.
  bool work(Clock::time_point now, std::chrono::milliseconds slice);

  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  /// Numbers of complete answers, refusals with a reason, and answers whose reader was dropped.
  [[nodiscard]] std::uint64_t served() const { return served_; }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  [[nodiscard]] std::uint64_t given_up() const { return given_up_; }

 private:
  struct Answer {
    msg::SnapshotRequest request;
    std::string bytes;
    std::string message;  // why there is none
    std::uint32_t pieces = 0;
    std::uint32_t next = 0;
    Clock::time_point last_sent;
  };
  void make_next(Clock::time_point now);
  [[nodiscard]] msg::SnapshotPiece piece(const Answer& answer) const;

  std::string robot_id_;
  Source source_;
  Send send_;
  std::deque<msg::SnapshotRequest> waiting_;
  std::deque<msg::SnapshotRequest> refused_requests_;
  std::optional<Answer> answer_;
  std::uint64_t sent_ = 0;
  std::uint64_t served_ = 0;
  std::uint64_t refused_ = 0;
  std::uint64_t given_up_ = 0;
};

}  // namespace topogeo::map_store
