// One command to a SICK sensor and what becomes of it: ACK and a reply, or NAK, a refusal or
// nothing, with a limited number of repetitions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/devices/pls_messages.hpp"
#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

class SickExchange {
 public:
  struct Limits {
    std::int64_t ack_timeout_ns = 0;    ///< from the end of the command to ACK, NAK or the reply
    std::int64_t reply_timeout_ns = 0;  ///< from ACK to the reply
    std::int64_t repeat_gap_ns = 0;     ///< before the command is sent again
    int tries = 1;                      ///< how often it is sent at most
    bool repeat_unanswered = true;      ///< or only what was refused
  };
  enum class Result {
    kNone,     ///< nothing was asked
    kOpen,     ///< the answer is awaited
    kReplied,  ///< see `mode_reply` if the command changed the mode
    kRefused,  ///< NAK or a telegram "not acknowledged", every time
    kSilent,   ///< no answer in time, the last time
    kNoReply,  ///< ACK but no reply in time
  };

  /// Sends `command` over `line`; what was open is forgotten.
  void start(std::vector<std::uint8_t> command, const Limits& limits, const LineSettings& line,
             std::int64_t now_ns);
  void stop() { result_ = Result::kNone; }

  void acknowledged(std::int64_t now_ns);
  void refused(std::int64_t now_ns);
  /// The reply to the command came; `reply` is that to a change of mode.
  void replied(std::optional<PlsModeReply> reply);
  /// Ends what took too long, or sends the command again.
  void tick(std::int64_t now_ns);
  /// When `tick` has something to do; the largest number while nothing is open.
  [[nodiscard]] std::int64_t due_ns() const;

  /// The command when it is to be written now, once each time.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> take_command();

  [[nodiscard]] Result result() const { return result_; }
  [[nodiscard]] bool open() const { return result_ == Result::kOpen; }
  [[nodiscard]] PlsModeReply mode_reply() const { return mode_reply_; }
  [[nodiscard]] std::uint8_t code() const;
  [[nodiscard]] std::uint64_t timeouts() const { return timeouts_; }
  [[nodiscard]] std::uint64_t repeats() const { return repeats_; }
  [[nodiscard]] std::uint64_t refusals() const { return refusals_; }

 private:
  void send(std::int64_t now_ns);
  void fail(Result result, std::int64_t now_ns);

  std::vector<std::uint8_t> command_;
  Limits limits_;
  LineSettings line_;
  Result result_ = Result::kNone;
  PlsModeReply mode_reply_ = PlsModeReply::kDone;
  bool to_write_ = false;
  bool repeating_ = false;  ///< until due_ns_, when the command is sent again
  bool acknowledged_ = false;
  int sent_ = 0;
  std::int64_t due_ns_ = 0;
  std::uint64_t timeouts_ = 0;
  std::uint64_t repeats_ = 0;
  std::uint64_t refusals_ = 0;
};

}  // namespace topogeo::devices
