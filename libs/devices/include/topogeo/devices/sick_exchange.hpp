// One command to a SICK sensor and its outcome: ACK and a reply, or NAK, a refusal or nothing, with
// a limited number of repetitions.
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
    std::int64_t ack_timeout_ns = 0;    ///< between its end and ACK, NAK or the reply
    std::int64_t reply_timeout_ns = 0;  ///< between ACK and the reply
    std::int64_t repeat_gap_ns = 0;     ///< before the command is repeated
    int tries = 1;                      ///< most attempts
    bool repeat_unanswered = true;      ///< else only refused commands
  };
  enum class Result {
    kNone,     ///< no command was sent
    kOpen,     ///< the answer is awaited
    kReplied,  ///< see `mode_reply` if the command changed the mode
    kRefused,  ///< NAK or a telegram "not acknowledged", every time
    kSilent,   ///< no answer in time, the last time
    kNoReply,  ///< ACK but no reply in time
  };

  /// Sends `command` over `line`; drops an open command. The sensor may have heard each attempt of
  /// a repeated command, and nothing tells its later replies from those to the next command: after
  /// such a reply, the next command waits as long as it took, and answers are ignored meanwhile.
  void start(std::vector<std::uint8_t> command, const Limits& limits, const LineSettings& line,
             std::int64_t now_ns);
  void stop() { result_ = Result::kNone; }

  void acknowledged(std::int64_t now_ns);
  void refused(std::int64_t now_ns);
  /// The reply to the command arrived; `reply` if it answers a change of mode.
  void replied(std::optional<PlsModeReply> reply);
  /// Ends an overdue command, or repeats it.
  void tick(std::int64_t now_ns);
  /// Time of the next useful `tick`; the largest number if no command is open.
  [[nodiscard]] std::int64_t due_ns() const;

  /// The command if it has to be written now, once each time.
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
  bool waiting_ = false;    ///< until due_ns_, when the command is sent for the first time
  bool repeating_ = false;  ///< until due_ns_, when the command is repeated
  bool acknowledged_ = false;
  int sent_ = 0;
  std::int64_t first_sent_ns_ = 0;
  std::int64_t due_ns_ = 0;
  std::uint64_t timeouts_ = 0;
  std::uint64_t repeats_ = 0;
  std::uint64_t refusals_ = 0;
};

}  // namespace topogeo::devices
