#include "topogeo/devices/port_search.hpp"

#include <array>
#include <limits>
#include <utility>

#include "topogeo/devices/pls_messages.hpp"
#include "topogeo/devices/rplidar_protocol.hpp"

namespace topogeo::devices {
namespace {

using Question = PortRecognizer::Question;

constexpr std::int64_t kSearchMs_ns = 1'000'000;
/// Opening its port restarts an Arduino, which is silent for up to two seconds then.
constexpr std::int64_t kFirstListen_ns = 3000 * kSearchMs_ns;
constexpr std::int64_t kListen_ns = 500 * kSearchMs_ns;
/// Two scans of a PLS at 9600 baud, so that one of them is whole.
constexpr std::int64_t kSlowListen_ns = 2000 * kSearchMs_ns;
constexpr std::int64_t kAnswer_ns = 300 * kSearchMs_ns;
constexpr std::int64_t kNetworkAnswer_ns = 1000 * kSearchMs_ns;
constexpr std::int64_t kSickAnswer_ns = 600 * kSearchMs_ns;
constexpr LineSettings kFirstLine{115'200, Parity::kNone};

/// Longer than any question.
constexpr std::size_t kLongestEcho = 64;

/// Rates of devices that send by themselves, or of lasers that still scan.
constexpr std::array<LineSettings, 15> kOtherLines{{{230'400, Parity::kNone},
                                                    {128'000, Parity::kNone},
                                                    {512'000, Parity::kNone},
                                                    {256'000, Parity::kNone},
                                                    {460'800, Parity::kNone},
                                                    {1'000'000, Parity::kNone},
                                                    {57'600, Parity::kNone},
                                                    {500'000, Parity::kEven},
                                                    {500'000, Parity::kNone},
                                                    {38'400, Parity::kEven},
                                                    {38'400, Parity::kNone},
                                                    {19'200, Parity::kEven},
                                                    {19'200, Parity::kNone},
                                                    {9'600, Parity::kEven},
                                                    {9'600, Parity::kNone}}};

/// The requests. None moves a base, even one that has no driver here:
/// - "get info" of a RPLIDAR (A5 50) and a YDLIDAR (A5 90) are no commands of an RWI base or of the
///   line protocol. A Roomba reads A5 as "press buttons", of which these are Clock, Schedule and
///   Hour. "Get health" (A5 52) and "stop" (A5 25, A5 65) would press Spot, Clean or Dock, and are
///   never sent.
/// - "VV" of a Hokuyo is no command of these bases; small robots sound their horn at V, if at all.
///   The other commands have letters that drive such robots, and are sent to a Hokuyo only.
/// - The status request of a SICK laser has no letter and no end of line.
/// - The start letter of an LDS-01 is "backward" for many small robots, and is never sent.
std::vector<std::uint8_t> question_bytes(Question question) {
  switch (question) {
    case Question::kRpLidarInfo:
      return rp_request(rp_command::kGetInfo);
    case Question::kYdLidarInfo:
      return yd_request(yd_command::kGetInfo);
    case Question::kSickStatus:
      return sick_command(pls_command::kRequestStatus);
    case Question::kScipVersion:
      return {'\n', 'V', 'V', '\n'};  // behind the rest of an earlier line
    case Question::kColaName: {
      std::vector<std::uint8_t> both = cola_bytes({ColaDialect::kText, "sRN DeviceIdent", {}});
      const std::vector<std::uint8_t> binary =
          cola_bytes({ColaDialect::kBinary, "sRN DeviceIdent", {}});
      both.insert(both.end(), binary.begin(), binary.end());
      return both;
    }
    case Question::kNone:
      break;
  }
  return {};
}

}  // namespace

std::deque<PortSearch::Stage> PortSearch::listening() {
  std::deque<Stage> stages;
  constexpr std::uint32_t kSlowBaud = 38'400;
  for (const LineSettings& line : kOtherLines) {
    stages.push_back({line, line.baud < kSlowBaud ? kSlowListen_ns : kListen_ns});
  }
  return stages;
}

std::deque<PortSearch::Stage> PortSearch::questions(Link link) {
  if (link == Link::kNetwork) {
    return {{kFirstLine, kNetworkAnswer_ns, Question::kScipVersion},
            {kFirstLine, kNetworkAnswer_ns, Question::kColaName}};
  }
  std::deque<Stage> stages;
  for (const std::uint32_t baud : {115'200U, 256'000U, 460'800U, 1'000'000U}) {
    stages.push_back({{baud, Parity::kNone}, kAnswer_ns, Question::kRpLidarInfo});
  }
  for (const std::uint32_t baud : {115'200U, 19'200U}) {
    stages.push_back({{baud, Parity::kNone}, kAnswer_ns, Question::kScipVersion});
  }
  for (const std::uint32_t baud : {128'000U, 230'400U, 512'000U}) {
    stages.push_back({{baud, Parity::kNone}, kAnswer_ns, Question::kYdLidarInfo});
  }
  for (const std::uint32_t baud : {9'600U, 38'400U, 19'200U, 500'000U}) {
    for (const Parity parity : {Parity::kEven, Parity::kNone}) {
      stages.push_back({{baud, parity}, kSickAnswer_ns, Question::kSickStatus});
    }
  }
  return stages;
}

void PortSearch::opened(std::int64_t now_ns) {
  if (done_) return;
  asking_ = other_rates_ = false;
  bytes_ = 0;
  stages_ = {{kFirstLine, link_ == Link::kSerial ? kFirstListen_ns : kListen_ns}};
  begin(now_ns);
}

void PortSearch::lost(std::int64_t /*now_ns*/) {
  orders_.clear();
  stages_.clear();
}

void PortSearch::begin(std::int64_t now_ns) {
  const Stage& stage = stages_.front();
  recognizer_.emplace(stage.line, stage.question);
  answer_.clear();
  orders_.push_back({stage.line, question_bytes(stage.question), {}});
  ends_ns_ = now_ns + stage.duration_ns;
}

void PortSearch::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (done_ || stages_.empty()) return;
  bytes_ += bytes.size();
  device_ = recognizer_->receive(bytes, now_ns);
  if (answer_.size() < kLongestEcho) answer_.insert(answer_.end(), bytes.begin(), bytes.end());
  echoes_ = asking_ && answer_ == question_bytes(stages_.front().question);
  if (!device_ && !echoes_) return;
  done_ = true;
  stages_.clear();
}

bool PortSearch::plan() {
  if (asking_) return false;
  if (bytes_ > 0) {
    if (link_ == Link::kNetwork || std::exchange(other_rates_, true)) return false;
    stages_ = listening();
    return true;
  }
  if (!asks_) return false;
  asking_ = true;
  stages_ = questions(link_);
  return true;
}

void PortSearch::tick(std::int64_t now_ns) {
  if (done_ || stages_.empty() || now_ns < ends_ns_) return;
  stages_.pop_front();
  if (stages_.empty() && !plan()) {
    done_ = true;
    return;
  }
  begin(now_ns);
}

std::int64_t PortSearch::due_ns() const {
  return done_ || stages_.empty() ? std::numeric_limits<std::int64_t>::max() : ends_ns_;
}

std::vector<LineOrder> PortSearch::take_orders() {
  return std::exchange(orders_, {});
}

std::string PortSearch::why_none() const {
  if (echoes_) return "echoes what it receives, as an RWI B21 does (base.model: rwi_b21)";
  if (bytes_ > 0) {
    return (asking_ ? "answers " : "sends ") + std::to_string(bytes_) +
           " bytes that no driver knows";
  }
  return asks_ ? "sends nothing and answers no question" : "sends nothing, and was not asked";
}

}  // namespace topogeo::devices
