#include "topogeo/devices/sick_exchange.hpp"

#include <limits>
#include <utility>

#include "topogeo/devices/line_time.hpp"

namespace topogeo::devices {
namespace {

constexpr std::size_t kCommandAt = 4;
constexpr std::uint8_t kReplyBit = 0x80;

}  // namespace

void SickExchange::start(std::vector<std::uint8_t> command, const Limits& limits,
                         const LineSettings& line, std::int64_t now_ns) {
  waiting_ = result_ == Result::kReplied && sent_ > 1;
  command_ = std::move(command);
  limits_ = limits;
  line_ = line;
  result_ = Result::kOpen;
  sent_ = 0;
  if (!waiting_) return send(now_ns);
  to_write_ = false;
  due_ns_ = now_ns + (now_ns - first_sent_ns_) + limits_.repeat_gap_ns;
}

void SickExchange::acknowledged(std::int64_t now_ns) {
  if (!open() || acknowledged_ || waiting_ || repeating_) return;
  acknowledged_ = true;
  due_ns_ = now_ns + limits_.reply_timeout_ns;
}

void SickExchange::refused(std::int64_t now_ns) {
  if (!open() || waiting_ || repeating_) return;
  ++refusals_;
  fail(Result::kRefused, now_ns);
}

void SickExchange::replied(std::optional<PlsModeReply> reply) {
  if (!open() || waiting_) return;
  to_write_ = false;
  mode_reply_ = reply.value_or(PlsModeReply::kDone);
  result_ = Result::kReplied;
}

void SickExchange::tick(std::int64_t now_ns) {
  if (!open() || now_ns < due_ns_) return;
  if (waiting_ || repeating_) {
    if (repeating_) ++repeats_;
    send(now_ns);
    return;
  }
  ++timeouts_;
  fail(acknowledged_ ? Result::kNoReply : Result::kSilent, now_ns);
}

std::int64_t SickExchange::due_ns() const {
  return open() ? due_ns_ : std::numeric_limits<std::int64_t>::max();
}

std::optional<std::vector<std::uint8_t>> SickExchange::take_command() {
  if (!std::exchange(to_write_, false)) return std::nullopt;
  return command_;
}

std::uint8_t SickExchange::code() const {
  return open() ? static_cast<std::uint8_t>(command_[kCommandAt] | kReplyBit) : std::uint8_t{0};
}

void SickExchange::send(std::int64_t now_ns) {
  if (sent_++ == 0) first_sent_ns_ = now_ns;
  to_write_ = true;
  waiting_ = false;
  repeating_ = false;
  acknowledged_ = false;
  due_ns_ = now_ns + line_time_ns(command_.size(), line_) + limits_.ack_timeout_ns;
}

void SickExchange::fail(Result result, std::int64_t now_ns) {
  if (sent_ >= limits_.tries || (result != Result::kRefused && !limits_.repeat_unanswered)) {
    result_ = result;
    return;
  }
  repeating_ = true;
  due_ns_ = now_ns + limits_.repeat_gap_ns;
}

}  // namespace topogeo::devices
