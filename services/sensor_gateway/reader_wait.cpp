#include "reader_wait.hpp"

#include <chrono>
#include <utility>

#include "topogeo/support/format.hpp"

namespace topogeo::sensor_gateway {

namespace {

constexpr std::chrono::milliseconds kReaderPoll{20};  // delays no scan noticeably

}  // namespace

ReaderWait::ReaderWait(messaging::EventLoop& loop, std::vector<Wanted> wanted)
    : loop_(loop), wanted_(std::move(wanted)) {}

void ReaderWait::start(Report report, std::function<void()> on_complete) {
  report_ = std::move(report);
  on_complete_ = std::move(on_complete);
  check();
}

void ReaderWait::check() {
  std::string what = missing();
  if (what.empty()) {
    on_complete_();
    return;
  }
  if (what != reported_) report_(what);
  reported_ = std::move(what);
  loop_.call_after(kReaderPoll, [this] { check(); });
}

std::string ReaderWait::missing() const {
  std::string text;
  for (const auto& [topic, programs, connected] : wanted_) {
    if (connected.count() >= programs) continue;
    text += fmt::format("{}{} readers of {}", text.empty() ? "" : ", ", programs, topic);
    if (const std::string lacks = connected.missing(); !lacks.empty()) {
      text += fmt::format(" (one is not connected with {} yet)", lacks);
    }
  }
  return text;
}

}  // namespace topogeo::sensor_gateway
