#include "topogeo/devices/base_link.hpp"

#include <algorithm>
#include <limits>
#include <string_view>

#include "topogeo/devices/base_start.hpp"
#include "topogeo/devices/base_status.hpp"
#include "topogeo/devices/mcp_units.hpp"

namespace topogeo::devices {
namespace {

/// Longest time between the end of the start sequence and the first report, beyond two periods and
/// the report's transmission. A margin for adapters, not measured on hardware.
constexpr std::int64_t kFirstReportLag_ns = 100'000'000;
/// Limits of the time between two questions to a silent base, which is a twentieth of its silence
/// so that a short absence ends soon: its answer needs a fifth of a second, and a person waits five
/// seconds.
constexpr std::int64_t kShortestProbe_ns = 200'000'000;
constexpr std::int64_t kLongestProbe_ns = 5'000'000'000;
constexpr std::int64_t kProbesPerSilence = 20;
/// A base without an answer for this long is set up anyway, because it may not understand the
/// question. Not sooner, because a setup restarts the reports of a base that has just come back.
constexpr std::int64_t kBlindStart_ns = 15'000'000'000;
/// A base that has left out three reports in succession has stopped.
constexpr std::int64_t kSilentPeriods = 4;

}  // namespace

BaseLink::BaseLink(const BaseSettings& settings, BaseWriter& writer)
    : settings_(settings),
      writer_(writer),
      period_ns_(ticks_ns(report_period_ticks(settings))),
      silence_ns_(std::max(static_cast<std::int64_t>(settings.silence_s * 1e9),
                           kSilentPeriods * period_ns_)),
      reason_(base_state_reason(BaseState::kOffline)) {}

void BaseLink::open(std::int64_t now_ns) {
  reason_.clear();
  phase_ = Phase::kClosed;
  heard_ns_ = now_ns;
  writer_.open(now_ns);
  start(now_ns);
}

void BaseLink::close() {
  reason_ = base_state_reason(BaseState::kOffline);
  phase_ = Phase::kClosed;
  writer_.close();
}

/// Writes everything that the base needs, starting with the line settings.
void BaseLink::start(std::int64_t now_ns) {
  reconnects_ = phase_ == Phase::kProbing;
  phase_ = Phase::kStarting;
  ++starts_;
  started_ns_ = now_ns;
  answered_ = false;
  writer_.queue_opening();
  for (const McpOrder& order : set_up_orders(settings_)) writer_.queue(order);
}

void BaseLink::probe(std::int64_t now_ns) {
  phase_ = Phase::kProbing;
  phase_until_ns_ = now_ns + std::clamp((now_ns - heard_ns_) / kProbesPerSilence, kShortestProbe_ns,
                                        kLongestProbe_ns);
  probe_answer_.clear();
  // Every base speaks ASCII after power-on.
  writer_.write_text("\rBV\r", now_ns);
}

BaseLink::Change BaseLink::reported(bool restarted, std::int64_t now_ns) {
  heard_ns_ = now_ns;
  const bool again = phase_ == Phase::kProbing || (phase_ == Phase::kStarting && reconnects_);
  if (again && !restarted) {
    // After a silence the base goes on as before, so no setup is needed. It may be in the middle of
    // our question.
    writer_.clear_queue();
    if (settings_.dialect == BaseDialect::kBinary) writer_.queue_sync();
  } else if (phase_ != Phase::kWaiting) {
    return Change::kNone;
  }
  phase_ = Phase::kRunning;
  reason_.clear();
  return again ? Change::kResumed : Change::kRunning;
}

BaseLink::Change BaseLink::received(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (phase_ != Phase::kProbing || !restarted(bytes)) return Change::kNone;
  start(now_ns);
  return Change::kSetUp;
}

/// A base that echoes, or unexpectedly speaks ASCII, was switched on anew. Other bytes may begin a
/// report, which needs no action.
bool BaseLink::restarted(std::span<const std::uint8_t> bytes) {
  const std::string_view sign = settings_.dialect == BaseDialect::kAscii ? "BV\r" : "BV";
  probe_answer_.append(bytes.begin(), bytes.end());
  if (probe_answer_.find(sign) != std::string::npos) return true;
  probe_answer_.erase(0, probe_answer_.size() - std::min(probe_answer_.size(), sign.size() - 1));
  return false;
}

BaseLink::Change BaseLink::tick(std::int64_t now_ns) {
  if (phase_ == Phase::kStarting && writer_.queue_empty() && now_ns >= writer_.free_ns()) {
    phase_ = Phase::kWaiting;
    phase_until_ns_ = now_ns + 2 * period_ns_ + report_line_time_ns(settings_) + kFirstReportLag_ns;
  }
  if (phase_ == Phase::kRunning && now_ns >= heard_ns_ + silence_ns_) {
    writer_.clear_queue();
    reason_ = "the base stopped reporting";
    probe(now_ns);
    return Change::kOffline;
  }
  if (phase_ == Phase::kWaiting && now_ns >= phase_until_ns_) {
    reason_ = "the base does not answer";
    probe(now_ns);
    return Change::kOffline;
  }
  if (phase_ == Phase::kProbing && now_ns >= phase_until_ns_) {
    if (answered_ || now_ns >= started_ns_ + kBlindStart_ns) {
      start(now_ns);
      return Change::kSetUp;
    }
    probe(now_ns);
  }
  return Change::kNone;
}

std::int64_t BaseLink::due_ns() const {
  std::int64_t due_ns = std::numeric_limits<std::int64_t>::max();
  if (phase_ == Phase::kClosed) return due_ns;
  if (!writer_.queue_empty() || phase_ == Phase::kStarting) due_ns = writer_.free_ns();
  if (phase_ == Phase::kWaiting || phase_ == Phase::kProbing) {
    due_ns = std::min(due_ns, phase_until_ns_);
  }
  if (phase_ == Phase::kRunning) due_ns = std::min(due_ns, heard_ns_ + silence_ns_);
  return due_ns;
}

}  // namespace topogeo::devices
