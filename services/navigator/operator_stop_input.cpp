#include "operator_stop_input.hpp"

#include <utility>

#include "topogeo/service/base_confirmation.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::navigator {

OperatorStopInput::OperatorStopInput(service::Service& service, const std::filesystem::path& memory,
                                     navigation::Navigator& navigator, std::int64_t start_ns,
                                     std::function<void()> on_change)
    : stop_(memory), wait_(start_ns), navigator_(navigator), on_change_(std::move(on_change)) {
  apply();
  service.subscribe<msg::BaseCommand>(
      [this](const msg::BaseCommand& command, const messaging::SampleInfo& info) {
        take(command, info.writer);
      });
}

void OperatorStopInput::take(const msg::BaseStatus& status) {
  stop_.base_counts(status.stop_count());
  bool changes = wait_.end();
  if (stop_.holds() && service::holds(status)) {
    stop_.hand_over();
    changes = true;
  }
  if (changes) change();
}

void OperatorStopInput::take(const msg::BaseCommand& command, const messaging::Handle& writer) {
  const bool waited = command.kind() != msg::kBaseSetLimits && wait_.end();
  const bool taken = stop_.take(command, writer);
  if (taken) {
    spdlog::warn("{} by {}", stop_.holds() ? "stopped" : "released", command.client_id().c_str());
  }
  if (waited || taken) change();
}

void OperatorStopInput::check(std::int64_t now_ns) {
  if (!wait_.check(now_ns)) return;
  spdlog::info("no base and no operator has sent anything since the start: goals are driven to");
  apply();
}

std::string OperatorStopInput::reason() const {
  if (stop_.holds()) return "stopped by an operator until the release";
  return wait_.waits() ? "waits for an operator's stop" : "";
}

void OperatorStopInput::change() {
  apply();
  on_change_();
}

}  // namespace topogeo::navigator
